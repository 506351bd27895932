#include "engine/formats/prescription/forbes_asphere.h"

#include <cmath>

namespace lensproof::formats {

namespace {

/// Coefficients of 1, x, x², …
using Polynomial = std::array<long double, optics::kAsphereTerms>;

/// (p + q x) of a polynomial.
Polynomial times(const Polynomial& polynomial, long double p, long double q) {
    Polynomial product{};
    for (std::size_t i = 0; i < product.size(); ++i) {
        product[i] = p * polynomial[i] + (i > 0 ? q * polynomial[i - 1] : 0.0L);
    }
    return product;
}

void add(Polynomial& sum, long double factor, const Polynomial& polynomial) {
    for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] += factor * polynomial[i];
    }
}

/// u^power Σ p_i u^2i by powers of r.
optics::AsphereTerms by_powers_of_r(const Polynomial& p, int power, double radius) {
    optics::AsphereTerms terms{};
    const auto first = static_cast<std::size_t>(power) / 2;
    for (std::size_t term = first; term <= terms.size(); ++term) {
        const long double scale = std::pow(1.0L / radius, static_cast<long double>(2 * term));
        terms[term - 1] = static_cast<double>(p[term - first] * scale);
    }
    return terms;
}

}  // namespace

optics::AsphereTerms powers_of_qcon(std::span<const double> a, double radius) {
    Polynomial sum{};
    Polynomial before{};
    Polynomial here{1.0L};
    for (std::size_t m = 0; m < a.size(); ++m) {
        add(sum, a[m], here);
        // Abramowitz and Stegun, 22.7.1, for α = 0, β = 4 and the argument 2 x − 1.
        const auto n = static_cast<long double>(m);
        const long double s = 2.0L * n + 4.0L;
        const long double next = 2.0L * (n + 1.0L) * (n + 5.0L) * s;
        const long double slope = s * (s + 1.0L) * (s + 2.0L);
        Polynomial after = times(here, (-16.0L * (s + 1.0L) - slope) / next, 2.0L * slope / next);
        add(after, -2.0L * n * (n + 4.0L) * (s + 2.0L) / next, before);
        before = here;
        here = after;
    }
    return by_powers_of_r(sum, 4, radius);
}

optics::AsphereTerms powers_of_qbfs(std::span<const double> a, double radius) {
    // f_m Q_m = P_m − g_(m−1) Q_(m−1) − h_(m−2) Q_(m−2), P_(m+1) = (2 − 4 x) P_m − P_(m−1).
    Polynomial sum{};
    Polynomial p_before{-2.0L};
    Polynomial p{2.0L};
    std::array<Polynomial, 2> q{};   // Q_(m−2), Q_(m−1)
    std::array<long double, 2> f{};  // f_(m−2), f_(m−1)
    long double g = 0.0L;
    for (std::size_t m = 0; m < a.size(); ++m) {
        const auto n = static_cast<long double>(m);
        const long double h = m < 2 ? 0.0L : -n * (n - 1.0L) / (2.0L * f[0]);
        g = m < 1 ? 0.0L : -(1.0L + g * h) / f[1];
        f = {f[1], m < 1 ? 2.0L : std::sqrt(n * (n + 1.0L) + 3.0L - g * g - h * h)};
        Polynomial here = times(p, 1.0L / f[1], 0.0L);
        add(here, -g / f[1], q[1]);
        add(here, -h / f[1], q[0]);
        add(sum, a[m], here);
        q = {q[1], here};
        Polynomial p_after = times(p, 2.0L, -4.0L);
        add(p_after, -1.0L, p_before);
        p_before = p;
        p = p_after;
    }
    return by_powers_of_r(times(sum, 1.0L, -1.0L), 2, radius);
}

}  // namespace lensproof::formats
