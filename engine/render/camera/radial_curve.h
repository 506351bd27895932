// engine/render/camera/radial_curve.h — a number over a radius or an angle, from 0 to an end, and back.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::render {

/// Cubic between nodes that lie evenly from 0 to the end, value and slope being continuous (Hermite's form): what is
/// derived from the slope is right for this very curve, however well it follows what it was made of. Of smooth data
/// with slopes of fourth order, N steps of h err by h⁴ f⁗ / 384.
class RadialCurve {
  public:
    struct At {
        double value = 0.0;
        double slope = 0.0;
    };

    /// 0, up to an end of 0.
    RadialCurve() : nodes_(2) {}
    /// Of so many nodes, two at least.
    RadialCurve(double end, const std::vector<At>& nodes);

    [[nodiscard]] double end() const { return end_; }

    /// x: from 0 to the end.
    [[nodiscard]] At at(double x) const {
        const double step = x * per_step_;
        const int i = std::min(static_cast<int>(step), static_cast<int>(nodes_.size()) - 2);
        const Piece piece = piece_at(i);
        const double t = step - i;
        return {piece.value(t), piece.slope(t) * per_step_};
    }

    [[nodiscard]] std::size_t steps() const { return nodes_.size() - 1; }
    [[nodiscard]] double per_step() const { return per_step_; }
    /// a, b, c, d of each step's a + t (b + t (c + t d)), t from 0 to 1.
    void append_pieces(std::vector<double>& pieces) const;

    /// As bytes, to the last bit; and from the front of such, nothing where there is no curve.
    void append_to(std::string& bytes) const;
    static std::optional<RadialCurve> taken_from(std::string_view& bytes);

  private:
    /// a + t (b + t (c + t d)), t from 0 to 1.
    struct Piece {
        double a;
        double b;
        double c;
        double d;
        [[nodiscard]] double value(double t) const { return a + t * (b + t * (c + t * d)); }
        [[nodiscard]] double slope(double t) const { return b + t * (2.0 * c + t * 3.0 * d); }
    };
    [[nodiscard]] Piece piece_at(int i) const {
        const At& from = nodes_[static_cast<std::size_t>(i)];
        const At& to = nodes_[static_cast<std::size_t>(i) + 1];
        const double rise = to.value - from.value;
        return {.a = from.value,
                .b = from.slope,
                .c = 3.0 * rise - 2.0 * from.slope - to.slope,
                .d = from.slope + to.slope - 2.0 * rise};
    }

    double end_ = 0.0;
    double per_step_ = 0.0;
    std::vector<At> nodes_;  // slopes per step
};

/// One that rises all the way, from 0: back, too, to the last digits.
class RisingCurve {
  public:
    RisingCurve() = default;
    explicit RisingCurve(RadialCurve curve);

    [[nodiscard]] const RadialCurve& curve() const { return curve_; }
    /// Places by values, to 1e-6 of them at least where `is_found_in_a_step`.
    [[nodiscard]] const RadialCurve& inverse() const { return inverse_; }
    /// Whether one step of Newton's from the inverse is enough everywhere.
    [[nodiscard]] bool is_found_in_a_step() const;
    [[nodiscard]] double end() const { return curve_.end(); }
    [[nodiscard]] RadialCurve::At at(double x) const { return curve_.at(x); }

    struct Place {
        double x = 0.0;
        double slope = 0.0;
    };
    /// Where it has this value, and its slope there; nothing where it has not.
    [[nodiscard]] std::optional<Place> where(double value) const {
        if (!(value >= 0.0 && value <= inverse_.end())) {
            return std::nullopt;
        }
        const Step step = step_to(value);
        return step.is_small ? step.place : searched(value);
    }

  private:
    struct Step {
        Place place;
        bool is_small;
    };
    /// The inverse's curve errs by some 1e-9, its slope by less than the square root: one step of Newton's is enough.
    [[nodiscard]] Step step_to(double value) const {
        const RadialCurve::At near = inverse_.at(value);
        const RadialCurve::At there = curve_.at(std::clamp(near.value, 0.0, curve_.end()));
        const double change = (there.value - value) * near.slope;
        constexpr double kSmall = 1e-6;
        return {{near.value - change, there.slope}, std::abs(change) <= kSmall * near.value};
    }
    [[nodiscard]] Place searched(double value) const;

    RadialCurve curve_;
    RadialCurve inverse_;
};

/// What the values of a curve are to the other side of 0.
enum class Parity { even, odd };

/// Through values at even steps, five at least, of what is smooth: slopes by differences of fourth order.
RadialCurve smooth_curve(double end, const std::vector<double>& values, Parity parity);

/// Through values at even steps, without a value beyond its neighbours' (Steffen 1990, A simple method for monotonic
/// interpolation, eq. 11): for what has bends. Even.
RadialCurve monotone_curve(double end, const std::vector<double>& values);

}  // namespace lensproof::render
