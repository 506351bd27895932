#include "engine/formats/prescription/zmx_shape.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/forbes_asphere.h"

namespace lensproof::formats {

namespace {

/// A coefficient of r^power, mm.
double in_mm(double coefficient, int power, double unit_mm) {
    return coefficient * std::pow(unit_mm, 1 - power);
}

void surface_type_error(Remarks& remarks, const ZmxSurface& surface, int number, const std::string& what) {
    remarks.add_once(fmt::format("{}", number), "surface-type", optics::Severity::error, number,
                     fmt::format("line {}, surface {} of the file: {}", surface.line, number, what));
}

/// Sets the coefficient of r^power, for which there is a place up to the highest power.
void set_term(optics::PrescribedSurface& row, int power, double coefficient, double unit_mm, const ZmxSurface& surface,
              int number, Remarks& remarks) {
    if (coefficient == 0.0) {
        return;
    }
    if (power > optics::kHighestPower) {
        surface_type_error(remarks, surface, number,
                           fmt::format("the {} has a term {} r^{}, which is left out: powers to r^{} are known",
                                       surface.type, coefficient, power, optics::kHighestPower));
        return;
    }
    row.term(power) = in_mm(coefficient, power, unit_mm);
}

/// Forbes's aspheres. XDAT 1 is 0 for the mild and 1 for the strong one, 2 the number of terms, 3 the normalizing
/// radius, from 4 on a_0, a_1, …, as Zemax's own macro from CODE V's QBF and QCN has it (version 2.06.4, 2019), and
/// Thorlabs' file of its ASL5040-UV. The mild one's terms count along the normal of the conic: otherwise that lens
/// would not focus (ForbesAspheresFocusAsMade in zmx_shape_test.cpp).
void read_forbes(optics::PrescribedSurface& row, const ZmxSurface& surface, int number, double unit_mm,
                 Remarks& remarks) {
    constexpr int kFirstTerm = 4;
    const double kind = surface.extra_value(1);
    const double radius = surface.extra_value(3) * unit_mm;
    if ((kind != 0.0 && kind != 1.0) || !(radius > 0.0)) {
        surface_type_error(remarks, surface, number,
                           fmt::format("the {} of kind {} with the normalizing radius {} is left out, expected 0 or 1 "
                                       "in XDAT 1 and a length in XDAT 3",
                                       surface.type, kind, surface.extra_value(3)));
        return;
    }
    std::array<double, kForbesTerms> a{};
    for (const auto& [index, value] : surface.extra) {
        const int term = index - kFirstTerm;
        if (term < 0 || term >= surface.extra_value(2) || value == 0.0) {
            continue;
        }
        if (term < kForbesTerms) {
            a[term] = value * unit_mm;
        } else {
            surface_type_error(remarks, surface, number,
                               fmt::format("the {} has a term a_{} = {}, which is left out: a_0 to a_{} are known",
                                           surface.type, term, value, kForbesTerms - 1));
        }
    }
    row.along_normal = kind == 0.0;
    row.asphere = row.along_normal ? powers_of_qbfs(a, radius) : powers_of_qcon(a, radius);
}

/// Binary 2: an even asphere's parameters, PARM 0 the order (0 says 1), XDAT 1 the number of terms, 2 the normalizing
/// radius, from 3 on the phase's coefficients A_i of (r/R)^(2i) in radians, of any wavelength. A path of λ A / 2π at
/// each.
void read_binary(optics::PrescribedSurface& row, const ZmxSurface& surface, int number, double unit_mm,
                 Remarks& remarks) {
    constexpr int kFirstTerm = 3;
    constexpr double kDesign_nm = 1000.0;  // whichever: λ over that times that wavelength's path is the same
    const double radius = surface.extra_value(2) * unit_mm;
    if (!(radius > 0.0)) {
        surface_type_error(remarks, surface, number, "its phase has no normalizing radius, and is left out");
        return;
    }
    optics::PhaseElement phase{.design_wavelength_nm = kDesign_nm};
    phase.order = surface.parameter(0) == 0.0 ? 1.0 : surface.parameter(0);
    for (const auto& [index, value] : surface.extra) {
        const int term = index - kFirstTerm;
        if (term < 0 || term >= surface.extra_value(1) || value == 0.0) {
            continue;
        }
        if (term < optics::kPhaseTerms) {
            phase.radial[term] =
                value / (2.0 * std::numbers::pi) * kDesign_nm * 1e-6 / std::pow(radius, 2 * (term + 1));
        } else {
            surface_type_error(remarks, surface, number,
                               fmt::format("its phase's term of r^{} is left out: terms to r^{} are known",
                                           2 * (term + 1), 2 * optics::kPhaseTerms));
        }
    }
    row.phase = phase;
    for (int i = 1; i <= optics::kPhaseTerms - 2; ++i) {
        set_term(row, 2 * i, surface.parameter(i), unit_mm, surface, number, remarks);
    }
}

}  // namespace

// OpticStudio's help, "Even Asphere", "Odd Asphere", "Extended Asphere", "Extended Odd Asphere", "Toroidal",
// "Paraxial", "Diffraction Grating" (lines parallel to the local x axis), "Binary 2".
void read_zmx_shape(optics::PrescribedSurface& row, const ZmxSurface& surface, int number, double unit_mm,
                    Remarks& remarks) {
    constexpr int kParameterTerms = 8;
    const auto set = [&](int power, double coefficient) {
        set_term(row, power, coefficient, unit_mm, surface, number, remarks);
    };
    const auto normalized_terms = [&](int step) {
        const double radius = surface.extra_value(2);
        for (const auto& [index, value] : surface.extra) {
            if (index >= 3 && value != 0.0) {
                const int power = step * (index - 2);
                set(power, radius == 0.0 ? value : value / std::pow(radius, power));
            }
        }
    };
    if (surface.type == "STANDARD") {
        return;
    }
    if (surface.type == "EVENASPH" || surface.type == "ODDASPHE") {
        const int step = surface.type == "EVENASPH" ? 2 : 1;
        for (int i = 1; i <= kParameterTerms; ++i) {
            set(step * i, surface.parameter(i));
        }
        std::vector<std::string> beyond;
        for (const auto& [index, value] : surface.parameters) {
            if (index > kParameterTerms && value != 0.0) {
                beyond.push_back(fmt::format("PARM {} = {}", index, value));
            }
        }
        if (!beyond.empty()) {
            surface_type_error(remarks, surface, number,
                               fmt::format("{} of the {}, which has {} terms, is left out", fmt::join(beyond, ", "),
                                           surface.type, kParameterTerms));
        }
    } else if (surface.type == "XASPHERE") {
        normalized_terms(2);
    } else if (surface.type == "XOSPHERE") {
        normalized_terms(1);
    } else if (surface.type == "TOROIDAL") {
        const double radius_of_rotation = surface.parameter(1);
        row.radius_x_mm = radius_of_rotation == 0.0 ? kInfinity : radius_of_rotation * unit_mm;
        for (int i = 2; i <= kParameterTerms; ++i) {
            set(2 * (i - 1), surface.parameter(i));
        }
        if (surface.parameter(13) != 0.0 || surface.extra_value(1) != 0.0) {
            surface_type_error(remarks, surface, number, "the toroid's Zernike terms are left out");
        }
    } else if (surface.type == "PARAXIAL") {
        row.ideal_focal_length_mm = surface.parameter(1) * unit_mm;
    } else if (surface.type == "DGRATING") {
        constexpr double kPerMm = 1e3;  // of lines a µm, whatever the unit of lengths
        row.phase = optics::PhaseElement{.order = surface.parameter(2), .lines_per_mm = kPerMm * surface.parameter(1)};
    } else if (surface.type == "BINARY_2") {
        read_binary(row, surface, number, unit_mm, remarks);
    } else if (surface.type == "QED_TYPE") {
        read_forbes(row, surface, number, unit_mm, remarks);
    } else if (surface.type == "JONESMAT") {
        remarks.add_once(fmt::format("{}", number), "polarisation-not-read", optics::Severity::warning, number,
                         fmt::format("line {}, surface {} of the file: its Jones matrix, what it does to polarised "
                                     "light, is left out; its plane stays",
                                     surface.line, number));
    } else {
        surface_type_error(remarks, surface, number,
                           fmt::format("the type {} is not known; the surface is taken as a conic", surface.type));
    }
}

}  // namespace lensproof::formats
