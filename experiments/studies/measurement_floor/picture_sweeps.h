// experiments/studies/measurement_floor/picture_sweeps.h — what is varied in simulated pictures, and what they have
// otherwise.
#pragma once
#include <string>
#include <vector>

#include "calibration/self_test/simulated_chart.h"

namespace lensproof::studies {

inline constexpr double kUsualNoise_percent = 1.0;  // of the white
inline constexpr double kUsualBlur_px = 0.6;
inline constexpr double kWhite = 0.7;

struct PictureSweep {
    std::string id;
    std::string name;       // in a title: "against noise"
    std::string parameter;  // at the axis
    std::string unit;
    std::vector<double> values;
    void (*apply)(double value, calibration::SimulatedCamera& camera);
};

/// Noise, blur and JPEG's quality.
std::vector<PictureSweep> picture_sweeps();

}  // namespace lensproof::studies
