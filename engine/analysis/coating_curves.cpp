#include "engine/analysis/coating_curves.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"

namespace lensproof::analysis {

namespace {

constexpr double kPercent = 100.0;

double percent_reflected(const CoatedFace& face, double wavelength_nm, double angle_deg) {
    return kPercent * coated_powers(face, wavelength_nm, angle_deg).unpolarised().reflected;
}

}  // namespace

optics::PolarisedPowers<double> coated_powers(const CoatedFace& face, double wavelength_nm, double angle_deg,
                                              FaceSide from) {
    if (!optics::covers(face.glass, wavelength_nm)) {
        throw InputError(fmt::format("{} nm is outside the range of {}, {} to {} nm", wavelength_nm, face.glass.name,
                                     face.glass.min_wavelength_nm, face.glass.max_wavelength_nm));
    }
    return optics::coating_powers(optics::coating_at(face.coating, wavelength_nm, face.where), 1.0,
                                  optics::refractive_index(face.glass.formula, wavelength_nm),
                                  std::cos(radians(angle_deg)), from == FaceSide::air);
}

double mean_reflectance(const CoatedFace& face) {
    constexpr int kFrom = 400;
    constexpr int kTo = 700;
    double sum = 0.0;
    for (int nm = kFrom; nm <= kTo; ++nm) {
        sum += coated_powers(face, nm, 0.0).unpolarised().reflected;
    }
    return sum / (kTo - kFrom + 1);
}

CoatingCurves coating_curves(const CoatedFace& face) {
    CoatingCurves curves;
    for (const double angle_deg : kCoatingAngles_deg) {
        ReflectanceSpectrum spectrum{.angle_deg = angle_deg};
        for (double nm = kShortestNm; nm <= kLongestNm; nm += 2.0) {
            spectrum.points.push_back({nm, percent_reflected(face, nm, angle_deg)});
        }
        curves.spectra.push_back(std::move(spectrum));
    }
    for (const double nm : kCoatingWavelengths_nm) {
        ReflectanceByAngle by_angle{.wavelength_nm = nm};
        for (int angle_deg = 0; angle_deg < 90; ++angle_deg) {
            const optics::PolarisedPowers<double> powers = coated_powers(face, nm, angle_deg);
            const double at = angle_deg;
            by_angle.s.push_back({at, kPercent * powers.s.reflected});
            by_angle.p.push_back({at, kPercent * powers.p.reflected});
            by_angle.unpolarised.push_back({at, kPercent * powers.unpolarised().reflected});
        }
        curves.angles.push_back(std::move(by_angle));
    }
    return curves;
}

}  // namespace lensproof::analysis
