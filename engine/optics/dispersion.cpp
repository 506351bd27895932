#include "engine/optics/dispersion.h"

#include <algorithm>
#include <cmath>

#include "engine/optics/normal_line.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

namespace {

double sum_of_powers(const std::vector<PowerTerm>& terms, double um) {
    double sum = 0.0;
    for (const PowerTerm& term : terms) {
        sum += term.coefficient * std::pow(um, term.exponent);
    }
    return sum;
}

double index_um(const ConstantIndex& formula, double) {
    return formula.index;
}

double index_um(const Sellmeier& formula, double um) {
    const double squared = um * um;
    double sum = 1.0 + formula.constant;
    for (const Sellmeier::Term& term : formula.terms) {
        sum += term.b * squared / (squared - term.c);
    }
    return std::sqrt(sum);
}

double index_um(const SchottPolynomial& formula, double um) {
    const auto& a = formula.a;
    const double squared = um * um;
    const double inverse = 1.0 / squared;
    return std::sqrt(a[0] + a[1] * squared + inverse * (a[2] + inverse * (a[3] + inverse * (a[4] + inverse * a[5]))));
}

double index_um(const SquaredPowerSeries& formula, double um) {
    return std::sqrt(sum_of_powers(formula.terms, um));
}

double index_um(const PowerSeries& formula, double um) {
    return sum_of_powers(formula.terms, um);
}

double index_um(const ResonancesAndPowers& formula, double um) {
    double sum = sum_of_powers(formula.powers, um);
    for (const ResonancesAndPowers::Resonance& resonance : formula.resonances) {
        sum += resonance.b * std::pow(um, resonance.power) / (um * um - resonance.c);
    }
    return std::sqrt(sum);
}

double index_um(const Herzberger& formula, double um) {
    const auto& a = formula.a;
    const double squared = um * um;
    const double l = 1.0 / (squared - 0.028);
    return a[0] + l * (a[1] + l * a[2]) + squared * (a[3] + squared * (a[4] + squared * a[5]));
}

double index_um(const GasDispersion& formula, double um) {
    double sum = 1.0 + formula.constant;
    for (const Sellmeier::Term& term : formula.terms) {
        sum += term.b / (term.c - 1.0 / (um * um));
    }
    return sum;
}

double index_um(const RetroDispersion& formula, double um) {
    const auto& a = formula.a;
    const double squared = um * um;
    const double refraction = a[0] + a[1] * squared / (squared - a[2]) + a[3] * squared;
    return std::sqrt((1.0 + 2.0 * refraction) / (1.0 - refraction));
}

double index_um(const ExoticDispersion& formula, double um) {
    const auto& a = formula.a;
    const double from = um - a[4];
    return std::sqrt(a[0] + a[1] / (um * um - a[2]) + a[3] * from / (from * from + a[5]));
}

/// The coordinate in which tables are interpolated: that of Cauchy's formula, where glass is nearly straight.
double table_coordinate(double um) {
    return -1.0 / (um * um);
}

/// dn/dx at entry i: that of the parabola through its neighbours, kept from overshooting.
double table_slope(const IndexTable& table, std::size_t i) {
    const auto x = [&](std::size_t k) { return table_coordinate(table.wavelength_um[k]); };
    const auto secant = [&](std::size_t k) { return (table.index[k + 1] - table.index[k]) / (x(k + 1) - x(k)); };
    const std::size_t last = table.index.size() - 1;
    if (last == 1) {
        return secant(0);
    }
    const std::size_t left = std::clamp<std::size_t>(i, 1, last - 1) - 1;
    const double before = secant(left);
    const double after = secant(left + 1);
    const double curvature = (after - before) / (x(left + 2) - x(left));
    const double slope = before + curvature * (2.0 * x(i) - x(left) - x(left + 1));
    if (i == 0 || i == last) {
        const double nearest = i == 0 ? before : after;
        return slope * nearest > 0.0 ? std::copysign(std::min(std::abs(slope), 3.0 * std::abs(nearest)), slope) : 0.0;
    }
    const double most = before * after > 0.0 ? 3.0 * std::min(std::abs(before), std::abs(after)) : 0.0;
    return std::clamp(slope, -most, most);
}

double index_um(const IndexTable& table, double um) {
    const auto& wavelengths = table.wavelength_um;
    if (!(um > wavelengths.front())) {
        return table.index.front();
    }
    if (um >= wavelengths.back()) {
        return table.index.back();
    }
    const std::size_t i = std::ranges::upper_bound(wavelengths, um) - wavelengths.begin() - 1;
    const double start = table_coordinate(wavelengths[i]);
    const double width = table_coordinate(wavelengths[i + 1]) - start;
    const double t = (table_coordinate(um) - start) / width;
    const double rest = 1.0 - t;
    return rest * rest * ((1.0 + 2.0 * t) * table.index[i] + t * width * table_slope(table, i)) +
           t * t * ((1.0 + 2.0 * rest) * table.index[i + 1] - rest * width * table_slope(table, i + 1));
}

double index_um(const NormalLine& glass, double um) {
    return glass.n_d + glass.dispersion * normal_line_shape(glass.shape, um);
}

}  // namespace

double refractive_index(const DispersionFormula& formula, double wavelength_nm) {
    return std::visit([&](const auto& f) { return index_um(f, 1e-3 * wavelength_nm); }, formula);
}

double abbe_number(const DispersionFormula& formula) {
    return (refractive_index(formula, spectral::kLineD) - 1.0) /
           (refractive_index(formula, spectral::kLineF) - refractive_index(formula, spectral::kLineC));
}

double abbe_number_e(const DispersionFormula& formula) {
    return (refractive_index(formula, spectral::kLineE) - 1.0) /
           (refractive_index(formula, spectral::kLineFPrime) - refractive_index(formula, spectral::kLineCPrime));
}

double partial_dispersion(const DispersionFormula& formula, double x_nm, double y_nm) {
    return (refractive_index(formula, x_nm) - refractive_index(formula, y_nm)) /
           (refractive_index(formula, spectral::kLineF) - refractive_index(formula, spectral::kLineC));
}

}  // namespace lensproof::optics
