// experiments/draw/analysis_plots.h — the plots that lens people know, from the numbers of an analysis.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::draw {

// Angles here are in degrees, lengths in the unit that the plot has. A value that there is none of is NaN; a curve
// breaks there. Fields may come in any order, and may reach beyond 90°. A field without any point is one that no light
// of reaches the image, and its panel says so.

/// What stands above every plot.
struct PlotHeading {
    std::string lens{};        // its name; any text
    std::string conditions{};  // "f/2.8, object at infinity, image plane 79.8 mm from the last surface"; any text
};

/// A curve that belongs to a wavelength.
struct WavelengthCurve {
    double wavelength_nm = 0.0;
    std::vector<Vec2d> points{};
};

/// Ray fans of one field: the transverse error (µm) in the image plane against the pupil coordinate, −1 to 1 over the
/// unvignetted pupil.
struct FieldFans {
    double field_deg = 0.0;
    std::vector<WavelengthCurve> tangential{};  // (p_y, ε_y)
    std::vector<WavelengthCurve> sagittal{};    // (p_x, ε_x)
};
/// A row a field, tangential beside sagittal, all on one scale.
std::string ray_fans_svg(const PlotHeading& heading, const std::vector<FieldFans>& fields);

/// Image surfaces and distortion at one wavelength.
struct FieldCurve {
    struct Point {
        double field_deg = 0.0;
        double tangential_mm = 0.0;  // focus from the image plane, positive beyond it
        double sagittal_mm = 0.0;
        double distortion_percent = 0.0;
    };
    double wavelength_nm = 0.0;
    std::vector<Point> points{};
};
/// Astigmatism (tangential solid, sagittal dashed) beside distortion, the field upwards. `projection`: what the
/// distortion refers to, "f tan θ".
std::string field_curves_svg(const PlotHeading& heading, const std::vector<FieldCurve>& curves,
                             const std::string& projection);

/// Longitudinal aberration: (zone of the pupil 0 to 1, where its ray crosses the axis from the image plane, mm).
std::string longitudinal_aberration_svg(const PlotHeading& heading, const std::vector<WavelengthCurve>& zones);

/// Lateral colour: (field in degrees, chief ray's height over that of the reference wavelength, µm), beside the Airy
/// disc's radius, (field in degrees, µm).
std::string lateral_colour_svg(const PlotHeading& heading, const std::vector<WavelengthCurve>& curves,
                               const std::vector<Vec2d>& airy_radius);

/// The rays of one field on one plane, µm from a point that `PlotHeading::conditions` may name.
struct Spot {
    double rms_um = 0.0;  // about the centroid, all wavelengths
    std::vector<WavelengthCurve> rays{};
};
/// A row of spots through focus.
struct FieldSpots {
    double field_deg = 0.0;
    double airy_radius_um = 0.0;
    std::vector<Spot> spots{};  // one for each defocus
};
/// All on one scale, each with the Airy disc and its rms radius. `defocus_mm`: of each plane from the image plane.
std::string spots_svg(const PlotHeading& heading, const std::vector<double>& defocus_mm,
                      const std::vector<FieldSpots>& fields);

/// Light against the field, both over the axis: the illumination, and the cross-section of the passing beam.
struct FieldBrightness {
    double field_deg = 0.0;
    double relative_illumination = 0.0;
    double vignetting = 0.0;
};
std::string illumination_svg(const PlotHeading& heading, const std::vector<FieldBrightness>& points);

/// A square grid of values over a square: row by row from low y to high y.
struct SquareMap {
    std::size_t size = 0;          // pixels a side
    double half_width = 0.0;       // from the middle to the outer edge of the outermost pixels
    std::vector<double> values{};  // size²; NaN: masked
};

/// Optical path differences (waves) over the exit pupil.
struct FieldWavefront {
    double field_deg = 0.0;
    double wavelength_nm = 0.0;
    SquareMap opd_waves{};  // the half width in units of the pupil coordinate
    double rms_waves = 0.0;
    double peak_to_valley_waves = 0.0;
    std::vector<double> zernike_waves{};  // coefficients in Noll's order, from piston on
    std::string remark{};                 // why there is no map where light arrives
};
std::string wavefront_svg(const PlotHeading& heading, const std::vector<FieldWavefront>& fields);

/// The image of a point, in units of the peak of a perfect lens with the same pupil; the half width in µm.
struct PsfMap {
    double field_deg = 0.0;
    SquareMap intensity{};
    double strehl = 0.0;
    std::string remark{};  // why there is no picture where light arrives: "aberrations too large for the grid"
};
/// A row a field: its middle linearly, beside all of it logarithmically.
std::string psf_svg(const PlotHeading& heading, const std::vector<PsfMap>& fields);

/// Modulation against spatial frequency (cycles/mm) at one field.
struct FieldMtf {
    double field_deg = 0.0;
    std::vector<Vec2d> tangential{};
    std::vector<Vec2d> sagittal{};
    std::string remark{};  // beside the field in the legend: "by rays"; without curves, why there are none
};
/// `kind`: what the title adds, "geometric".
std::string mtf_svg(const PlotHeading& heading, const std::vector<FieldMtf>& fields,
                    const std::vector<Vec2d>& diffraction_limit, const std::string& kind = {});

/// Modulation against field (degrees) at one spatial frequency.
struct FrequencyMtf {
    double cycles_per_mm = 0.0;
    std::vector<Vec2d> tangential{};
    std::vector<Vec2d> sagittal{};
};
std::string mtf_field_svg(const PlotHeading& heading, const std::vector<FrequencyMtf>& frequencies);

/// Writes drawings by file name ("mtf.svg") into a folder, which is made where it is missing; each file appears whole
/// or not at all. Throws InputError where it cannot.
void write_plots(const std::filesystem::path& folder, const std::map<std::string, std::string>& drawings);

}  // namespace lensproof::draw
