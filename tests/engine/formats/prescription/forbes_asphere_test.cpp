#include "engine/formats/prescription/forbes_asphere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/formats/prescription/prescription_forms.h"
#include "tests/complaint.h"

namespace lensproof::formats::forbes_asphere_test {

/// Coefficients of r⁴, r⁶, … of one polynomial over a radius of 1.
std::vector<double> powers_of(int m) {
    std::vector<double> a(kQconTerms);
    a[m] = 1.0;
    const optics::AsphereTerms terms = powers_of_qcon(a, 1.0);
    return {terms.begin() + 1, terms.end()};
}

// Forbes 2007 lists the first of them: 1, −(5 − 6x), 15 − 14x(3 − 2x), −{35 − 12x[14 − x(21 − 10x)]},
// 70 − 3x{168 − 5x[84 − 11x(8 − 3x)]}. Whole numbers come out as such.
TEST(Qcon, FirstPolynomialsAreThoseOfThePaper) {
    const std::vector<std::vector<double>> published = {
        {1}, {-5, 6}, {15, -42, 28}, {-35, 168, -252, 120}, {70, -504, 1260, -1320, 495}};
    for (std::size_t m = 0; m < published.size(); ++m) {
        std::vector<double> expected = published[m];
        expected.resize(kQconTerms);
        EXPECT_EQ(powers_of(static_cast<int>(m)), expected) << m;
    }
}

// What defines them: ∫ x⁴ Q_m Q_n dx over 0 … 1 is 0, and 1 / (2m + 5) for m = n; and Q_m(1) = 1. The sums are of
// products up to 3e12, in long double.
TEST(Qcon, PolynomialsAreOrthogonal) {
    for (int m = 0; m < kQconTerms; ++m) {
        const std::vector<double> q = powers_of(m);
        long double at_rim = 0.0L;
        for (const double coefficient : q) {
            at_rim += coefficient;
        }
        EXPECT_EQ(at_rim, 1.0L) << m;
        for (int n = 0; n <= m; ++n) {
            const std::vector<double> p = powers_of(n);
            long double integral = 0.0L;
            for (int i = 0; i < kQconTerms; ++i) {
                for (int k = 0; k < kQconTerms; ++k) {
                    integral += static_cast<long double>(q[i]) * p[k] / (i + k + 5);
                }
            }
            EXPECT_NEAR(static_cast<double>(integral), m == n ? 1.0 / (2 * m + 5) : 0.0, 1e-5) << m << ", " << n;
        }
    }
}

// Of a radius that is no power of two, against Jacobi's polynomials by their recurrence, which loses no digits: the sum
// of nine terms of 1 µm to 1 fm.
TEST(Qcon, PowersKeepTheSagToAFemtometre) {
    constexpr double kRadius = 13.7;
    const std::vector<double> a(kQconTerms, 1e-3);
    const optics::AsphereTerms terms = powers_of_qcon(a, kRadius);
    for (int step = 0; step <= 100; ++step) {
        const double r = kRadius * step / 100;
        const long double u2 = static_cast<long double>(r) * r / (static_cast<long double>(kRadius) * kRadius);
        long double before = 0.0L;
        long double here = 1.0L;
        long double sum = 0.0L;
        for (int m = 0; m < kQconTerms; ++m) {
            sum += a[m] * here;
            const long double s = 2.0L * m + 4.0L;
            const long double after = ((s + 1.0L) * (s * (s + 2.0L) * (2.0L * u2 - 1.0L) - 16.0L) * here -
                                       2.0L * m * (m + 4.0L) * (s + 2.0L) * before) /
                                      (2.0L * (m + 1.0L) * (m + 5.0L) * s);
            before = here;
            here = after;
        }
        double sag = 0.0;
        for (int i = optics::kAsphereTerms; i > 0; --i) {
            sag = sag * r * r + terms[i - 1];
        }
        EXPECT_NEAR(sag * r * r, static_cast<double>(u2 * u2 * sum), 1e-12) << r;
    }
}

optics::Prescription parse(const std::string& keys) {
    return parse_toml_prescription(
        "name = \"x\"\nsource = \"y\"\nsurfaces = [{ radius_mm = 40.0, thickness_mm = 1.0, " + keys + " }]\n",
        "a.toml");
}

std::string complaint(const std::string& keys) {
    return complaint_about([&] { parse(keys); });
}

TEST(Qcon, StandsInATomlSurface) {
    const optics::PrescribedSurface surface =
        parse("A4 = 1e-6, A6 = 2e-9, Qcon = [0.5, -0.25], Q_radius_mm = 10.0").surfaces[0];
    EXPECT_DOUBLE_EQ(surface.term(4), 1e-6 + (0.5 + 0.25 * 5) * 1e-4);
    EXPECT_DOUBLE_EQ(surface.term(6), 2e-9 - 0.25 * 6 * 1e-6);
    EXPECT_EQ(surface.term(8), 0.0);
    EXPECT_TRUE(says(complaint("Qcon = [0.5]"), "Q_radius_mm"));
    EXPECT_TRUE(says(complaint("Q_radius_mm = 10.0"), "stands without Qcon"));
    EXPECT_TRUE(says(complaint("Qcon = [0.5], Q_radius_mm = 0.0"), "Q_radius_mm"));
    EXPECT_TRUE(says(complaint("Qcon = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1], Q_radius_mm = 10.0"), "holds 10 coefficients"));
}

}  // namespace lensproof::formats::forbes_asphere_test
