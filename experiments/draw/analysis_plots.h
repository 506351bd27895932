// experiments/draw/analysis_plots.h — the plots that lens people know, from the numbers of an analysis.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/analysis/ray_curves.h"
#include "engine/analysis/wave_curves.h"

namespace lensproof::draw {

// Fields may come in any order, and may reach beyond 90°. A curve breaks where a value is NaN. A field without any
// point is one that no light of reaches the image, and its panel says so.

inline constexpr const char* kNoLight = "no light";  // stands in a panel that has none

/// What stands above every plot.
struct PlotHeading {
    std::string lens{};        // its name; any text
    std::string conditions{};  // "f/2.8, object at infinity, image plane 79.8 mm from the last surface"; any text
};

/// A row a field, tangential beside sagittal, all on one scale.
std::string ray_fans_svg(const PlotHeading& heading, const std::vector<analysis::FieldFans>& fields);

/// Astigmatism (tangential solid, sagittal dashed) beside distortion, the field upwards. `projection`: what the
/// distortion refers to, "f tan θ".
std::string field_curves_svg(const PlotHeading& heading, const std::vector<analysis::FieldCurve>& curves,
                             const std::string& projection);

/// Longitudinal aberration: (zone of the pupil 0 to 1, where its ray crosses the axis from the image plane, mm).
std::string longitudinal_aberration_svg(const PlotHeading& heading,
                                        const std::vector<analysis::WavelengthCurve>& zones);

/// Lateral colour: (field in degrees, chief ray's height over that of the reference wavelength, µm), beside the Airy
/// disc's radius, (field in degrees, µm).
std::string lateral_colour_svg(const PlotHeading& heading, const std::vector<analysis::WavelengthCurve>& curves,
                               const std::vector<Vec2d>& airy_radius);

/// All on one scale, each with the Airy disc and its rms radius. `defocus_mm`: of each plane from the image plane.
std::string spots_svg(const PlotHeading& heading, const std::vector<double>& defocus_mm,
                      const std::vector<analysis::FieldSpots>& fields);

/// Illumination and vignetting against the field.
std::string illumination_svg(const PlotHeading& heading, const std::vector<analysis::FieldBrightness>& points);

/// Optical path differences over the exit pupil, a map a field.
std::string wavefront_svg(const PlotHeading& heading, const std::vector<analysis::FieldWavefront>& fields);

/// A row a field: its middle linearly, beside all of it logarithmically.
std::string psf_svg(const PlotHeading& heading, const std::vector<analysis::PsfMap>& fields);

/// `kind`: what the title adds, "geometric".
std::string mtf_svg(const PlotHeading& heading, const std::vector<analysis::FieldMtf>& fields,
                    const std::vector<Vec2d>& diffraction_limit, const std::string& kind = {});

/// Modulation against the field, by frequency.
std::string mtf_field_svg(const PlotHeading& heading, const std::vector<analysis::FrequencyMtf>& frequencies);

/// Writes drawings by file name ("mtf.svg") into a folder, which is made where it is missing; each file appears whole
/// or not at all. Throws InputError where it cannot.
void write_plots(const std::filesystem::path& folder, const std::map<std::string, std::string>& drawings);

}  // namespace lensproof::draw
