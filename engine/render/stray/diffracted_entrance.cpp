#include "engine/render/stray/diffracted_entrance.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::render {

DiffractedEntrance::DiffractedEntrance(const Camera& camera, const DiffractionSettings& settings)
    : front_(camera), zone_width_(settings.zone_width) {
    const optics::Lens& lens = *camera.lens();
    mask_ = lens.stop_mask.with_edges();
    if (!mask_.has_edges()) {
        throw InputError(fmt::format(
            "{}: the picture that describes its stop is too soft to have edges that diffract light; expected "
            "one that goes from nine tenths of full brightness to one tenth within six texels",
            lens.name));
    }
    if (!(settings.smallest_airy >= 1.0 && settings.smallest_airy <= 1000.0)) {
        throw InputError(fmt::format("diffraction from {} λN on, expected from 1 to 1000", settings.smallest_airy));
    }
    if (!(settings.zone_width > 0.0 && settings.zone_width <= 0.5)) {
        throw InputError(fmt::format("a zone of {} beside the stop's edges, expected more than 0 and at most 0.5",
                                     settings.zone_width));
    }
    for (std::size_t i = 0; i < camera.exact().lens().at().size(); ++i) {
        const optics::TraceLens<double>& at = camera.exact().lens().at()[i];
        if (!optics::has_plane_stop(at, lens.stop_index())) {
            throw InputError(fmt::format(
                "{}: the stop, surface {}, is a face of glass: expected a plane in air, whose edges diffract light",
                lens.name, lens.stop_index() + 1));
        }
        const optics::StopAim aim(at, lens.stop_index());
        semi_diameter_ = aim.semi_diameter();
        // λN on the film is λ / 2a at the stop, by the Lagrange invariant.
        const double wavelength = spectral::kMmPerNm * camera.grid().strata.midpoints()[i] / aim.index();
        at_.push_back({.aim = aim,
                       .wavenumber = 2.0 * kPi / wavelength,
                       .deflections = {.smallest = settings.smallest_airy * wavelength / (2.0 * semi_diameter_),
                                       .largest = 0.5 * kPi}});
    }
    if (!(at_.front().deflections.smallest < 0.1 && at_.back().deflections.smallest < 0.1)) {
        throw InputError(fmt::format("{}: a stop of {} mm is too small for rays that its edges diffract", lens.name,
                                     2.0 * semi_diameter_));
    }
}

std::optional<Entry> DiffractedEntrance::draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                              bool is_hero_alone, PathSampler& numbers) const {
    const auto u = numbers.next();
    const LightOrigin lens_from = front_.camera().in_lens_space(from);
    const optics::RayOrigin origin{lens_from.at, lens_from.is_far};
    const optics::StopMask::EdgePoint edge = mask_.edge_at(u[0]);
    const Vec2d point = semi_diameter_ * edge.point;

    std::optional<Entry> entry;
    std::optional<optics::AimedRay> first;
    const std::size_t count = is_hero_alone ? 1 : spectral::kWavelengthsPerPath;
    for (std::size_t i = 0; i < count; ++i) {
        const Wavelength& at = at_[path.index[i]];
        const auto aimed = at.aim.aim(origin, point, first ? &first->direction : nullptr);
        if (!aimed) {
            continue;
        }
        const optics::DiffractedRay ray =
            optics::diffracted_at_edge({edge.outward, edge.length * semi_diameter_}, at.wavenumber, aimed->direction,
                                       at.deflections, {u[1], u[2]});
        if (!first) {
            first = aimed;
            const Ray<double> world = front_.camera().to_world(aimed->front);
            entry = Entry{.direction = world.direction, .end = world.origin};
        }
        land(*entry, i, at, point, ray,
             mask_.perimeter() * semi_diameter_ * aimed->beam_per_mm2 * aimed->transmittance *
                 front_.clear(aimed->front.origin));
    }
    return entry;
}

std::optional<Entry> DiffractedEntrance::meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                              PathSampler& numbers) const {
    const auto u = numbers.next();
    const Ray<double> lens_ray{front_.camera().in_lens_space({ray.origin, false}).at,
                               front_.camera().in_lens_space({ray.direction, true}).at};
    std::optional<Entry> entry;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const Wavelength& at = at_[path.index[i]];
        const auto stop = at.aim.to_stop(lens_ray);
        const Vec2d open = stop ? stop->point / semi_diameter_ : Vec2d{};
        if (!stop || dot(open, open) > 1.0 || !(mask_.transmittance(open.x, open.y) > 0.0)) {
            continue;
        }
        const auto diffracted = optics::diffracted({&mask_, semi_diameter_, at.wavenumber},
                                                   {.width = zone_width_, .deflections = at.deflections}, stop->point,
                                                   stop->direction, {u[0], u[1], u[2], u[3]});
        if (!diffracted) {
            continue;
        }
        if (!entry) {
            entry = Entry{.direction = ray.direction, .end = front_.camera().to_world({stop->front, {}}).origin};
        }
        land(*entry, i, at, stop->point, *diffracted, stop->transmittance * front_.clear(stop->front));
    }
    return entry;
}

void DiffractedEntrance::land(Entry& entry, std::size_t wavelength, const Wavelength& at, const Vec2d& point,
                              const optics::DiffractedRay& ray, double weight) const {
    if (!(ray.direction.z > 0.0)) {
        return;
    }
    const optics::TracedRay<double> traced = at.aim.onwards(point, ray.direction);
    if (traced.status != optics::RayStatus::ok || !(traced.ray.direction.z > 0.0)) {
        return;
    }
    const Vec3d film = optics::meet_plane(traced.ray, at.aim.image_z()).point;
    entry.at_px[wavelength] = front_.camera().sensor().pixel({film.x, film.y});
    entry.weight[wavelength] = weight * ray.weight * traced.transmittance;
}

double DiffractedEntrance::geometric_fraction() const {
    const Wavelength& any = at_.front();
    return 1.0 - optics::diffracted_fraction({&mask_, semi_diameter_, any.wavenumber}, any.deflections.smallest);
}

}  // namespace lensproof::render
