#include "engine/render/stray/walk_entrance.h"

#include "engine/base/disc.h"
#include "engine/render/stray/walk_numbers.h"

namespace lensproof::render {

WalkEntrance::WalkEntrance(const Camera& camera, StrayClass wanted)
    : front_(camera), wanted_(wanted), barrel_(camera.lens().value()) {}

bool is_dark(StrayClass wanted, const optics::Barrel& barrel) {
    return wanted == StrayClass::walls && barrel.is_black();
}

bool counts(StrayClass wanted, const optics::StrayLight& light) {
    switch (wanted) {
        case StrayClass::many_reflections:
            return light.walls == 0 && light.reflections >= 4;
        case StrayClass::walls:
            return light.walls > 0;
        case StrayClass::all:
            break;
    }
    return true;
}

std::optional<Entry> WalkEntrance::draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                        bool /*is_hero_alone*/, PathSampler& numbers) const {
    const auto u = numbers.next();
    const auto beam = front_.beam(from);
    if (!beam || is_dark(wanted_, barrel_)) {
        return std::nullopt;
    }
    const Disc disc{beam->radius};
    const Vec2d offset = disc.warped(u[0], u[1]);
    return landed(front_.entry(from, *beam, offset, 1.0 / disc.area()), beam->ray(offset), path, u);
}

std::optional<Entry> WalkEntrance::meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                        PathSampler& numbers) const {
    const auto u = numbers.next();
    const auto meeting = front_.meet(ray);
    if (!meeting || is_dark(wanted_, barrel_)) {
        return std::nullopt;
    }
    return landed(front_.entry(ray, *meeting), meeting->beam.ray(meeting->offset), path, u);
}

Entry WalkEntrance::landed(Entry entry, const Ray<double>& ray, const spectral::PathWavelengths& path,
                           const std::array<double, PathSampler::kNumbers>& seed) const {
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const optics::TraceLens<double>& lens = front_.lens().at(path.index[i]);
        WalkNumbers numbers(seed);
        optics::StrayWalk walk(lens, barrel_, front_.camera().settings().mirrors, numbers);
        optics::StrayLight light{.ray = ray};
        int places = 0;
        double kept = 0.0;
        walk.follow(light, true, [&](const optics::StrayLight& on_film) {
            if (!counts(wanted_, on_film)) {
                return;
            }
            ++places;
            if (places == 1 || numbers() * places < 1.0) {
                entry.at_px[i] = front_.film_px(on_film.ray, lens);
                kept = on_film.weight;
                entry.is_by_dust[i] = on_film.dust_normal.has_value();
            }
        });
        entry.weight[i] = places * kept;
    }
    return entry;
}

}  // namespace lensproof::render
