// engine/analysis/lens_analysis.h — a lens's numbers over field and wavelength, as `lensproof analyze` prints them.
#pragma once
#include <optional>
#include <vector>

#include "engine/analysis/paraxial_rays.h"
#include "engine/analysis/polychromatic_field.h"
#include "engine/analysis/seidel.h"
#include "engine/analysis/working_f_number.h"
#include "engine/base/infinity.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"

namespace lensproof::analysis {

/// What a lens is analysed for.
struct AnalysisSettings {
    std::vector<double> wavelengths_nm;    // at least one
    double reference_wavelength_nm = 0.0;  // need not be among them
    std::vector<double> fields_deg;        // at least one, −180 < θ < 180
    double object_distance = kInfinity;    // in front of z = 0, the table's first vertex, mm
    int rings = 12;                        // of the quadrature over a beam
};

/// One field at one wavelength. What does not exist, such as a chief ray beyond the field, is nothing; mm.
struct FieldAnalysis {
    double field_deg = 0.0;
    double wavelength_nm = 0.0;
    optics::RayStatus status = optics::RayStatus::ok;  // of the chief ray, past the rims where one clips it
    int surface = -1;                                  // where the status befell it, from 0
    std::optional<Vec2d> chief_ray_point;              // in the image plane; y is the chief ray's height
    std::optional<double> distortion_percent;
    std::optional<double> tangential_focus;  // from the image plane, positive beyond it
    std::optional<double> sagittal_focus;
    std::optional<double> relative_illumination;
    std::optional<double> vignetting;     // beam cross-section over that on axis
    std::optional<double> transmittance;  // of the chief ray: surfaces, coatings, glass
    std::optional<double> spot_rms;
    std::optional<Vec2d> spot_centroid;
    std::optional<double> wavefront_rms_waves;
    std::optional<double> lateral_colour;  // chief ray height less that at the reference wavelength
};

/// The one farthest from the axis, without its sign.
double largest_field_deg(const AnalysisSettings& settings);

/// The object's distance from the first vertex where that stands now: focusing groups may have moved it.
double distance_from_front(const optics::Lens& lens, double object_distance);

/// The lens with its image plane in the paraxial image of such an object, where its source does not say where that is.
optics::Lens with_image_plane(optics::Lens lens, double object_distance, double reference_wavelength_nm);

struct LensAnalysis {
    std::vector<optics::ParaxialData> paraxial;  // by wavelength, as in the settings
    optics::ParaxialData reference_paraxial;     // at the reference wavelength, as all that follows
    optics::Conjugates conjugates;               // of the settings' object
    double real_working_f_number = 0.0;          // infinite where no axial light passes
    std::optional<double> lagrange_invariant;    // for the largest field, as the sums; nothing at and beyond 90°
    std::vector<RayAtSurface> marginal_ray;      // of the object; empty where there is none
    std::vector<RayAtSurface> chief_ray;         // of the largest field likewise
    std::optional<SeidelSums<double>> seidel;    // colour from the longest to the shortest wavelength
    std::vector<FieldAnalysis> fields;           // by field, and for each by wavelength
};

/// Throws InputError for a wavelength that a glass's formula does not cover, as does what follows. `threads`: as in
/// `parallel_for`.
LensAnalysis analyze_lens(const optics::Lens& lens, const AnalysisSettings& settings, int threads = 1);

/// The settings' fields with all of their wavelengths, of equal weight each: what focus, PSF and MTF are judged by.
/// Nothing for a field whose object has no chief ray, or no light that passes.
std::vector<std::optional<PolychromaticField>> polychromatic_fields(const optics::Lens& lens,
                                                                    const AnalysisSettings& settings);

}  // namespace lensproof::analysis
