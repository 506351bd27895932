#include "engine/render/film/smoothed_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "engine/base/parallel.h"

namespace lensproof::render {

namespace {

/// Weights along an axis, of sum 1.
cv::Mat gaussian_weights(double sigma_px) {
    constexpr double kReach = 4.0;  // standard deviations: beyond are 6e-5 of it
    return cv::getGaussianKernel(2 * static_cast<int>(std::ceil(kReach * sigma_px)) + 1, sigma_px, CV_64F);
}

/// Sums of a plane's numbers around each pixel.
cv::Mat sums_around(const cv::Mat& plane, const cv::Mat& weights) {
    cv::Mat sums;
    cv::sepFilter2D(plane, sums, CV_64F, weights, weights, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
    return sums;
}

/// What camera paths, or light paths, have made of a film: its numbers, a plane each.
struct FilmPlanes {
    std::vector<cv::Mat> means;  // R, G, B and the spectral layers
    std::vector<cv::Mat> variances;

    FilmPlanes(const Film& film, std::size_t layers) : means(kColours + layers), variances(kColours) {
        for (std::vector<cv::Mat>* planes : {&means, &variances}) {
            for (cv::Mat& plane : *planes) {
                plane.create(film.height(), film.width(), CV_64F);
            }
        }
    }

    void put(int x, int y, const PixelEstimate& estimate, const std::vector<double>& layers) {
        const std::array rgb = {estimate.rgb.x, estimate.rgb.y, estimate.rgb.z};
        const std::array variance = {estimate.variance.x, estimate.variance.y, estimate.variance.z};
        for (std::size_t c = 0; c < kColours; ++c) {
            means[c].at<double>(y, x) = rgb[c];
            variances[c].at<double>(y, x) = variance[c];
        }
        for (std::size_t k = 0; k < layers.size(); ++k) {
            means[kColours + k].at<double>(y, x) = layers[k];
        }
    }

    PixelEstimate take(int x, int y, std::vector<double>& layers) const {
        for (std::size_t k = 0; k < layers.size(); ++k) {
            layers[k] = means[kColours + k].at<double>(y, x);
        }
        const auto at = [&](const std::vector<cv::Mat>& planes) {
            return Vec3d{planes[0].at<double>(y, x), planes[1].at<double>(y, x), planes[2].at<double>(y, x)};
        };
        return {.rgb = at(means), .variance = at(variances)};
    }

  private:
    static constexpr std::size_t kColours = 3;
};

}  // namespace

Film smoothed(const Film& film, double sigma_px, int threads) {
    std::vector<double> of_camera(film.layout().layer_nm.size());
    std::vector<double> of_light(of_camera.size());
    FilmPlanes camera(film, of_camera.size());
    FilmPlanes light(film, of_light.size());
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            film.layers(x, y, of_camera);  // of both
            film.light_layers(x, y, of_light);
            std::ranges::transform(of_camera, of_light, of_camera.begin(), std::minus());
            camera.put(x, y, film.camera_estimate(x, y), of_camera);
            light.put(x, y, film.light_estimate(x, y), of_light);
        }
    }
    const cv::Mat weights = gaussian_weights(sigma_px);
    const cv::Mat within = sums_around(cv::Mat::ones(film.height(), film.width(), CV_64F), weights);
    const auto smooth = [&](std::vector<cv::Mat>& planes, const cv::Mat& by, const cv::Mat& over) {
        parallel_for(static_cast<int>(planes.size()), threads, [&](int i) {
            cv::Mat& plane = planes[static_cast<std::size_t>(i)];
            plane = sums_around(plane, by) / over;
        });
    };
    for (FilmPlanes* planes : {&camera, &light}) {
        smooth(planes->means, weights, within);
        smooth(planes->variances, weights.mul(weights), within.mul(within));
    }
    Film result(film.layout());
    result.set_light_paths(film.light_paths());
    result.set_left_out(film.left_out());
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            const PixelEstimate camera_estimate = camera.take(x, y, of_camera);
            const PixelEstimate light_estimate = light.take(x, y, of_light);
            result.set_pixel(x, y,
                             {.counts = film.counts(x, y),
                              .camera = camera_estimate,
                              .camera_layers = of_camera,
                              .light = light_estimate,
                              .light_layers = of_light,
                              .features = film.features(x, y),
                              .coverage = film.coverage(x, y)});
        }
    }
    return result;
}

double smoothing_gain(double sigma_px) {
    return 4.0 * std::numbers::pi * sigma_px * sigma_px;
}

}  // namespace lensproof::render
