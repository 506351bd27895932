#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "calibration/geometry/fit_geometry.h"
#include "calibration/light/light_samples.h"
#include "calibration/light/vignetting.h"
#include "calibration/measure/measure_sharpness.h"
#include "calibration/profile/curve_difference.h"
#include "calibration/self_test/simulated_chart.h"
#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "experiments/studies/measurement_floor/floor_point.h"
#include "experiments/studies/measurement_floor/measure_floor.h"
#include "experiments/studies/measurement_floor/picture_sweeps.h"
#include "experiments/studies/measurement_floor/random_poses.h"

namespace lensproof::studies {

namespace {

constexpr int kViews = 2;  // of the chart, in a set
// The board nearly fills the picture, so that its outermost points lie near the corners.
constexpr PoseWish kWish{.tilt_deg = 3.0, .largest_roll_deg = 1.0, .fill = 0.94, .reach = 0.02};

// What is asked at 1 % noise.
constexpr double kShift_px = 0.02;
constexpr double kVignetting_percent = 0.2;
constexpr double kMtf50_percent = 2.0;

Vec2d centre() {
    return {(kWidth - 1) / 2.0, (kHeight - 1) / 2.0};
}

double true_shift_px(double height) {
    return 0.8 * height - 0.5 * std::pow(height, 3.0);
}

double true_vignetting(double height) {
    return std::pow(std::cos(0.5 * height), 4.0);
}

/// Without distortion, so that a blur is the same in every direction.
calibration::SimulatedCamera usual_camera() {
    return {.model = calibration::BrownConrady{{820.0, centre().x, centre().y}},
            .width_px = kWidth,
            .height_px = kHeight,
            .channels = {{.name = "R", .radial_shift_px = true_shift_px, .vignetting = true_vignetting},
                         {.name = "G", .vignetting = true_vignetting},
                         {.name = "B", .vignetting = true_vignetting}},
            .white = kWhite,
            .blur_px = kUsualBlur_px,
            .read_noise = kUsualNoise_percent / 100.0 * kWhite,
            .threads = 1};
}

scene::Chart chart_of(const scene::ChartPattern& pattern) {
    return {.pattern = pattern, .white_reflectance = 1.0, .black_reflectance = 0.05};
}

/// The errors of one set of pictures; NaN where something could not be measured.
struct QuantityErrors {
    double shift_px = kNaN;       // of red against green, at the outermost corner
    double flat_percent = kNaN;   // of vignetting from a flat field, rms over the picture,
    double white_percent = kNaN;  // and from the charts' white
    double mtf50_percent = kNaN;  // of one edge, rms
};

void fields(JsonArchive& json, QuantityErrors& errors) {
    json.any_number("shift_px", errors.shift_px)
        .any_number("flat_percent", errors.flat_percent)
        .any_number("white_percent", errors.white_percent)
        .any_number("mtf50_percent", errors.mtf50_percent);
}

double vignetting_error_percent(const std::vector<calibration::LightGroup>& groups) {
    try {
        const calibration::Curve measured = calibration::fit_vignetting(groups, centre(), kHalfDiagonal).ratio;
        calibration::Curve truth{.image_height = measured.image_height};
        for (const double height : truth.image_height) {
            truth.value.push_back(true_vignetting(height));
        }
        truth.lower_95 = truth.upper_95 = truth.value;
        truth.covered_image_height = measured.covered_image_height;
        const auto apart = calibration::difference(measured, truth);
        return apart ? 100.0 * apart->rms : kNaN;
    } catch (const InputError&) {
        return kNaN;
    }
}

/// Where a Gaussian blur and the pixel's box together have fallen to a half, in the direction of an edge's normal.
double true_mtf50(double blur_px, double normal_deg) {
    const double angle = radians(normal_deg);
    const auto box = [](double f) { return f == 0.0 ? 1.0 : std::sin(std::numbers::pi * f) / (std::numbers::pi * f); };
    const auto mtf = [&](double f) {
        return std::exp(-2.0 * std::pow(std::numbers::pi * blur_px * f, 2.0)) * box(f * std::cos(angle)) *
               box(f * std::sin(angle));
    };
    return bisected({0.0, 1.0}, 50, [&](double f) { return mtf(f) > 0.5; }).inside;
}

/// Red against green, and the light on the charts' white.
void look_at_charts(const calibration::SimulatedCamera& camera, std::uint32_t seed, QuantityErrors& errors) {
    const scene::Chart chart = chart_of(scene::Checkerboard{20, 15, 15.0});
    std::mt19937 random(seed);
    std::vector<calibration::ChromaticPair> pairs;
    std::vector<calibration::LightGroup> whites;
    for (int view = 0; view < kViews; ++view) {
        const calibration::Pose pose = draw_pose(camera.model, kWidth, kHeight, 300.0, kWish, random);
        const formats::Image image =
            calibration::simulate_chart(camera, pose, chart, seed * kViews + static_cast<std::uint32_t>(view));
        const calibration::Detection detection = calibration::detect(image, chart);
        if (!detection.found()) {
            return;
        }
        const calibration::ChartPoints green = calibration::refine(image, 1, detection.points, chart);
        const calibration::ChartPoints red = calibration::refine(image, 0, green, chart);
        for (std::size_t i = 0; i < green.found.size(); ++i) {
            if (green.found[i] && red.found[i]) {
                pairs.push_back({green.image_px[i], red.image_px[i]});
            }
        }
        whites.push_back(calibration::chart_white_samples(image, 1, green, chart));
    }
    errors.white_percent = vignetting_error_percent(whites);
    try {
        const calibration::Curve radial = calibration::fit_chromatic_shift(pairs, centre(), kHalfDiagonal).radial;
        errors.shift_px = std::abs(radial.value.back() - true_shift_px(radial.image_height.back()));
    } catch (const InputError&) {
        errors.shift_px = kNaN;
    }
}

/// The edges of a grid that faces the camera, at places that are known: finding them is the detectors' part.
double mtf50_error_percent(const calibration::SimulatedCamera& in_colour, std::uint32_t seed) {
    calibration::SimulatedCamera camera = in_colour;
    camera.channels = {{.name = "Y"}};
    const scene::Chart chart = chart_of(scene::SlantedEdges{5, 4, 60.0, 32.0, 5.0});
    const calibration::Pose pose{{0.0, 0.0, 0.0}, {1.0, -2.0, 420.0}};
    const formats::Image image = calibration::simulate_chart(camera, pose, chart, seed);
    calibration::ChartPoints points;
    for (const Vec2d& point : scene::feature_points(chart)) {
        points.image_px.push_back(
            calibration::project(camera.model, calibration::to_camera(pose, point)).value_or(Vec2d{}));
        points.found.push_back(true);
    }
    calibration::SharpnessObservations seen;
    calibration::observe_chart_edges(seen, image, 0, "edges", points, chart);
    double squares = 0.0;
    int count = 0;
    for (const calibration::ProfileEdge& listed : seen.edges["Y"]) {
        if (listed.edge.mtf50) {
            const double truth = true_mtf50(camera.blur_px, listed.edge.normal_deg);
            squares += std::pow(listed.edge.mtf50->cycles_per_px / truth - 1.0, 2.0);
            ++count;
        }
    }
    return count > 0 ? 100.0 * std::sqrt(squares / count) : kNaN;
}

QuantityErrors errors_of_set(const calibration::SimulatedCamera& camera, std::uint32_t seed) {
    QuantityErrors errors;
    look_at_charts(camera, seed, errors);
    errors.flat_percent =
        vignetting_error_percent({calibration::flat_field_samples(calibration::simulate_flat_field(camera, seed), 1)});
    errors.mtf50_percent = mtf50_error_percent(camera, seed);
    return errors;
}

/// A curve of a sweep.
struct JudgedQuantity {
    std::string label;
    double QuantityErrors::*error;
};

/// Quantities of one unit and target: a sweep.
struct Sort {
    std::string id;
    std::string title;
    std::string error;
    std::string unit;
    double target;
    std::vector<JudgedQuantity> quantities;
};

std::vector<Sort> sorts() {
    return {{"chromatic-shift",
             "Chromatic shift",
             "rms at the outermost corner",
             "px",
             kShift_px,
             {{"red against green", &QuantityErrors::shift_px}}},
            {"vignetting",
             "Vignetting",
             "rms over the picture, of the axis",
             "%",
             kVignetting_percent,
             {{"from a flat field", &QuantityErrors::flat_percent},
              {"from the charts' white", &QuantityErrors::white_percent}}},
            {"mtf50",
             "MTF50",
             "rms of one edge",
             "%",
             kMtf50_percent,
             {{"slanted edges", &QuantityErrors::mtf50_percent}}}};
}

findings::Check target_check(const Sort& sort, const JudgedQuantity& quantity, const FloorPoint& point) {
    return {.id = fmt::format("{}-{}", sort.id, quantity.label),
            .group = "Chromatic shift, vignetting and sharpness at 1 % noise",
            .subject = sort.id + "-noise",
            .label = fmt::format("{}, {}", sort.title, quantity.label),
            .value = point.error,
            .sigma = point.sigma,
            .unit = sort.unit,
            .limit = sort.target,
            .expectation = findings::Expectation::at_most,
            .target = 0.0,
            .explanation = fmt::format("{}; {} sets of {} views, a flat field and a grid of edges, blur of {} px.{}",
                                       sort.error, point.trials, kViews, kUsualBlur_px, failed_in_words(point))};
}

}  // namespace

MeasurementFloor measure_quantities(const FloorSettings& settings, const findings::RunSettings& run,
                                    const findings::RunProgress& progress) {
    std::vector<PictureSweep> sweeps = picture_sweeps();
    std::erase_if(sweeps, [&](const PictureSweep& sweep) { return !findings::is_wanted(settings.sweeps, sweep.id); });
    for (PictureSweep& sweep : sweeps) {
        std::erase_if(sweep.values, [&](double value) { return !findings::is_wanted(settings.values, value); });
    }
    const int sets = settings.pictures;
    struct Job {
        std::size_t sweep, value;
        int set;
    };
    std::vector<Job> jobs;
    for (std::size_t s = 0; s < sweeps.size(); ++s) {
        for (std::size_t v = 0; v < sweeps[s].values.size(); ++v) {
            for (int set = 0; set < sets; ++set) {
                jobs.push_back({s, v, set});
            }
        }
    }
    std::vector<QuantityErrors> results(jobs.size());
    const int count = static_cast<int>(jobs.size());
    parallel_for(
        count, run.threads,
        [&](int i) {
            const Job& job = jobs[static_cast<std::size_t>(i)];
            calibration::SimulatedCamera camera = usual_camera();
            sweeps[job.sweep].apply(sweeps[job.sweep].values[job.value], camera);
            const auto own = static_cast<std::uint32_t>(run.seed * 1000U + static_cast<std::uint64_t>(job.set));
            const findings::StepInput input{.settings = {{"sweep", sweeps[job.sweep].id},
                                                         {"value", sweeps[job.sweep].values[job.value]},
                                                         {"seed", own}}};
            results[static_cast<std::size_t>(i)] =
                run.steps.step("quantities", input, [&] { return errors_of_set(camera, own); });
        },
        [&](int done) { progress("quantities", static_cast<double>(done) / count); });

    MeasurementFloor floor;
    std::size_t first = 0;  // of a sweep's results
    for (const PictureSweep& what : sweeps) {
        for (const Sort& sort : sorts()) {
            FloorSweep sweep{
                .id = fmt::format("{}-{}", sort.id, what.id),
                .title = fmt::format("{} against {}", sort.title, what.name),
                .setting = fmt::format("else {} % noise, a blur of {} px, no JPEG", kUsualNoise_percent, kUsualBlur_px),
                .parameter = what.parameter,
                .unit = what.unit,
                .error = sort.error,
                .error_unit = sort.unit,
                .curves = {},
                .target = sort.target};
            for (const JudgedQuantity& quantity : sort.quantities) {
                FloorCurve curve{.label = quantity.label, .points = {}};
                std::size_t next = first;
                for (const double value : what.values) {
                    std::vector<double> errors;
                    errors.reserve(static_cast<std::size_t>(sets));
                    for (int set = 0; set < sets; ++set) {
                        errors.push_back(results[next++].*quantity.error);
                    }
                    curve.points.push_back(rms_point(value, errors));
                    if (what.id == "noise" && value == kUsualNoise_percent) {
                        floor.checks.push_back(target_check(sort, quantity, curve.points.back()));
                    }
                }
                sweep.curves.push_back(std::move(curve));
            }
            floor.sweeps.push_back(std::move(sweep));
        }
        first += what.values.size() * static_cast<std::size_t>(sets);
    }
    return floor;
}

}  // namespace lensproof::studies
