// engine/base/vec.h — vectors of two and three components over any number type.
#pragma once
#include <cmath>

namespace lensproof {

template <class T>
struct Vec2 {
    T x{};
    T y{};
    friend bool operator==(const Vec2&, const Vec2&) = default;
};

template <class T>
struct Vec3 {
    T x{};
    T y{};
    T z{};
    friend bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec2d = Vec2<double>;
using Vec3d = Vec3<double>;

template <class T>
constexpr Vec2<T> operator+(const Vec2<T>& a, const Vec2<T>& b) {
    return {a.x + b.x, a.y + b.y};
}

template <class T>
constexpr Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class T>
constexpr Vec2<T> operator-(const Vec2<T>& a, const Vec2<T>& b) {
    return {a.x - b.x, a.y - b.y};
}

template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class T>
constexpr Vec2<T> operator*(const T& s, const Vec2<T>& v) {
    return {s * v.x, s * v.y};
}

template <class T>
constexpr Vec3<T> operator*(const T& s, const Vec3<T>& v) {
    return {s * v.x, s * v.y, s * v.z};
}

template <class T>
constexpr Vec2<T> operator/(const Vec2<T>& v, const T& s) {
    return {v.x / s, v.y / s};
}

template <class T>
constexpr T dot(const Vec2<T>& a, const Vec2<T>& b) {
    return a.x * b.x + a.y * b.y;
}

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The signed area that two vectors span, positive where b lies counter-clockwise of a.
template <class T>
constexpr T cross(const Vec2<T>& a, const Vec2<T>& b) {
    return a.x * b.y - a.y * b.x;
}

template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
constexpr T length(const Vec2<T>& v) {
    using std::hypot;
    return hypot(v.x, v.y);
}

template <class T>
constexpr T length(const Vec3<T>& v) {
    using std::sqrt;
    return sqrt(dot(v, v));
}

template <class T>
constexpr Vec3<T> normalized(const Vec3<T>& v) {
    return (T(1) / length(v)) * v;
}

}  // namespace lensproof
