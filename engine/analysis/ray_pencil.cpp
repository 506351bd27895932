#include "engine/analysis/ray_pencil.h"

#include <cmath>
#include <utility>

#include "engine/base/infinity.h"
#include "engine/optics/surface_axes.h"
#include "engine/optics/surface_curvature.h"

namespace lensproof::analysis {

namespace {

/// The unit normal of surface `index` at a point on it, towards the sensor, and how it turns over a tangential shift.
class LocalSurface {
  public:
    LocalSurface(const optics::TraceLens<double>& lens, int index, const Vec3d& at) {
        const optics::TraceSurface<double>& surface = lens.surfaces[index];
        frame_ = optics::special_of(lens, surface);
        const optics::SurfaceDerivatives<double> derivatives =
            optics::surface_derivatives(optics::shape_of(lens, surface), optics::to_own_axes(lens, surface, at));
        hessian_ = derivatives.hessian;
        steepness_ = length(derivatives.gradient);
        normal_ = from_own((1.0 / steepness_) * derivatives.gradient);
    }

    [[nodiscard]] const Vec3d& normal() const { return normal_; }
    [[nodiscard]] const optics::ThinElement<double>* thin() const {
        return frame_ != nullptr && frame_->thin.kind != optics::ThinKind::none ? &frame_->thin : nullptr;
    }
    [[nodiscard]] Vec3d to_own(const Vec3d& v) const { return frame_ != nullptr ? frame_->to_own(v) : v; }
    [[nodiscard]] Vec3d from_own(const Vec3d& v) const { return frame_ != nullptr ? frame_->from_own(v) : v; }

    [[nodiscard]] Vec3d normal_turn(const Vec3d& shift) const {
        const Vec3d own = to_own(shift);
        const Vec3d change =
            from_own((1.0 / steepness_) * Vec3d{dot(hessian_[0], own), dot(hessian_[1], own), dot(hessian_[2], own)});
        return change - dot(change, normal_) * normal_;
    }

  private:
    const optics::SpecialSurface<double>* frame_ = nullptr;
    std::array<Vec3d, 3> hessian_{};
    double steepness_ = 1.0;
    Vec3d normal_;
};

/// How the direction behind an ideal lens turns, n' δm' = n δm − φ σ in slopes m, where the one in front turns by
/// `turn` and the point on it shifts by `shift`; in its own axes.
Vec3d turn_behind_ideal_lens(const optics::TraceSurface<double>& surface, double power, const Vec3d& before,
                             const Vec3d& after, const Vec3d& turn, const Vec3d& shift) {
    const auto slope = [&](double turn_across, double across, double shift_across) {
        const double change = (turn_across - across / before.z * turn.z) / before.z;
        return (surface.index_before * change - power * shift_across) / surface.index_after;
    };
    const Vec3d turned{after.z * slope(turn.x, before.x, shift.x), after.z * slope(turn.y, before.y, shift.y), 0.0};
    return turned - dot(turned, after) * after;
}

/// A 2 × 2 matrix by columns: how (x, y) across the chief ray depend on the offset's x and y.
using Columns = std::array<Vec2d, 2>;

/// −numerator / denominator, infinite where both rays stay parallel.
double quotient(double numerator, double denominator) {
    return denominator != 0.0 ? -numerator / denominator : kInfinity;
}

/// How far along the chief ray det (shift + t turn) vanishes, the tangential focus first.
std::pair<double, double> focal_distances(const Columns& shift, const Columns& turn) {
    if (shift[0].y == 0.0 && shift[1].x == 0.0 && turn[0].y == 0.0 && turn[1].x == 0.0) {
        return {quotient(shift[1].y, turn[1].y), quotient(shift[0].x, turn[0].x)};
    }
    // c + b t + a t² = 0 for t, each root in the form that does not cancel.
    const double a = cross(turn[0], turn[1]);
    const double b = cross(shift[0], turn[1]) + cross(turn[0], shift[1]);
    const double c = cross(shift[0], shift[1]);
    const double root2 = b * b - 4.0 * a * c;
    const double q = -0.5 * (b + std::copysign(std::sqrt(std::max(root2, 0.0)), b));
    const double first = quotient(-c, q);
    const double second = quotient(-q, a);
    // The offsets (x, y) whose rays meet the chief ray at t: the null vector of shift + t turn.
    const auto leans_to_y = [&](double t) {
        const bool is_far = !std::isfinite(t);
        const auto entry = [&](double p, double q_) { return is_far ? q_ : p + t * q_; };
        const double xx = entry(shift[0].x, turn[0].x);
        const double xy = entry(shift[1].x, turn[1].x);
        const double yx = entry(shift[0].y, turn[0].y);
        const double yy = entry(shift[1].y, turn[1].y);
        // Both rows say the same; the longer one says it better.
        const bool upper = xx * xx + xy * xy > yx * yx + yy * yy;
        return upper ? std::abs(xx) > std::abs(xy) : std::abs(yx) > std::abs(yy);
    };
    return leans_to_y(first) ? std::pair(first, second) : std::pair(second, first);
}

}  // namespace

std::optional<RayPencil> ray_pencil(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle) {
    const std::array<Vec3d, 2> across = bundle.across();
    RayPencil pencil{.chief = bundle.chief.front, .shift = across};
    if (bundle.is_near()) {
        const double divergence = 1.0 / bundle.distance();
        pencil.turn = {divergence * across[0], divergence * across[1]};
    }
    const auto step = [&](const optics::SurfaceEvent<double>& event) {
        if (!optics::gets_through(event.status)) {
            return;
        }
        const optics::TraceSurface<double>& surface = lens.surfaces[event.surface];
        const Vec3d before = pencil.chief.direction;
        const Vec3d& after = event.ray.direction;
        const LocalSurface local(lens, event.surface, event.ray.origin);
        const Vec3d& normal = local.normal();
        const double n1 = surface.index_before;
        const double n2 = surface.index_after;
        const optics::ThinElement<double>* const thin = local.thin();
        const Vec3d own_point = optics::to_own_axes(lens, surface, event.ray.origin);
        const bool is_phase = thin != nullptr && thin->kind == optics::ThinKind::phase;
        const Vec3d gradient = is_phase ? local.from_own(optics::phase_gradient(*thin, own_point)) : Vec3d{};
        const double bending = n2 * dot(after, normal) - n1 * dot(before, normal) - dot(gradient, normal);
        const double distance = dot(event.ray.origin - pencil.chief.origin, before);
        for (std::size_t i = 0; i < pencil.shift.size(); ++i) {
            const Vec3d arriving = pencil.shift[i] + distance * pencil.turn[i];
            const Vec3d on_surface = arriving - (dot(arriving, normal) / dot(before, normal)) * before;
            Vec3d turned = n1 * pencil.turn[i] + bending * local.normal_turn(on_surface);
            if (is_phase) {
                turned =
                    turned + local.from_own(optics::phase_gradient_turn(*thin, own_point, local.to_own(on_surface)));
            }
            const double change = -dot(turned, after) / dot(normal, after);
            pencil.turn[i] = thin != nullptr && !is_phase
                                 ? local.from_own(turn_behind_ideal_lens(
                                       surface, thin->power, local.to_own(before), local.to_own(after),
                                       local.to_own(pencil.turn[i]), local.to_own(on_surface)))
                                 : (1.0 / n2) * (turned + change * normal);
            pencil.shift[i] = on_surface - dot(on_surface, after) * after;
        }
        pencil.chief = event.ray;
    };
    pencil.status =
        optics::trace<optics::Direction::forward, optics::Rims::follow>(lens, bundle.chief.front, step).status;
    return optics::gets_through(pencil.status) ? std::optional(pencil) : std::nullopt;
}

AstigmaticFoci astigmatic_foci(const RayPencil& pencil, double image_z) {
    const std::array<Vec3d, 2> frame = optics::across_axes(pencil.chief.direction);
    const auto columns = [&](const std::array<Vec3d, 2>& vectors) {
        return Columns{Vec2d{dot(frame[0], vectors[0]), dot(frame[1], vectors[0])},
                       Vec2d{dot(frame[0], vectors[1]), dot(frame[1], vectors[1])}};
    };
    const auto [tangential, sagittal] = focal_distances(columns(pencil.shift), columns(pencil.turn));
    const double last_z = pencil.chief.origin.z - image_z;
    return {last_z + tangential * pencil.chief.direction.z, last_z + sagittal * pencil.chief.direction.z};
}

}  // namespace lensproof::analysis
