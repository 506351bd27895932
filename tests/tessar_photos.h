// tests/tessar_photos.h — an experiment that takes five photos of a chart through a Tessar.
#pragma once
#include <fmt/format.h>

#include <string>

namespace lensproof {

/// The chart's table, without its head.
inline constexpr const char* kTessarChart = "kind = \"checkerboard\"\nsquares = [9, 6]\nsquare_mm = 180.0\n";

/// Its one simulation is "camera", at f/11 and 3 m; its pictures have 4 to 3 sides.
inline std::string tessar_photos(int width, int samples_per_pixel) {
    std::string text = fmt::format(R"(title = "photos"
[render]
samples_per_pixel = {}
layers = 16
strata_per_layer = 1
[[simulations]]
name = "camera"
model = "brown-conrady"
flat_field = false
[simulations.camera]
lens = "tessar"
f_number = 11.0
focus_distance_mm = 3000.0
sensor_mm = [96.0, 72.0]
pixels = [{}, {}]
shutter_s = 0.15
iso = 100.0
response = "camera"
[simulations.chart]
{})",
                                   samples_per_pixel, width, 3 * width / 4, kTessarChart);
    for (const char* tilt :
         {"0.0, 0.0, 0.0", "35.0, 0.0, 0.0", "-35.0, 0.0, 5.0", "0.0, 35.0, -5.0", "0.0, -35.0, 3.0"}) {
        text += fmt::format("[[simulations.views]]\ndistance_mm = 3000.0\ntilt_deg = [{}]\n", tilt);
    }
    return text;
}

}  // namespace lensproof
