#include "engine/render/stray/fate_entrance.h"

#include "engine/base/disc.h"
#include "engine/render/stray/walk_numbers.h"

namespace lensproof::render {

std::optional<Entry> FateEntrance::draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                        bool /*is_hero_alone*/, PathSampler& numbers) const {
    const auto u = numbers.next();
    const auto beam = front_.beam(from);
    if (!beam) {
        return std::nullopt;
    }
    const Disc disc{beam->radius};
    const Vec2d offset = disc.warped(u[0], u[1]);
    return ended(front_.entry(from, *beam, offset, 1.0 / disc.area()), beam->ray(offset), path, u);
}

std::optional<Entry> FateEntrance::meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                        PathSampler& numbers) const {
    const auto u = numbers.next();
    const auto meeting = front_.meet(ray);
    if (!meeting) {
        return std::nullopt;
    }
    return ended(front_.entry(ray, *meeting), meeting->beam.ray(meeting->offset), path, u);
}

Entry FateEntrance::ended(Entry entry, const Ray<double>& ray, const spectral::PathWavelengths& path,
                          const std::array<double, PathSampler::kNumbers>& seed) const {
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        WalkNumbers numbers(seed);
        if (const auto end = fate(ray, front_.lens().at(path.index[i]), numbers)) {
            entry.at_px[i] = {static_cast<double>(*end), 0.0};
            entry.weight[i] = 1.0;
        }
    }
    return entry;
}

template <class Numbers>
std::optional<Fate> FateEntrance::fate(const Ray<double>& ray, const optics::TraceLens<double>& lens,
                                       Numbers& numbers) const {
    const optics::StrayMirrors<double>& mirrors = front_.camera().settings().mirrors;
    optics::TravellingRay<double> at_front{.origin = ray.origin, .direction = ray.direction};
    const optics::RayStatus status =
        optics::run_to_surface<optics::Rims::clip>(lens, 0, true, optics::AtSurface::pass, mirrors, at_front).first;
    if (status == optics::RayStatus::missed || status == optics::RayStatus::clipped) {
        return std::nullopt;
    }
    optics::StrayWalk walk(lens, barrel_, mirrors, numbers);
    optics::StrayLight light{.ray = ray};
    const optics::StrayEnd end = walk.follow(light, true, [](const optics::StrayLight&) {});
    // What it lost on its way, and what is left of it: one of them, by chance.
    const double number = numbers();
    if (number >= light.weight) {
        return number < light.weight + light.at_first_wall ? Fate::clipped : Fate::absorbed;
    }
    switch (end) {
        case optics::StrayEnd::front:
            return Fate::front;
        case optics::StrayEnd::film:
            return fate_behind(light, lens);
        case optics::StrayEnd::body:
            return Fate::beside;
        case optics::StrayEnd::absorbed:
            return Fate::clipped;
        case optics::StrayEnd::wall:  // where this walk does not stop
        case optics::StrayEnd::lost:
            break;
    }
    return Fate::lost;
}

Fate FateEntrance::fate_behind(const optics::StrayLight& light, const optics::TraceLens<double>& lens) const {
    const Sensor& sensor = front_.camera().sensor();
    const Vec2d px = front_.film_px(light.ray, lens);
    if (!(px.x >= -0.5 && px.x < sensor.width - 0.5 && px.y >= -0.5 && px.y < sensor.height - 0.5)) {
        return Fate::beside;
    }
    if (light.walls > 0) {
        return Fate::barrel;
    }
    return light.reflections > 0 ? Fate::ghosts : Fate::imaged;
}

}  // namespace lensproof::render
