#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "calibration/geometry/cross_validation.h"
#include "calibration/geometry/fit_geometry.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "experiments/studies/measurement_floor/floor_point.h"
#include "experiments/studies/measurement_floor/measure_floor.h"
#include "experiments/studies/measurement_floor/random_poses.h"

namespace lensproof::studies {

namespace {

constexpr int kUsualPhotos = 12;
// What fits of a corner leave at 1 % noise, and half as much again (the points' own sweep: 0.0064 px). Where points are
// known to no more than the 0.02 px that is asked of them, twelve photos leave the mapping at 0.023 to 0.031 px (sets
// of fifty).
constexpr double kPointNoise_px = 0.01;
constexpr double kMapping_px = 0.03;  // what is asked of the mapping over the covered frame
constexpr double kGridStep_px = 16.0;
constexpr PoseWish kUsualWish{.tilt_deg = 30.0, .largest_roll_deg = 20.0, .fill = 0.7, .reach = 0.5};

/// A model, and the lens that it is tried on.
struct Trial {
    calibration::ModelKind fitted;
    calibration::CameraModel truth;
};

/// Models that stand in one chart.
struct TrueLens {
    std::string id;
    std::string title;
    std::vector<Trial> trials;
    bool is_one_lens = true;  // for all the models; else each has its own, which it can express, and none is chosen
};

/// The views that a lens's nearest relative in another family is found by: no noise, all over the frame.
constexpr int kViewsOfRelative = 16;

calibration::CameraModel barrel_lens() {
    return calibration::BrownConrady{{820.0, 318.5, 243.0, -0.24, 0.09, -0.01, 0.0008, -0.0005}};
}

/// To 79° in the corners: the sine projection, which ends at 90°, can image as much.
calibration::CameraModel moderate_fisheye() {
    return calibration::KannalaBrandt{{290.0, 322.0, 236.0, -0.02, 0.004, -0.001, 0.0001}};
}

/// Each model on the lens of its own family that is nearest to `lens`.
std::vector<Trial> own_families(const calibration::CameraModel& lens,
                                const std::vector<calibration::ModelKind>& kinds) {
    std::mt19937 random(1);
    const std::vector<calibration::ChartView> views =
        draw_views({.model = lens, .width_px = kWidth, .height_px = kHeight, .noise_px = 0.0}, kViewsOfRelative,
                   {.tilt_deg = 30.0, .largest_roll_deg = 20.0, .fill = 0.7, .reach = 0.8}, random);
    std::vector<Trial> trials;
    trials.reserve(kinds.size());
    for (const calibration::ModelKind kind : kinds) {
        trials.push_back(
            {kind, calibration::fit_geometry(views, kWidth, kHeight, {.model = kind, .outlier_sigmas = 0.0}).model});
    }
    return trials;
}

std::vector<Trial> all_on(const calibration::CameraModel& lens, const std::vector<calibration::ModelKind>& kinds) {
    std::vector<Trial> trials;
    trials.reserve(kinds.size());
    for (const calibration::ModelKind kind : kinds) {
        trials.push_back({kind, lens});
    }
    return trials;
}

std::vector<TrueLens> true_lenses() {
    const std::vector<calibration::ModelKind> perspective = {
        calibration::ModelKind::brown_conrady, calibration::ModelKind::brown_conrady_rational,
        calibration::ModelKind::division,      calibration::ModelKind::poly3,
        calibration::ModelKind::poly5,         calibration::ModelKind::ptlens};
    const std::vector<calibration::ModelKind> fisheye = {
        calibration::ModelKind::kannala_brandt, calibration::ModelKind::equidistant,  calibration::ModelKind::equisolid,
        calibration::ModelKind::stereographic,  calibration::ModelKind::orthographic, calibration::ModelKind::spline};
    const calibration::CameraModel wide =
        calibration::KannalaBrandt{{220.0, 322.0, 236.0, -0.012, 0.004, -0.002, 0.0002}};
    return {
        {"perspective", "barrel distortion",
         all_on(barrel_lens(), {calibration::ModelKind::brown_conrady, calibration::ModelKind::brown_conrady_rational,
                                calibration::ModelKind::division, calibration::ModelKind::ptlens,
                                calibration::ModelKind::kannala_brandt, calibration::ModelKind::spline})},
        {"fisheye", "a fisheye to 105°",
         all_on(wide, {calibration::ModelKind::kannala_brandt, calibration::ModelKind::equidistant,
                       calibration::ModelKind::equisolid, calibration::ModelKind::spline})},
        {"own-perspective", "each model on a lens of its own family", own_families(barrel_lens(), perspective), false},
        {"own-fisheye", "each model on a fisheye of its own family", own_families(moderate_fisheye(), fisheye), false}};
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

std::vector<Vec2d> covered_grid(const std::vector<calibration::ChartView>& views) {
    const std::vector<Vec2d> all = frame_grid();
    const std::vector<bool> covered = calibration::covered_pixels(views, all);
    std::vector<Vec2d> pixels;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (covered[i]) {
            pixels.push_back(all[i]);
        }
    }
    return pixels;
}

/// What a set of photos gave: the error, NaN where there is none, and where the model was chosen, which.
struct SetResult {
    double error_px = kNaN;
    std::string chosen;
};

void fields(JsonArchive& json, SetResult& result) {
    json.any_number("error_px", result.error_px).field("chosen", result.chosen);
}

/// Where a fitted mapping is compared with the true one.
enum class Where { covered, frame };

/// What is varied: photos, and how far from the middle the board is seen.
struct Varied {
    std::string id;
    std::string title;
    std::string own_title;  // of lenses of the models' own families
    std::string parameter;
    std::string unit;
    std::vector<double> values;
    Where where;
    void (*apply)(double value, int& photos, PoseWish& wish);
};

std::vector<Varied> varied() {
    return {{"photos",
             "Mapping against the number of photos",
             "Mapping against the number of photos",
             "photos",
             "",
             {3.0, 5.0, 8.0, 12.0, 20.0},
             Where::covered,
             [](double value, int& photos, PoseWish&) { photos = static_cast<int>(value); }},
            {"coverage",
             "Mapping of the whole frame against its coverage",
             "Mapping of what is covered against how far that reaches",
             "reach of the board's middle",
             "%",
             {0.0, 20.0, 40.0, 60.0, 80.0},
             Where::frame,
             [](double value, int&, PoseWish& wish) { wish.reach = value / 100.0; }}};
}

std::vector<calibration::ChartView> views_of(const calibration::CameraModel& lens, int photos, const PoseWish& wish,
                                             std::uint32_t seed) {
    std::mt19937 random(seed);
    return draw_views({.model = lens, .width_px = kWidth, .height_px = kHeight, .noise_px = kPointNoise_px}, photos,
                      wish, random);
}

/// Root mean square over the pixels compared; NaN where the fit is refused or images too little.
double mapping_error(const Trial& trial, const std::vector<calibration::ChartView>& views, Where where) {
    try {
        const calibration::GeometryFit fit = calibration::fit_geometry(views, kWidth, kHeight, {.model = trial.fitted});
        const auto apart = calibration::mapping_difference(
            fit.model, trial.truth, where == Where::covered ? covered_grid(views) : frame_grid());
        return apart ? apart->rms_px : kNaN;
    } catch (const InputError&) {
        return kNaN;
    }
}

/// The same with the model chosen, and which it was.
SetResult choice_error(const calibration::CameraModel& lens, const std::vector<calibration::ChartView>& views) {
    try {
        const calibration::ChosenGeometry choice = calibration::choose_model(views, kWidth, kHeight, {});
        const auto apart = calibration::mapping_difference(choice.fit.model, lens, covered_grid(views));
        return {.error_px = apart ? apart->rms_px : kNaN, .chosen = calibration::kind_name(choice.fit.model)};
    } catch (const InputError&) {
        return {.error_px = kNaN, .chosen = "none"};
    }
}

/// A model's own lens is compared where it was seen; what others make of what they did not see is its own question.
Where where_compared(const TrueLens& lens, const Varied& sweep) {
    return lens.is_one_lens ? sweep.where : Where::covered;
}

/// Sets of photos for the model that is chosen: a set's error scatters by half of itself and more,
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
findings::Check chosen_check(const TrueLens& lens, const std::vector<double>& errors,
                             const std::vector<std::string>& chosen) {
    const FloorPoint point = rms_point(0.0, errors);
    return {.id = "mapping-" + lens.id,
            .group = "Mapping over the covered frame",
            .subject = "photos-" + lens.id,
            .label = fmt::format("{}, model chosen by itself", lens.title),
            .value = point.error,
            .sigma = point.sigma,
            .unit = "px rms",
            .limit = kMapping_px,
            .expectation = findings::Expectation::at_most,
            .target = 0.0,
            .explanation = fmt::format("{} sets of {} photos, points known to {} px. Chosen: {}.{}", chosen.size(),
                                       kUsualPhotos, kPointNoise_px, counted(chosen), failed_in_words(point))};
}

/// That a model whose lens it can express keeps the target with the usual number of photos, from the last sweeps.
void own_checks(MeasurementFloor& floor) {
    const auto sweep = std::ranges::find_if(floor.sweeps.rbegin(), floor.sweeps.rend(),
                                            [](const FloorSweep& s) { return s.id.starts_with("photos-"); });
    for (const FloorCurve& curve : sweep->curves) {
        const auto point = std::ranges::find(curve.points, double{kUsualPhotos}, &FloorPoint::value);
        floor.checks.push_back({.id = fmt::format("{}-{}", sweep->id, curve.label),
                                .group = "Mapping over the covered frame, every model on a lens of its own family",
                                .subject = sweep->id,
                                .label = curve.label,
                                .value = point->error,
                                .sigma = point->sigma,
                                .unit = "px rms",
                                .limit = kMapping_px,
                                .expectation = findings::Expectation::at_most,
                                .target = 0.0,
                                .explanation = fmt::format("{} photos, points known to {} px.{}", kUsualPhotos,
                                                           kPointNoise_px, failed_in_words(*point))});
    }
}

}  // namespace

MeasurementFloor measure_models(const FloorSettings& settings, const findings::RunSettings& run,
                                const findings::RunProgress& progress) {
    const std::vector<TrueLens> lenses = true_lenses();
    const std::vector<Varied> sweeps = varied();
    struct Job {
        std::size_t sweep, lens, model, value;  // sweep = sweeps.size(): the model is chosen
        int first_set, sets;
    };
    std::vector<Job> jobs;
    for (std::size_t l = 0; l < lenses.size(); ++l) {
        for (std::size_t s = 0; s < sweeps.size(); ++s) {
            for (std::size_t m = 0; m < lenses[l].trials.size(); ++m) {
                for (std::size_t v = 0; v < sweeps[s].values.size(); ++v) {
                    jobs.push_back({s, l, m, v, 0, settings.pictures});
                }
            }
        }
        for (int set = 0; lenses[l].is_one_lens && set < chosen_sets(settings); ++set) {
            jobs.push_back({sweeps.size(), l, 0, 0, set, 1});
        }
    }
    const auto measured = [&](const Job& job, int set) -> SetResult {
        const TrueLens& lens = lenses[job.lens];
        int photos = kUsualPhotos;
        PoseWish wish = kUsualWish;
        const auto own = static_cast<std::uint32_t>(run.seed * 1000U + static_cast<std::uint64_t>(set));
        if (job.sweep == sweeps.size()) {
            const calibration::CameraModel& truth = lens.trials.front().truth;
            return choice_error(truth, views_of(truth, photos, wish, own));
        }
        const Varied& sweep = sweeps[job.sweep];
        sweep.apply(sweep.values[job.value], photos, wish);
        const Trial& trial = lens.trials[job.model];
        return {.error_px = mapping_error(trial, views_of(trial.truth, photos, wish, own), where_compared(lens, sweep)),
                .chosen = ""};
    };
    std::vector<std::vector<SetResult>> results(jobs.size());
    const int count = static_cast<int>(jobs.size());
    parallel_for(
        count, run.threads,
        [&](int i) {
            const auto& job = jobs[static_cast<std::size_t>(i)];
            const auto& [sweep, lens, model, value, first_set, sets] = job;
            const findings::StepInput input{
                .settings = {{"cell", Json::list({sweep, lens, model, value, first_set, sets})}, {"seed", run.seed}}};
            results[static_cast<std::size_t>(i)] = run.steps.step("models", input, [&] {
                std::vector<SetResult> of_sets;
                for (int set = job.first_set; set < job.first_set + job.sets; ++set) {
                    of_sets.push_back(measured(job, set));
                }
                return of_sets;
            });
        },
        [&](int done) { progress("models", static_cast<double>(done) / count); });

    std::vector<double> errors;
    std::vector<std::string> chosen;
    for (const std::vector<SetResult>& of_sets : results) {
        for (const SetResult& result : of_sets) {
            errors.push_back(result.error_px);
            chosen.push_back(result.chosen);
        }
    }
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
                .title = fmt::format("{}: {}", lens.is_one_lens ? what.title : what.own_title, lens.title),
                .setting = fmt::format("points known to {} px; else {} photos, the board's middle up to {} % "
                                       "from the frame's",
                                       kPointNoise_px, kUsualPhotos, 100.0 * kUsualWish.reach),
                .parameter = what.parameter,
                .unit = what.unit,
                .error = where_compared(lens, what) == Where::covered ? "rms over the covered frame"
                                                                      : "rms over the whole frame",
                .error_unit = "px",
                .curves = {},
                .target = kMapping_px};
            for (const Trial& trial : lens.trials) {
                FloorCurve curve{.label = calibration::kind_name(calibration::empty_model(trial.fitted)), .points = {}};
                for (const double value : what.values) {
                    curve.points.push_back(rms_point(value, take(settings.pictures)));
                }
                sweep.curves.push_back(std::move(curve));
            }
            floor.sweeps.push_back(std::move(sweep));
        }
        if (lens.is_one_lens) {
            const auto first = chosen.begin() + static_cast<std::ptrdiff_t>(next);
            const std::vector<std::string> names(first, first + chosen_sets(settings));
            floor.checks.push_back(chosen_check(lens, take(chosen_sets(settings)), names));
        } else {
            own_checks(floor);
        }
    }
    return floor;
}

}  // namespace lensproof::studies
