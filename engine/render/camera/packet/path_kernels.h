// engine/render/camera/packet/path_kernels.h — the loops that camera paths start with and are weighed in, one of each
// for each width of packets.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/optics/packet/trace_batch.h"
#include "engine/pupil/pupil_slice.h"
#include "engine/render/camera/packet/ideal_path.h"
#include "engine/render/camera/packet/path_chunk.h"
#include "engine/render/camera/packet/profile_path.h"
#include "engine/render/camera/packet/shared_chunk.h"

namespace lensproof::render {

/// Paths out of a camera with a lens's profile; aligned for packets.
struct ProfilePathColumns {
    Vec2<const double*> film;
    Ray<const double*> ray;
};

/// The loops of one level; all levels yield the same bits.
struct PathKernels {
    /// Draws `count` samples: pixel, sample, film point, wavelength, numbers for the pupil. Moves the cursor.
    void (*draw_samples)(const PathSampling& sampling, int count, PathCursor& cursor, PathStarts& starts);

    /// Points of the pupil and their areas; of those that are drawn in defence it leaves −1 as area.
    void (*draw_pupil_points)(const pupil::PupilSliceTables& slices, PathStarts& starts);

    /// From film and pupil points the rays and their etendue.
    void (*aim_rays)(double film_z, double pupil_z, PathStarts& starts, optics::RayBatch<double>& rays);

    /// From film points and numbers for the pupil the rays out of an ideal camera, and their weights.
    void (*leave_ideal_camera)(const IdealOpticsColumns& optics, PathStarts& starts, optics::RayBatch<double>& rays);

    /// The same out of a camera with a lens's profile, with weights but for the filter's; 0: no path.
    void (*leave_profile_camera)(const ProfileTables& tables, PathStarts& starts, optics::RayBatch<double>& rays);

    /// Where such paths end at the others' wavelengths.
    void (*meet_profile_film)(const ProfileTables& tables, const ProfilePathColumns& paths, SharedPaths& shared);

    /// Where rays behind the lens cross film and pupil.
    void (*cross_film)(double film_z, double pupil_z, const optics::RayBatch<double>& behind, FilmMeetings& meetings);
    void (*cross_film_in_float)(double film_z, double pupil_z, const optics::RayBatch<float>& behind,
                                FilmMeetings& meetings);

    /// The pdfs of the pupil points, a wavelength each.
    void (*weigh_pupil_points)(const pupil::PupilSliceTables& slices, const std::uint16_t* wavelength, int count,
                               FilmMeetings& meetings);

    /// Which of the others' rays arrive within so many millimetres of their pixel's border; returns how many.
    int (*find_at_borders)(const Sensor& sensor, double within_mm, const SharedPaths& paths, OtherRays& found);

    /// From meetings and heroes the weights and pdfs.
    void (*trace_shared)(const Sensor& sensor, SharedPaths& paths);
};

/// Those of a level, or of the widest; throws as `LoopsByLevel` does.
const PathKernels& path_kernels(std::optional<SimdLevel> level);

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
PathKernels path_kernels_at();

}  // namespace lensproof::render
