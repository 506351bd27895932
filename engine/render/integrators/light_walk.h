// engine/render/integrators/light_walk.h — light paths, from the lights through the scene and into the camera to the
// film, by whichever way they take in the camera.
#pragma once
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/render/integrators/mis_weight.h"
#include "engine/render/integrators/pixel_paths.h"
#include "engine/render/integrators/view.h"
#include "engine/render/stray/entry.h"

namespace lensproof::render {

/// Which light paths count.
enum class LightPathsKept {
    all,
    /// Beside camera paths: those that come to the camera straight, of the sky what camera paths leave of it
    /// (`sky_by_camera`), of dust on the front nothing; and those of point lights whose first scattering is by a mirror
    /// or smooth glass, which no camera path makes.
    beside_camera_paths,
    /// Those that come to the camera straight from a sun.
    of_suns,
    /// All but those that come to it by a mirror or smooth glass, of which point lights' straight reflections alone.
    beside_mirrored_camera_paths,
};

/// What goes along a ray into the camera: an intensity from a point, from far off an irradiance; the pdfs of the other
/// techniques to make the path (LightMisWeight); and what has to be free for it.
struct LightCarried {
    spectral::SpectralSample light;
    double others = 0.0;
    scene::Segment segment;
};

/// A light path's last segment, at the path's wavelengths: one path of those that the tile was told of.
struct LightArrival {
    LightCarried carried;
    spectral::PathWavelengths path;
    bool is_hero_alone = false;
    bool is_far = false;
    std::uint64_t light_path = 0;
};

/// Where the light of a tile's light paths lands on the film, as `entrance` says.
///
/// An entrance says at once what becomes of light (`draw`, stray/entry.h), or it says where a ray goes in and with
/// which pdf (`aim`), and of many together what becomes of them (`arrive`): these wait for each other, and what they
/// meet between light and camera is asked for together, too.
///
/// An entrance that says `mis_weight(entry, wavelength, others, is_hero_alone)` is one of two ways to make these paths,
/// the other being camera paths.
template <class Entrance>
class LightLanding {
  public:
    LightLanding(const View& view, const Entrance& entrance, FilmTile& tile)
        : scene_(view.scene()),
          entrance_(entrance),
          tile_(tile),
          pixel_m2_(1e-6 * view.camera->sensor().pixel_pitch_mm * view.camera->sensor().pixel_pitch_mm) {}

    static constexpr bool kIsAimed = requires(const Entrance& entrance, const LightOrigin& from,
                                              const spectral::PathWavelengths& path, PathSampler& numbers) {
        entrance.aim(from, path, numbers);
    };
    static constexpr bool kIsWeighed = requires(const Entrance& entrance, const typename Entrance::Entry& entry) {
        entrance.mis_weight(entry, std::size_t{0}, 0.0, false);
    };

    /// The light path that follows began.
    void begin_path() { tile_.begin_light_path(); }
    [[nodiscard]] std::uint64_t path() const { return tile_.light_path(); }

    void land(const typename Entrance::Entry& entry, const LightArrival& of) {
        const double to_irradiance = (of.is_far ? kSquareMetresPerSquareMm : 1.0) / (entry.pdf * pixel_m2_);
        std::array<float, spectral::kWavelengthsPerPath> irradiance{};
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            if (entry.weight[i] > 0.0) {
                double arrives = to_irradiance * entry.weight[i] * of.carried.light[i];
                if constexpr (kIsWeighed) {
                    arrives *= entrance_.mis_weight(entry, i, of.carried.others, of.is_hero_alone);
                }
                irradiance[i] = static_cast<float>(arrives);
            }
        }
        tile_.splat(entry.at_px, of.path.index, irradiance, of.light_path);
    }

    /// Lands it with those after it.
    void land_later(const LensSample& aim, const LightArrival& of) {
        aims_.push_back(aim);
        arrivals_.push_back(of);
        if (arrivals_.size() == kTogether) {
            land_all();
        }
    }

    /// Lands all that wait. Until then the tile lacks them.
    void land_all() {
        if constexpr (kIsAimed) {
            segments_.clear();
            for (const LightArrival& of : arrivals_) {
                segments_.push_back(of.carried.segment);
            }
            are_blocked_.resize(segments_.size());
            scene::find_occluded(*scene_.geometry, segments_, are_blocked_);
            tile_.count_rays(segments_.size());
            std::size_t free = 0;
            for (std::size_t i = 0; i < arrivals_.size(); ++i) {
                if (are_blocked_[i] == 0) {
                    aims_[free] = aims_[i];
                    arrivals_[free++] = arrivals_[i];
                }
            }
            aims_.resize(free);
            arrivals_.resize(free);
            tile_.count_rays(spectral::kWavelengthsPerPath * free);
            entrance_.arrive(aims_, arrivals_, [&](std::size_t i, const auto& entry) { land(entry, arrivals_[i]); });
            aims_.clear();
            arrivals_.clear();
        }
    }

  private:
    static constexpr std::size_t kTogether = 64;
    static constexpr double kSquareMetresPerSquareMm = 1e-6;

    const scene::Scene& scene_;
    const Entrance& entrance_;
    FilmTile& tile_;
    double pixel_m2_;
    std::vector<LensSample> aims_;
    std::vector<LightArrival> arrivals_;  // as many
    std::vector<scene::Segment> segments_;
    std::vector<std::uint8_t> are_blocked_;
};

/// One light path: from each of its points it joins the camera, whose film it reaches as `landing` says. An entrance
/// that says `meet` is met by chance, too: behind a mirror or smooth glass, from where no ray can be drawn.
template <class Entrance>
class LightWalk {
  public:
    LightWalk(const View& view, const Entrance& entrance, const spectral::PathWavelengths& path, PathSampler& numbers,
              LightLanding<Entrance>& landing, LightPathsKept kept = LightPathsKept::all)
        : scene_(view.scene()),
          entrance_(entrance),
          path_(path),
          settings_(view.paths),
          numbers_(numbers),
          landing_(landing),
          kept_(kept) {}

    /// Returns how many rays were traced, in the scene and into the camera, but for those that wait in the landing.
    std::uint32_t walk() {
        const auto begin = numbers_.next();
        if (kept_ == LightPathsKept::of_suns) {
            join_from_light(scene_.lights.start_at_sun(path_, begin[0], begin[1], begin[2]));
            return rays_;
        }
        const scene::LightStart start = scene_.lights.start(path_, begin[0], begin[1], begin[2]);
        if (settings_.min_bounces == 0 && (Entrance::shows_points || !start.is_point()) &&
            !(start.is_sun && settings_.leaves_suns_out)) {
            join_from_light(start);
        }
        if (settings_.max_bounces > 0 && (kept_ != LightPathsKept::beside_camera_paths || start.is_point())) {
            const auto onwards = numbers_.next();
            scatter(start, scene_.lights.leave(start, onwards[0], onwards[1]));
        }
        return rays_;
    }

  private:
    static constexpr bool kIsWeighed = LightLanding<Entrance>::kIsWeighed;
    static constexpr bool kIsMet = requires(const Entrance& entrance, const Ray<double>& ray,
                                            const spectral::PathWavelengths& path, PathSampler& numbers) {
        entrance.meet(ray, path, numbers);
    };

    /// Carries on from surface to surface, and joins the camera from each.
    void scatter(const scene::LightStart& start, const scene::EmittedRay& light) {
        Ray<double> ray = light.ray;
        spectral::SpectralSample throughput(1.0F);
        for (int bounce = 1; spectral::max_value(light.power) > 0.0F; ++bounce) {
            const auto hit = scene::intersect(*scene_.geometry, ray.origin, ray.direction, 0.0, kInfinity);
            ++rays_;
            if constexpr (kIsMet) {
                const bool is_others = kept_ == LightPathsKept::beside_mirrored_camera_paths &&
                                       !(start.is_point() && is_mirrored_throughout_);
                if (is_mirrored_ && !is_others) {
                    arrive(ray, hit ? hit->distance_mm : kInfinity, light.power * throughput);
                }
            }
            if (!hit) {
                return;
            }
            throughput *= body_transmittance(scene_, *hit, ray.direction, path_);
            const PathVertex vertex(*hit, -1.0 * ray.direction, scene_, path_);
            if (!vertex.is_consistent(-1.0 * ray.direction, vertex.wo)) {
                return;
            }
            if (kIsWeighed && bounce == 1) {
                weight_.leave(scene_.lights.first_segment(start, hit->point));
            }
            const bool is_others = bounce == 1 && kept_ == LightPathsKept::beside_camera_paths;
            if (!scene::is_delta(vertex.bsdf) && !is_others) {
                join_from_surface(vertex, light.power * throughput);
            }
            if (bounce == settings_.max_bounces) {
                return;
            }
            const auto numbers = numbers_.next();
            const auto turn = vertex.turn_from_light(scene::bsdf_numbers(numbers[0], numbers[1], numbers[2]));
            if (!turn.bsdf || (is_others && !turn.bsdf->is_delta)) {
                return;
            }
            const auto& [drawn, onwards, wo] = turn;
            const scene::BsdfSample& scattered = *drawn;
            throughput *=
                scattered.weight * spectral::SpectralSample(shading_correction(vertex, wo, onwards, scattered.wi));
            if (scattered.is_dispersed && !is_hero_alone_) {
                throughput = static_cast<float>(spectral::kWavelengthsPerPath) * spectral::hero_alone(throughput);
                is_hero_alone_ = true;
            }
            if constexpr (kIsWeighed) {
                weight_.turn(scattered.is_delta ? PathTurn{.is_delta = true}
                                                : light_turn(vertex, onwards, scattered.wi, scattered.pdf));
            }
            if (!survives_roulette(settings_, bounce, numbers[3], throughput)) {
                return;
            }
            is_mirrored_ = scattered.is_delta;
            is_mirrored_throughout_ = is_mirrored_throughout_ && is_mirrored_;
            ray = {scene::ray_origin(vertex.hit, onwards), onwards};
        }
    }

    /// Light carries |cos| about the geometric normal where its paths' weights have that about the shading normal
    /// (Veach 1997, eq. 5.17).
    static float shading_correction(const PathVertex& vertex, const Vec3d& wo, const Vec3d& wi_world, const Vec3d& wi) {
        const double before =
            std::abs(wo.z) / std::abs(dot(vertex.frame.to_world(vertex.wo), vertex.hit.geometric_normal));
        const double after = std::abs(dot(wi_world, vertex.hit.geometric_normal)) / std::abs(wi.z);
        return static_cast<float>(before * after);
    }

    void join_from_light(const scene::LightStart& start) {
        const bool is_shared = kept_ == LightPathsKept::beside_camera_paths;
        const LightOrigin from{start.is_at_infinity ? start.direction : start.point, start.is_at_infinity};
        join(
            from,
            [&](const auto& in) {
                if (start.is_at_infinity) {
                    const double kept = is_shared ? 1.0 - sky_by_camera(start.pdf) : 1.0;
                    return LightCarried{
                        .light = scene::scaled(start.value, kept),
                        .others = LightMisWeight::others(start, 1.0),
                        .segment = {in.end - scene_.lights.beyond_mm(in.end) * start.direction, in.end}};
                }
                return LightCarried{
                    .light = scene_.lights.intensity(start, in.direction),
                    .others = LightMisWeight::others(start, std::abs(dot(start.normal, in.direction))),
                    .segment = {scene::ray_origin(start.point, start.normal, start.error_mm, in.direction), in.end}};
            },
            is_shared);
    }

    void join_from_surface(const PathVertex& vertex, const spectral::SpectralSample& power) {
        join({vertex.hit.point, false}, [&](const auto& in) -> LightCarried {
            const auto [wi, wo, is_bent] = vertex.as_from(in.direction, vertex.frame.to_local(in.direction));
            if (!vertex.is_consistent(in.direction, wi) || (is_bent && !vertex.is_consistent(vertex.backwards, wo))) {
                return {};
            }
            const spectral::SpectralSample scattered =
                scene::evaluate(vertex.bsdf, wo, wi, scene::Transport::importance);
            if (spectral::is_black(scattered)) {
                return {};
            }
            return {
                .light = power * scattered * spectral::SpectralSample(shading_correction(vertex, wo, in.direction, wi)),
                .others = kIsWeighed ? weight_.others(light_turn(vertex, in.direction, wi, 0.0)) : 0.0,
                .segment = {scene::ray_origin(vertex.hit, in.direction), in.end}};
        });
    }

    [[nodiscard]] LightArrival arrival(const LightCarried& carried, bool is_far) const {
        return {.carried = carried,
                .path = path_,
                .is_hero_alone = is_hero_alone_,
                .is_far = is_far,
                .light_path = landing_.path()};
    }

    /// Draws a ray into the camera and brings its light to the film.
    template <class CarriedBy>
    void join(const LightOrigin& from, const CarriedBy& carried_by, bool leaves_dust_out = false) {
        if constexpr (LightLanding<Entrance>::kIsAimed) {
            if (const auto aim = entrance_.aim(from, path_, numbers_)) {
                const LightCarried carried = carried_by(*aim);
                if (!spectral::is_black(carried.light)) {
                    landing_.land_later(*aim, arrival(carried, from.is_far));
                }
            }
        } else {
            join_at_once(from, carried_by, leaves_dust_out);
        }
    }

    template <class CarriedBy>
    void join_at_once(const LightOrigin& from, const CarriedBy& carried_by, bool leaves_dust_out) {
        auto entry = entrance_.draw(from, path_, is_hero_alone_, numbers_);
        if (!entry) {
            return;
        }
        rays_ += spectral::kWavelengthsPerPath;
        for (std::size_t i = 0; leaves_dust_out && i < spectral::kWavelengthsPerPath; ++i) {
            entry->weight[i] = entry->is_by_dust[i] ? 0.0 : entry->weight[i];
        }
        if (entry->is_dark()) {
            return;
        }
        const LightCarried carried = carried_by(*entry);
        if (!spectral::is_black(carried.light) && !is_blocked(carried.segment)) {
            landing_.land(*entry, arrival(carried, from.is_far));
        }
    }

    /// The same along a ray that comes anyway and is free up to `free_mm`.
    void arrive(const Ray<double>& ray, double free_mm, const spectral::SpectralSample& power) {
        const auto entry = entrance_.meet(ray, path_, numbers_);
        if (entry && length(entry->end - ray.origin) < free_mm) {
            rays_ += spectral::kWavelengthsPerPath;
            landing_.land(*entry, arrival({.light = power}, false));
        }
    }

    bool is_blocked(const scene::Segment& segment) {
        ++rays_;
        return scene::is_occluded(*scene_.geometry, segment.from, segment.to);
    }

    const scene::Scene& scene_;
    const Entrance& entrance_;
    const spectral::PathWavelengths& path_;
    const PathSettings& settings_;
    PathSampler& numbers_;
    LightLanding<Entrance>& landing_;
    LightMisWeight weight_;
    LightPathsKept kept_;
    std::uint32_t rays_ = 0;
    bool is_hero_alone_ = false;
    bool is_mirrored_ = false;  // its last point sends light one way only
    bool is_mirrored_throughout_ = true;
};

/// Renders a scene by light paths, one for each sample of each pixel, wherever it lands: the film's layout has splats.
/// A TileRenderer.
template <class Entrance>
class LightPaths {
  public:
    /// Light paths have numbers of their own, and `salt` tells those of one entrance from another's: those of other
    /// paths of the same sample would go with them.
    LightPaths(const View& view, Entrance entrance, std::uint64_t salt, LightPathsKept kept = LightPathsKept::all)
        : view_(view),
          entrance_(std::make_shared<const Entrance>(std::move(entrance))),
          seed_(sampler_detail::mixed(view.seed ^ salt)),
          kept_(kept) {}

    void operator()(const TileSamples& samples, FilmTile& tile) const {
        LightLanding<Entrance> landing(view_, *entrance_, tile);
        for_each_path(view_, seed_, samples,
                      [&](int /*x*/, int /*y*/, std::uint32_t /*sample*/, const spectral::PathWavelengths& path,
                          PathSampler& numbers) {
                          landing.begin_path();
                          tile.count_rays(LightWalk(view_, *entrance_, path, numbers, landing, kept_).walk());
                      });
        landing.land_all();
    }

  private:
    View view_;
    std::shared_ptr<const Entrance> entrance_;
    std::uint64_t seed_;
    LightPathsKept kept_;
};

}  // namespace lensproof::render
