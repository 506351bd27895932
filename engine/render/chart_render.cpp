#include "engine/render/chart_render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "engine/render/camera_paths.h"
#include "engine/render/parallel.h"
#include "engine/spectral/spectral_exr.h"

namespace lensproof {

namespace {

/// The sums that a pixel's samples leave.
class PixelSums {
  public:
    explicit PixelSums(const SeenChart& view)
        : layers_(view.layer_nm.size()),
          strata_per_layer_(view.strata.size() / layers_.size()),
          band_nm_(view.stratum_width_nm * static_cast<double>(view.strata.size())) {}

    /// A sample's estimate of the film irradiance, W·m⁻²·nm⁻¹. Samples that met no light need not be told.
    void add(std::size_t stratum, double irradiance, const Vec3d& rgb_weights) {
        const std::array<double, 3> rgb = {band_nm_ * irradiance * rgb_weights.x, band_nm_ * irradiance * rgb_weights.y,
                                           band_nm_ * irradiance * rgb_weights.z};
        for (std::size_t k = 0; k < 3; ++k) {
            sum_[k] += rgb[k];
            sum_of_squares_[k] += rgb[k] * rgb[k];
        }
        layers_[stratum / strata_per_layer_] += irradiance;
    }

    /// Writes what n samples make of a pixel, and begins anew.
    void write(int n, int u, int v, Image& image) {
        for (int k = 0; k < 3; ++k) {
            const double mean = sum_[k] / n;
            const double variance = n > 1 ? std::max(0.0, (sum_of_squares_[k] / n - mean * mean) / (n - 1)) : 0.0;
            image.at(u, v, k) = static_cast<float>(mean);
            image.at(u, v, 3 + k) = static_cast<float>(std::sqrt(variance));
        }
        // Per layer, the mean over the samples expected there, which keeps the layers' sum unbiased.
        const double expected = static_cast<double>(n) / static_cast<double>(layers_.size());
        for (std::size_t k = 0; k < layers_.size(); ++k) {
            image.at(u, v, 6 + static_cast<int>(k)) = static_cast<float>(layers_[k] / expected);
        }
        sum_ = {};
        sum_of_squares_ = {};
        std::ranges::fill(layers_, 0.0);
    }

  private:
    std::array<double, 3> sum_{};
    std::array<double, 3> sum_of_squares_{};
    std::vector<double> layers_;
    std::size_t strata_per_layer_;
    double band_nm_;
};

/// Renders rows, each from its camera paths, a buffer after the other.
class RowRenderer {
  public:
    RowRenderer(const SeenChart& view, const CameraPathSource<double>& source, int samples_per_pixel, Image& image)
        : view_(&view), producer_(source), sums_(view), samples_(samples_per_pixel), image_(&image) {}

    void operator()(int v) {
        const auto width = static_cast<std::uint32_t>(image_->width);
        producer_.start({.first_pixel = static_cast<std::uint32_t>(v) * width,
                         .pixels = width,
                         .samples = static_cast<std::uint32_t>(samples_)});
        std::optional<std::uint32_t> pixel;
        const auto finish = [&] {
            if (pixel) {
                sums_.write(samples_, static_cast<int>(*pixel % width), v, *image_);
            }
        };
        while (producer_.fill(paths_)) {
            for (int i = 0; i < paths_.size; ++i) {
                const auto at = static_cast<std::size_t>(i);
                if (pixel != paths_.pixel[at]) {
                    finish();
                    pixel = paths_.pixel[at];
                }
                const std::size_t stratum = paths_.wavelength[at];
                const WavelengthStratum& of = view_->strata[stratum];
                const double radiance = seen_reflectance(view_->chart, view_->pose, paths_.ray(i)) * of.white_radiance;
                sums_.add(stratum, radiance * paths_.weight[at], of.rgb_weights);
            }
        }
        finish();  // a pixel that no path left stays black
    }

  private:
    const SeenChart* view_;
    CameraPathProducer<double> producer_;
    CameraPathBuffer<double> paths_;
    PixelSums sums_;
    int samples_;
    Image* image_;
};

SpectralLens<double> spectral_lens(const std::vector<WavelengthStratum>& strata) {
    std::vector<TraceLens<double>> at;
    std::ranges::transform(strata, std::back_inserter(at), &WavelengthStratum::lens);
    return SpectralLens<double>(std::move(at));
}

}  // namespace

double seen_reflectance(const Chart& chart, const RigidMotion& pose, const Ray<double>& outwards) {
    const Vec3d origin = rotate_back(pose, camera_to_lens(outwards.origin) - pose.translation);
    const Vec3d direction = rotate_back(pose, camera_to_lens(outwards.direction));
    const double distance = -origin.z / direction.z;
    if (!(distance > 0.0) || !std::isfinite(distance)) {
        return chart.white_reflectance;
    }
    return reflectance(chart, origin.x + distance * direction.x, origin.y + distance * direction.y);
}

Image render_chart(const SeenChart& view, const PupilMap& pupil, const RenderSettings& settings,
                   const std::function<void(double)>& progress) {
    std::vector<std::string> channels = {"R", "G", "B", "error.R", "error.G", "error.B"};
    for (const double nm : view.layer_nm) {
        channels.push_back(spectral_channel_name(nm));
    }
    Image image = make_image(view.sensor.width, view.sensor.height, std::move(channels));
    const SpectralLens<double> lens = spectral_lens(view.strata);
    const PupilSlices slices(pupil, lens.wavelengths());
    const CameraPathSource<double> source{
        .sensor = view.sensor, .lens = &lens, .pupil = &slices, .seed = settings.seed};
    parallel_for_workers(
        image.height, settings.threads, [&] { return RowRenderer(view, source, settings.samples_per_pixel, image); },
        [&](int rows) {
            if (progress) {
                progress(static_cast<double>(rows) / image.height);
            }
        });
    return image;
}

}  // namespace lensproof
