#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/geometry/fit_geometry.h"
#include "calibration/geometry/geometry_curves.h"
#include "calibration/light/light_samples.h"
#include "calibration/light/vignetting.h"
#include "calibration/self_test/simulated_chart.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "experiments/studies/measurement_floor/measure_floor.h"
#include "experiments/studies/measurement_floor/random_poses.h"

namespace lensproof::studies {

namespace {

constexpr double kTrialNoise_px = 0.02;                        // what points are asked to be known to
constexpr std::array<double, 3> kHeights = {0.25, 0.5, 0.75};  // image heights at which curves are judged

calibration::BrownConrady true_camera() {
    return {{820.0, 318.5, 243.0, -0.24, 0.09, -0.01, 0.0008, -0.0005}};
}

/// Whether intervals held the truth, counted, by what they are of; each trial its own.
struct Stated {
    std::string id;
    std::string label;
};
constexpr int kNoInterval = 2;
using Outcome = std::vector<int>;  // a quantity each: 1 held, 0 not, or no interval

int holds(const std::optional<calibration::Banded>& stated, double truth) {
    return !stated ? kNoInterval : stated->lower_95 <= truth && truth <= stated->upper_95 ? 1 : 0;
}

std::vector<Stated> at_heights(const std::string& id, const std::string& label) {
    std::vector<Stated> quantities;
    quantities.reserve(kHeights.size());
    for (const double height : kHeights) {
        quantities.push_back(
            {fmt::format("{}-{:g}", id, height), fmt::format("{} at image height {:g}", label, height)});
    }
    return quantities;
}

// Eight views of a board of 9 × 6 points whose positions have normal errors.
Outcome geometry_trial(std::uint32_t seed) {
    std::mt19937 random(seed);
    const calibration::BrownConrady camera = true_camera();
    const std::vector<calibration::ChartView> views =
        draw_views({.model = camera, .width_px = kWidth, .height_px = kHeight, .noise_px = kTrialNoise_px}, 8,
                   {.tilt_deg = 30.0, .largest_roll_deg = 20.0, .fill = 0.8, .reach = 0.4}, random);
    const calibration::GeometryFit fit =
        calibration::fit_geometry(views, kWidth, kHeight, {.model = calibration::ModelKind::brown_conrady});
    const double focal = calibration::focal_length_px(fit.model);
    const double half = calibration::k95 * fit.standard_error(0);
    Outcome held{holds(calibration::Banded{focal, focal - half, focal + half}, calibration::focal_length_px(camera))};
    const calibration::Curve angle = calibration::field_angle_curve(fit, kHalfDiagonal);
    for (const double height : kHeights) {
        held.push_back(holds(calibration::sample(angle, height),
                             *calibration::field_angle_rad(camera, height * kHalfDiagonal) / kDegree));
    }
    return held;
}

double trial_vignetting(double height) {
    return std::pow(std::cos(0.5 * height), 4.0) * (1.0 - 0.05 * std::pow(height, 6.0));
}

// One flat field with a noise of 1 % of the white.
Outcome vignetting_trial(std::uint32_t seed) {
    calibration::SimulatedCamera camera{.model = calibration::BrownConrady{{400.0, 159.5, 119.5}},
                                        .width_px = kWidth / 2,
                                        .height_px = kHeight / 2,
                                        .channels = {{.name = "Y", .vignetting = trial_vignetting}},
                                        .white = 0.7,
                                        .blur_px = 0.0,
                                        .read_noise = 0.007,
                                        .shot_noise = 0.0,
                                        .jpeg_quality = {},
                                        .threads = 1};
    const formats::Image image = calibration::simulate_flat_field(camera, seed);
    const calibration::Vignetting fit = calibration::fit_vignetting(
        {calibration::flat_field_samples(image, 0)}, calibration::centre_px(camera.model), kHalfDiagonal / 2.0);
    Outcome held;
    for (const double height : kHeights) {
        held.push_back(holds(calibration::sample(fit.ratio, height), trial_vignetting(height)));
    }
    return held;
}

// 54 points of five views, in two channels.
Outcome chromatic_trial(std::uint32_t seed) {
    std::mt19937 random(seed);
    const Vec2d centre{(kWidth - 1) / 2.0, (kHeight - 1) / 2.0};
    const auto shift = [](double height) { return 0.8 * height - 0.5 * std::pow(height, 3.0); };
    std::vector<calibration::ChromaticPair> pairs;
    for (int i = 0; i < 5 * 54; ++i) {
        const Vec2d green{kWidth * uniform(random), kHeight * uniform(random)};
        const Vec2d q{(green.x - centre.x) / kHalfDiagonal, (green.y - centre.y) / kHalfDiagonal};
        const double height = std::hypot(q.x, q.y);
        const double scale = shift(height) / height;
        const auto noise = [&] { return kTrialNoise_px * normal(random); };
        pairs.push_back({{green.x + noise(), green.y + noise()},
                         {green.x + scale * q.x + noise(), green.y + scale * q.y + noise()}});
    }
    const calibration::ChromaticShift fit = calibration::fit_chromatic_shift(pairs, centre, kHalfDiagonal);
    Outcome held;
    for (const double height : kHeights) {
        held.push_back(holds(calibration::sample(fit.radial, height), shift(height)));
    }
    return held;
}

/// A trial whose fit is refused states no interval, and is counted as such.
Outcome outcome_of(Outcome (*trial)(std::uint32_t seed), std::size_t quantities, std::uint32_t seed) {
    try {
        return trial(seed);
    } catch (const InputError&) {
        return Outcome(quantities, kNoInterval);
    }
}

struct Study {
    std::vector<Stated> quantities;
    Outcome (*trial)(std::uint32_t seed);
};

std::vector<Study> studies() {
    std::vector<Stated> geometry = at_heights("field-angle", "field angle");
    geometry.insert(geometry.begin(), {"focal-length", "focal length"});
    return {{std::move(geometry), geometry_trial},
            {at_heights("vignetting", "vignetting"), vignetting_trial},
            {at_heights("chromatic-shift", "chromatic shift"), chromatic_trial}};
}

}  // namespace

MeasurementFloor measure_intervals(const FloorSettings& settings, const findings::RunSettings& run,
                                   const findings::RunProgress& progress) {
    const std::vector<Study> all = studies();
    // Many at a time are a step: one takes a few milliseconds.
    constexpr int kTrialsOfAStep = 25;
    const int steps = (settings.trials + kTrialsOfAStep - 1) / kTrialsOfAStep;  // of a study
    std::vector<std::vector<Outcome>> results(all.size() * static_cast<std::size_t>(steps));
    const int count = static_cast<int>(results.size());
    parallel_for(
        count, run.threads,
        [&](int i) {
            const int of = i / steps;
            const Study& study = all[static_cast<std::size_t>(of)];
            const int first = i % steps * kTrialsOfAStep;
            const int end = std::min(first + kTrialsOfAStep, settings.trials);
            const findings::StepInput input{
                .settings = {{"study", of}, {"trials", Json::list({first, end, settings.trials})}, {"seed", run.seed}}};
            results[static_cast<std::size_t>(i)] = run.steps.step("intervals", input, [&] {
                std::vector<Outcome> outcomes;
                for (int trial = first; trial < end; ++trial) {
                    const auto own = run.seed * 100003U + static_cast<std::uint64_t>(of * settings.trials + trial);
                    outcomes.push_back(
                        outcome_of(study.trial, study.quantities.size(), static_cast<std::uint32_t>(own)));
                }
                return outcomes;
            });
        },
        [&](int done) { progress("intervals", static_cast<double>(done) / count); });

    std::vector<std::vector<Outcome>> outcomes(all.size());
    for (std::size_t i = 0; i < results.size(); ++i) {
        std::vector<Outcome>& of_study = outcomes[i / static_cast<std::size_t>(steps)];
        of_study.insert(of_study.end(), results[i].begin(), results[i].end());
    }
    MeasurementFloor floor;
    for (std::size_t s = 0; s < all.size(); ++s) {
        for (std::size_t q = 0; q < all[s].quantities.size(); ++q) {
            int stated = 0;
            int held = 0;
            for (const Outcome& outcome : outcomes[s]) {
                stated += outcome[q] != kNoInterval ? 1 : 0;
                held += outcome[q] == 1 ? 1 : 0;
            }
            floor.checks.push_back(
                {.id = "interval-" + all[s].quantities[q].id,
                 .group = "Stated 95 % intervals that hold the truth",
                 .subject = "",
                 .label = all[s].quantities[q].label,
                 .value = 100.0 * held / std::max(1, stated),
                 .sigma = 0.0,
                 .unit = "%",
                 .limit = 2.0,
                 .expectation = findings::Expectation::within,
                 .target = 95.0,
                 .explanation = fmt::format(
                     "{} of {} trials{}. Right intervals would scatter by {:.1f} %.", held, stated,
                     stated < settings.trials ? fmt::format(" ({} more stated no interval)", settings.trials - stated)
                                              : "",
                     100.0 * std::sqrt(0.95 * 0.05 / std::max(1, stated)))});
        }
    }
    return floor;
}

}  // namespace lensproof::studies
