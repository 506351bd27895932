#include "experiments/studies/tradeoff/smooth_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calibration/comparison/colour_planes.h"
#include "engine/render/film/film_image.h"
#include "experiments/studies/tradeoff/pilot_changes.h"
#include "experiments/studies/tradeoff/processor_time.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

namespace {

/// A view of the picture's pixels, not a copy.
cv::Mat mat_of(const formats::Image& rgb) {
    return {rgb.height, rgb.width, CV_32FC3, const_cast<float*>(rgb.pixels.data())};
}

cv::Mat blurred(const formats::Image& picture, double sigma) {
    cv::Mat result;
    cv::GaussianBlur(mat_of(picture), result, {}, sigma, sigma, cv::BORDER_REFLECT);
    return result;
}

/// As if the plane went on from its end with its beginning.
cv::Mat turned(const cv::Mat& plane, int columns, int rows) {
    cv::Mat across;
    cv::hconcat(plane.colRange(columns, plane.cols), plane.colRange(0, columns), across);
    cv::Mat turned;
    cv::vconcat(across.rowRange(rows, plane.rows), across.rowRange(0, rows), turned);
    return turned;
}

double mean_product(const cv::Mat& a, const cv::Mat& b) {
    return a.dot(b) / (static_cast<double>(a.total()) * a.channels());
}

/// What two planes have in common, a mean square; its error is what they seem to have where one is shifted far against
/// the other.
Measured common(const cv::Mat& a, const cv::Mat& b) {
    constexpr int kShifts = 8;
    double squares = 0.0;
    for (int i = 1; i <= kShifts; ++i) {
        const auto part = [&](int length) { return i * length / (kShifts + 1); };
        squares += std::pow(mean_product(a, turned(b, part(b.cols), part(b.rows))), 2);
    }
    return {mean_product(a, b), std::sqrt(squares / kShifts)};
}

}  // namespace

SmoothLight::SmoothLight(const Films& films, const Vec3d& mean, double coarser) : films_(films), coarser_(coarser) {
    for (formats::Image& film : films_) {
        film = with_gain(film, [&](int, int) { return Vec3d{1.0 / mean.x, 1.0 / mean.y, 1.0 / mean.z}; });
    }
}

Measured SmoothLight::between(double sigma) const {
    const auto band = [&](const formats::Image& film) { return blurred(film, sigma) - blurred(film, 2.0 * sigma); };
    return common(band(films_[0]), band(films_[1]));
}

Measured SmoothLight::beyond(double sigma) const {
    const auto rest = [&](const formats::Image& film) { return mat_of(film) - blurred(film, sigma); };
    return common(rest(films_[0]), rest(films_[1]));
}

Measured SmoothLight::lost(double sigma_px) const {
    constexpr double kLostOverBetween = 0.2337 / 0.0914;
    const double sigma = sigma_px / coarser_;
    const double widest = films_.front().width / 16.0;
    Measured least{std::numeric_limits<double>::infinity(), 0.0};
    std::optional<Measured> finest;
    for (double wider = 1.0; !finest || wider * sigma <= widest; wider *= 2.0) {
        if (wider * sigma < 1.0) {
            continue;  // finer than the films' pixels
        }
        const auto [value, error] = between(wider * sigma);
        const Measured square{kLostOverBetween * value / wider, kLostOverBetween * error / wider};
        finest = finest.value_or(square);
        if (at_most(square) < at_most(least)) {
            least = square;
        }
    }
    const bool is_in_points = at_least(*finest) > at_most(least);
    return root(is_in_points ? beyond(std::max(1.0, sigma)) : least);
}

Measured PassFilms::fraction(const Pilot& pilot) const {
    double sum = 0.0;
    double squares = 0.0;
    const std::size_t pixels = rgb[0].pixels.size() / rgb[0].channels.size();
    for (std::size_t i = 0; i < pixels; ++i) {
        const double one = calibration::luminance(calibration::rgb_at(rgb[0], i));
        const double other = calibration::luminance(calibration::rgb_at(rgb[1], i));
        sum += 0.5 * (one + other);
        squares += 0.25 * (one - other) * (one - other);
    }
    double straight = 0.0;
    for (const formats::Image& picture : pilot.full().rgb) {
        straight += calibration::luminance(mean_rgb(picture)) / static_cast<double>(pilot.full().rgb.size());
    }
    const double whole = straight * static_cast<double>(pixels);
    return {sum / whole, std::sqrt(squares) / whole};
}

SmoothLight PassFilms::smoothness(const Pilot& pilot) const {
    return {rgb, mean_rgb(pilot.full().rgb.front()),
            static_cast<double>(pilot.setup().camera.sensor.width) / rgb.front().width};
}

void PassFilms::add(const PassFilms& more) {
    const double part = static_cast<double>(more.samples) / (samples + more.samples);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        std::ranges::transform(rgb[i].pixels, more.rgb[i].pixels, rgb[i].pixels.begin(),
                               [&](float had, float found) { return std::lerp(had, found, static_cast<float>(part)); });
    }
    ns_per_sample = std::lerp(ns_per_sample, more.ns_per_sample, part);
    samples += more.samples;
}

PassFilms pass_films(const Pilot& pilot, const std::string& pass, int first_seed, const render::SampleRange& samples) {
    const PilotSettings& settings = pilot.settings();
    const render::SceneSetup small = with_pixels(pilot.setup(), settings.smooth_pixels);
    render::PreparedScene scene(small, render::PixelFilter{}, settings.cache);
    PassFilms films{.rgb = {}, .samples = static_cast<int>(samples.end - samples.first)};
    for (std::size_t i = 0; i < films.rgb.size(); ++i) {
        const std::uint64_t seed = settings.probe.seed + static_cast<std::uint64_t>(first_seed) + i;
        const std::vector<render::Render> renders = scene.render(std::vector{pass}, seed, false, false);
        const double start = processor_seconds();
        films.rgb[i] = render::film_rgb(render::render_film(renders.front(), samples, settings.probe.threads));
        const double taken = static_cast<double>(small.camera.sensor.width) * small.camera.sensor.height *
                             films.samples * static_cast<double>(films.rgb.size());
        films.ns_per_sample += 1e9 * (processor_seconds() - start) / taken;
    }
    return films;
}

const PassFilms& KeptFilms::of(const std::string& pass, int samples) {
    const auto kept = films_.find(pass);
    const int has = kept == films_.end() ? 0 : kept->second.samples;
    if (has < samples) {
        const PassFilms more = pass_films(
            *pilot_, pass, 0, {.first = static_cast<std::uint32_t>(has), .end = static_cast<std::uint32_t>(samples)});
        if (kept == films_.end()) {
            return films_.emplace(pass, more).first->second;
        }
        kept->second.add(more);
    }
    return kept->second;
}

}  // namespace lensproof::studies
