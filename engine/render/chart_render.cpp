#include "engine/render/chart_render.h"

#include <array>
#include <cmath>

#include "engine/render/parallel.h"
#include "engine/render/sampler.h"
#include "engine/spectral/spectral_exr.h"

namespace lensproof {

namespace {

/// Reflectance of the world where a ray that left the lens arrives, in the white's own terms.
double seen_reflectance(const SeenChart& view, const Ray<double>& outwards) {
    const Vec3d origin = rotate_back(view.pose, camera_to_lens(outwards.origin) - view.pose.translation);
    const Vec3d direction = rotate_back(view.pose, camera_to_lens(outwards.direction));
    const double distance = -origin.z / direction.z;
    if (!(distance > 0.0) || !std::isfinite(distance)) {
        return view.chart.white_reflectance;
    }
    return reflectance(view.chart, origin.x + distance * direction.x, origin.y + distance * direction.y);
}

struct Sample {
    int stratum = 0;
    double irradiance = 0.0;  // this sample's estimate, W·m⁻²·nm⁻¹
};

Sample sample_path(const SeenChart& view, const PupilMap& pupil, const std::array<double, 5>& xi, int u, int v) {
    const auto count = static_cast<double>(view.strata.size());
    Sample sample{.stratum = static_cast<int>(xi[4] * count)};
    const WavelengthStratum& stratum = view.strata[sample.stratum];

    const Vec2d at = view.sensor.position(u - 0.5 + xi[0], v - 0.5 + xi[1]);
    const double band_position = count > 1.0 ? sample.stratum / (count - 1.0) : 0.0;
    const PupilSample in_pupil = pupil.sample(at, band_position, xi[2], xi[3]);
    if (!(in_pupil.density > 0.0)) {
        return sample;
    }
    const Vec3d film_point{at.x, at.y, stratum.lens.image_z};

    const Vec3d way = Vec3d{in_pupil.point.x, in_pupil.point.y, pupil.plane_z()} - film_point;
    const double distance2 = dot(way, way);
    const Ray<double> ray{film_point, (1.0 / std::sqrt(distance2)) * way};
    const TracedRay<double> traced = trace<Direction::reverse>(stratum.lens, ray);
    if (traced.status == RayStatus::ok) {
        const double cos2 = ray.direction.z * ray.direction.z;
        sample.irradiance = seen_reflectance(view, traced.ray) * stratum.white_radiance * traced.transmittance * cos2 /
                            (distance2 * in_pupil.density);
    }
    return sample;
}

void render_pixel(const SeenChart& view, const PupilMap& pupil, const RenderSettings& settings, int u, int v,
                  Image& image) {
    const PixelSampler sampler(settings.seed, static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(image.width) +
                                                  static_cast<std::uint32_t>(u));
    const int n = settings.samples_per_pixel;
    const int strata_per_layer = static_cast<int>(view.strata.size() / view.layer_nm.size());
    const double band_nm = view.stratum_width_nm * static_cast<double>(view.strata.size());
    std::array<double, 3> sum{};
    std::array<double, 3> sum_of_squares{};
    std::vector<double> layer_sum(view.layer_nm.size());
    std::vector<int> layer_samples(view.layer_nm.size());
    for (int i = 0; i < n; ++i) {
        const Sample sample = sample_path(view, pupil, sampler.point(static_cast<std::uint32_t>(i)), u, v);
        const Vec3d& weights = view.strata[sample.stratum].rgb_weights;
        const std::array<double, 3> rgb = {band_nm * sample.irradiance * weights.x,
                                           band_nm * sample.irradiance * weights.y,
                                           band_nm * sample.irradiance * weights.z};
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += rgb[k];
            sum_of_squares[k] += rgb[k] * rgb[k];
        }
        layer_sum[sample.stratum / strata_per_layer] += sample.irradiance;
        ++layer_samples[sample.stratum / strata_per_layer];
    }
    for (int k = 0; k < 3; ++k) {
        const double mean = sum[k] / n;
        const double variance = n > 1 ? std::max(0.0, (sum_of_squares[k] / n - mean * mean) / (n - 1)) : 0.0;
        image.at(u, v, k) = static_cast<float>(mean);
        image.at(u, v, 3 + k) = static_cast<float>(std::sqrt(variance));
    }
    // Per layer, the mean over the samples expected there, which keeps the layers' sum unbiased.
    const double expected = static_cast<double>(n) / static_cast<double>(layer_sum.size());
    for (std::size_t k = 0; k < layer_sum.size(); ++k) {
        image.at(u, v, 6 + static_cast<int>(k)) = static_cast<float>(layer_sum[k] / expected);
    }
}

}  // namespace

double Sensor::half_diagonal_mm() const {
    return 0.5 * std::hypot(width, height) * pixel_pitch_mm;
}

Image render_chart(const SeenChart& view, const PupilMap& pupil, const RenderSettings& settings,
                   const std::function<void(double)>& progress) {
    std::vector<std::string> channels = {"R", "G", "B", "error.R", "error.G", "error.B"};
    for (const double nm : view.layer_nm) {
        channels.push_back(spectral_channel_name(nm));
    }
    Image image = make_image(view.sensor.width, view.sensor.height, std::move(channels));
    parallel_for(
        image.height, settings.threads,
        [&](int v) {
            for (int u = 0; u < image.width; ++u) {
                render_pixel(view, pupil, settings, u, v, image);
            }
        },
        [&](int rows) {
            if (progress) {
                progress(static_cast<double>(rows) / image.height);
            }
        });
    return image;
}

}  // namespace lensproof
