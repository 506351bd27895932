#include "engine/render/film/smoothed_film.h"

#include <array>
#include <cmath>
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

/// A film's numbers, a plane each: what a pixel is and the variance of that, by camera paths and by light paths.
struct FilmPlanes {
    std::array<std::vector<cv::Mat>, 2> means;  // R, G, B and the spectral layers
    std::array<std::vector<cv::Mat>, 2> variances;

    explicit FilmPlanes(const Film& film) {
        const std::size_t layers = film.layout().layer_nm.size();
        const auto planes = [&](std::size_t count) {
            std::vector<cv::Mat> all(count);
            for (cv::Mat& plane : all) {
                plane.create(film.height(), film.width(), CV_64F);
            }
            return all;
        };
        means = {planes(3 + layers), planes(3 + layers)};
        variances = {planes(3), planes(3)};
        std::vector<double> of_both(layers);
        std::vector<double> of_light(layers);
        for (int y = 0; y < film.height(); ++y) {
            for (int x = 0; x < film.width(); ++x) {
                film.layers(x, y, of_both);
                film.light_layers(x, y, of_light);
                put(0, x, y, film.camera_estimate(x, y));
                put(1, x, y, film.light_estimate(x, y));
                for (std::size_t k = 0; k < layers; ++k) {
                    means[0][3 + k].at<double>(y, x) = of_both[k] - of_light[k];
                    means[1][3 + k].at<double>(y, x) = of_light[k];
                }
            }
        }
    }

    [[nodiscard]] PixelEstimate estimate(std::size_t i, int x, int y) const {
        const auto at = [&](const std::vector<cv::Mat>& planes) {
            return Vec3d{planes[0].at<double>(y, x), planes[1].at<double>(y, x), planes[2].at<double>(y, x)};
        };
        return {.rgb = at(means[i]), .variance = at(variances[i])};
    }

    void layers(std::size_t i, int x, int y, std::vector<double>& of_pixel) const {
        for (std::size_t k = 0; k < of_pixel.size(); ++k) {
            of_pixel[k] = means[i][3 + k].at<double>(y, x);
        }
    }

  private:
    void put(std::size_t i, int x, int y, const PixelEstimate& estimate) {
        const auto put_each = [&](std::vector<cv::Mat>& planes, const Vec3d& rgb) {
            planes[0].at<double>(y, x) = rgb.x;
            planes[1].at<double>(y, x) = rgb.y;
            planes[2].at<double>(y, x) = rgb.z;
        };
        put_each(means[i], estimate.rgb);
        put_each(variances[i], estimate.variance);
    }
};

}  // namespace

Film smoothed(const Film& film, double sigma_px, int threads) {
    FilmPlanes planes(film);
    const cv::Mat weights = gaussian_weights(sigma_px);
    const cv::Mat squares = weights.mul(weights);
    const cv::Mat within = sums_around(cv::Mat::ones(film.height(), film.width(), CV_64F), weights);
    const cv::Mat within_squared = within.mul(within);
    std::vector<cv::Mat*> means;
    std::vector<cv::Mat*> variances;
    for (std::size_t i = 0; i < 2; ++i) {
        for (cv::Mat& plane : planes.means[i]) {
            means.push_back(&plane);
        }
        for (cv::Mat& plane : planes.variances[i]) {
            variances.push_back(&plane);
        }
    }
    parallel_for(static_cast<int>(means.size()), threads, [&](int i) {
        cv::Mat& plane = *means[static_cast<std::size_t>(i)];
        plane = sums_around(plane, weights) / within;
    });
    parallel_for(static_cast<int>(variances.size()), threads, [&](int i) {
        cv::Mat& plane = *variances[static_cast<std::size_t>(i)];
        plane = sums_around(plane, squares) / within_squared;
    });
    Film result(film.layout());
    result.set_light_paths(film.light_paths());
    result.set_left_out(film.left_out());
    std::vector<double> camera_layers(film.layout().layer_nm.size());
    std::vector<double> light_layers(camera_layers.size());
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            planes.layers(0, x, y, camera_layers);
            planes.layers(1, x, y, light_layers);
            result.set_pixel(x, y,
                             {.counts = film.counts(x, y),
                              .camera = planes.estimate(0, x, y),
                              .camera_layers = camera_layers,
                              .light = planes.estimate(1, x, y),
                              .light_layers = light_layers,
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
