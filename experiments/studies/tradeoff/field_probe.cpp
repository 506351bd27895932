#include "experiments/studies/tradeoff/field_probe.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "engine/base/angle.h"
#include "engine/base/parallel.h"
#include "engine/render/sampling/sampler.h"
#include "experiments/studies/tradeoff/point_sums.h"

namespace lensproof::studies {

void fields(JsonArchive& json, FieldError& error) {
    json.field("image_height", error.image_height)
        .field("position_um", error.position_um)
        .field("image_px", error.image_px)
        .field("blur_px", error.blur_px)
        .field("exposure_ev", error.exposure_ev)
        .field("mtf_tangential", error.mtf_tangential)
        .field("mtf_sagittal", error.mtf_sagittal)
        .field("mtf", error.mtf);
}

void fields(JsonArchive& json, FieldErrors& errors) {
    json.field("at", errors.at).field("frame", errors.frame).field("lost", errors.lost);
}

namespace {

constexpr double kFarthestInFocus = 80.0 * kDegree;
constexpr double kNyquist = 0.5;  // cycles a pixel

/// A camera's answers about one point of light, by a number in [0, 1) for the wavelength.
class PointCamera {
  public:
    PointCamera(const render::Camera& camera, const ProbePoint& point) : camera_(&camera), point_(&point) {
        const auto one = sample(0.5, 0.1, 0.3);
        const auto other = sample(0.5, 0.8, 0.7);
        is_pinhole_ =
            one && other && one->ray.direction == other->ray.direction && one->ray.origin == other->ray.origin;
    }

    [[nodiscard]] std::optional<render::LensSample> sample(double x, double u, double v) const {
        return camera_->sample(point_->origin, path(x), u, v);
    }
    /// Where the ray lands, px from the point's pixel, and how much of it.
    struct Arrival {
        Vec2d at;
        double transmittance = 0.0;
    };
    [[nodiscard]] Arrival arrival(const Ray<double>& ray, double x) const {
        const render::FilmImportance film = camera_->importance(ray, path(x));
        return {film.at_px[0] - point_->at_px, film.transmittance[0]};
    }
    /// The same of a ray of the point that another camera drew.
    [[nodiscard]] Arrival arrival_of_other(const Ray<double>& ray, double x) const {
        if (is_pinhole_) {
            const auto own = sample(x, 0.5, 0.5);
            return own ? arrival(own->ray, x) : Arrival{};
        }
        return arrival(ray, x);
    }
    /// Of lines at the pixels' Nyquist frequency, from the point's pixel to `at`: along the image height and across it.
    [[nodiscard]] Vec2d cycles(Vec2d at) const {
        const Vec2d out = point_->outwards;
        return kNyquist * Vec2d{out.x * at.x + out.y * at.y, out.x * at.y - out.y * at.x};
    }
    /// R, G and B of light at that wavelength; what a response takes off a colour does not count.
    [[nodiscard]] std::array<double, 3> weights(double x) const {
        const Vec3d& rgb = camera_->film().rgb_weights[path(x).index[0]];
        return {std::max(0.0, rgb.x), std::max(0.0, rgb.y), std::max(0.0, rgb.z)};
    }
    /// What an even world of radiance 1 at all wavelengths gives to the pixel in green.
    [[nodiscard]] double even_light(const ProbeSettings& settings, int repetition) const {
        render::CameraPaths paths =
            camera_->paths(settings.seed + static_cast<std::uint64_t>(repetition), render::PathCarry::hero);
        paths.start({.first_pixel = point_->pixel,
                     .pixels = 1,
                     .first_sample = 0,
                     .samples = static_cast<std::uint32_t>(settings.even_rays)});
        render::CameraPathBuffer buffer;
        double light = 0.0;
        while (paths.fill(buffer)) {
            for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
                light += buffer.weight[i] * camera_->film().rgb_weights[buffer.wavelength[i]].y;
            }
        }
        return light / settings.even_rays;
    }

  private:
    [[nodiscard]] spectral::PathWavelengths path(double x) const {
        const int size = camera_->grid().size();
        return camera_->grid().path(std::min(size - 1, static_cast<int>(x * size)));
    }

    const render::Camera* camera_;
    const ProbePoint* point_;
    bool is_pinhole_ = false;
};

void add_exact_ray(const PointCamera& exact, const PointCamera& model, double x, double u, double v, PointSums& sums) {
    const auto drawn = exact.sample(x, u, v);
    if (!drawn) {
        return;
    }
    const PointCamera::Arrival there = exact.arrival(drawn->ray, x);
    if (!(there.transmittance > 0.0)) {
        return;
    }
    const double light = there.transmittance / drawn->pdf.hero;
    const auto weights = exact.weights(x);
    for (std::size_t c = 0; c < 3; ++c) {
        sums.exact[c].add(light * weights[c], there.at);
    }
    sums.exact_modulation.add(light * weights[1], exact.cycles(there.at));
    const double all = light * (weights[0] + weights[1] + weights[2]);
    const PointCamera::Arrival here = model.arrival_of_other(drawn->ray, x);
    if (!(here.transmittance > 0.0)) {
        sums.lost_light += all;
        return;
    }
    const Vec2d off = here.at - there.at;
    sums.ray_square += all * (off.x * off.x + off.y * off.y);
    sums.ray_light += all;
}

void add_model_ray(const PointCamera& model, double x, double u, double v, PointSums& sums) {
    if (const auto drawn = model.sample(x, u, v)) {
        const PointCamera::Arrival here = model.arrival(drawn->ray, x);
        if (!(here.transmittance > 0.0)) {
            return;
        }
        const double light = here.transmittance / drawn->pdf.hero;
        const auto weights = model.weights(x);
        for (std::size_t c = 0; c < 3; ++c) {
            sums.model[c].add(light * weights[c], here.at);
        }
        sums.model_modulation.add(light * weights[1], model.cycles(here.at));
    }
}

PointSums probe(const render::Camera& exact_camera, const render::Camera& model_camera, const ProbePoint& point,
                const ProbeSettings& settings, int repetition) {
    const PointCamera exact(exact_camera, point);
    const PointCamera model(model_camera, point);
    const render::PixelSampler numbers(settings.seed + static_cast<std::uint64_t>(repetition), point.pixel);
    PointSums sums;
    for (int i = 0; i < settings.rays; ++i) {
        const auto number = numbers.point(static_cast<std::uint32_t>(i));
        add_exact_ray(exact, model, number[0], number[1], number[2], sums);
        add_model_ray(model, number[0], number[1], number[2], sums);
    }
    sums.even_exact = exact.even_light(settings, repetition);
    sums.even_model = model.even_light(settings, repetition);
    return sums;
}

/// Squares of the errors at a point, in px² and EV². Nothing where one of the cameras sees no light.
struct Squares {
    double position = 0.0;
    double image = 0.0;
    double blur = 0.0;
    double exposure = 0.0;
    double signed_blur = 0.0;
    double signed_exposure = 0.0;
    double mtf_tangential = 0.0;
    double mtf_sagittal = 0.0;
    double signed_tangential = 0.0;
    double signed_sagittal = 0.0;
    double mtf = 0.0;

    Squares& operator+=(const Squares& more) {
        position += more.position;
        image += more.image;
        blur += more.blur;
        exposure += more.exposure;
        mtf_tangential += more.mtf_tangential;
        mtf_sagittal += more.mtf_sagittal;
        mtf += more.mtf;
        return *this;
    }
};

Squares squares_of(const PointSums& sums) {
    Squares squares;
    if (sums.ray_light > 0.0) {
        squares.position = sums.ray_square / sums.ray_light;
    }
    double channels = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
        if (sums.exact[c].light > 0.0 && sums.model[c].light > 0.0) {
            const Vec2d off = sums.model[c].centroid() - sums.exact[c].centroid();
            squares.image += off.x * off.x + off.y * off.y;
            channels += 1.0;
        }
    }
    squares.image /= std::max(1.0, channels);
    if (sums.exact[1].light > 0.0 && sums.model[1].light > 0.0) {
        squares.signed_blur = sums.model[1].spread() - sums.exact[1].spread();
        squares.signed_tangential = sums.model_modulation.mtf(0) - sums.exact_modulation.mtf(0);
        squares.signed_sagittal = sums.model_modulation.mtf(1) - sums.exact_modulation.mtf(1);
    }
    if (sums.even_exact > 0.0 && sums.even_model > 0.0) {
        squares.signed_exposure = std::log2(sums.even_model / sums.even_exact);
    }
    squares.blur = squares.signed_blur * squares.signed_blur;
    squares.exposure = squares.signed_exposure * squares.signed_exposure;
    squares.mtf_tangential = squares.signed_tangential * squares.signed_tangential;
    squares.mtf_sagittal = squares.signed_sagittal * squares.signed_sagittal;
    squares.mtf = 0.5 * (squares.mtf_tangential + squares.mtf_sagittal);
    return squares;
}

/// Of the points in [r] what all repetitions but r found together, in the last what all did.
using PooledSums = std::vector<std::vector<PointSums>>;

/// `probe(point, repetition)` of all of them.
template <class Probe>
PooledSums pooled(const std::vector<ProbePoint>& points, const ProbeSettings& settings, const Probe& probe) {
    const auto repetitions = static_cast<std::size_t>(settings.repetitions);
    PooledSums sums(repetitions + 1, std::vector<PointSums>(points.size()));
    parallel_for(static_cast<int>(points.size()), settings.threads, [&](int i) {
        const auto p = static_cast<std::size_t>(i);
        for (std::size_t r = 0; r < repetitions; ++r) {
            const PointSums found = probe(points[p], static_cast<int>(r));
            for (std::size_t left_out = 0; left_out < sums.size(); ++left_out) {
                if (left_out != r) {
                    sums[left_out][p] += found;
                }
            }
        }
    });
    return sums;
}

PointSums look(const render::Camera& camera, const ProbePoint& point, const ProbeSettings& settings, int repetition) {
    const PointCamera there(camera, point);
    const render::PixelSampler numbers(settings.seed + static_cast<std::uint64_t>(repetition), point.pixel);
    PointSums sums;
    for (int i = 0; i < settings.rays; ++i) {
        const auto number = numbers.point(static_cast<std::uint32_t>(i));
        add_model_ray(there, number[0], number[1], number[2], sums);
    }
    sums.even_model = there.even_light(settings, repetition);
    return sums;
}

PointLook look_of(const PointSums& sums) {
    PointLook look;
    for (std::size_t c = 0; c < 3; ++c) {
        look.light[c] = sums.model[c].light;
        if (look.light[c] > 0.0) {
            look.centroid[c] = sums.model[c].centroid();
            look.spread_px[c] = sums.model[c].spread();
        }
    }
    look.even_light = sums.even_model;
    return look;
}

Measured scaled(Measured measured, double factor) {
    return {factor * measured.value, factor * measured.standard_error};
}

}  // namespace

Measured jackknifed(int repetitions, const std::function<double(int left_out)>& of) {
    std::vector<double> without(static_cast<std::size_t>(repetitions));
    for (int r = 0; r < repetitions; ++r) {
        without[static_cast<std::size_t>(r)] = of(r);
    }
    const auto n = static_cast<double>(repetitions);
    const double mean = std::accumulate(without.begin(), without.end(), 0.0) / n;
    double variance = 0.0;
    for (const double value : without) {
        variance += (n - 1.0) / n * (value - mean) * (value - mean);
    }
    return {n * of(repetitions) - (n - 1.0) * mean, std::sqrt(variance)};
}

Measured root(const Measured& square) {
    const double value = std::sqrt(std::max(0.0, square.value));
    // To first order; where that does not hold, the root of what the square may be.
    const double largest = std::sqrt(std::max(0.0, square.value) + square.standard_error) - value;
    return {value, value > 0.0 ? std::min(square.standard_error / (2.0 * value), largest) : largest};
}

std::vector<ProbePoint> probe_points(const render::Camera& exact, int count) {
    const render::Sensor& sensor = exact.sensor();
    const double aspect = static_cast<double>(sensor.width) / sensor.height;
    const int across = std::clamp(static_cast<int>(std::lround(std::sqrt(count * aspect))), 1, sensor.width);
    const int down = std::clamp(static_cast<int>(std::lround(count / static_cast<double>(across))), 1, sensor.height);
    const double focus_z = -exact.settings().focus_distance_mm;
    render::CameraPaths paths = exact.paths(0, render::PathCarry::hero);
    std::vector<ProbePoint> points;
    for (int row = 0; row < down; ++row) {
        for (int column = 0; column < across; ++column) {
            const int u = static_cast<int>((column + 0.5) * sensor.width / across);
            const int v = static_cast<int>((row + 0.5) * sensor.height / down);
            ProbePoint point{.pixel = static_cast<std::uint32_t>(v * sensor.width + u),
                             .at_px = {static_cast<double>(u), static_cast<double>(v)}};
            paths.start({.first_pixel = point.pixel, .pixels = 1, .first_sample = 0, .samples = 64});
            render::CameraPathBuffer buffer(64);
            if (!paths.fill(buffer) || buffer.size == 0) {
                continue;
            }
            const Ray<double> out = buffer.ray(0);
            const bool is_far = !std::isfinite(focus_z) || -out.direction.z < std::cos(kFarthestInFocus);
            const double distance = is_far ? 0.0 : (focus_z - out.origin.z) / out.direction.z;
            const Ray<double> in_world = exact.to_world({out.origin + distance * out.direction, -1.0 * out.direction});
            point.origin = {.at = is_far ? in_world.direction : in_world.origin, .is_far = is_far};
            const Vec2d from_axis = point.at_px - sensor.axis();
            const double radius = std::hypot(from_axis.x, from_axis.y);
            point.image_height = radius * sensor.pixel_pitch_mm / sensor.half_diagonal_mm();
            point.outwards = radius > 0.0 ? (1.0 / radius) * from_axis : Vec2d{1.0, 0.0};
            points.push_back(point);
        }
    }
    return points;
}

PointLooks look_at_points(const render::Camera& camera, const std::vector<ProbePoint>& points,
                          const ProbeSettings& settings) {
    const PooledSums all =
        pooled(points, settings, [&](const ProbePoint& point, int r) { return look(camera, point, settings, r); });
    PointLooks looks;
    for (const std::vector<PointSums>& sums : all) {
        std::ranges::transform(sums, std::back_inserter(looks.emplace_back()), look_of);
    }
    return looks;
}

Measured rms_over_points(const PointLooks& one, const PointLooks& other, const PointNumber& of) {
    const int repetitions = static_cast<int>(one.size()) - 1;
    return root(jackknifed(repetitions, [&](int left_out) {
        const auto looks = static_cast<std::size_t>(left_out);
        double squares = 0.0;
        double count = 0.0;
        for (std::size_t i = 0; i < one[looks].size(); ++i) {
            if (const std::optional<double> value = of(one[looks], other[looks], i)) {
                squares += *value * *value;
                count += 1.0;
            }
        }
        return squares / std::max(1.0, count);
    }));
}

FieldErrors field_errors(const render::Camera& exact, const render::Camera& model,
                         const std::vector<ProbePoint>& points, const ProbeSettings& settings) {
    const PooledSums sums = pooled(
        points, settings, [&](const ProbePoint& point, int r) { return probe(exact, model, point, settings, r); });
    const double um = 1e3 * exact.sensor().pixel_pitch_mm;
    const auto of_point = [&](std::size_t p, double Squares::*what) {
        return jackknifed(settings.repetitions,
                          [&](int left_out) { return squares_of(sums[static_cast<std::size_t>(left_out)][p]).*what; });
    };
    const auto of_frame = [&](double Squares::*what) {
        return jackknifed(settings.repetitions, [&](int left_out) {
            Squares sum;
            for (const PointSums& at : sums[static_cast<std::size_t>(left_out)]) {
                sum += squares_of(at);
            }
            return sum.*what / static_cast<double>(std::max<std::size_t>(1, points.size()));
        });
    };
    FieldErrors errors;
    for (std::size_t p = 0; p < points.size(); ++p) {
        errors.at.push_back({.image_height = points[p].image_height,
                             .position_um = scaled(root(of_point(p, &Squares::position)), um),
                             .image_px = root(of_point(p, &Squares::image)),
                             .blur_px = of_point(p, &Squares::signed_blur),
                             .exposure_ev = of_point(p, &Squares::signed_exposure),
                             .mtf_tangential = of_point(p, &Squares::signed_tangential),
                             .mtf_sagittal = of_point(p, &Squares::signed_sagittal),
                             .mtf = root(of_point(p, &Squares::mtf))});
    }
    errors.frame = {.image_height = 0.0,
                    .position_um = scaled(root(of_frame(&Squares::position)), um),
                    .image_px = root(of_frame(&Squares::image)),
                    .blur_px = root(of_frame(&Squares::blur)),
                    .exposure_ev = root(of_frame(&Squares::exposure)),
                    .mtf_tangential = root(of_frame(&Squares::mtf_tangential)),
                    .mtf_sagittal = root(of_frame(&Squares::mtf_sagittal)),
                    .mtf = root(of_frame(&Squares::mtf))};
    double light = 0.0;
    for (const PointSums& at : sums.back()) {
        errors.lost += at.lost_light;
        light += at.lost_light + at.ray_light;
    }
    errors.lost = light > 0.0 ? errors.lost / light : 0.0;
    return errors;
}

}  // namespace lensproof::studies
