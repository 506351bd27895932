// engine/optics/stray_walk.h — light that goes its way inside a lens by chance: through glass, back from it, from wall
// to wall.
#pragma once
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/basis.h"
#include "engine/optics/barrel.h"
#include "engine/optics/ghost_path.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::optics {

/// Light on its way, and what it met so far. A path belongs to the barrel where it met a wall, else to the ghosts where
/// glass or the sensor reflected it, else to the image.
struct StrayLight {
    Ray<double> ray;
    double weight = 1.0;
    double at_first_wall = 0.0;  // what that wall took of it; later ones take all or nothing
    int reflections = 0;
    int walls = 0;  // dust counts as one
    /// Where dust on the front is the outermost thing that scatters it: the first surface's normal there, outwards.
    std::optional<Vec3d> dust_normal{};
};

enum class StrayEnd {
    front,     // out through the first surface, into the scene
    film,      // on the sensor's plane
    body,      // out behind the last surface, and not towards the sensor
    absorbed,  // by a wall, or outside the first or last surface; or glass let nothing pass
    wall,      // on the first wall that scatters it, where it was to be followed no farther
    lost       // through a gap in the table's walls, or still on its way after many thousands of events
};

/// Told of what a walk meets; this one does not listen.
struct NoWitness {
    void at_surface(AtSurface /*what*/, int /*index*/, bool /*forward*/, const Ray<double>& /*on*/) const {}
    void at_mirror() const {}  // the sensor, or blades, in a plane across the axis
    void at_wall(const Vec3d& /*scattered_along*/) const {}
};

/// Follows light until it leaves the lens or ends: at glass it is reflected or refracted by chance, as the surface's
/// reflectance and transmittance have it, at walls scattered as their finish says. The weight carries what is then left
/// to account for: glass and coatings that absorb, the first wall's albedo (later ones end the path by chance), so that
/// light of weight 1 in a lens that absorbs nothing keeps it to the end.
///
/// `forward`: from the scene to the first surface, else from the sensor to the last; both ways carry the same light, as
/// surfaces and walls are reciprocal. A ray from one surface to its neighbour's clear aperture passes, whatever wall
/// the table's rims put in between: what `trace` sees as open is open.
///
/// Dust on the front (FrontDust) is met from outside before the first surface, by chance, and from inside behind it;
/// between a grain and the glass under it light goes back and forth until either lets it go.
///
/// Numbers: `double numbers()`, from (0, 1). `landed(const StrayLight&)` is called at each arrival on the sensor's
/// plane, the ray's origin on it; a sensor and a stop's blades that are mirrors send light back, by chance
/// too, and that counts as a reflection: what such blades do not reflect meets their finish.
///
/// Witness: as `NoWitness`; a copy is told, in order.
template <class Numbers, class Witness = NoWitness>
class StrayWalk {
  public:
    StrayWalk(const TraceLens<double>& lens, const Barrel& barrel, const StrayMirrors<double>& mirrors,
              Numbers& numbers, Witness witness = {})
        : lens_(lens),
          barrel_(barrel),
          mirrors_(mirrors),
          numbers_(numbers),
          witness_(witness),
          count_(static_cast<int>(lens.surfaces.size())) {}

    template <class Landed>
    StrayEnd follow(StrayLight& light, bool forward, Landed&& landed) {
        cell_ = forward ? 0 : count_;
        target_ = forward ? 0 : count_ - 1;
        return go_on(light, landed);
    }

    /// The same as far as the first wall that scatters: from there copies of the walk may go several ways.
    template <class Landed>
    StrayEnd follow_to_wall(StrayLight& light, bool forward, Landed&& landed) {
        stops_at_wall_ = true;
        return follow(light, forward, landed);
    }

    /// From the wall that `follow_to_wall` has come to.
    template <class Landed>
    StrayEnd leave_first_wall(StrayLight& light, Landed&& landed) {
        stops_at_wall_ = false;
        const std::optional<StrayEnd> end = is_wall_dust_ ? leave_dust(light, wall_normal_, is_under_dust_)
                                                          : leave_wall(light, wall_normal_, wall_finish_);
        return end ? *end : go_on(light, landed);
    }

  private:
    static constexpr int kAnySurface = -2;

    template <class Landed>
    StrayEnd go_on(StrayLight& light, Landed&& landed) {
        constexpr int kMostEvents = 10000;
        for (int event = 0; event < kMostEvents; ++event) {
            if (cell_ == count_ && target_ == count_) {
                if (!reach_film(light)) {
                    return StrayEnd::body;
                }
                landed(std::as_const(light));
                if (!(numbers_() < mirrors_.sensor)) {
                    return StrayEnd::film;
                }
                light.ray.direction.z = -light.ray.direction.z;
                ++light.reflections;
                witness_.at_mirror();
                target_ = count_ - 1;
                continue;
            }
            if (target_ == -1 && cell_ == 0) {
                return StrayEnd::front;
            }
            const std::optional<StrayEnd> end = take_step(light);
            if (end) {
                return *end;
            }
        }
        return StrayEnd::lost;
    }

    struct GlassMeeting {
        int surface = 0;
        bool forward = true;
        double distance = 0.0;
        TravellingRay<double> arrived;  // at the surface, and not through it yet
        bool goes_on = true;
        SurfaceMeeting<double> meeting{};
        double open = 1.0;  // of a stop's mask at the point
    };

    bool reach_film(StrayLight& light) const {
        if (!(light.ray.direction.z > 0.0)) {
            return false;
        }
        light.ray.origin = meet_plane(light.ray, lens_.image_z).point;
        return true;
    }

    /// The surface where the ray crosses it inside its rim.
    [[nodiscard]] std::optional<GlassMeeting> meet_surface(const Ray<double>& ray, int index, bool forward) const {
        GlassMeeting found{
            .surface = index, .forward = forward, .arrived = {.origin = ray.origin, .direction = ray.direction}};
        const auto keep = [&](const SurfaceMeeting<double>& at) {
            found.meeting = at;
            return true;
        };
        const auto [status, goes_on] =
            come_to_surface<Rims::clip>(lens_, index, forward, AtSurface::pass, found.arrived, keep);
        found.goes_on = goes_on;
        if (status == RayStatus::missed || status == RayStatus::clipped) {
            return std::nullopt;
        }
        const TraceSurface<double>& surface = lens_.surfaces[static_cast<std::size_t>(index)];
        const Vec3d point = found.arrived.global().origin;
        if (const SpecialSurface<double>* special = special_of(lens_, surface)) {
            const Vec3d own = to_own_axes(lens_, surface, point);
            const bool is_beyond = own.x * own.x + own.y * own.y > surface.semi_diameter_squared;
            found.open = is_beyond ? 0.0 : mask_transmittance(surface, *special, own.x, own.y);
            if (is_beyond) {
                return std::nullopt;
            }
        } else if (status == RayStatus::stopped) {
            return std::nullopt;
        }
        found.distance = dot(point - ray.origin, ray.direction);
        return found;
    }

    /// To the next surface or wall and on from it, or to an end.
    std::optional<StrayEnd> take_step(StrayLight& light) {
        if (target_ != kAnySurface) {
            if (const auto next = meet_surface(light.ray, target_, target_ == cell_)) {
                return leave_surface(light, *next);
            }
            if (cell_ == 0 || cell_ == count_) {
                return StrayEnd::absorbed;
            }
        }
        // Past the neighbour's rim or from a wall: whatever is nearest. A hollow surface may meet its own light again.
        std::optional<GlassMeeting> glass;
        for (const int index : {cell_ - 1, cell_}) {
            if (index != target_) {
                const auto meeting = meet_surface(light.ray, index, index == cell_);
                constexpr double kAhead = 1e-9;  // mm
                if (meeting && meeting->distance > kAhead && (!glass || meeting->distance < glass->distance)) {
                    glass = meeting;
                }
            }
        }
        const std::optional<WallMeeting> wall = barrel_.meet(cell_, light.ray);
        if (glass && !(wall && wall->distance < glass->distance)) {
            return leave_surface(light, *glass);
        }
        if (!wall) {
            return StrayEnd::lost;
        }
        if (!lens_.attenuation.empty()) {
            light.weight *= fading(lens_.attenuation[static_cast<std::size_t>(cell_)] * wall->distance);
        }
        light.ray.origin = light.ray.origin + wall->distance * light.ray.direction;
        if (wall->is_blades && numbers_() < mirrors_.blades) {
            leave_mirror(light);
            return std::nullopt;
        }
        return leave_wall(light, wall->normal, wall->finish);
    }

    /// Back from blades that are mirrors, to the surface in front of them or behind.
    void leave_mirror(StrayLight& light) {
        light.ray.direction.z = -light.ray.direction.z;
        ++light.reflections;
        witness_.at_mirror();
        target_ = light.ray.direction.z > 0.0 ? cell_ : cell_ - 1;
    }

    std::optional<StrayEnd> leave_wall(StrayLight& light, const Vec3d& normal, const WallFinish& finish) {
        if (stops_at_wall_ && finish.albedo > 0.0) {
            wall_normal_ = normal;
            wall_finish_ = finish;
            return StrayEnd::wall;
        }
        if (!scatters(light, finish.albedo)) {
            return StrayEnd::absorbed;
        }
        const Basis frame(normal);
        light.ray.direction =
            normalized(frame.to_world(scattered_direction(finish, frame.to_local(light.ray.direction), numbers_)));
        witness_.at_wall(light.ray.direction);
        target_ = kAnySurface;
        return std::nullopt;
    }

    bool scatters(StrayLight& light, double albedo) {
        if (!(albedo > 0.0) || (light.walls > 0 && numbers_() >= albedo)) {
            return false;
        }
        if (light.walls == 0) {
            light.at_first_wall = light.weight * (1.0 - albedo);
            light.weight *= albedo;
        }
        ++light.walls;
        return true;
    }

    /// Whether a grain lies on the first surface at a point.
    bool meets_dust(const Vec3d& front) {
        const FrontDust* dust = barrel_.dust();
        return dust != nullptr && numbers_() >= dust->clear(front);
    }

    /// From a grain, which the light met from outside or `is_under` it; `outwards`: the first surface's normal.
    std::optional<StrayEnd> leave_dust(StrayLight& light, const Vec3d& outwards, bool is_under) {
        const FrontDust& dust = *barrel_.dust();
        if (stops_at_wall_ && dust.albedo > 0.0) {
            wall_normal_ = outwards;
            is_wall_dust_ = true;
            is_under_dust_ = is_under;
            return StrayEnd::wall;
        }
        while (scatters(light, dust.albedo)) {
            const bool goes_out = is_under == (numbers_() < dust.through);
            const double u = numbers_();
            light.ray.direction =
                Basis(goes_out ? outwards : -1.0 * outwards).to_world(lambert_direction(u, numbers_()));
            witness_.at_wall(light.ray.direction);
            if (goes_out) {
                light.dust_normal = outwards;
                cell_ = 0;
                target_ = -1;
                return std::nullopt;
            }
            TravellingRay<double> passed{.origin = light.ray.origin, .direction = light.ray.direction};
            TravellingRay<double> reflected = passed;
            run_to_surface<Rims::follow>(lens_, 0, true, AtSurface::pass, mirrors_, passed);
            run_to_surface<Rims::follow>(lens_, 0, true, AtSurface::reflect, mirrors_, reflected);
            const bool is_through = passed.status == RayStatus::ok;
            const double passing = is_through ? passed.at_surfaces.value() : 0.0;
            const double going_on = passing + reflected.at_surfaces.value();
            light.weight *= going_on;
            if (numbers_() * going_on < passing) {
                witness_.at_surface(AtSurface::pass, 0, true, passed.global());
                light.ray = passed.global();
                cell_ = 1;
                target_ = 1;
                return std::nullopt;
            }
            witness_.at_surface(AtSurface::reflect, 0, true, reflected.global());
            is_under = true;
        }
        return StrayEnd::absorbed;
    }

    std::optional<StrayEnd> leave_surface(StrayLight& light, const GlassMeeting& at) {
        const TraceSurface<double>& surface = lens_.surfaces[static_cast<std::size_t>(at.surface)];
        light.weight *= at.arrived.optical_depth > 0.0 ? fading(at.arrived.optical_depth) : 1.0;
        if (at.open < 1.0 && numbers_() >= at.open) {
            light.ray.origin = at.arrived.global().origin;
            if (reflects_by_blades(surface) && numbers_() < mirrors_.blades) {
                leave_mirror(light);
                return std::nullopt;
            }
            return leave_wall(light, {0.0, 0.0, at.forward ? -1.0 : 1.0}, barrel_.finish().blades);
        }
        if (!at.goes_on) {
            return StrayEnd::absorbed;
        }
        TravellingRay<double> passed = at.arrived;
        const bool is_through = pass_surface(lens_, at.surface, at.forward, at.meeting, passed);
        const double passing = is_through ? passed.at_surfaces.value() / at.open : 0.0;
        const double reflecting = reflects_by_blades(surface)
                                      ? 0.0
                                      : reflected_at(lens_, at.surface, at.forward, mirrors_, at.meeting) / at.open;
        const auto reflected = [&] {
            TravellingRay<double> back = at.arrived;
            turn_back(lens_, at.surface, at.meeting, back);
            return back.global();
        };
        const bool is_dusty = at.surface == 0 && barrel_.dust() != nullptr;
        const Vec3d along = is_dusty ? normalized(light.ray.direction - reflected().direction) : Vec3d{};  // the normal
        if (is_dusty && at.forward && meets_dust(at.arrived.global().origin)) {
            light.ray.origin = at.arrived.global().origin;
            light.dust_normal = -1.0 * along;
            return leave_dust(light, -1.0 * along, false);
        }
        const double going_on = passing + reflecting;
        if (!(going_on > 0.0)) {
            return StrayEnd::absorbed;
        }
        light.weight *= going_on;
        const bool is_back = reflecting > 0.0 && numbers_() * going_on < reflecting;
        light.ray = is_back ? reflected() : passed.global();
        light.reflections += is_back ? 1 : 0;
        witness_.at_surface(is_back ? AtSurface::reflect : AtSurface::pass, at.surface, at.forward, light.ray);
        if (is_dusty && !at.forward && !is_back && meets_dust(light.ray.origin)) {
            return leave_dust(light, along, true);
        }
        const bool runs_forward = at.forward != is_back;
        cell_ = runs_forward ? at.surface + 1 : at.surface;
        target_ = runs_forward ? at.surface + 1 : at.surface - 1;
        return std::nullopt;
    }

    const TraceLens<double>& lens_;
    const Barrel& barrel_;
    const StrayMirrors<double>& mirrors_;
    Numbers& numbers_;
    Witness witness_;
    int count_;
    int cell_ = 0;    // the space in front of surface `cell_`
    int target_ = 0;  // the surface that light from the one it left comes to next
    bool stops_at_wall_ = false;
    Vec3d wall_normal_;  // where it has stopped
    WallFinish wall_finish_;
    bool is_wall_dust_ = false;
    bool is_under_dust_ = false;
};

}  // namespace lensproof::optics
