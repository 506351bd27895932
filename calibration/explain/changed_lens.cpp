#include "calibration/explain/changed_lens.h"

#include <ceres/jet.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calibration/explain/lens_halves.h"
#include "engine/base/infinity.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::calibration {

namespace {

constexpr int kAtOnce = 8;  // derivatives that one ray carries
using DerivativeNumber = ceres::Jet<double, kAtOnce>;

BareLens bare_lens(const optics::Lens& lens, double wavelength_nm) {
    optics::Lens plain = lens;
    plain.stop_mask = {};
    for (optics::LensSurface& surface : plain.surfaces) {
        surface.coating = {};
    }
    BareLens bare;
    bare.traced = optics::at_wavelength<double>(plain, wavelength_nm);
    bare.stop = lens.stop_index();
    bare.traced.attenuation.clear();
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        const auto& formula = lens.surfaces[i].medium.formula;
        const double n_d = optics::refractive_index(formula, spectral::kLineD);
        const double main =
            optics::refractive_index(formula, spectral::kLineF) - optics::refractive_index(formula, spectral::kLineC);
        bare.n_d.push_back(n_d);
        bare.V_d.push_back(main != 0.0 ? (n_d - 1.0) / main : kInfinity);
        bare.dispersion.push_back(main != 0.0 ? (bare.traced.surfaces[i].index_after - n_d) / main : 0.0);
    }
    return bare;
}

std::vector<DerivativeNumber> constants(const std::vector<double>& values) {
    return {values.begin(), values.end()};
}

Vec3<DerivativeNumber> constant(const Vec3d& v) {
    return {DerivativeNumber(v.x), DerivativeNumber(v.y), DerivativeNumber(v.z)};
}

std::array<Vec3d, 2> axes_across(const Vec3d& direction) {
    const bool is_along_x = std::abs(direction.x) > 0.7 * length(direction);
    const Vec3d one = normalized(cross(direction, is_along_x ? Vec3d{0.0, 1.0, 0.0} : Vec3d{1.0, 0.0, 0.0}));
    return {one, normalized(cross(direction, one))};
}

}  // namespace

struct ChangedLens::Parts {
    LensHalves<double> halves;
    LensHalves<DerivativeNumber> fixed;                   // the same, as constants
    std::vector<LensHalves<DerivativeNumber>> by_change;  // each with kAtOnce of the changes
    int changes = 0;

    /// The slopes at the stop, by Newton's method; a step that leads away is halved.
    [[nodiscard]] std::optional<Vec2d> aim(const Vec3d& object, const std::optional<Vec2d>& start,
                                           const std::array<Vec3d, 2>& across) const;
};

std::optional<Vec2d> ChangedLens::Parts::aim(const Vec3d& object, const std::optional<Vec2d>& start,
                                             const std::array<Vec3d, 2>& across) const {
    constexpr int kMostSteps = 40;
    constexpr double kAimed = 1e-13;
    const double off_axis = std::hypot(object.x, object.y);
    const double angle = 0.7 * std::min(1.2, std::atan2(off_axis, -object.z));
    const double along = off_axis > 0.0 ? -std::tan(angle) / off_axis : 0.0;
    Vec2d s = start.value_or(Vec2d{along * object.x, along * object.y});
    const Vec3<DerivativeNumber> point = constant(object);
    auto here = miss(halves, s, object, across);
    if (!here && start) {
        return aim(object, std::nullopt, across);
    }
    for (int step = 0; step < kMostSteps && here && !(length(*here) <= kAimed); ++step) {
        const auto slopes = miss(fixed, {DerivativeNumber(s.x, 0), DerivativeNumber(s.y, 1)}, point, across);
        if (!slopes) {
            return std::nullopt;
        }
        const Vec2d by_x{slopes->x.v[0], slopes->y.v[0]};
        const Vec2d by_y{slopes->x.v[1], slopes->y.v[1]};
        Vec2d move = Vec2d{-cross(*here, by_y), -cross(by_x, *here)} / cross(by_x, by_y);
        bool is_nearer = false;
        for (int halving = 0; halving < 12 && !is_nearer; ++halving, move = 0.5 * move) {
            const auto next = miss(halves, s + move, object, across);
            if (next && length(*next) < length(*here)) {
                is_nearer = true;
                s = s + move;
                here = next;
            }
        }
        if (!is_nearer) {
            break;
        }
    }
    constexpr double kGoodEnough = 1e-11;  // of rounding: 1e-9 mm in the image
    return here && length(*here) <= kGoodEnough ? std::optional(s) : std::nullopt;
}

ChangedLens::ChangedLens(const optics::Lens& lens, double wavelength_nm, const std::vector<LensChange>& changes,
                         const Eigen::VectorXd& values, int profile)
    : parts_(std::make_unique<Parts>()) {
    const BareLens bare = bare_lens(lens, wavelength_nm);
    const std::vector<double> plain(values.data(), values.data() + values.size());
    parts_->changes = static_cast<int>(changes.size());
    parts_->halves = changed_halves(bare, changes, plain, profile);
    parts_->fixed = changed_halves(bare, changes, constants(plain), profile);
    for (std::size_t first = 0; first < changes.size(); first += kAtOnce) {
        std::vector<DerivativeNumber> some = constants(plain);
        for (std::size_t i = first; i < std::min(first + kAtOnce, changes.size()); ++i) {
            some[i] = DerivativeNumber(plain[i], static_cast<int>(i - first));
        }
        parts_->by_change.push_back(changed_halves(bare, changes, some, profile));
    }
}

ChangedLens::~ChangedLens() = default;
ChangedLens::ChangedLens(ChangedLens&&) noexcept = default;

std::optional<Landing> ChangedLens::image_of(const Vec3d& object, const std::optional<Vec2d>& start,
                                             bool with_derivatives) const {
    const std::array<Vec3d, 2> across = axes_across(object - parts_->halves.stop_centre);
    const std::optional<Vec2d> s = parts_->aim(object, start, across);
    const auto landed = s ? image(parts_->halves, *s) : std::nullopt;
    if (!landed) {
        return std::nullopt;
    }
    Landing landing{.image_mm = *landed, .stop_slopes = *s};
    if (!with_derivatives) {
        return landing;
    }
    const Vec2<DerivativeNumber> slopes{DerivativeNumber(s->x, 0), DerivativeNumber(s->y, 1)};
    const Vec3<DerivativeNumber> point{DerivativeNumber(object.x, 2), DerivativeNumber(object.y, 3),
                                       DerivativeNumber(object.z, 4)};
    const auto missed = miss(parts_->fixed, slopes, point, across);
    const auto imaged = image(parts_->fixed, slopes);
    if (!missed || !imaged) {
        return std::nullopt;
    }
    Eigen::Matrix2d miss_by_slopes;
    miss_by_slopes << missed->x.v[0], missed->x.v[1], missed->y.v[0], missed->y.v[1];
    Eigen::Matrix2d image_by_slopes;
    image_by_slopes << imaged->x.v[0], imaged->x.v[1], imaged->y.v[0], imaged->y.v[1];
    const Eigen::Matrix2d through = -image_by_slopes * miss_by_slopes.inverse();
    Eigen::Matrix<double, 2, 3> miss_by_point;
    miss_by_point << missed->x.v.segment<3>(2).transpose(), missed->y.v.segment<3>(2).transpose();
    landing.by_point = through * miss_by_point;
    landing.by_change.resize(2, parts_->changes);
    const Vec2<DerivativeNumber> held{DerivativeNumber(s->x), DerivativeNumber(s->y)};
    for (std::size_t part = 0; part < parts_->by_change.size(); ++part) {
        const auto missed_by = miss(parts_->by_change[part], held, constant(object), across);
        const auto imaged_by = image(parts_->by_change[part], held);
        if (!missed_by || !imaged_by) {
            return std::nullopt;
        }
        const auto first = static_cast<Eigen::Index>(part) * kAtOnce;
        for (Eigen::Index i = first; i < std::min<Eigen::Index>(first + kAtOnce, parts_->changes); ++i) {
            const Eigen::Vector2d direct(imaged_by->x.v[i - first], imaged_by->y.v[i - first]);
            const Eigen::Vector2d aimed(missed_by->x.v[i - first], missed_by->y.v[i - first]);
            landing.by_change.col(i) = direct + through * aimed;
        }
    }
    return landing;
}

}  // namespace lensproof::calibration
