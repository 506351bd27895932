#include "engine/polynomial/polynomial_lens.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/bytes.h"
#include "engine/optics/intersect.h"

namespace lensproof::polynomial {

namespace {

// Comes first; to be changed with what follows it.
constexpr double kMark = 20261125.01;

/// How far beyond the rays that were fitted one may lie and still be one of them, but for rounding and the fit's error.
constexpr double kSlack = 1.02;

constexpr int kMostSteps = 12;

bool is_within(const SymmetricPoint& at, double slack) {
    return dot(at.x, at.x) <= slack * slack && dot(at.q, at.q) <= slack * slack;
}

/// ∂(w, u) / ∂(x, q).
Eigen::Matrix4d jacobian(const std::array<VectorSlopes, 2>& of) {
    Eigen::Matrix4d j;
    for (Eigen::Index k = 0; k < 2; ++k) {
        const VectorSlopes& slopes = of[static_cast<std::size_t>(k)];
        for (Eigen::Index i = 0; i < 2; ++i) {
            const Vec2d by_x = slopes.by_x[static_cast<std::size_t>(i)];
            const Vec2d by_q = slopes.by_q[static_cast<std::size_t>(i)];
            j(2 * k, i) = by_x.x;
            j(2 * k + 1, i) = by_x.y;
            j(2 * k, 2 + i) = by_q.x;
            j(2 * k + 1, 2 + i) = by_q.y;
        }
    }
    return j;
}

double fourth_power(double x) {
    return x * x * x * x;
}

template <class Frame>
auto numbers_of(Frame& frame) {
    return std::array{&frame.film_radius_mm, &frame.film_z,          &frame.pupil_z,
                      &frame.pupil_shear,    &frame.pupil_radius_mm, &frame.front_curvature,
                      &frame.front_w,        &frame.front_shear,     &frame.front_radius};
}

template <class Error>
auto numbers_of_error(Error& error) {
    return std::array{&error.rms_um, &error.bound_um, &error.entry_rms_um, &error.irradiance, &error.worst_irradiance};
}

}  // namespace

bool PolynomialLens::passes(const SymmetricPoint& at) const {
    for (int rim = 0; rim < rims(); ++rim) {
        if (exits_.scalar(1 + rim, at) > 1.0) {
            return false;
        }
    }
    return true;
}

PolynomialExit PolynomialLens::exit(Vec2d film, Vec2d pupil, int wavelength) const {
    const SymmetricPoint at = frame_.inside(film, pupil, band_[static_cast<std::size_t>(wavelength)]);
    return {.ray = exit_ray<double>({.u = exits_.vector(1, at), .w = exits_.vector(0, at)}, frame_.front_curvature),
            .transmittance = passes(at) ? exits_.scalar(0, at) : 0.0};
}

std::optional<PolynomialEnd> PolynomialLens::end(const Ray<double>& inwards, int wavelength) const {
    const double t = band_[static_cast<std::size_t>(wavelength)];
    const optics::Intersection<double> front = optics::intersect(inwards, frame_.front_curvature, 1.0);
    if (!front.hit) {
        return std::nullopt;
    }
    const ExitPoint<double> outside =
        exit_point<double>({front.point, -1.0 * inwards.direction}, frame_.front_curvature);
    const SymmetricPoint from = frame_.outside(outside, t);
    if (!is_within(from, kSlack)) {
        return std::nullopt;
    }
    SymmetricPoint at{guess_.vector(0, from), guess_.vector(1, from), t};
    std::array<VectorSlopes, 2> slopes;
    Eigen::Matrix4d by_inside;
    bool is_found = false;
    for (int i = 0; i < kMostSteps && !is_found; ++i) {
        if (!is_within(at, 2.0 * kSlack)) {
            return std::nullopt;
        }
        slopes = exits_.slopes(at);
        by_inside = jacobian(slopes);
        const Vec2d w = outside.w - slopes[0].value;
        const Vec2d u = outside.u - slopes[1].value;
        const Eigen::Vector4d step = by_inside.partialPivLu().solve(Eigen::Vector4d(w.x, w.y, u.x, u.y));
        at.x = at.x + Vec2d{step[0], step[1]};
        at.q = at.q + Vec2d{step[2], step[3]};
        is_found = step.cwiseAbs().maxCoeff() < 1e-10;  // so that the next would be of rounding
    }
    if (!is_found || !is_within(at, kSlack) || dot(at.x, at.x) > 1.0 + 1e-9 || !passes(at)) {
        return std::nullopt;
    }
    const Vec2d film = frame_.film_radius_mm * at.x;
    const Vec2d pupil = frame_.pupil_radius_mm * at.q + frame_.pupil_shear * film;
    const double z = frame_.film_z - frame_.pupil_z;
    const Vec2d across = pupil - film;
    const double cosine4 = fourth_power(z) / ((dot(across, across) + z * z) * (dot(across, across) + z * z));
    const double area = frame_.film_radius_mm * frame_.pupil_radius_mm;
    return PolynomialEnd{
        .film = film,
        .pupil = pupil,
        .transmittance = exits_.scalar(0, at),
        .etendue = cosine4 / (z * z) * area * area /
                   (std::abs(by_inside.determinant()) * etendue_density(outside, frame_.front_curvature))};
}

PolynomialTables PolynomialLens::tables() const {
    return {.monomials = exits_.monomials().data(),
            .monomial_count = static_cast<int>(exits_.monomials().size()),
            .first_term = exits_.first_term().data(),
            .term_monomial = exits_.term_monomial().data(),
            .coefficients = exits_.coefficients().data(),
            .rims = rims(),
            .band = band_.data(),
            .per_film = 1.0 / frame_.film_radius_mm,
            .pupil_shear = frame_.pupil_shear,
            .per_pupil = 1.0 / frame_.pupil_radius_mm,
            .front_curvature = frame_.front_curvature};
}

std::string PolynomialLens::serialized() const {
    std::string bytes;
    append_bytes(bytes, kMark);
    for (const double* number : numbers_of(frame_)) {
        append_bytes(bytes, *number);
    }
    for (const double* number : numbers_of_error(error_)) {
        append_bytes(bytes, *number);
    }
    append_bytes(bytes, static_cast<std::uint32_t>(band_.size()));
    for (const double t : band_) {
        append_bytes(bytes, t);
    }
    exits_.append_to(bytes);
    guess_.append_to(bytes);
    return bytes;
}

std::optional<PolynomialLens> PolynomialLens::deserialized(std::string_view bytes) {
    if (take_bytes<double>(bytes) != kMark) {
        return std::nullopt;
    }
    PolynomialFrame frame;
    PolynomialError error;
    bool is_finite = true;
    const auto take = [&](double* number) {
        *number = take_bytes<double>(bytes).value_or(NAN);
        is_finite = is_finite && std::isfinite(*number);
    };
    std::ranges::for_each(numbers_of(frame), take);
    std::ranges::for_each(numbers_of_error(error), take);
    const std::uint32_t wavelengths = take_bytes<std::uint32_t>(bytes).value_or(0);
    if (!is_finite || bytes.size() < wavelengths * sizeof(double)) {
        return std::nullopt;
    }
    std::vector<double> band(wavelengths);
    std::ranges::for_each(band, [&](double& t) { take(&t); });
    std::optional<SymmetricMap> exits = SymmetricMap::taken_from(bytes);
    std::optional<SymmetricMap> guess = exits ? SymmetricMap::taken_from(bytes) : std::nullopt;
    if (!guess || !bytes.empty() || exits->vectors() != 2 || exits->scalars() < 1 || guess->vectors() != 2) {
        return std::nullopt;
    }
    PolynomialLens lens(frame, *std::move(exits), *std::move(guess), std::move(band));
    lens.set_error(error);
    return lens;
}

}  // namespace lensproof::polynomial
