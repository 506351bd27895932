// engine/analysis/coating_curves.h — what a coating on glass reflects, for lists and plots.
#pragma once
#include <string>
#include <vector>

#include "engine/base/vec.h"
#include "engine/optics/thin_film.h"

namespace lensproof::analysis {

/// A coating on a face between air and glass, its layers as they lie from air on.
struct CoatedFace {
    optics::LensCoating coating;
    optics::Glass glass;
    std::string where;  // the coating is stated
};

/// For light from air or from the glass, at an angle below 90° in the medium that it comes from. Throws InputError
/// where the coating or the glass has no data at the wavelength.
enum class FaceSide { air, glass };
optics::PolarisedPowers<double> coated_powers(const CoatedFace& face, double wavelength_nm, double angle_deg,
                                              FaceSide from = FaceSide::air);

/// Of unpolarised light at normal incidence: the mean over 400 to 700 nm, of a value a nanometre.
double mean_reflectance(const CoatedFace& face);

inline constexpr double kShortestNm = 380.0;
inline constexpr double kLongestNm = 780.0;
inline constexpr double kCoatingAngles_deg[] = {0.0, 15.0, 30.0, 45.0, 60.0};
inline constexpr double kCoatingWavelengths_nm[] = {450.0, 550.0, 650.0};

/// (wavelength in nm, reflectance in %) of unpolarised light.
struct ReflectanceSpectrum {
    double angle_deg = 0.0;
    std::vector<Vec2d> points{};
};

/// (angle of incidence in degrees, reflectance in %).
struct ReflectanceByAngle {
    double wavelength_nm = 0.0;
    std::vector<Vec2d> s{};
    std::vector<Vec2d> p{};
    std::vector<Vec2d> unpolarised{};
};

struct CoatingCurves {
    std::vector<ReflectanceSpectrum> spectra{};
    std::vector<ReflectanceByAngle> angles{};
};
CoatingCurves coating_curves(const CoatedFace& face);

}  // namespace lensproof::analysis
