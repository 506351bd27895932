// calibration/profile/quantity.h — what a profile has curves of: key, title and unit of each, said once.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::calibration {

/// A text with the place of a channel in it, "vignetting_{}_ev", or with none.
struct ChannelText {
    constexpr ChannelText(const char* text) : pattern(text) {}

    std::string_view pattern;

    [[nodiscard]] bool has_channel() const { return pattern.find("{}") != std::string_view::npos; }
    std::string operator()(std::string_view channel = "") const;
    /// The channel for which it makes this text; none where it makes it for no channel. "" where it has no place.
    [[nodiscard]] std::optional<std::string> channel_in(std::string_view text) const;
};

/// As a person and as a JSON key reads it.
struct Unit {
    const char* symbol = "";
    const char* suffix = "";
};
inline constexpr Unit kNoUnit;
inline constexpr Unit kPixels{"px", "_px"};
inline constexpr Unit kPercent{"%", "_percent"};
inline constexpr Unit kExposureValues{"EV", "_ev"};
inline constexpr Unit kDegrees{"°", "_deg"};
inline constexpr Unit kMillimetres{"mm", "_mm"};
inline constexpr Unit kCyclesPerPixel{"cycles/px", "_cycles_per_px"};
inline constexpr Unit kCyclesPerMillimetre{"cycles/mm", "_cycles_per_mm"};

struct Quantity {
    ChannelText key;    // in Profile::curves
    ChannelText title;  // for people
    Unit unit;
    std::string_view channels{};  // those in which lenses are compared
    bool of_blur = false;         // simulated pictures, whose blur is one Gaussian, say nothing of it
};

/// Every one of them; a channel that is a spectral layer is called by its wavelength, "450nm".
struct Quantities {
    /// Where a direction is imaged, as far as two profiles differ in it; no profile has it as a curve.
    Quantity image_position{"radial_px", "image position", kPixels};
    Quantity field_angle{"field_angle_deg", "field angle", kDegrees};
    Quantity distortion{"distortion_percent", "distortion", kPercent};  // against f tan θ
    Quantity equidistant_distortion{"distortion_equidistant_percent", "distortion equidistant", kPercent};  // f θ
    Quantity vignetting{"vignetting_{}", "vignetting {}", kNoUnit, "RGBY"};  // ratio to the axis
    Quantity vignetting_ev{"vignetting_{}_ev", "vignetting {}", kExposureValues, "RGBY"};
    Quantity chromatic_shift{"chromatic_shift_{}_px", "chromatic shift {}", kPixels, "RB"};  // radial
    Quantity tangential_shift{"chromatic_shift_tangential_{}_px", "chromatic shift tangential {}", kPixels};
    Quantity tangential_mtf50{"mtf50_tangential_{}", "MTF50 tangential {}", kCyclesPerPixel, "", true};
    Quantity sagittal_mtf50{"mtf50_sagittal_{}", "MTF50 sagittal {}", kCyclesPerPixel, "", true};
    Quantity tangential_mtf50_per_mm{"mtf50_tangential_{}_cycles_per_mm", "MTF50 tangential {}", kCyclesPerMillimetre,
                                     "", true};
    Quantity sagittal_mtf50_per_mm{"mtf50_sagittal_{}_cycles_per_mm", "MTF50 sagittal {}", kCyclesPerMillimetre, "",
                                   true};
    Quantity astigmatism{"mtf50_tangential_over_sagittal_{}", "MTF50 tangential over sagittal {}", kNoUnit, "", true};
    Quantity tangential_focus{"best_focus_tangential_{}_mm", "focus tangential {}", kMillimetres, "", true};
    Quantity sagittal_focus{"best_focus_sagittal_{}_mm", "focus sagittal {}", kMillimetres, "", true};
};
inline constexpr Quantities kQuantities;

/// A curve's quantity and channel; none for a key that is not in the table.
struct ChannelQuantity {
    Quantity quantity;
    std::string channel;
};
std::optional<ChannelQuantity> quantity_of(std::string_view key);

/// The keys of the curves that two lenses may have in common.
std::vector<std::string> compared_curves();

/// The fits behind the curves, in Profile::terms: of the shift (calibration/chromatic/chromatic_shift.h), its means
/// over the points (calibration/measure/measure_bands.h), the spline of ln V (calibration/light/vignetting.h), 1/MTF50²
/// in px² and the best focus (calibration/sharpness/sharpness_field.h).
inline constexpr ChannelText kShiftTerms{"chromatic_shift_{}"};
inline constexpr ChannelText kMeanShiftTerms{"chromatic_shift_mean_{}"};
inline constexpr ChannelText kVignettingTerms{"vignetting_{}"};
inline constexpr ChannelText kSharpnessTerms{"sharpness_{}"};
inline constexpr ChannelText kBestFocusTerms{"best_focus_{}"};
/// Of charts that tell no camera (calibration/geometry/plane_distortion.h).
inline constexpr ChannelText kPlaneDistortionTerms{"plane_distortion"};
/// Of straight lines of a scene (calibration/lines/plumb_line.h).
inline constexpr ChannelText kLineDistortionTerms{"line_distortion"};

/// What a profile consists of, in Profile::not_measured.
namespace part {
inline constexpr const char* kGeometry = "geometry";
inline constexpr const char* kDistortion = "distortion";
inline constexpr const char* kVignetting = "vignetting";
inline constexpr const char* kChromaticShift = "chromatic_shift";
inline constexpr const char* kSharpness = "sharpness_over_the_field";
inline constexpr const char* kFieldCurvature = "field_curvature";
inline constexpr const char* kSelfTest = "self_test";
}  // namespace part

}  // namespace lensproof::calibration
