#include "experiments/studies/measurement_floor/picture_sweeps.h"

namespace lensproof::studies {

std::vector<PictureSweep> picture_sweeps() {
    return {
        {"noise",
         "noise",
         "noise of the white",
         "%",
         {0.0, 0.25, 0.5, 1.0, 2.0, 4.0},
         [](double value, calibration::SimulatedCamera& camera) { camera.read_noise = value / 100.0 * kWhite; }},
        {"blur",
         "blur",
         "blur, σ",
         "px",
         {0.2, 0.4, 0.6, 1.0, 1.5, 2.5},
         [](double value, calibration::SimulatedCamera& camera) { camera.blur_px = value; }},
        {"jpeg",
         "JPEG's quality",
         "quality",
         "",
         {100.0, 95.0, 90.0, 80.0, 60.0, 40.0},
         [](double value, calibration::SimulatedCamera& camera) { camera.jpeg_quality = static_cast<int>(value); }},
    };
}

}  // namespace lensproof::studies
