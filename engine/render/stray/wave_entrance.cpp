#include "engine/render/stray/wave_entrance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/basis.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/optics/stop_aim.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::render {

namespace {

constexpr double kByEdges = 0.25;  // of paths

/// Rays through the middle of the stop, on the film.
class ChiefRays {
  public:
    ChiefRays(const Camera& camera, std::size_t wavelength)
        : camera_(camera), aim_(camera.exact().lens().at()[wavelength], camera.lens()->stop_index()) {}

    struct Chief {
        Ray<double> front;
        Vec2d film_mm;
    };
    [[nodiscard]] std::optional<Chief> from(const Vec3d& towards) const {
        const auto aimed = aim_.aim({camera_.in_lens_space({-1.0 * towards, true}).at, true}, {});
        if (!aimed) {
            return std::nullopt;
        }
        const optics::TracedRay<double> traced = aim_.onwards({}, aimed->direction);
        if (traced.status != optics::RayStatus::ok || !(traced.ray.direction.z > 0.0)) {
            return std::nullopt;
        }
        const Vec3d film = optics::meet_plane(traced.ray, aim_.image_z()).point;
        return Chief{aimed->front, {film.x, film.y}};
    }

    /// λN: N the working f-number of far light on the axis, from the rim of the stop.
    [[nodiscard]] std::optional<double> airy_mm(double wavelength_nm) const {
        constexpr double kNearRim = 0.999;  // rounding must not take the ray beyond it
        const Vec2d rim{kNearRim * aim_.semi_diameter(), 0.0};
        const auto aimed = aim_.aim({{0.0, 0.0, 1.0}, true}, rim);
        if (!aimed) {
            return std::nullopt;
        }
        const optics::TracedRay<double> traced = aim_.onwards(rim, aimed->direction);
        const double aperture = std::abs(traced.ray.direction.x) / kNearRim;
        return traced.status == optics::RayStatus::ok && aperture > 0.0
                   ? std::optional(spectral::kMmPerNm * wavelength_nm / (2.0 * aperture))
                   : std::nullopt;
    }

  private:
    const Camera& camera_;
    optics::StopAim aim_;
};

}  // namespace

WaveEntrance::WaveEntrance(const Camera& camera, const std::vector<scene::SunLight>& suns,
                           const DiffractionSettings& settings)
    : camera_(&camera),
      far_edges_(camera, {.smallest_airy = WaveImage::kReachAiry, .zone_width = settings.zone_width}) {
    if (!camera.lens()->stop_mask.opening().texture.empty()) {
        throw InputError(
            fmt::format("{}: a picture describes its stop, whose wave is not known; expected a circle or "
                        "blades: suns are imaged by rays, without the pass \"waves\"",
                        camera.lens()->name));
    }
    const auto wavelengths = static_cast<std::size_t>(camera.grid().size());
    for (const scene::SunLight& sun : suns) {
        std::vector<std::optional<Image>> found(wavelengths);
        parallel_for(camera.grid().size(), 0, [&](int i) {
            const auto wavelength = static_cast<std::size_t>(i);
            found[wavelength] = image_of(sun, wavelength);
        });
        Sun& known = suns_.emplace_back(Sun{.towards = sun.towards});
        for (std::optional<Image>& image : found) {
            known.images.push_back(std::move(*image));
        }
    }
}

WaveEntrance::Image WaveEntrance::image_of(const scene::SunLight& sun, std::size_t wavelength) const {
    constexpr double kStep = 1e-4;  // radians
    const double across_deg = 2.0 * degrees(std::acos(sun.cos_radius));
    if (across_deg > kWidestDiscDeg) {
        throw InputError(
            fmt::format("a sun of {:.3g}° across is no distant point, expected {}° at most: its image is "
                        "made by rays, without the pass \"waves\"",
                        across_deg, kWidestDiscDeg));
    }
    const ChiefRays chiefs(*camera_, wavelength);
    const double wavelength_nm = camera_->grid().strata.midpoints()[wavelength];
    const Basis basis(sun.towards);
    const auto chief = chiefs.from(sun.towards);
    const auto airy_mm = chiefs.airy_mm(wavelength_nm);
    const auto right = chiefs.from(basis.to_world(normalized(Vec3d{kStep, 0.0, 1.0})));
    const auto up = chiefs.from(basis.to_world(normalized(Vec3d{0.0, kStep, 1.0})));
    if (!chief || !airy_mm || !right || !up) {
        throw InputError(
            fmt::format("{}: no ray from a sun at {} nm comes through the middle of the stop: its light "
                        "is found by rays, without the pass \"waves\"",
                        camera_->lens()->name, wavelength_nm));
    }
    return {
        .wave = WaveImage(*camera_->lens(), chief->front, wavelength_nm, *airy_mm),
        .chief_mm = chief->film_mm,
        .across = {(1.0 / kStep) * (right->film_mm - chief->film_mm), (1.0 / kStep) * (up->film_mm - chief->film_mm)}};
}

std::optional<Entry> WaveEntrance::draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                        bool is_hero_alone, PathSampler& numbers) const {
    const auto u = numbers.next();
    if (u[0] < kByEdges) {
        std::optional<Entry> entry = far_edges_.draw(from, path, is_hero_alone, numbers);
        if (entry) {
            entry->pdf *= kByEdges;
        }
        return entry;
    }
    const Sun& sun =
        *std::ranges::min_element(suns_, {}, [&](const Sun& candidate) { return length(from.at + candidate.towards); });
    const Vec3d beside = Basis(sun.towards).to_local(-1.0 * from.at);
    const Vec3d front = sun.images[path.index[0]].wave.front(u[1]);
    Entry entry{.direction = from.at,
                .end = camera_->to_world({front, {}}).origin,
                .pdf = (1.0 - kByEdges) / far_edges_.geometric_fraction()};
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const Image& image = sun.images[path.index[i]];
        const WaveImage::Draw drawn = image.wave.draw(u[2], u[3]);
        entry.at_px[i] = camera_->sensor().pixel(image.chief_mm + beside.x * image.across[0] +
                                                 beside.y * image.across[1] + drawn.offset);
        entry.weight[i] = image.wave.light_mm2() * drawn.weight;
    }
    return entry;
}

}  // namespace lensproof::render
