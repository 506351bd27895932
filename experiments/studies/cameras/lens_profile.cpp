#include "experiments/studies/cameras/lens_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/illumination.h"
#include "engine/render/integrators/chart_tracer.h"

namespace lensproof::studies {

namespace {

using calibration::kQuantities;

constexpr std::array<const char*, 3> kChannels = {"R", "G", "B"};
constexpr int kGreen = 1;

// Linear interpolation between 400 field angles errs by h″ Δθ² / 8: below 0.1 µm for a 100 mm lens with a field of 25°.
constexpr int kFieldAngles = 400;
// Illumination varies slowly with wavelength: every fourth stratum is enough, and much faster.
constexpr std::size_t kIlluminationStride = 4;

using PerChannel = std::array<double, 3>;
using PerWavelength = std::array<double, kShownWavelengths_nm.size()>;

/// What each channel makes of a white's light, a stratum each; up to a common factor.
std::vector<PerChannel> channel_weights(const render::Camera& camera) {
    const std::vector<double> white = render::white_radiance(camera, 1000.0);
    std::vector<PerChannel> weights;
    std::ranges::transform(camera.film().rgb_weights, white, std::back_inserter(weights),
                           [](const Vec3d& w, double radiance) {
                               return PerChannel{w.x * radiance, w.y * radiance, w.z * radiance};
                           });
    return weights;
}

template <std::size_t n>
std::array<double, n> mixed(const std::array<double, n>& a, const std::array<double, n>& b, double t) {
    std::array<double, n> result{};
    std::ranges::transform(a, b, result.begin(), [t](double from, double to) { return std::lerp(from, to, t); });
    return result;
}

/// Image heights (mm) over field angle: of each channel, the mean of the wavelengths' chief rays, and of some
/// wavelengths alone.
struct HeightTable {
    struct Row {
        double field_angle = 0.0;
        PerChannel height{};
        PerWavelength alone{};
    };
    std::vector<Row> rows;

    /// Where the green channel has `height_mm`.
    [[nodiscard]] std::optional<Row> at_green_height(double height_mm) const {
        for (std::size_t i = 1; i < rows.size(); ++i) {
            const Row& low = rows[i - 1];
            const Row& high = rows[i];
            if (height_mm <= high.height[kGreen]) {
                const double t = (height_mm - low.height[kGreen]) / (high.height[kGreen] - low.height[kGreen]);
                return Row{.field_angle = std::lerp(low.field_angle, high.field_angle, t),
                           .height = mixed(low.height, high.height, t),
                           .alone = mixed(low.alone, high.alone, t)};
            }
        }
        return std::nullopt;
    }
};

HeightTable chief_ray_heights(const render::Camera& camera) {
    const std::vector<PerChannel> weights = channel_weights(camera);
    std::vector<optics::ChiefRays> rays;
    double field = std::numbers::pi;
    for (const double nm : camera.grid().strata.midpoints()) {
        rays.emplace_back(*camera.lens(), nm);
        field = std::min(field, rays.back().largest_field());
    }
    std::vector<optics::ChiefRays> alone;
    alone.reserve(kShownWavelengths_nm.size());
    for (const double nm : kShownWavelengths_nm) {
        alone.emplace_back(*camera.lens(), nm);
    }
    HeightTable table;
    table.rows.resize(kFieldAngles);
    parallel_for(
        kFieldAngles, 0,
        [&](int i) {
            const double angle = field * i / (kFieldAngles - 1) * (1.0 - 1e-12);
            PerChannel sum{};
            PerChannel weight{};
            for (std::size_t k = 0; k < rays.size(); ++k) {
                const std::optional<optics::ChiefRay> ray = rays[k].at_field(angle);
                for (std::size_t c = 0; ray && c < 3; ++c) {
                    sum[c] += weights[k][c] * ray->image_height;
                    weight[c] += weights[k][c];
                }
            }
            HeightTable::Row& row = table.rows[i];
            row.field_angle = angle;
            for (std::size_t c = 0; c < 3; ++c) {
                row.height[c] = sum[c] / weight[c];
            }
            for (std::size_t w = 0; w < alone.size(); ++w) {
                const std::optional<optics::ChiefRay> ray = alone[w].at_field(angle);
                row.alone[w] = ray ? ray->image_height : kNaN;
            }
        },
        [](int) {});
    return table;
}

/// Light of an even scene that each channel gets at `height_mm`, in a common unit.
PerChannel light_at(const std::vector<optics::TraceLens<double>>& strata, const std::vector<PerChannel>& weights,
                    double height_mm) {
    PerChannel light{};
    for (std::size_t k = 0; k < strata.size(); k += kIlluminationStride) {
        const double transmitted = optics::image_bundle(strata[k], height_mm).transmitted;
        for (std::size_t c = 0; c < 3; ++c) {
            light[c] += weights[k][c] * transmitted;
        }
    }
    return light;
}

void add_geometry(const render::Camera& camera, double half_diagonal_mm, calibration::Profile& profile) {
    const HeightTable table = chief_ray_heights(camera);
    const double pitch_mm = camera.sensor().pixel_pitch_mm;
    const double focal = table.rows[1].height[kGreen] / table.rows[1].field_angle;
    for (const double x : calibration::standard_image_heights()) {
        const double r = x * half_diagonal_mm;
        const std::optional<HeightTable::Row> row = table.at_green_height(r);
        if (!row) {
            break;
        }
        const double angle = row->field_angle;
        calibration::append_exact(profile.curves[kQuantities.field_angle.key()], x, angle / kDegree);
        if (angle < 89.0 * kDegree) {
            calibration::append_exact(profile.curves[kQuantities.distortion.key()], x,
                                      x > 0.0 ? 100.0 * (r / (focal * std::tan(angle)) - 1.0) : 0.0);
        }
        calibration::append_exact(profile.curves[kQuantities.equidistant_distortion.key()], x,
                                  x > 0.0 ? 100.0 * (r / (focal * angle) - 1.0) : 0.0);
        for (const int c : {0, 2}) {
            calibration::append_exact(profile.curves[kQuantities.chromatic_shift.key(kChannels[c])], x,
                                      (row->height[c] - row->height[kGreen]) / pitch_mm);
        }
        for (std::size_t w = 0; w < row->alone.size(); ++w) {
            if (std::isfinite(row->alone[w])) {
                const std::string wavelength = fmt::format("{:g}nm", kShownWavelengths_nm[w]);
                calibration::append_exact(profile.curves[kQuantities.chromatic_shift.key(wavelength)], x,
                                          (row->alone[w] - row->height[kGreen]) / pitch_mm);
            }
        }
    }
}

void add_vignetting(const render::Camera& camera, double half_diagonal_mm, calibration::Profile& profile) {
    const std::vector<double> heights = calibration::standard_image_heights();
    const std::vector<PerChannel> weights = channel_weights(camera);
    std::vector<PerChannel> light(heights.size());
    parallel_for(
        static_cast<int>(heights.size()), 0,
        [&](int i) { light[i] = light_at(camera.exact().lens().at(), weights, heights[i] * half_diagonal_mm); },
        [](int) {});
    for (std::size_t i = 0; i < heights.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double ratio = light[i][c] / light[0][c];
            if (ratio > 0.0) {
                calibration::append_exact(profile.curves[kQuantities.vignetting.key(kChannels[c])], heights[i], ratio);
                calibration::append_exact(profile.curves[kQuantities.vignetting_ev.key(kChannels[c])], heights[i],
                                          std::log2(ratio));
            }
        }
    }
}

}  // namespace

render::CameraSettings camera_like(const calibration::Profile& like, const std::string& lens) {
    if (!like.pixel_pitch_um) {
        throw InputError(fmt::format("{}: has no pixel_pitch_um, which {} needs to be set beside it", like.name, lens));
    }
    return {.lens = lens, .sensor = {like.width_px, like.height_px, *like.pixel_pitch_um / 1e3}, .response = "camera"};
}

calibration::Profile lens_profile(const render::Camera& camera) {
    calibration::Profile profile;
    profile.name = camera.lens()->name + ", traced";
    profile.source.kind = "lens";
    profile.source.lens = camera.lens()->name;
    profile.width_px = camera.sensor().width;
    profile.height_px = camera.sensor().height;
    profile.pixel_pitch_um = 1e3 * camera.sensor().pixel_pitch_mm;
    const double half_diagonal_mm = calibration::half_diagonal_px(profile) * camera.sensor().pixel_pitch_mm;
    add_geometry(camera, half_diagonal_mm, profile);
    add_vignetting(camera, half_diagonal_mm, profile);
    return profile;
}

}  // namespace lensproof::studies
