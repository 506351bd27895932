// experiments/studies/stability/extreme_parts.h — what the extremes are put together from.
#pragma once
#include <random>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/optics/lens.h"

namespace lensproof::studies {

inline constexpr double kFlatRadius = kInfinity;

/// A surface of a prescription; `n` is the index behind it. Lengths in mm.
struct SurfaceRow {
    double radius = kFlatRadius;
    double thickness = 0.0;
    double n = 1.0;
    double semi_diameter = 1e6;
    double conic = 0.0;
    optics::AsphereTerms asphere{};
    optics::Misalignment misalignment{};
};

/// The rows behind an open stop, which stands in the plane of the first vertex.
optics::Prescription prescription_of(const std::vector<SurfaceRow>& rows);

/// The rows as a lens, by way of a prescription, as a file's lens is made. Throws InputError where make_lens refuses
/// them.
optics::TraceLens<double> lens_of(const std::vector<SurfaceRow>& rows);

/// A ray from `origin` through `aim`.
Ray<double> ray_through(const Vec3d& origin, const Vec3d& aim);

/// Rays through random points of the disc of `height` around the origin, with random slopes up to `slope` in x and y,
/// from `distance` in front of it. The first goes along the axis.
std::vector<Ray<double>> random_rays(double height, double slope, std::mt19937_64& random, double distance = 20.0);

/// `low`, `high` and what lies between, `per_decade` to a factor of ten.
std::vector<double> decades(double low, double high, double per_decade = 1.0);

/// How many rays an extreme traces at each value.
inline constexpr int kRaysPerValue = 32;

}  // namespace lensproof::studies
