#include "engine/base/complex.h"

#include <gtest/gtest.h>

#include <complex>
#include <random>

namespace lensproof::complex_test {

std::complex<double> standard(const Complex<double>& z) {
    return {z.real, z.imag};
}

// Seven roundings make a part of a quotient (a ratio, a product and a sum, the divisor's last two, the division), which
// is the longest way here, and the standard one's has as many.
constexpr double kSomeUlps = 16.0 * 0x1p-53;

TEST(Complex, CountsAsTheStandardOneDoes) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> exponent(-8.0, 8.0);
    std::uniform_real_distribution<double> part(-1.0, 1.0);
    const auto draw = [&] {
        const double scale = std::pow(10.0, exponent(random));
        return Complex<double>{scale * part(random), scale * part(random)};
    };
    for (int i = 0; i < 10000; ++i) {
        const Complex<double> a = draw();
        const Complex<double> b = draw();
        const std::complex<double> x = standard(a);
        const std::complex<double> y = standard(b);
        EXPECT_EQ(standard(a + b), x + y);
        EXPECT_EQ(standard(a - b), x - y);
        EXPECT_EQ(standard(b.real * a), b.real * x);
        EXPECT_EQ(standard(a / b.real), x / b.real);
        EXPECT_LT(std::abs(standard(a * b) - x * y), kSomeUlps * std::abs(x) * std::abs(y));
        EXPECT_LT(std::abs(standard(a / b) - x / y), kSomeUlps * std::abs(x) / std::abs(y));
        EXPECT_EQ(standard(a / Complex<double>{b.real}), x / b.real) << "by a real number";
        EXPECT_NEAR(norm(a), std::norm(x), kSomeUlps * std::norm(x));
        const Complex<double> upper{a.real, std::abs(a.imag)};
        EXPECT_LT(std::abs(standard(sqrt_of_upper(upper)) - std::sqrt(standard(upper))),
                  kSomeUlps * std::sqrt(std::abs(x)));
    }
}

TEST(Complex, RootsNearTheAxisKeepTheirDigits) {
    for (const double real : {-4.0, 4.0}) {
        const Complex<double> root = sqrt_of_upper(Complex<double>{real, 1e-12});
        const std::complex<double> expected = std::sqrt(std::complex<double>(real, 1e-12));
        EXPECT_NEAR(root.real, expected.real(), kSomeUlps * expected.real());
        EXPECT_NEAR(root.imag, expected.imag(), kSomeUlps * expected.imag());
    }
}

}  // namespace lensproof::complex_test
