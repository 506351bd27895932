#include "experiments/studies/pupil_passage/measure_passage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/illumination.h"
#include "engine/pupil/pupil_map.h"
#include "engine/render/sampling/sampler.h"

namespace lensproof::studies {

namespace {

constexpr int kWavelengths = 16;
constexpr int kScrambles = 8;
constexpr int kPathsPerScramble = 4096;  // of each ring
constexpr int kDrawnPaths = 15;          // from each height

double position(int wavelength) {
    return wavelength / (kWavelengths - 1.0);
}

/// The radius up to which any wavelength's light reaches the sensor, at most `stated`.
double last_light(const std::vector<optics::TraceLens<double>>& band, double stated) {
    const auto is_lit = [&](double radius) {
        return std::ranges::any_of(band, [&](const optics::TraceLens<double>& lens) {
            return !optics::image_outline(lens, {0.0, radius}).is_empty();
        });
    };
    double lit = 0.0;
    double dark = 1.0;
    while (dark < stated && is_lit(dark)) {
        lit = dark;
        dark *= 1.25;
    }
    dark = std::min(dark, stated);
    if (is_lit(dark)) {
        return dark;
    }
    while (dark - lit > 1e-4 * dark) {
        const double middle = 0.5 * (lit + dark);
        (is_lit(middle) ? lit : dark) = middle;
    }
    return lit;
}

Ray<double> path_from(const optics::TraceLens<double>& lens, Vec2d film, Vec2d pupil, double plane_z) {
    const Vec3d from{film.x, film.y, lens.image_z};
    return optics::reverse_ray(from, Vec3d{pupil.x, pupil.y, plane_z});
}

/// Evenly over a ring's area.
Vec2d in_ring(double circle_mm, int ring, double u, double v) {
    const double radius = circle_mm / kPassageRings * std::sqrt(ring * ring + u * (2 * ring + 1));
    return {radius * std::sin(2.0 * std::numbers::pi * v), radius * std::cos(2.0 * std::numbers::pi * v)};
}

DrawnPath drawn_path(const optics::TraceLens<double>& lens, const Ray<double>& ray) {
    DrawnPath path;
    path.points.push_back({ray.origin.z, ray.origin.y});
    const optics::TracedRay<double> traced =
        optics::trace<optics::Direction::reverse>(lens, ray, [&](const optics::SurfaceEvent<double>& event) {
            if (event.status != optics::RayStatus::missed) {
                path.points.push_back({event.ray.origin.z, event.ray.origin.y});
            }
        });
    path.passes = traced.status == optics::RayStatus::ok;
    if (path.passes) {
        const double beyond = 0.3 * (lens.image_z - lens.surfaces.front().vertex_z);
        path.points.push_back({traced.ray.origin.z + beyond * traced.ray.direction.z,
                               traced.ray.origin.y + beyond * traced.ray.direction.y});
    }
    return path;
}

class PassageMeter {
  public:
    PassageMeter(const std::vector<optics::TraceLens<double>>& band, double circle_mm, std::uint64_t seed)
        : band_(band), circle_mm_(circle_mm), seed_(seed) {}

    [[nodiscard]] PassageOf measure(const pupil::PupilMap& map) const {
        PassageOf result;
        std::array<double, kScrambles> means{};
        for (int ring = 0; ring < kPassageRings; ++ring) {
            const double area = (2.0 * ring + 1.0) / (kPassageRings * kPassageRings);
            for (int scramble = 0; scramble < kScrambles; ++scramble) {
                const double fraction = ring_fraction(map, ring, scramble);
                result.rings[static_cast<std::size_t>(ring)] += fraction / kScrambles;
                means[static_cast<std::size_t>(scramble)] += area * fraction;
            }
        }
        double squares = 0.0;
        for (const double mean : means) {
            result.mean += mean / kScrambles;
            squares += mean * mean / kScrambles;
        }
        result.error = std::sqrt(std::max(0.0, squares - result.mean * result.mean) / (kScrambles - 1));
        for (const double height : {0.0, 0.35, 0.7, 0.95}) {
            draw(map, height * circle_mm_, result.drawn);
        }
        return result;
    }

  private:
    [[nodiscard]] double ring_fraction(const pupil::PupilMap& map, int ring, int scramble) const {
        const render::PixelSampler sampler(seed_, static_cast<std::uint32_t>(ring * kScrambles + scramble));
        int started = 0;
        int passed = 0;
        for (int i = 0; i < kPathsPerScramble; ++i) {
            const auto u = sampler.point(static_cast<std::uint32_t>(i));
            const Vec2d film = in_ring(circle_mm_, ring, u[0], u[1]);
            const int wavelength = static_cast<int>(u[4] * kWavelengths);
            const pupil::PupilSample start = map.sample(film, position(wavelength), u[2], u[3]);
            if (start.pdf > 0.0) {
                const optics::TraceLens<double>& lens = band_[static_cast<std::size_t>(wavelength)];
                const Ray<double> ray = path_from(lens, film, start.point, map.plane_z());
                ++started;
                passed += optics::trace<optics::Direction::reverse>(lens, ray).status == optics::RayStatus::ok ? 1 : 0;
            }
        }
        return static_cast<double>(passed) / std::max(1, started);
    }

    /// Paths from a height on the sensor to points that are even over what the map draws from in the section: where its
    /// density is more than that of the defensive fraction alone.
    void draw(const pupil::PupilMap& map, double height, std::vector<DrawnPath>& drawn) const {
        const int wavelength = kWavelengths / 2;
        const optics::TraceLens<double>& lens = band_[static_cast<std::size_t>(wavelength)];
        const Vec2d film{0.0, height};
        const double radius = map.disc().radius;
        const auto density = [&](double y) { return map.pdf(film, position(wavelength), {0.0, y}); };
        constexpr int kSteps = 2000;
        double largest = 0.0;
        for (int i = 0; i <= kSteps; ++i) {
            largest = std::max(largest, density(radius * (2.0 * i / kSteps - 1.0)));
        }
        double low = radius;
        double high = -radius;
        for (int i = 0; i <= kSteps; ++i) {
            const double y = radius * (2.0 * i / kSteps - 1.0);
            if (density(y) > 0.5 * largest) {
                low = std::min(low, y);
                high = std::max(high, y);
            }
        }
        for (int i = 0; i < kDrawnPaths && low <= high; ++i) {
            const double y = low + (high - low) * (i + 0.5) / kDrawnPaths;
            drawn.push_back(drawn_path(lens, path_from(lens, film, {0.0, y}, map.plane_z())));
        }
    }

    const std::vector<optics::TraceLens<double>>& band_;
    double circle_mm_;
    std::uint64_t seed_;
};

}  // namespace

// Where the archive looks for them, beside the types.
static void fields(JsonArchive& json, DrawnPath& path) {
    json.field("points", path.points).field("passes", path.passes);
}

static void fields(JsonArchive& json, PassageOf& of) {
    json.field("rings", of.rings).field("mean", of.mean).field("error", of.error).field("drawn", of.drawn);
}

void fields(JsonArchive& json, PassageCounts& counts) {
    json.field("circle_mm", counts.circle_mm).field("whole_element", counts.whole_element).field("pupil", counts.pupil);
}

optics::Lens passage_lens(const PassageSetting& setting) {
    return optics::focused_at(optics::with_f_number(formats::load_lens(setting.lens), setting.f_number), kInfinity);
}

PassageCounts count_passage(const optics::Lens& lens, std::uint64_t seed) {
    std::vector<optics::TraceLens<double>> band;
    band.reserve(kWavelengths);
    for (int i = 0; i < kWavelengths; ++i) {
        band.push_back(optics::at_wavelength<double>(lens, 400.0 + 300.0 * (i + 0.5) / kWavelengths));
    }
    const auto& stated = lens.stated.image_circle_mm;
    const double circle_mm = last_light(band, stated ? 0.5 * *stated : kInfinity);
    const pupil::PupilMap map(band, lens.is_rotationally_symmetric, circle_mm);
    const PassageMeter meter(band, circle_mm, seed);
    return {.circle_mm = circle_mm,
            .whole_element = meter.measure(pupil::PupilMap::whole_element(band.front(), circle_mm)),
            .pupil = meter.measure(map)};
}

Passage measure_passage(const PassageSetting& setting, std::uint64_t seed) {
    optics::Lens lens = passage_lens(setting);
    PassageCounts counts = count_passage(lens, seed);
    return {std::move(counts), setting, std::move(lens)};
}

}  // namespace lensproof::studies
