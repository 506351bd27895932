#include "engine/optics/illumination.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace lensproof {

namespace {

/// A ray from the sensor, by its direction cosines (l, m).
class SensorPoint {
  public:
    SensorPoint(const TraceLens<double>& lens, double height) : lens_(lens), height_(height) {}

    /// The transmittance towards the scene; nothing where a rim or total reflection ends the ray.
    [[nodiscard]] std::optional<double> transmittance(Vec2d cosines) const {
        const double z2 = 1.0 - cosines.x * cosines.x - cosines.y * cosines.y;
        if (z2 <= 0.0) {
            return std::nullopt;
        }
        const Ray<double> ray{{0.0, height_, lens_.image_z}, {cosines.x, cosines.y, -std::sqrt(z2)}};
        const TracedRay<double> traced = trace<Direction::reverse>(lens_, ray);
        return traced.status == RayStatus::ok ? std::optional(traced.transmittance) : std::nullopt;
    }

    /// The mean of passing directions on a grid over the rear element, refined around the first one found.
    [[nodiscard]] std::optional<Vec2d> bundle_centre() const {
        const TraceSurface<double>& rear = lens_.surfaces.back();
        const double radius = std::sqrt(rear.semi_diameter_squared);
        for (const int cells : {32, 128, 512}) {
            Vec2d sum{};
            int passed = 0;
            for (int i = 0; i < cells; ++i) {
                for (int k = 0; k < cells; ++k) {
                    const double x = radius * (2.0 * (i + 0.5) / cells - 1.0);
                    const double y = radius * (2.0 * (k + 0.5) / cells - 1.0);
                    const Vec3d towards = normalized(Vec3d{x, y - height_, rear.vertex_z - lens_.image_z});
                    if (transmittance({towards.x, towards.y})) {
                        sum = {sum.x + towards.x, sum.y + towards.y};
                        ++passed;
                    }
                }
            }
            if (passed >= 8) {
                return Vec2d{sum.x / passed, sum.y / passed};
            }
        }
        return std::nullopt;
    }

  private:
    const TraceLens<double>& lens_;
    double height_;
};

Vec2d along(Vec2d from, double azimuth, double distance) {
    return {from.x + distance * std::cos(azimuth), from.y + distance * std::sin(azimuth)};
}

// Gauss-Legendre nodes and weights on [0, 1], six points (Abramowitz & Stegun, table 25.4).
constexpr std::array<double, 6> kNodes = {0.033765242898424, 0.169395306766868, 0.380690406958402,
                                          0.619309593041598, 0.830604693233132, 0.966234757101576};
constexpr std::array<double, 6> kWeights = {0.085662246189585, 0.180380786524069, 0.233956967286346,
                                            0.233956967286346, 0.180380786524069, 0.085662246189585};

}  // namespace

Bundle image_bundle(const TraceLens<double>& lens, double image_height, int azimuths) {
    const SensorPoint point(lens, image_height);
    const std::optional<Vec2d> centre = point.bundle_centre();
    if (!centre || !point.transmittance(*centre)) {
        return {};
    }
    Bundle bundle;
    for (int i = 0; i < azimuths; ++i) {
        const double azimuth = 2.0 * std::numbers::pi * (i + 0.5) / azimuths;
        double inside = 0.0;
        double outside = 2.0;
        for (int halving = 0; halving < 50; ++halving) {
            const double middle = 0.5 * (inside + outside);
            (point.transmittance(along(*centre, azimuth, middle)) ? inside : outside) = middle;
        }
        double mean_transmittance = 0.0;  // over the wedge, weighted with the distance from its tip
        for (std::size_t k = 0; k < kNodes.size(); ++k) {
            const double share = point.transmittance(along(*centre, azimuth, inside * kNodes[k])).value_or(0.0);
            mean_transmittance += 2.0 * kWeights[k] * kNodes[k] * share;
        }
        const double wedge = 0.5 * inside * inside * 2.0 * std::numbers::pi / azimuths;
        bundle.projected_solid_angle += wedge;
        bundle.transmitted += wedge * mean_transmittance;
    }
    return bundle;
}

}  // namespace lensproof
