#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "calibration/geometry/cross_validation.h"
#include "calibration/geometry/fit_geometry.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "engine/io/input_error.h"
#include "engine/render/parallel.h"
#include "experiments/measurement_floor/measure_floor.h"
#include "experiments/measurement_floor/random_poses.h"

namespace lensproof {

namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kUsualPhotos = 12;
constexpr double kPointNoise_px = 0.02;  // what points are asked to be known to
constexpr double kMapping_px = 0.03;     // what is asked of the mapping over the covered frame
constexpr double kGridStep_px = 16.0;
constexpr PoseWish kUsualWish{.tilt_deg = 30.0, .largest_roll_deg = 20.0, .fill = 0.7, .reach = 0.5};

/// A lens, and the models that are tried on it.
struct TrueLens {
    std::string id;
    std::string title;
    CameraModel model;
    std::vector<ModelKind> fitted;
};

std::vector<TrueLens> true_lenses() {
    return {{"perspective",
             "barrel distortion",
             BrownConrady{{820.0, 318.5, 243.0, -0.24, 0.09, -0.01, 0.0008, -0.0005}},
             {ModelKind::brown_conrady, ModelKind::brown_conrady_rational, ModelKind::division, ModelKind::ptlens,
              ModelKind::kannala_brandt, ModelKind::spline}},
            {"fisheye",
             "a fisheye to 105°",
             KannalaBrandt{{220.0, 322.0, 236.0, -0.012, 0.004, -0.002, 0.0002}},
             {ModelKind::kannala_brandt, ModelKind::equidistant, ModelKind::equisolid, ModelKind::spline}}};
}

std::vector<Vec2d> frame_grid() {
    std::vector<Vec2d> pixels;
    for (double y = 0.0; y <= kHeight - 1; y += kGridStep_px) {
        for (double x = 0.0; x <= kWidth - 1; x += kGridStep_px) {
            pixels.push_back({x, y});
        }
    }
    return pixels;
}

std::vector<Vec2d> covered_grid(const std::vector<ChartView>& views) {
    const std::vector<Vec2d> all = frame_grid();
    const std::vector<bool> covered = covered_pixels(views, all);
    std::vector<Vec2d> pixels;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (covered[i]) {
            pixels.push_back(all[i]);
        }
    }
    return pixels;
}

/// Where a fitted mapping is compared with the true one.
enum class Where { covered, frame };

/// What is varied: photos, and how far from the middle the board is seen.
struct Varied {
    std::string id;
    std::string title;
    std::string parameter;
    std::string unit;
    std::vector<double> values;
    Where where;
    void (*apply)(double value, int& photos, PoseWish& wish);
};

std::vector<Varied> varied() {
    return {{"photos",
             "Mapping against the number of photos",
             "photos",
             "",
             {3.0, 5.0, 8.0, 12.0, 20.0},
             Where::covered,
             [](double value, int& photos, PoseWish&) { photos = static_cast<int>(value); }},
            {"coverage",
             "Mapping of the whole frame against its coverage",
             "reach of the board's middle",
             "%",
             {0.0, 20.0, 40.0, 60.0, 80.0},
             Where::frame,
             [](double value, int&, PoseWish& wish) { wish.reach = value / 100.0; }}};
}

std::vector<ChartView> views_of(const TrueLens& lens, int photos, const PoseWish& wish, std::uint32_t seed) {
    std::mt19937 random(seed);
    return draw_views({.model = lens.model, .width_px = kWidth, .height_px = kHeight, .noise_px = kPointNoise_px},
                      photos, wish, random);
}

/// Root mean square over the pixels compared; NaN where the fit is refused or images too little.
double mapping_error(const TrueLens& lens, ModelKind kind, const std::vector<ChartView>& views, Where where) {
    try {
        const GeometryFit fit = fit_geometry(views, kWidth, kHeight, {.model = kind});
        const auto apart =
            mapping_difference(fit.model, lens.model, where == Where::covered ? covered_grid(views) : frame_grid());
        return apart ? apart->rms_px : std::numeric_limits<double>::quiet_NaN();
    } catch (const InputError&) {
        return std::numeric_limits<double>::quiet_NaN();
    }
}

/// Root of the mean square of those that are numbers.
FloorPoint point_of(double value, const std::vector<double>& errors) {
    std::vector<double> squares;
    for (const double error : errors) {
        if (std::isfinite(error)) {
            squares.push_back(error * error);
        }
    }
    FloorPoint point{.value = value, .error = std::numeric_limits<double>::quiet_NaN(), .sigma = 0.0};
    point.found_percent = 100.0 * static_cast<double>(squares.size()) / static_cast<double>(errors.size());
    if (squares.empty()) {
        return point;
    }
    const auto n = static_cast<double>(squares.size());
    double mean = 0.0;
    for (const double square : squares) {
        mean += square / n;
    }
    double variance = 0.0;
    for (const double square : squares) {
        variance += (square - mean) * (square - mean) / std::max(1.0, n - 1.0);
    }
    point.error = std::sqrt(mean);
    point.sigma = point.error > 0.0 ? std::sqrt(variance / n) / (2.0 * point.error) : 0.0;
    return point;
}

/// Sets of photos for the model that is chosen: a set's error scatters by half of itself and more (0.004 to 0.04 px),
/// so six sets tell the rms to a quarter and fifty to a twelfth.
int chosen_sets(const FloorSettings& settings) {
    return std::max(settings.pictures, settings.trials / 10);
}

/// "brown-conrady 41, division 9": most often first.
std::string counted(const std::vector<std::string>& names) {
    std::map<std::string, int> count;
    for (const std::string& name : names) {
        ++count[name];
    }
    std::vector<std::pair<int, std::string>> ordered;
    ordered.reserve(count.size());
    for (const auto& [name, times] : count) {
        ordered.emplace_back(-times, name);
    }
    std::sort(ordered.begin(), ordered.end());
    std::string text;
    for (const auto& [times, name] : ordered) {
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, -times);
    }
    return text;
}

/// What the model that is chosen without being told makes of the usual set of photos.
Check chosen_check(const TrueLens& lens, const std::vector<double>& errors, const std::vector<std::string>& chosen) {
    const FloorPoint point = point_of(0.0, errors);
    return {.id = "mapping-" + lens.id,
            .group = "Mapping over the covered frame",
            .subject = "photos-" + lens.id,
            .label = fmt::format("{}, model chosen by itself", lens.title),
            .value = point.error,
            .sigma = point.sigma,
            .unit = "px rms",
            .limit = kMapping_px,
            .expectation = Expectation::at_most,
            .target = 0.0,
            .explanation = fmt::format("{} sets of {} photos, points known to {} px. Chosen: {}.", chosen.size(),
                                       kUsualPhotos, kPointNoise_px, counted(chosen))};
}

}  // namespace

MeasurementFloor measure_models(const FloorSettings& settings, std::uint64_t seed, int threads,
                                const FloorProgress& progress) {
    const std::vector<TrueLens> lenses = true_lenses();
    const std::vector<Varied> sweeps = varied();
    struct Job {
        std::size_t sweep, lens, model, value;  // sweep = sweeps.size(): the model is chosen
        int set;
    };
    std::vector<Job> jobs;
    for (std::size_t l = 0; l < lenses.size(); ++l) {
        for (std::size_t s = 0; s < sweeps.size(); ++s) {
            for (std::size_t m = 0; m < lenses[l].fitted.size(); ++m) {
                for (std::size_t v = 0; v < sweeps[s].values.size(); ++v) {
                    for (int set = 0; set < settings.pictures; ++set) {
                        jobs.push_back({s, l, m, v, set});
                    }
                }
            }
        }
        for (int set = 0; set < chosen_sets(settings); ++set) {
            jobs.push_back({sweeps.size(), l, 0, 0, set});
        }
    }
    std::vector<double> errors(jobs.size());
    std::vector<std::string> chosen(jobs.size());
    const int count = static_cast<int>(jobs.size());
    parallel_for(
        count, threads,
        [&](int i) {
            const auto at = static_cast<std::size_t>(i);
            const Job& job = jobs[at];
            const TrueLens& lens = lenses[job.lens];
            int photos = kUsualPhotos;
            PoseWish wish = kUsualWish;
            const auto own = static_cast<std::uint32_t>(seed * 1000U + static_cast<std::uint64_t>(job.set));
            if (job.sweep == sweeps.size()) {
                const std::vector<ChartView> views = views_of(lens, photos, wish, own);
                const ChosenGeometry choice = choose_model(views, kWidth, kHeight, {});
                const auto apart = mapping_difference(choice.fit.model, lens.model, covered_grid(views));
                errors[at] = apart ? apart->rms_px : std::numeric_limits<double>::quiet_NaN();
                chosen[at] = kind_name(choice.fit.model);
            } else {
                const Varied& sweep = sweeps[job.sweep];
                sweep.apply(sweep.values[job.value], photos, wish);
                errors[at] =
                    mapping_error(lens, lens.fitted[job.model], views_of(lens, photos, wish, own), sweep.where);
            }
        },
        [&](int done) { progress("models", static_cast<double>(done) / count); });

    MeasurementFloor floor;
    std::size_t next = 0;
    const auto take = [&](int number) {
        const auto from = errors.begin() + static_cast<std::ptrdiff_t>(next);
        next += static_cast<std::size_t>(number);
        return std::vector<double>(from, from + number);
    };
    for (const TrueLens& lens : lenses) {
        for (const Varied& what : sweeps) {
            FloorSweep sweep{
                .id = fmt::format("{}-{}", what.id, lens.id),
                .title = fmt::format("{}: {}", what.title, lens.title),
                .setting = fmt::format("points known to {} px; else {} photos, the board's middle up to {} % "
                                       "from the frame's",
                                       kPointNoise_px, kUsualPhotos, 100.0 * kUsualWish.reach),
                .parameter = what.parameter,
                .unit = what.unit,
                .error = what.where == Where::covered ? "rms over the covered frame" : "rms over the whole frame",
                .error_unit = "px",
                .curves = {}};
            for (const ModelKind kind : lens.fitted) {
                FloorCurve curve{.label = kind_name(empty_model(kind)), .points = {}};
                for (const double value : what.values) {
                    curve.points.push_back(point_of(value, take(settings.pictures)));
                }
                sweep.curves.push_back(std::move(curve));
            }
            floor.sweeps.push_back(std::move(sweep));
        }
        const std::vector<std::string> names(
            chosen.begin() + static_cast<std::ptrdiff_t>(next),
            chosen.begin() + static_cast<std::ptrdiff_t>(next) + chosen_sets(settings));
        floor.checks.push_back(chosen_check(lens, take(chosen_sets(settings)), names));
    }
    return floor;
}

}  // namespace lensproof
