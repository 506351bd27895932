#include "engine/formats/prescription/axial_terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/prescription_losses.h"
#include "engine/optics/lens.h"
#include "engine/optics/surface_shape.h"

namespace lensproof::formats {

namespace {

using Real = long double;
constexpr int kNodes = optics::kAsphereTerms - 1;  // each settles a term beyond that of r²

/// What a shape's terms add to the sag of its conic, at r². A difference of sags would lose its small end.
Real departure(const optics::SurfaceShape<Real>& shape, Real r2) {
    const Real sum = optics::terms_profile(shape, r2).sag;
    return shape.along_normal ? optics::normal_secant(shape, r2, true).first * sum : sum;
}

/// The polynomial through values at nodes: Newton's divided differences, then multiplied out.
std::array<Real, kNodes> interpolating_polynomial(const std::array<Real, kNodes>& nodes,
                                                  std::array<Real, kNodes> values) {
    for (int order = 1; order < kNodes; ++order) {
        for (int i = kNodes - 1; i >= order; --i) {
            values[i] = (values[i] - values[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    std::array<Real, kNodes> polynomial{};
    for (int k = kNodes - 1; k >= 0; --k) {  // polynomial = values[k] + (x − nodes[k]) polynomial
        for (int i = kNodes - 1; i >= 0; --i) {
            polynomial[i] = (i > 0 ? polynomial[i - 1] : values[k]) - nodes[k] * polynomial[i];
        }
    }
    return polynomial;
}

/// How far from the axis: no further than nine tenths of where the conic ends.
double reach_of(const optics::PrescribedSurface& row, std::optional<double> semi_diameter_mm) {
    const double c = std::abs(row.curvature());
    const double end = row.conic > -1.0 ? 1.0 / (c * std::sqrt(1.0 + row.conic)) : kInfinity;
    return std::min(semi_diameter_mm.value_or(0.5 / c), 0.9 * end);
}

}  // namespace

AxialTerms axial_terms(const optics::PrescribedSurface& row, std::optional<double> semi_diameter_mm) {
    AxialTerms axial{.terms = row.asphere};
    if (!row.along_normal || row.is_flat()) {
        return axial;
    }
    axial.reach_mm = reach_of(row, semi_diameter_mm);
    optics::SurfaceShape<Real> shape{.curvature = row.curvature(), .conic = row.conic};
    std::ranges::copy(row.asphere, shape.asphere.begin());
    shape.terms = optics::kAsphereTerms;
    shape.along_normal = true;
    const Real largest = static_cast<Real>(axial.reach_mm) * axial.reach_mm;
    std::array<Real, kNodes> nodes{};  // Chebyshev's, of (r / reach)²
    std::array<Real, kNodes> values{};
    for (int i = 0; i < kNodes; ++i) {
        nodes[i] = 0.5L - 0.5L * std::cos(std::numbers::pi_v<Real> * (i + 0.5L) / kNodes);
        const Real r2 = largest * nodes[i];
        values[i] = (departure(shape, r2) - shape.asphere[0] * r2) / (nodes[i] * nodes[i]);
    }
    const std::array<Real, kNodes> polynomial = interpolating_polynomial(nodes, values);
    optics::SurfaceShape<Real> along_axis{.asphere = {row.asphere[0]}, .terms = optics::kAsphereTerms};
    for (int i = 0; i < kNodes; ++i) {
        axial.terms[i + 1] = static_cast<double>(polynomial[i] / std::pow(largest, static_cast<Real>(i + 2)));
        along_axis.asphere[i + 1] = axial.terms[i + 1];
    }
    constexpr int kSamples = 1000;
    for (int i = 1; i <= kSamples; ++i) {
        const Real r2 = largest * i / kSamples;
        axial.error_mm =
            std::max(axial.error_mm, static_cast<double>(std::abs(departure(along_axis, r2) - departure(shape, r2))));
    }
    return axial;
}

void state_along_axis(optics::Prescription& prescription, std::vector<optics::Finding>& lost_here) {
    constexpr double kNoticeable = 1e-6;  // mm
    for (std::size_t i = 0; i < prescription.surfaces.size(); ++i) {
        optics::PrescribedSurface& row = prescription.surfaces[i];
        if (!row.along_normal) {
            continue;
        }
        const AxialTerms axial = axial_terms(row, plain_semi_diameter(prescription, i));
        row.asphere = axial.terms;
        row.along_normal = false;
        if (row.is_flat()) {
            continue;  // whose normal is the axis
        }
        const auto severity = axial.error_mm <= kNoticeable ? optics::Severity::info : optics::Severity::warning;
        lost_here.push_back(lost("lost-normal-terms", severity, static_cast<int>(i) + 1,
                                 fmt::format("its terms along the conic's normal are written as powers of r along the "
                                             "axis, which keep the sag within {:.1g} mm up to {:.4g} mm from it",
                                             axial.error_mm, axial.reach_mm)));
    }
}

}  // namespace lensproof::formats
