// experiments/studies/measurement_floor/measure_floor.h — what the measurement of a chart gets wrong by itself, on
// pictures whose truth is known.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/findings/study.h"

namespace lensproof::studies {

/// What an experiment file states, [measurement_floor].
struct FloorSettings {
    std::vector<std::string> sweeps;     // ids of `detector_sweeps()`; empty: all
    std::vector<double> values{};        // of the sweeps of pictures only these (not in files); empty: all
    std::vector<std::string> detectors;  // of `floor_detectors()`; empty: all
    int pictures = 6;                    // simulated for each value of a sweep
    int trials = 500;                    // of each interval
};

/// An error at one value of what is varied.
struct FloorPoint {
    double value = 0.0;
    double error = 0.0;            // rms; NaN where nothing was found
    double sigma = 0.0;            // its standard error
    double found_percent = 100.0;  // of the points, pictures or trials
    int trials = 0;                // pictures or sets of them, and
    int failed = 0;                // how many of them gave no number
};

struct FloorCurve {
    std::string label;  // the detector or the model
    std::vector<FloorPoint> points;
};

/// One quantity varied, everything else as `setting` says.
struct FloorSweep {
    std::string id;
    std::string title;
    std::string setting;
    std::string parameter;  // "noise"
    std::string unit;
    std::string error;  // "rms of one coordinate"
    std::string error_unit;
    std::vector<FloorCurve> curves;
    std::optional<double> target = std::nullopt;  // what is asked, in the error's unit, drawn as a line
};

struct MeasurementFloor {
    std::vector<FloorSweep> sweeps;
    std::vector<findings::Check> checks;
};

/// What detectors are swept over, and the detectors.
std::vector<std::string> detector_sweeps();
std::vector<std::string> floor_detectors();

/// The parts, each on up to as many threads as the run's settings say, with the same result for any number of them.
/// Their seed draws poses and noise.
///
/// Detectors: the error of found points against noise, blur, tilt and JPEG's quality, for each kind of chart.
MeasurementFloor measure_detectors(const FloorSettings& settings, const findings::RunSettings& run,
                                   const findings::RunProgress& progress);
/// Quantities: the errors of chromatic shift, vignetting and MTF50 against noise, blur and JPEG's quality.
MeasurementFloor measure_quantities(const FloorSettings& settings, const findings::RunSettings& run,
                                    const findings::RunProgress& progress);
/// Models: the error of fitted mappings against the number of photos and their coverage, for the models that one might
/// fit to a lens, and for every model on a lens of its own family; and what the model that is chosen by itself makes of
/// the usual set. A value's "pictures" are sets.
MeasurementFloor measure_models(const FloorSettings& settings, const findings::RunSettings& run,
                                const findings::RunProgress& progress);
/// Intervals: in how many of the trials the stated 95 % intervals hold the truth.
MeasurementFloor measure_intervals(const FloorSettings& settings, const findings::RunSettings& run,
                                   const findings::RunProgress& progress);

}  // namespace lensproof::studies
