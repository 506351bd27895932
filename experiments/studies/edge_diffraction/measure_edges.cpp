#include "experiments/studies/edge_diffraction/measure_edges.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "engine/analysis/edge_wave.h"
#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/power_law.h"
#include "engine/render/integrators/passes.h"
#include "engine/scene/scene.h"

namespace lensproof::studies {

static void fields(JsonArchive& json, EdgeProfile& profile) {
    json.field("octaves", profile.octaves)
        .field("rings", profile.rings)
        .field("energy", profile.energy)
        .field("near_streaks", profile.near_streaks);
}

static void fields(JsonArchive& json, Streak& streak) {
    json.field("light", streak.light).field("turn_deg", streak.turn_deg);
}

static void fields(JsonArchive& json, EdgeMap& map) {
    json.field("side", map.side).packed("values", map.values);
}

static void fields(JsonArchive& json, EdgeRays& rays) {
    json.field("profile", rays.profile).field("streaks", rays.streaks);
}

void fields(JsonArchive& json, EdgeDiffraction& found) {
    json.field("rays", found.rays)
        .field("batches", found.batches)
        .field("wave", found.wave)
        .field("ray_map", found.ray_map)
        .field("wave_map", found.wave_map);
}

namespace {

constexpr double kWavelength_nm = 550.0;
constexpr double kHalfBand_nm = 5.0;
constexpr double kRotation_deg = 10.0;
constexpr int kPixelsPerAiry = 3;
constexpr int kPixels = 2 * (static_cast<int>(kOutermost) + 1) * kPixelsPerAiry;
constexpr int kMapSide = 2 * static_cast<int>(kMapRadius) * kPixelsPerAiry;
constexpr double kIrradiance = 1000.0;  // of the light, across it
constexpr double kFaintest = 1e-12;     // of a map, for pixels without light

render::CameraSettings camera_settings(const EdgeSetting& setting) {
    render::CameraSettings camera{
        .lens = setting.lens,
        .f_number = setting.f_number,
        .focus_distance_mm = kInfinity,
        .sensor = {.width = kPixels, .height = kPixels, .pixel_pitch_mm = airy_mm(setting) / kPixelsPerAiry},
        .response = "luminance"};
    if (setting.blades > 0) {
        camera.blades = optics::PolygonStop{
            .blades = setting.blades, .curvature = setting.curvature, .rotation_deg = kRotation_deg};
    }
    return camera;
}

/// A star before the camera, a millidegree wide, and nothing else: a grain behind the camera, since a scene has one.
scene::Scene starlight(const spectral::SpectralGrid& grid) {
    const double cos_radius = std::cos(1e-5);
    const double cone = 2.0 * kPi * (1.0 - cos_radius);
    std::vector<scene::LightSource> lights;
    lights.emplace_back(
        scene::SunLight{{0.0, 0.0, 1.0}, cos_radius, spectral::constant_spectrum(kIrradiance / cone, grid)});
    const std::vector<scene::Shape> grain{scene::Sphere{1.0}};
    const std::vector<scene::SceneObject> objects{
        {.shape = 0, .to_world = {.linear = kIdentity3, .translation = {0.0, 0.0, -1e4}}, .material = 0}};
    scene::Scene made{.grid = grid,
                      .geometry = std::make_unique<scene::SceneGeometry>(grain, objects),
                      .materials = {scene::Material{scene::DiffuseMaterial{spectral::constant_spectrum(0.0, grid)}}},
                      .absorption = {},
                      .lights = {}};
    made.lights = scene::Lights(*made.geometry, lights);
    return made;
}

/// A pixel's place in λN from the image.
Vec2d place_of(int x, int y, const render::Sensor& sensor) {
    return sensor.position(x, y) / (kPixelsPerAiry * sensor.pixel_pitch_mm);
}

/// What a star on the axis is diffracted to: irradiances over the light's.
class StarFilm {
  public:
    explicit StarFilm(const render::Sensor& sensor) : sensor_(sensor), irradiance_(std::size_t{kPixels} * kPixels) {}

    void add(const render::Film& film, double weight) {
        for (int y = 0; y < kPixels; ++y) {
            for (int x = 0; x < kPixels; ++x) {
                irradiance_[index(x, y)] += weight * film.estimate(x, y).rgb.x / kIrradiance;
            }
        }
    }

    /// Visits each pixel: its place, its irradiance.
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (int y = 0; y < kPixels; ++y) {
            for (int x = 0; x < kPixels; ++x) {
                visit(place_of(x, y, sensor_), irradiance_[index(x, y)]);
            }
        }
    }

  private:
    static std::size_t index(int x, int y) {
        return static_cast<std::size_t>(y) * kPixels + static_cast<std::size_t>(x);
    }

    render::Sensor sensor_;
    std::vector<double> irradiance_;
};

/// By that many light paths, or a few less.
render::Film star_film(const render::Camera& camera, int paths, std::uint64_t seed) {
    const render::World world = starlight(camera.grid());
    const render::View view{.world = &world, .camera = &camera, .seed = seed, .paths = {.max_bounces = 0}};
    render::Render render = render::pass_named("diffracted").render(view, render::integrator_named("camera"));
    const double per_nm = 1.0 / render.film.band_nm;
    render.film.rgb_weights.assign(render.film.rgb_weights.size(), {per_nm, per_nm, per_nm});
    render::Film film(render.film);
    // Paths land anywhere, so that a few rows' stand for all.
    render::FilmTile tile(film.layout());
    const render::TileSamples rows{
        .rect = {.width = kPixels, .height = std::clamp(paths / kPixels, 1, kPixels)}, .first = 0, .end = 1};
    film.load(rows, tile);
    render.renderer(rows, tile);
    tile.finish();
    film.store(tile);
    return film;
}

double octave_weight(double from, double radius) {
    const double s = std::sin(kPi * (radius / from - 1.0));
    return radius > from && radius < 2.0 * from ? s * s : 0.0;
}

/// How the streaks of straight blades stand: evenly, the first at this azimuth.
struct StreakFan {
    int count = 0;  // 0: no streaks
    double first_deg = 0.0;

    [[nodiscard]] double sector_deg() const { return 360.0 / count; }

    /// In sectors from the first.
    [[nodiscard]] double turn(double azimuth) const { return (degrees(azimuth) - first_deg) / sector_deg(); }

    /// From the middle of the nearest; infinite where there is none.
    [[nodiscard]] double distance(double radius, double azimuth) const {
        if (count == 0) {
            return kInfinity;
        }
        const double sectors = turn(azimuth);
        return radius * std::sin(radians(std::abs(sectors - std::round(sectors)) * sector_deg()));
    }
};

/// An edge's normal stands between two corners, of which one is at the rotation; of an odd number a corner's own
/// direction is that of the opposite edge's other streak.
StreakFan streak_fan(const EdgeSetting& setting) {
    if (setting.blades == 0 || setting.curvature != 0.0) {
        return {};
    }
    return setting.blades % 2 == 1 ? StreakFan{2 * setting.blades, kRotation_deg}
                                   : StreakFan{setting.blades, kRotation_deg + 180.0 / setting.blades};
}

constexpr double kStreaksFrom = 20.0;  // λN: there they stand apart
constexpr double kStreakCore = 1.0;    // λN from its middle: farther out it is as faint as the light between them

/// `visit_all`: calls its argument with (radius, azimuth, irradiance, area) for the places of the film.
template <class VisitAll>
EdgeProfile profile_of(const StreakFan& fan, const VisitAll& visit_all) {
    constexpr std::size_t kRings = 48;
    const double octaves = std::log(kOutermost / kOctaves.front());
    EdgeProfile profile{.octaves = std::vector<double>(kOctaves.size()), .rings = std::vector<Vec2d>(kRings)};
    std::vector<double> weights(kOctaves.size());
    std::vector<double> areas(kRings);
    double beyond = 0.0;
    visit_all([&](double radius, double azimuth, double here, double area) {
        const double begun = std::clamp(0.5 * (radius - kOctaves.front()), 0.0, 1.0);
        profile.energy += radius < kOutermost ? begun * area * here : 0.0;
        for (std::size_t i = 0; i < kOctaves.size(); ++i) {
            const double weight = octave_weight(kOctaves.at(i), radius) * area;
            profile.octaves[i] += weight * here;
            weights[i] += weight;
        }
        if (radius > kStreaksFrom && radius < kOutermost) {
            beyond += area * here;
            profile.near_streaks += fan.distance(radius, azimuth) < kStreakCore ? area * here : 0.0;
        }
        const double ring = kRings * std::log(radius / kOctaves.front()) / octaves;
        if (ring >= 0.0 && ring < kRings) {
            profile.rings[static_cast<std::size_t>(ring)].y += area * here;
            areas[static_cast<std::size_t>(ring)] += area;
        }
    });
    profile.near_streaks /= beyond;
    for (std::size_t i = 0; i < kOctaves.size(); ++i) {
        profile.octaves[i] /= weights[i];
    }
    for (std::size_t i = 0; i < kRings; ++i) {
        profile.rings[i].x = kOctaves.front() * std::exp((static_cast<double>(i) + 0.5) * octaves / kRings);
        profile.rings[i].y /= std::max(areas[i], 1e-9);
    }
    return profile;
}

analysis::EdgeWave wave_of(const EdgeSetting& setting, const render::Camera& camera) {
    constexpr int kPiecesPerBlade = 32;
    constexpr int kPiecesOfCircle = 2048;  // of 100 λN: a sixth of an oscillation each
    const optics::Lens& lens = *camera.lens();
    const optics::StopAim aim(optics::at_wavelength<double>(lens, kWavelength_nm), lens.stop_index());
    const int pieces = setting.blades > 0 ? kPiecesPerBlade * setting.blades : kPiecesOfCircle;
    return {aim, lens.stop_mask, {.at = {0.0, 0.0, 1.0}, .is_far = true}, kWavelength_nm, pieces};
}

/// A blade's sector is like the others, and its halves each other's mirror image: from a corner to the next edge's
/// normal, with steps that are short at both, where streaks are narrow.
EdgeProfile by_wave(const EdgeSetting& setting, const analysis::EdgeWave& wave) {
    const double half_sector = setting.blades > 0 ? kPi / setting.blades : kPi;
    const int azimuths = setting.blades > 0 ? 64 : 1;
    constexpr double kStep = 0.15;
    return profile_of(streak_fan(setting), [&](const auto& visit) {
        for (double radius = kOctaves.front() + 0.5 * kStep; radius < kOutermost; radius += kStep) {
            for (int j = 0; j < azimuths; ++j) {
                const double t = (j + 0.5) / azimuths;
                const double azimuth = radians(kRotation_deg) + half_sector * t * t * (3.0 - 2.0 * t);
                const double fraction = azimuths == 1 ? 1.0 : 6.0 * t * (1.0 - t) / azimuths;
                const double r = radius * airy_mm(setting);
                visit(radius, azimuth, wave.irradiance({r * std::cos(azimuth), r * std::sin(azimuth)}),
                      2.0 * kPi * radius * kStep * fraction);
            }
        }
    });
}

/// Of the light from kStreaksFrom on, in the middle of each.
std::vector<Streak> streaks_of(const EdgeSetting& setting, const StarFilm& film) {
    const StreakFan fan = streak_fan(setting);
    if (fan.count == 0) {
        return {};
    }
    std::vector<Streak> streaks(static_cast<std::size_t>(fan.count));
    film.for_each([&](const Vec2d& place, double irradiance) {
        const double azimuth = std::atan2(place.y, place.x);
        if (length(place) > kStreaksFrom && fan.distance(length(place), azimuth) < kStreakCore) {
            const double turn = fan.turn(azimuth);
            const int nearest = static_cast<int>(std::lround(turn));
            Streak& streak = streaks[static_cast<std::size_t>((nearest % fan.count + fan.count) % fan.count)];
            streak.light += irradiance;
            streak.turn_deg += irradiance * fan.sector_deg() * (turn - nearest);
        }
    });
    const double most = std::ranges::max(streaks, {}, &Streak::light).light;
    for (Streak& streak : streaks) {
        streak.turn_deg /= streak.light;
        streak.light /= most;
    }
    return streaks;
}

EdgeRays by_rays(const EdgeSetting& setting, const StarFilm& film) {
    const EdgeProfile profile = profile_of(streak_fan(setting), [&](const auto& visit) {
        film.for_each([&](const Vec2d& place, double irradiance) {
            visit(length(place), std::atan2(place.y, place.x), irradiance, 1.0 / (kPixelsPerAiry * kPixelsPerAiry));
        });
    });
    return {.profile = profile, .streaks = streaks_of(setting, film)};
}

float shown(double irradiance) {
    return static_cast<float>(std::log10(std::max(irradiance, kFaintest)));
}

EdgeMap map_of_rays(const StarFilm& film) {
    EdgeMap map{.side = kMapSide, .values = std::vector<float>(static_cast<std::size_t>(kMapSide) * kMapSide)};
    const auto pixel = [](double place) { return static_cast<int>(std::floor((place + kMapRadius) * kPixelsPerAiry)); };
    film.for_each([&](const Vec2d& place, double irradiance) {
        const int x = pixel(place.x);
        const int y = pixel(place.y);
        if (std::min(x, y) >= 0 && std::max(x, y) < kMapSide) {
            map.values[static_cast<std::size_t>(y) * kMapSide + static_cast<std::size_t>(x)] = shown(irradiance);
        }
    });
    return map;
}

EdgeMap map_of_wave(const EdgeSetting& setting, const analysis::EdgeWave& wave) {
    EdgeMap map{.side = kMapSide, .values = {}};
    const auto place = [&](int i) { return airy_mm(setting) * ((i + 0.5) / kPixelsPerAiry - kMapRadius); };
    for (int y = 0; y < kMapSide; ++y) {
        for (int x = 0; x < kMapSide; ++x) {
            map.values.push_back(shown(wave.irradiance({place(x), place(y)})));
        }
    }
    return map;
}

}  // namespace

double airy_mm(const EdgeSetting& setting) {
    return 1e-6 * kWavelength_nm * setting.f_number;
}

double EdgeProfile::slope() const {
    std::vector<Vec2d> points;
    for (std::size_t i = 0; i < octaves.size(); ++i) {
        points.push_back({kOctaves.at(i), octaves[i]});
    }
    return power_law(points).exponent;
}

EdgeDiffraction measure_edges(const EdgeSetting& setting, std::uint64_t seed) {
    const render::Camera camera(
        camera_settings(setting),
        {kWavelength_nm - kHalfBand_nm, kWavelength_nm + kHalfBand_nm, spectral::kWavelengthsPerPath, 1}, {}, {});
    const analysis::EdgeWave wave = wave_of(setting, camera);
    StarFilm all(camera.sensor());
    EdgeDiffraction found{.rays = {}, .batches = {}, .wave = by_wave(setting, wave), .ray_map = {}, .wave_map = {}};
    for (std::uint64_t i = 0; i < kEdgeBatches; ++i) {
        const render::Film film = star_film(camera, setting.paths / kEdgeBatches, kEdgeBatches * seed + i);
        StarFilm one(camera.sensor());
        one.add(film, 1.0);
        all.add(film, 1.0 / kEdgeBatches);
        found.batches.push_back(by_rays(setting, one));
    }
    found.rays = by_rays(setting, all);
    if (setting.has_maps) {
        found.ray_map = map_of_rays(all);
        found.wave_map = map_of_wave(setting, wave);
    }
    return found;
}

}  // namespace lensproof::studies
