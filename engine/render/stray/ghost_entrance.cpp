#include "engine/render/stray/ghost_entrance.h"

#include <array>
#include <cmath>

#include "engine/base/disc.h"
#include "engine/optics/packet/ghost_lanes.h"

namespace lensproof::render {

namespace {

constexpr double kUnguided = 0.2;  // the fraction of rays

}  // namespace

GhostEntrance::GhostEntrance(const Camera& camera, bool is_guided)
    : front_(camera),
      mirrors_(camera.settings().mirrors),
      guide_(std::make_shared<const GhostGuide>(*camera.lens(), front_.middle(), mirrors_, front_.film_radius_mm(),
                                                is_guided, camera.cache())) {}

std::optional<GhostEntrance::DrawnGhost> GhostEntrance::draw_ghost(const pupil::EntranceBeam& beam, bool of_beam,
                                                                   PathSampler& numbers) const {
    if (guide_->paths().empty()) {
        return std::nullopt;
    }
    const auto u = numbers.next();
    const auto ghosts = static_cast<double>(guide_->paths().size());
    const Disc disc{beam.radius};
    const double unguided = guide_->is_known() ? kUnguided : 1.0;
    GhostGuide::Draw drawn;
    if (u[3] < unguided) {
        drawn = {.ghost = static_cast<std::size_t>(u[0] * ghosts), .offset = disc.warped(u[1], u[2])};
    } else if (const auto guided = guide_->draw(beam, {u[0], u[1], u[2]})) {
        drawn = *guided;
    } else {
        return std::nullopt;
    }
    const double guided_pdf = of_beam ? guide_->pdf(beam, drawn) : guide_->probability(beam, drawn.ghost);
    const bool is_in_disc = !of_beam || disc.contains(drawn.offset);
    const double even_pdf = is_in_disc ? 1.0 / (ghosts * (of_beam ? disc.area() : 1.0)) : 0.0;
    return DrawnGhost{guide_->paths()[drawn.ghost], drawn.offset, (1.0 - unguided) * guided_pdf + unguided * even_pdf};
}

Entry GhostEntrance::followed(Entry entry, const Ray<double>& ray, const optics::GhostPath& ghost,
                              const spectral::PathWavelengths& path) const {
    const double clear = front_.clear(ray);
    const optics::GhostLanes traced = optics::trace_ghost_lanes(front_.lens(), path.index, ghost, ray, mirrors_);
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        if (traced.arrives[i] && traced.ray[i].direction.z > 0.0) {
            entry.at_px[i] = front_.film_px(traced.ray[i], front_.lens().at(path.index[i]));
            entry.weight[i] = clear * traced.transmittance[i];
        }
    }
    return entry;
}

std::optional<Entry> GhostEntrance::draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                         bool /*is_hero_alone*/, PathSampler& numbers) const {
    const auto beam = front_.beam(from);
    const auto drawn = beam ? draw_ghost(*beam, true, numbers) : std::nullopt;
    if (!drawn) {
        return std::nullopt;
    }
    return followed(front_.entry(from, *beam, drawn->offset, drawn->pdf), beam->ray(drawn->offset), drawn->path, path);
}

std::optional<Entry> GhostEntrance::meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                         PathSampler& numbers) const {
    const auto meeting = front_.meet(ray);
    const auto drawn = meeting ? draw_ghost(meeting->beam, false, numbers) : std::nullopt;
    if (!drawn) {
        return std::nullopt;
    }
    Entry entry = front_.entry(ray, *meeting);
    entry.pdf = drawn->pdf;
    return followed(entry, meeting->beam.ray(meeting->offset), drawn->path, path);
}

}  // namespace lensproof::render
