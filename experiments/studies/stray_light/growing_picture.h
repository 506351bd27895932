// experiments/studies/stray_light/growing_picture.h — how a sum of passes nears its picture with every sample.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/render/prepared_scene.h"

namespace lensproof::studies {

/// A picture after so many samples of each pixel of every pass. Its error is half of the mean square difference from
/// another picture of as many samples, as it is shown (from black to saturation), root, over white.
struct PictureGrowth {
    int samples = 0;
    double seconds = 0.0;             // of rendering, of all passes
    double error = 0.0;               // of their sum
    std::vector<double> pass_errors;  // of each by itself, in their order
    std::vector<double> pass_seconds;
};
void fields(JsonArchive& json, PictureGrowth& growth);

/// After 1, 2, 4, … samples, up to half of `most_samples`, each against as many more, which then join it.
std::vector<PictureGrowth> picture_growth(const std::vector<render::Render>& passes, int most_samples, int threads,
                                          const std::function<void(double done)>& progress);

}  // namespace lensproof::studies
