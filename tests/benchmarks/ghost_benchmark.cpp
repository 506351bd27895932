#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <random>
#include <string>

#include "engine/analysis/ghost_orders.h"
#include "engine/analysis/ghost_pictures.h"
#include "engine/analysis/ghost_region.h"
#include "engine/base/angle.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/packet/ghost_lanes.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

constexpr double kError = 0.01;    // of each visible ghost's energy
constexpr double kVisible = 1e-6;  // of the light that enters the entrance pupil
constexpr double kReferenceNm = 587.5618;

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Light at random over the front element, and at each surface of glass reflected or refracted at random: as often the
/// former as suits two reflections among some 25 surfaces, and no third.
class Untargeted {
  public:
    explicit Untargeted(const std::vector<analysis::GhostScene>& scenes) : scenes_(scenes) {}

    /// Sums of the energies that landed and of their squares, of a ghost over all wavelengths.
    struct Seen {
        double sum = 0.0;
        double squares = 0.0;
    };

    void follow_ray() {
        const auto& scene = scenes_[static_cast<std::size_t>(unit_(random_) * static_cast<double>(scenes_.size()))];
        const Vec2d place{unit_(random_), unit_(random_)};
        const Ray<double> ray = scene.beam.ray(scene.beam.corner() + scene.beam.side() * place);
        optics::TravellingRay<double> at{.origin = ray.origin, .direction = ray.direction};
        const int count = static_cast<int>(scene.lens.surfaces.size());
        optics::GhostPath path;
        double weight = scene.beam.area() / scene.pupil_area;
        ++rays_;
        int step = 1;
        for (int index = 0; index < count; index += step) {
            if (index < 0) {
                return;
            }
            constexpr double kReflected = 0.08;
            const auto& surface = scene.lens.surfaces[static_cast<std::size_t>(index)];
            const bool may_reflect = path.size() < 2 && surface.index_before != surface.index_after;
            const bool reflects = may_reflect && unit_(random_) < kReflected;
            if (may_reflect) {
                weight /= reflects ? kReflected : 1.0 - kReflected;
            }
            const auto what = reflects ? optics::AtSurface::reflect : optics::AtSurface::pass;
            if (!optics::run_to_surface<optics::Rims::clip>(scene.lens, index, step > 0, what, scene.mirrors, at)
                     .second) {
                return;
            }
            if (reflects) {
                path.push_back(index);
                step = -step;
            }
        }
        const Vec3d point = optics::meet_plane(at.global(), scene.lens.image_z).point;
        if (at.direction.z > 0.0 && std::hypot(point.x, point.y) <= scene.image_radius) {
            const double energy = weight * at.transmittance(scene.lens);
            Seen& seen = seen_[path];
            seen.sum += energy;
            seen.squares += energy * energy;
        }
    }

    /// How many rays it takes to know a ghost's energy to `kError`; at least, where it has been met by few so far.
    [[nodiscard]] double rays_needed(const optics::GhostPath& path) const {
        const auto found = seen_.find(path);
        if (found == seen_.end()) {
            return static_cast<double>(rays_) / (kError * kError);
        }
        const auto& [sum, squares] = found->second;
        return static_cast<double>(rays_) * squares / (sum * sum) / (kError * kError);
    }
    [[nodiscard]] long rays() const { return rays_; }

  private:
    const std::vector<analysis::GhostScene>& scenes_;
    std::mt19937_64 random_{1};
    std::uniform_real_distribution<double> unit_{0.0, 1.0};
    std::map<optics::GhostPath, Seen> seen_;
    long rays_ = 0;
};

/// All pairs at eight wavelengths on 1000 × 1000 pixels, on one thread; and in the same run what rays at random take.
void ghost_flare(benchmark::State& state, const std::string& name) {
    const optics::Lens lens = formats::load_lens(name);
    const double radius = analysis::image_radius(lens, kReferenceNm).value();
    analysis::GhostSettings settings{.reference_wavelength_nm = kReferenceNm,
                                     .wavelengths_nm = {},
                                     .source_angle = 10.0 * kDegree,
                                     .mirrors = {},
                                     .image_radius = radius,
                                     .sampling = {},
                                     .threads = 1};
    // The square within the image circle, so that light counts in the circle either way.
    const analysis::PictureSettings picture{.width = 1000,
                                            .height = 1000,
                                            .pitch_mm = std::sqrt(2.0) * radius / 1000.0,
                                            .wavelengths_nm = {420, 460, 500, 540, 580, 620, 660, 700},
                                            .energy_error = kError,
                                            .place_error_px = 4.0};
    std::vector<analysis::GhostScene> scenes;
    for (const double nm : picture.wavelengths_nm) {
        scenes.push_back(analysis::ghost_scene(lens, settings, nm));
    }
    const std::vector<optics::GhostPath> paths = analysis::ghosts_of_two(scenes.front());

    analysis::GhostPictures pictures;
    const double start = cpu_seconds();
    while (state.KeepRunning()) {
        pictures = analysis::draw_ghosts(lens, settings, picture, paths, 0);
    }
    const double by_beams = (cpu_seconds() - start) / static_cast<double>(state.iterations());

    Untargeted untargeted(scenes);
    constexpr long kRays = 300'000;
    const double random_start = cpu_seconds();
    while (untargeted.rays() < kRays) {
        untargeted.follow_ray();
    }
    const double a_ray = (cpu_seconds() - random_start) / kRays;
    double worst = 0.0;
    double most_rays = 0.0;
    int visible = 0;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        double energy = 0.0;
        double bound = 0.0;
        for (const analysis::MeshedGhost& ghost : pictures.ghosts[i].at) {
            energy += ghost.energy / static_cast<double>(scenes.size());
            bound += ghost.energy_bound / static_cast<double>(scenes.size());
        }
        if (energy > kVisible) {
            ++visible;
            worst = std::max(worst, bound / energy);
            most_rays = std::max(most_rays, untargeted.rays_needed(paths[i]));
        }
    }
    state.counters["visible"] = visible;
    state.counters["error_percent"] = 100.0 * worst;
    state.counters["untargeted_s"] = most_rays * a_ray;
    state.counters["times_as_fast"] = most_rays * a_ray / by_beams;
}

/// A ray along a ghost at four wavelengths, from the ghosts' own entrances over the front; `trace` returns how many
/// arrive.
template <class Trace>
void ghost_rays(benchmark::State& state, const Trace& trace) {
    const optics::Lens lens = formats::load_lens("double-gauss-tronnier");
    const auto at = optics::at_wavelengths<double>(lens, {450.0, 525.0, 600.0, 675.0});
    const analysis::GhostSettings settings{.reference_wavelength_nm = kReferenceNm,
                                           .wavelengths_nm = {},
                                           .source_angle = 10.0 * kDegree,
                                           .mirrors = {},
                                           .image_radius = analysis::image_radius(lens, kReferenceNm).value(),
                                           .sampling = {},
                                           .threads = 1};
    const analysis::GhostScene scene = analysis::ghost_scene(lens, settings, kReferenceNm);
    std::vector<std::pair<optics::GhostPath, Ray<double>>> rays;
    for (const optics::GhostPath& path : analysis::ghosts_of_two(scene)) {
        const analysis::GhostRegion region = analysis::ghost_region(scene, path);
        for (std::size_t i = 0; i < region.cells.size(); i += 1 + region.cells.size() / 20) {
            const auto [x, y] = region.cells[i];
            rays.emplace_back(path, scene.beam.ray(region.corner + region.cell * Vec2d{x + 0.5, y + 0.5}));
        }
    }
    std::size_t next = 0;
    int arrived = 0;
    for (auto _ : state) {
        const auto& [path, ray] = rays[next++ % rays.size()];
        arrived += trace(at, path, ray);
    }
    benchmark::DoNotOptimize(arrived);
}

int one_by_one(const optics::SpectralLens<double>& at, const optics::GhostPath& path, const Ray<double>& ray) {
    int arrived = 0;
    for (const optics::TraceLens<double>& lens : at.at()) {
        arrived += optics::trace_ghost(lens, path, ray).status == optics::RayStatus::ok ? 1 : 0;
    }
    return arrived;
}

int side_by_side(const optics::SpectralLens<double>& at, const optics::GhostPath& path, const Ray<double>& ray) {
    constexpr std::array<std::uint16_t, 4> kWavelengths = {0, 1, 2, 3};
    return static_cast<int>(
        std::ranges::count(optics::trace_ghost_lanes(at, kWavelengths, path, ray, {}).arrives, true));
}

}  // namespace

void register_ghost_benchmarks() {
    benchmark::RegisterBenchmark("ghosts/ray/alone", [](benchmark::State& state) { ghost_rays(state, one_by_one); });
    benchmark::RegisterBenchmark("ghosts/ray/lanes", [](benchmark::State& state) { ghost_rays(state, side_by_side); });
    const std::string lens = "double-gauss-angenieux";
    benchmark::RegisterBenchmark(("ghosts/" + lens).c_str(), ghost_flare, lens)->Unit(benchmark::kMillisecond);
}

}  // namespace lensproof
