// engine/base/complex.h — complex numbers for what GPUs compute too.
//
// std::complex of float and double is made of the compiler's own complex type, and nvcc 13 drops the arithmetic of that
// type without a word: x / y becomes x. These are for finite numbers, and do not look for infinities.
#pragma once
#include <cmath>

namespace lensproof {

template <class T>
struct Complex {
    T real = T(0);
    T imag = T(0);

    friend constexpr Complex operator+(const Complex& a, const Complex& b) {
        return {a.real + b.real, a.imag + b.imag};
    }
    friend constexpr Complex operator-(const Complex& a, const Complex& b) {
        return {a.real - b.real, a.imag - b.imag};
    }
    friend constexpr Complex operator*(const Complex& a, const Complex& b) {
        return {a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real};
    }
    friend constexpr Complex operator*(const T& a, const Complex& b) { return {a * b.real, a * b.imag}; }
    friend constexpr Complex operator/(const Complex& a, const T& b) { return {a.real / b, a.imag / b}; }
    /// Smith, Comm. ACM 5, 435 (1962): no square of either part, and by a real number the quotients themselves.
    friend constexpr Complex operator/(const Complex& a, const Complex& b) {
        using std::abs;
        if (abs(b.real) < abs(b.imag)) {
            const T ratio = b.real / b.imag;
            return Complex{a.real * ratio + a.imag, a.imag * ratio - a.real} / (b.real * ratio + b.imag);
        }
        const T ratio = b.imag / b.real;
        return Complex{a.imag * ratio + a.real, a.imag - a.real * ratio} / (b.imag * ratio + b.real);
    }
};

/// |z|².
template <class T>
constexpr T norm(const Complex<T>& z) {
    return z.real * z.real + z.imag * z.imag;
}

/// The root of which no part is negative. `z.imag` is above 0.
template <class T>
constexpr Complex<T> sqrt_of_upper(const Complex<T>& z) {
    using std::sqrt;
    const T modulus = sqrt(norm(z));
    // The larger part has no digits to lose.
    if (z.real < T(0)) {
        const T imag = sqrt((modulus - z.real) / T(2));
        return {z.imag / (T(2) * imag), imag};
    }
    const T real = sqrt((modulus + z.real) / T(2));
    return {real, z.imag / (T(2) * real)};
}

}  // namespace lensproof
