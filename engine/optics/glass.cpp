#include "engine/optics/glass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/io/toml.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof {

namespace {

double squared_index(const Sellmeier& formula, double squared_um) {
    double sum = 1.0;
    for (std::size_t i = 0; i < formula.b.size(); ++i) {
        sum += formula.b[i] * squared_um / (squared_um - formula.c[i]);
    }
    return sum;
}

double squared_index(const SchottPolynomial& formula, double squared_um) {
    const auto& a = formula.a;
    const double inverse = 1.0 / squared_um;
    return a[0] + a[1] * squared_um + inverse * (a[2] + inverse * (a[3] + inverse * (a[4] + inverse * a[5])));
}

double index_um(const ConstantIndex& formula, double) {
    return formula.index;
}

double index_um(const BuchdahlNormalLine& formula, double wavelength_um) {
    const double from_d = wavelength_um - 1e-3 * kLineD;
    const double omega = from_d / (1.0 + 2.5 * from_d);
    return formula.n_d + omega * (formula.nu1 + omega * formula.nu2);
}

template <class Formula>
double index_um(const Formula& formula, double wavelength_um) {
    return std::sqrt(squared_index(formula, wavelength_um * wavelength_um));
}

DispersionFormula read_formula(TomlTable& entry) {
    if (entry.choice("formula", {"sellmeier", "schott-polynomial"}) == "sellmeier") {
        Sellmeier formula;
        std::ranges::copy(entry.numbers("B", 3), formula.b.begin());
        std::ranges::copy(entry.numbers("C_um2", 3), formula.c.begin());
        return formula;
    }
    SchottPolynomial formula;
    std::ranges::copy(entry.numbers("A", 6), formula.a.begin());
    return formula;
}

bool same_letters(const std::string& a, const std::string& b) {
    return std::ranges::equal(a, b,
                              [](unsigned char x, unsigned char y) { return std::toupper(x) == std::toupper(y); });
}

}  // namespace

double refractive_index(const DispersionFormula& formula, double wavelength_nm) {
    return std::visit([&](const auto& f) { return index_um(f, 1e-3 * wavelength_nm); }, formula);
}

bool covers(const Glass& glass, double wavelength_nm) {
    return wavelength_nm >= glass.min_wavelength_nm && wavelength_nm <= glass.max_wavelength_nm;
}

double abbe_number(const DispersionFormula& formula) {
    return (refractive_index(formula, kLineD) - 1.0) /
           (refractive_index(formula, kLineF) - refractive_index(formula, kLineC));
}

BuchdahlNormalLine buchdahl_normal_line(double n_d, double V_d) {
    const auto omega = [](double wavelength_nm) {
        const double from_d = 1e-3 * (wavelength_nm - kLineD);
        return from_d / (1.0 + 2.5 * from_d);
    };
    const double F = omega(kLineF);
    const double C = omega(kLineC);
    const double g = omega(kLineG);
    const double principal_dispersion = (n_d - 1.0) / V_d;
    const double g_minus_F = (0.6438 - 0.001682 * V_d) * principal_dispersion;
    // Two linear equations: n_F − n_C and n_g − n_F.
    const double a11 = F - C;
    const double a12 = F * F - C * C;
    const double a21 = g - F;
    const double a22 = g * g - F * F;
    const double determinant = a11 * a22 - a12 * a21;
    return {.n_d = n_d,
            .nu1 = (principal_dispersion * a22 - g_minus_F * a12) / determinant,
            .nu2 = (g_minus_F * a11 - principal_dispersion * a21) / determinant};
}

std::vector<Glass> read_glasses(const std::filesystem::path& file) {
    TomlTable top = TomlTable::read(file);
    std::vector<Glass> glasses;
    for (TomlTable& entry : top.tables("glass")) {
        Glass glass;
        glass.name = entry.text("name");
        glass.catalogue = entry.text("catalogue");
        glass.formula = read_formula(entry);
        const std::vector<double> range = entry.numbers("range_nm", 2, kPositive);
        glass.min_wavelength_nm = range[0];
        glass.max_wavelength_nm = range[1];
        glass.stated_n_d = entry.number("n_d", {.min = 1.0, .max = 4.0});
        glass.stated_V_d = entry.number("V_d", kPositive);
        glass.source = entry.text("source");
        entry.finish();
        if (find_glass(glasses, glass.name)) {
            entry.fail("name", fmt::format("{} stands in the file twice", glass.name));
        }
        glasses.push_back(std::move(glass));
    }
    top.finish();
    return glasses;
}

std::vector<Glass> shipped_glasses() {
    return read_glasses(data_root() / "lenses" / "glasses.toml");
}

std::optional<Glass> find_glass(const std::vector<Glass>& glasses, const std::string& name) {
    const auto found =
        std::ranges::find_if(glasses, [&](const Glass& glass) { return same_letters(glass.name, name); });
    return found == glasses.end() ? std::nullopt : std::optional(*found);
}

}  // namespace lensproof
