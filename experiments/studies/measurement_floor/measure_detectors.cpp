#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "calibration/geometry/fit_geometry.h"
#include "calibration/self_test/simulated_chart.h"
#include "engine/base/infinity.h"
#include "engine/base/parallel.h"
#include "engine/scene/chart/aruco.h"
#include "experiments/studies/measurement_floor/floor_point.h"
#include "experiments/studies/measurement_floor/measure_floor.h"
#include "experiments/studies/measurement_floor/picture_sweeps.h"
#include "experiments/studies/measurement_floor/random_poses.h"

namespace lensproof::studies {

namespace {

constexpr double kUsualTilt_deg = 20.0;
constexpr double kCorner_px = 0.02;  // what is asked of points, rms of one coordinate at 1 % noise
constexpr double kBias_px = 0.02;

struct Detector {
    std::string label;
    scene::Chart chart;
    double width_mm = 0.0;
    double disc_diameter_mm = 0.0;
};

std::vector<std::uint64_t> markers_of(const std::string& dictionary, std::size_t count) {
    std::vector<std::uint64_t> markers = scene::aruco_dictionary(dictionary).markers;
    markers.resize(count);
    return markers;
}

Detector detector(const std::string& label, const scene::ChartPattern& pattern, double width_mm) {
    Detector made{.label = label, .chart = {}, .width_mm = width_mm};
    made.chart.pattern = pattern;
    made.chart.white_reflectance = 1.0;
    made.chart.black_reflectance = 0.05;
    made.disc_diameter_mm = calibration::disc_diameter_mm(made.chart);
    return made;
}

std::vector<Detector> detectors() {
    const scene::CharucoBoard charuco{.columns = 9,
                                      .rows = 6,
                                      .square_mm = 33.0,
                                      .marker_mm = 24.0,
                                      .cells = 5,
                                      .markers = markers_of("DICT_5X5_50", 27)};
    std::vector<Detector> all;
    all.push_back(detector("checkerboard", scene::Checkerboard{10, 7, 30.0}, 300.0));
    all.push_back(detector("charuco", charuco, 300.0));
    all.push_back(detector("disc grid", scene::DiscGrid{9, 6, 33.0, 18.0}, 300.0));
    all.push_back(detector("point grid", scene::PointGrid{9, 6, 33.0, 10.0}, 300.0));
    all.push_back(detector("slanted edges", scene::SlantedEdges{9, 6, 33.0, 18.0, 5.0}, 300.0));
    all.push_back(detector("straight lines", scene::StraightLines{9, 6, 33.0, 6.0}, 300.0));
    return all;
}

/// What is varied_pictures in a sweep, and how it enters the simulation.
struct VariedPictures {
    PictureSweep of;
    double tilt_fraction = 0.0;  // 1: the value is the tilt
};

/// Those of pictures, and the chart's tilt.
std::vector<VariedPictures> varied_pictures() {
    std::vector<VariedPictures> all;
    for (const PictureSweep& sweep : picture_sweeps()) {
        all.push_back({.of = sweep});
    }
    const PictureSweep tilt{.id = "tilt",
                            .name = "tilt",
                            .parameter = "tilt",
                            .unit = "°",
                            .values = {0.0, 15.0, 30.0, 45.0, 55.0},
                            .apply = [](double, calibration::SimulatedCamera&) {}};
    all.insert(all.begin() + 2, {.of = tilt, .tilt_fraction = 1.0});
    return all;
}

struct Errors {
    int expected = 0;
    int found = 0;
    int pictures = 0;
    int empty = 0;         // pictures in which the chart was not found
    double squares = 0.0;  // of both coordinates
    Vec2d sum;

    void add(const Errors& other) {
        expected += other.expected;
        found += other.found;
        pictures += other.pictures;
        empty += other.empty;
        squares += other.squares;
        sum = {sum.x + other.sum.x, sum.y + other.sum.y};
    }
    [[nodiscard]] double rms() const { return found > 0 ? std::sqrt(squares / (2.0 * found)) : kNaN; }
    /// Of the rms, as if errors were independent and normal.
    [[nodiscard]] double sigma() const { return found > 0 ? rms() / std::sqrt(4.0 * found) : 0.0; }
    [[nodiscard]] double bias() const { return found > 0 ? std::hypot(sum.x, sum.y) / found : 0.0; }
};

void fields(JsonArchive& json, Errors& errors) {
    json.field("expected", errors.expected)
        .field("found", errors.found)
        .field("pictures", errors.pictures)
        .field("empty", errors.empty)
        .field("squares", errors.squares)
        .field("sum", errors.sum);
}

/// One picture, simulated, searched and refined.
Errors look(const Detector& detector, const calibration::SimulatedCamera& camera, const PoseWish& wish,
            std::uint32_t seed) {
    std::mt19937 random(seed);
    const calibration::Pose pose =
        draw_pose(camera.model, camera.width_px, camera.height_px, detector.width_mm, wish, random);
    const formats::Image image = calibration::simulate_chart(camera, pose, detector.chart, seed);
    const std::vector<Vec2d> features = scene::feature_points(detector.chart);
    Errors errors{.expected = static_cast<int>(features.size()), .pictures = 1};
    const calibration::Detection detection = calibration::detect(image, detector.chart);
    if (!detection.found()) {
        errors.empty = 1;
        return errors;
    }
    const calibration::ChartPoints points = calibration::refine(image, 0, detection.points, detector.chart);
    for (std::size_t i = 0; i < features.size(); ++i) {
        const auto truth = calibration::predict(camera.model, pose, features[i], detector.disc_diameter_mm);
        if (points.found[i] && truth) {
            const Vec2d error{points.image_px[i].x - truth->x, points.image_px[i].y - truth->y};
            errors.add({.expected = 0, .found = 1, .squares = error.x * error.x + error.y * error.y, .sum = error});
        }
    }
    return errors;
}

calibration::SimulatedCamera chart_camera() {
    return {.model = calibration::BrownConrady{{820.0, 318.5, 243.0, -0.24, 0.09, -0.01, 0.0008, -0.0005}},
            .width_px = 640,
            .height_px = 480,
            .channels = {{.name = "Y"}},
            .white = kWhite,
            .blur_px = kUsualBlur_px,
            .read_noise = kUsualNoise_percent / 100.0 * kWhite,
            .shot_noise = 0.0,
            .jpeg_quality = {},
            .threads = 1};
}

findings::Check target_check(const std::string& id, const Detector& detector, const std::string& label, double value,
                             double sigma, double limit, const Errors& errors) {
    return {.id = fmt::format("{}-{}", detector.label, id),
            .group = "Points at 1 % noise",
            .subject = "noise",
            .label = fmt::format("{}: {}", detector.label, label),
            .value = value,
            .sigma = sigma,
            .unit = "px",
            .limit = limit,
            .expectation = findings::Expectation::at_most,
            .target = 0.0,
            .explanation = fmt::format("Blur of {} px, tilts of {}°, 640 × 480 pixels; {} of {} points found.",
                                       kUsualBlur_px, kUsualTilt_deg, errors.found, errors.expected)};
}

}  // namespace

std::vector<std::string> detector_sweeps() {
    std::vector<std::string> ids;
    std::ranges::transform(varied_pictures(), std::back_inserter(ids),
                           [](const VariedPictures& what) { return what.of.id; });
    return ids;
}

std::vector<std::string> floor_detectors() {
    std::vector<std::string> labels;
    std::ranges::transform(detectors(), std::back_inserter(labels), &Detector::label);
    return labels;
}

MeasurementFloor measure_detectors(const FloorSettings& settings, const findings::RunSettings& run,
                                   const findings::RunProgress& progress) {
    std::vector<Detector> all = detectors();
    std::erase_if(all,
                  [&](const Detector& detector) { return !findings::is_wanted(settings.detectors, detector.label); });
    std::vector<VariedPictures> sweeps = varied_pictures();
    std::erase_if(sweeps,
                  [&](const VariedPictures& what) { return !findings::is_wanted(settings.sweeps, what.of.id); });
    for (VariedPictures& what : sweeps) {
        std::erase_if(what.of.values, [&](double value) { return !findings::is_wanted(settings.values, value); });
    }
    struct Job {
        std::size_t sweep, detector, value;
    };
    std::vector<Job> jobs;
    for (std::size_t s = 0; s < sweeps.size(); ++s) {
        for (std::size_t d = 0; d < all.size(); ++d) {
            for (std::size_t v = 0; v < sweeps[s].of.values.size(); ++v) {
                jobs.push_back({s, d, v});
            }
        }
    }
    std::vector<Errors> results(jobs.size());
    const int count = static_cast<int>(jobs.size());
    parallel_for(
        count, run.threads,
        [&](int i) {
            const Job& job = jobs[static_cast<std::size_t>(i)];
            calibration::SimulatedCamera camera = chart_camera();
            const VariedPictures& what = sweeps[job.sweep];
            const double value = what.of.values[job.value];
            what.of.apply(value, camera);
            const PoseWish wish{.tilt_deg = std::lerp(kUsualTilt_deg, value, what.tilt_fraction)};
            const findings::StepInput input{.settings = {{"sweep", what.of.id},
                                                         {"value", value},
                                                         {"detector", all[job.detector].label},
                                                         {"pictures", settings.pictures},
                                                         {"seed", run.seed}}};
            results[static_cast<std::size_t>(i)] = run.steps.step("detector", input, [&] {
                Errors errors;
                for (int picture = 0; picture < settings.pictures; ++picture) {
                    // The same poses and noise at every value and for every chart, so that curves differ by these
                    // alone.
                    const auto own = static_cast<std::uint32_t>(run.seed * 1000U + static_cast<std::uint64_t>(picture));
                    errors.add(look(all[job.detector], camera, wish, own));
                }
                return errors;
            });
        },
        [&](int done) { progress("detectors", static_cast<double>(done) / count); });

    MeasurementFloor floor;
    std::size_t next = 0;
    for (const VariedPictures& what : sweeps) {
        FloorSweep sweep{.id = what.of.id,
                         .title = "Points against " + what.of.name,
                         .setting = fmt::format("else {} % noise, a blur of {} px, tilts of {}°, no JPEG",
                                                kUsualNoise_percent, kUsualBlur_px, kUsualTilt_deg),
                         .parameter = what.of.parameter,
                         .unit = what.of.unit,
                         .error = "rms of one coordinate",
                         .error_unit = "px",
                         .curves = {},
                         .target = kCorner_px};
        for (const Detector& detector : all) {
            FloorCurve curve{.label = detector.label, .points = {}};
            for (const double value : what.of.values) {
                const Errors& errors = results[next++];
                curve.points.push_back({.value = value,
                                        .error = errors.rms(),
                                        .sigma = errors.sigma(),
                                        .found_percent = 100.0 * errors.found / errors.expected,
                                        .trials = errors.pictures,
                                        .failed = errors.empty});
                if (what.of.id == "noise" && value == 1.0) {
                    floor.checks.push_back(target_check("rms", detector, "rms of one coordinate", errors.rms(),
                                                        errors.sigma(), kCorner_px, errors));
                    floor.checks.push_back(target_check("bias", detector, "mean error", errors.bias(),
                                                        errors.rms() / std::sqrt(std::max(1, errors.found)), kBias_px,
                                                        errors));
                }
            }
            sweep.curves.push_back(std::move(curve));
        }
        floor.sweeps.push_back(std::move(sweep));
    }
    return floor;
}

}  // namespace lensproof::studies
