// engine/check/rays.h — real rays that the checks ask about, and where they fail.
#pragma once
#include <string>
#include <vector>

#include "engine/check/checked_lens.h"

namespace lensproof::check {

/// What became of a ray towards the image plane.
struct RayFate {
    optics::RayStatus status = optics::RayStatus::ok;
    int surface = 0;                 // from 0: where it failed, or was cut first
    bool is_backwards = false;       // it met `surface` before the one that bent it last: no physical order
    double largest_incidence = 0.0;  // rad
    int steepest_surface = 0;
    Ray<double> ray;  // behind the last surface that it reached

    [[nodiscard]] bool passes() const { return status == optics::RayStatus::ok && !is_backwards; }
};

RayFate follow(const optics::TraceLens<double>& lens, const Ray<double>& ray, optics::Rims rims = optics::Rims::clip);

/// A failed ray's fate in words: "it misses surface 3".
std::string words(const RayFate& fate);

/// The lens with rims so wide that none cuts; with `keep_stop`, the stop still does.
optics::TraceLens<double> without_rims(const CheckedLens& checked, bool keep_stop);

/// The real rays from the axial object point. They are told apart by their height in the plane of the first vertex
/// (of a surface that changes light), which is the beam's semi-diameter in front of the lens where the object is far,
/// and less where it is near.
struct AxialBeam {
    double height = 0.0;     // mm, in the first vertex's plane: the largest up to which every ray passes
    RayFate limit;           // of the ray just above
    double exit_sine = 0.0;  // of the outermost ray's angle with the axis behind the lens
};

/// What an axial beam is held against: the paraxial ray from the same object point through the stop's edge.
struct ParaxialBeam {
    double height = 0.0;    // mm, in the first vertex's plane
    double f_number = 0.0;  // the working one, 1 / (2 |u'|): that of the lens where the object is far
};

ParaxialBeam paraxial_beam(const CheckedLens& checked);

AxialBeam axial_beam(const CheckedLens& checked);

/// The beam that the stop alone would leave.
AxialBeam stop_limited_beam(const CheckedLens& checked);

/// How far from the axis the axial beam's rays meet planes behind the lens: heights y + t z, z mm from the last vertex,
/// each ray weighed with the ring of the pupil that it stands for.
struct AxialSpread {
    double yy = 0.0;  // mean of y²
    double yt = 0.0;
    double tt = 0.0;

    /// The rms distance, mm.
    [[nodiscard]] double at(double z) const;
    /// Where that is smallest.
    [[nodiscard]] double best_z() const { return tt > 0.0 ? -yt / tt : 0.0; }
};

/// Of the rays up to `beam_height` in the first vertex's plane.
AxialSpread axial_spread(const CheckedLens& checked, double beam_height);

/// Whether the last thickness ends off the paraxial image and where real rays of the axial beam are sharpest, at the
/// reference wavelength or at all of the file's together, to a tenth of the way there from the paraxial image, or where
/// the beam's edge crosses the axis, to a fiftieth: then it is where a designer puts the sensor. A digit's slip seldom
/// meets it. Of centred lenses; those of cylinders, too.
bool stands_at_best_focus(const CheckedLens& checked);

}  // namespace lensproof::check
