#include "engine/formats/prescription/forbes_asphere.h"

#include <cmath>

namespace lensproof::formats {

namespace {

/// Coefficients of 1, x, x², …
using Polynomial = std::array<long double, kQconTerms>;

/// (p + q x) of a polynomial.
Polynomial times(const Polynomial& polynomial, long double p, long double q) {
    Polynomial product{};
    for (std::size_t i = 0; i < product.size(); ++i) {
        product[i] = p * polynomial[i] + (i > 0 ? q * polynomial[i - 1] : 0.0L);
    }
    return product;
}

}  // namespace

optics::AsphereTerms powers_of_qcon(std::span<const double> a, double radius) {
    Polynomial sum{};
    Polynomial before{};
    Polynomial here{1.0L};
    for (std::size_t m = 0; m < a.size(); ++m) {
        for (std::size_t i = 0; i < sum.size(); ++i) {
            sum[i] += a[m] * here[i];
        }
        // Abramowitz and Stegun, 22.7.1, for α = 0, β = 4 and the argument 2 x − 1.
        const auto n = static_cast<long double>(m);
        const long double s = 2.0L * n + 4.0L;
        const long double next = 2.0L * (n + 1.0L) * (n + 5.0L) * s;
        const long double slope = s * (s + 1.0L) * (s + 2.0L);
        Polynomial after = times(here, (-16.0L * (s + 1.0L) - slope) / next, 2.0L * slope / next);
        for (std::size_t i = 0; i < after.size(); ++i) {
            after[i] -= 2.0L * n * (n + 4.0L) * (s + 2.0L) / next * before[i];
        }
        before = here;
        here = after;
    }
    optics::AsphereTerms terms{};
    for (std::size_t i = 0; i < sum.size(); ++i) {
        terms[i + 1] = static_cast<double>(sum[i] * std::pow(1.0L / radius, static_cast<long double>(2 * i + 4)));
    }
    return terms;
}

}  // namespace lensproof::formats
