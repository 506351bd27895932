#include "calibration/photographed/imaged_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/bisect.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/focus.h"
#include "engine/optics/illumination.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/illuminant.h"
#include "engine/spectral/sensor_response.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::calibration {

namespace {

constexpr double kRoundedStop = 1.05;
constexpr double kNearAxis = 1e-4;  // rad: third order is 1e-8 of it

/// The chief rays of each wavelength.
class SeenRays {
  public:
    SeenRays(const optics::Lens& lens, const std::vector<SeenWavelength>& light) : light_(light) {
        rays_.reserve(light.size());
        for (const SeenWavelength& of : light) {
            rays_.emplace_back(lens, of.wavelength_nm, optics::Rims::follow);
            largest_field_ = std::min(largest_field_, rays_.back().largest_field());
        }
    }

    [[nodiscard]] double largest_field() const { return largest_field_; }

    /// Each channel's height; nothing where a wavelength's ray does not arrive.
    [[nodiscard]] std::optional<std::array<double, 3>> heights(double field_angle) const {
        std::array<double, 3> sum{};
        std::array<double, 3> total{};
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const std::optional<optics::ChiefRay> ray = rays_[i].at_field(field_angle);
            if (!ray) {
                return std::nullopt;
            }
            for (std::size_t c = 0; c < 3; ++c) {
                sum[c] += light_[i].weight[c] * ray->image_height;
                total[c] += light_[i].weight[c];
            }
        }
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] /= total[c];
        }
        return sum;
    }

  private:
    const std::vector<SeenWavelength>& light_;
    std::vector<optics::ChiefRays> rays_;
    double largest_field_ = std::numbers::pi;
};

}  // namespace

std::vector<SeenWavelength> camera_wavelengths(const optics::Lens& lens) {
    const spectral::Illuminant daylight = spectral::illuminant("D65");
    const spectral::SensorResponse sensor = spectral::sensor_response("camera", {}, daylight);
    const spectral::WavelengthStrata strata;
    const std::vector<Vec3d> weights = spectral::stratum_weights(sensor, strata, daylight);
    const optics::WavelengthRange covered = optics::wavelength_range(lens);
    std::vector<SeenWavelength> light;
    for (int i = 0; i < strata.count; ++i) {
        const double nm = strata.midpoint(i);
        if (nm >= covered.min_nm && nm <= covered.max_nm) {
            const double power = daylight.relative(nm);
            const Vec3d& w = weights[static_cast<std::size_t>(i)];
            light.push_back({.wavelength_nm = nm, .weight = {w.x * power, w.y * power, w.z * power}});
        }
    }
    return light;
}

ImagedField imaged_field(const optics::Lens& lens, const std::vector<SeenWavelength>& light, double up_to_mm,
                         int count) {
    const SeenRays rays(lens, light);
    ImagedField field{.field_angle = {0.0}, .height_mm = {{}}};
    if (const auto near_axis = rays.heights(kNearAxis)) {
        std::ranges::transform(*near_axis, field.focal_length_mm.begin(),
                               [](double height) { return height / kNearAxis; });
    }
    const auto is_within = [&](double angle) {
        const auto heights = rays.heights(angle);
        return heights && (*heights)[1] <= up_to_mm;
    };
    double end = rays.largest_field() * (1.0 - 1e-9);
    if (!is_within(end)) {
        end = bisected({0.0, end}, 40, is_within).inside;
    }
    for (int i = 1; i <= count; ++i) {
        const double angle = end * i / count;
        const auto heights = rays.heights(angle);
        if (!heights || !((*heights)[1] > field.largest_mm())) {
            break;
        }
        field.field_angle.push_back(angle);
        field.height_mm.push_back(*heights);
    }
    return field;
}

std::optional<double> light_falloff(const optics::Lens& lens, double f_number, double height_mm, double wavelength_nm) {
    const double full = optics::paraxial_data(optics::at_wavelength<double>(lens, wavelength_nm)).f_number;
    if (!(f_number * kRoundedStop >= full)) {
        return std::nullopt;
    }
    const optics::Lens stopped = f_number > full ? optics::with_f_number(lens, f_number, wavelength_nm) : lens;
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(stopped, wavelength_nm);
    const double axis = optics::image_bundle(traced, 0.0).transmitted;
    if (!(axis > 0.0)) {
        return std::nullopt;
    }
    return optics::image_bundle(traced, height_mm).transmitted / axis;
}

}  // namespace lensproof::calibration
