// experiments/runner/run_experiment.h — renders, measures and compares what an experiment states.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/profile/curve_difference.h"
#include "calibration/profile/profile.h"
#include "engine/base/cache.h"
#include "experiments/runner/experiment.h"
#include "experiments/studies/photo_set.h"

namespace lensproof::runner {

/// A picture as the report shows it: an sRGB PNG, perhaps smaller than what was measured.
struct ShownPicture {
    std::string name;  // "tessar/view-1.png"
    std::string caption;
    int width = 0;  // of the measured picture
    int height = 0;
    std::string png;
    int view = -1;  // index into the profile's views; -1 for a flat field
};

struct Fact {
    std::string label;
    std::string value;
};

/// A camera, simulated or photographed, with what was measured.
struct Subject {
    std::string name;
    std::string label;
    bool simulated = false;
    calibration::Profile profile;
    std::optional<calibration::Profile> traced;  // the lens's own rays, for a simulation
    std::vector<ShownPicture> pictures;
    std::vector<Fact> facts;
};

struct ComparisonResult {
    Comparison comparison;
    std::optional<calibration::CurveDifference> difference;
    std::optional<double> floor;  // rms of both methods' own errors; none where one's is not known
};

struct ExperimentResult {
    std::vector<Subject> subjects;
    std::vector<ComparisonResult> comparisons;
    std::vector<Check> checks;
    std::vector<std::filesystem::path> inputs;  // every file that the result depends on
};

struct RunSettings {
    std::uint64_t seed = 0;
    int threads = 0;
    Cache cache{};          // for what is found by tracing lenses
    bool self_test = true;  // each measurement says its own floor (calibration/self_test/self_test.h)
};

/// Reports what is being done ("tessar, view 2 of 6") and how much of it is.
using RunProgress = std::function<void(const std::string& step, double done)>;

ExperimentResult run_experiment(const Experiment& experiment, const RunSettings& settings, const RunProgress& progress);

}  // namespace lensproof::runner
