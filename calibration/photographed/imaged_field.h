// calibration/photographed/imaged_field.h — where a simulated lens images directions, as a sensor's channels see it.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "engine/optics/lens.h"

namespace lensproof::calibration {

/// Light of one wavelength, and how much of it red, green and blue make their picture of; in any scale.
struct SeenWavelength {
    double wavelength_nm = 0.0;
    std::array<double, 3> weight{1.0, 1.0, 1.0};
};

/// What the measured response "camera" (engine/spectral/sensor_response.h) sees of daylight (D65), at the middles of 16
/// bands from 380 to 780 nm; those that a glass of the lens has no data for are left out.
std::vector<SeenWavelength> camera_wavelengths(const optics::Lens& lens);

/// Image heights over the field angle, from the axis outwards: chief rays through the stop's centre from objects at
/// infinity, of each channel the mean over its light.
struct ImagedField {
    std::vector<double> field_angle;               // rad, from 0
    std::vector<std::array<double, 3>> height_mm;  // of red, green, blue
    std::array<double, 3> focal_length_mm{};       // dh/dθ on the axis, at the sensor's plane

    [[nodiscard]] double green(std::size_t i) const { return height_mm[i][1]; }
    [[nodiscard]] double largest_mm() const { return height_mm.empty() ? 0.0 : height_mm.back()[1]; }
};

/// The field up to green's image height `up_to_mm`, or as far as chief rays of every wavelength go: rims do not end it,
/// since published tables hold few clear diameters. `count` even steps of the field angle. Throws InputError for a
/// wavelength that a glass does not cover.
ImagedField imaged_field(const optics::Lens& lens, const std::vector<SeenWavelength>& light, double up_to_mm,
                         int count = 160);

/// Light at image height `height_mm` over that on the axis, at `wavelength_nm` with the stop at `f_number`, through
/// every rim (engine/optics/illumination.h); at the full stop where that is at most 5 % narrower, since f-numbers are
/// engraved rounded. Nothing where the lens does not open that far, or the axis is dark.
std::optional<double> light_falloff(const optics::Lens& lens, double f_number, double height_mm, double wavelength_nm);

}  // namespace lensproof::calibration
