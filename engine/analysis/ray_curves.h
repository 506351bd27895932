// engine/analysis/ray_curves.h — what rays alone say of a lens, sampled for plots: fans, image surfaces, spots, light.
#pragma once
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "engine/base/vec.h"

namespace lensproof::analysis {

// Angles here are in degrees; a value that there is none of is NaN.

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

/// Light against the field, both over the axis: the illumination, and the cross-section of the passing beam.
struct FieldBrightness {
    double field_deg = 0.0;
    double relative_illumination = 0.0;
    double vignetting = 0.0;
};

/// Of fields without light there is the angle alone.
struct RayCurves {
    std::vector<FieldFans> fans;
    std::vector<FieldCurve> field_curves;
    std::vector<WavelengthCurve> longitudinal;
    std::vector<WavelengthCurve> lateral_colour;
    std::vector<Vec2d> airy_radius;  // µm over the field in degrees
    std::vector<double> defocus_mm;  // of the spots' planes
    std::vector<FieldSpots> spots;
    std::vector<FieldBrightness> illumination;
};

RayCurves ray_curves(const optics::Lens& lens, const AnalysisSettings& settings);

}  // namespace lensproof::analysis
