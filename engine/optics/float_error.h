// engine/optics/float_error.h — what tracing in float costs: the same rays in double, and the distances between them.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/ghost_path.h"

namespace lensproof::optics {

/// What becomes of a ray: its status, and the surface that gave it, counted from 0.
struct RayFate {
    RayStatus status = RayStatus::ok;
    int surface = -1;
    friend bool operator==(const RayFate&, const RayFate&) = default;
};

/// One ray traced in float and in double. Each has the lens and the ray rounded to its own precision, so the distances
/// hold the rounding of the input too.
struct RayInFloat {
    std::vector<double> off_um;        // between the points on each surface that both reach, in the order of the light
    std::optional<double> end_off_um;  // on the image plane, or in reverse on the first surface, where both arrive
    RayFate in_float;
    RayFate in_double;
};

RayInFloat trace_in_float(const TraceLens<float>& lens_in_float, const TraceLens<double>& lens, const Ray<double>& ray,
                          Direction direction, Rims rims);

/// The same of a ray along a ghost.
RayInFloat trace_ghost_in_float(const TraceLens<float>& lens_in_float, const TraceLens<double>& lens,
                                const GhostPath& path, const Ray<double>& ray, Rims rims);

/// Some distances, µm.
struct Distances {
    int points = 0;
    double largest_um = 0.0;
    double sum_of_squares = 0.0;  // µm²

    void add(double um);
    [[nodiscard]] double rms_um() const;
};

/// What float costs a number of rays.
struct FloatError {
    int rays = 0;
    int other_fates = 0;  // that end otherwise, or elsewhere
    Distances at_end;     // on the image plane, or in reverse on the first surface
    Distances anywhere;   // on all surfaces, and on the image plane

    void add(const RayInFloat& ray);
};

/// What float is allowed to cost in a lens that is so long from its first vertex to the image plane: 1e-3 µm a mm,
/// which is 8 ulps of a float of that length.
double float_error_bound_um(double system_length_mm);

}  // namespace lensproof::optics
