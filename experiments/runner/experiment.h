// experiments/runner/experiment.h — an experiment as its file states it: what is rendered, what is photographed, what
// is expected.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/fit_geometry.h"
#include "engine/render/camera.h"
#include "experiments/runner/verdict.h"
#include "experiments/studies/measurement_floor/measure_floor.h"

namespace lensproof::runner {

/// How far a measured render may be from what the lens's own rays say; each that is stated becomes a check.
struct ClosedLoopLimits {
    std::optional<double> distortion_rms_px;
    std::optional<double> distortion_largest_px;
    std::optional<double> vignetting_percent;  // of the relative illumination, largest over the covered heights
    std::optional<double> chromatic_shift_px;  // red and blue against green, largest over the covered heights
};

/// A simulated camera, the views of a chart that it renders, and its limits.
struct Simulation {
    std::string name;
    render::ChartScene scene;  // the camera, light and chart; its placement is not used
    std::vector<scene::Placement> views;
    bool flat_field = true;
    int flat_field_samples_per_pixel = 128;  // an even field shows the noise that edges hide
    std::optional<calibration::ModelKind> model;
    ClosedLoopLimits limits;
};

/// What is known about a photographed camera from elsewhere.
struct PhotoExpectations {
    std::optional<double> focal_length_px;
    double focal_length_within_percent = 0.0;
    std::string focal_length_source;
    std::optional<double> reprojection_rms_px;
};

struct PhotoSubject {
    std::string name;
    std::filesystem::path manifest;
    std::optional<calibration::ModelKind> model;
    PhotoExpectations expected;
};

/// Two subjects set against each other in one curve.
struct Comparison {
    std::string of;
    std::string with;
    std::string curve;  // as in calibration/profile/profile.h; "radial_px" for positions of the same camera
    std::optional<double> limit;
    Expectation expectation = Expectation::at_most;
};

/// The tracer's number types at the extremes (experiments/stability).
struct StabilityExperiment {
    std::vector<std::string> extremes;  // ids; empty: all
};

/// A lens whose camera paths are counted (experiments/pupil_passage).
struct PassageSetting {
    std::string lens;
    double f_number = 0.0;
    struct Published {
        double whole_element_percent = 0.0;
        double pupil_percent = 0.0;
    };
    std::optional<Published> published;
};

struct Experiment {
    std::filesystem::path file;
    std::string title;
    std::string summary;
    std::vector<Simulation> simulations;
    std::vector<PhotoSubject> photos;
    std::vector<Comparison> comparisons;
    std::optional<StabilityExperiment> stability;             // then there is nothing else
    std::vector<PassageSetting> pupil_passage;                // the same
    std::optional<studies::FloorSettings> measurement_floor;  // the same
};

/// Reads an experiment file (described in experiments/README.md). Throws InputError naming file, line and key.
Experiment read_experiment(const std::filesystem::path& file);

}  // namespace lensproof::runner
