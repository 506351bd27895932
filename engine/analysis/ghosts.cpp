#include "engine/analysis/ghosts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/analysis/ghost_device.h"
#include "engine/analysis/ghost_orders.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/polarised_ghost.h"

namespace lensproof::analysis {

namespace {

constexpr std::size_t kWeighedRays = 200;  // of a ghost

GhostLight light_along(const GhostScene& scene, const optics::GhostPath& path, const GhostSampling& sampling,
                       Footprint* footprint = nullptr) {
    return measure_ghost(scene, path, ghost_region(scene, path), sampling, footprint);
}

/// The largest mean irradiance of the light's own image, which is no larger than a few of a footprint's pixels, over a
/// square as Footprint takes it, about the image's centroid.
double image_peak(const GhostLight& image, double patch) {
    double inside = 0.0;
    double all = 0.0;
    for (const LandedRay& ray : image.first_grid) {
        const Vec2d from = ray.point - image.centroid;
        all += ray.energy;
        inside += std::max(std::abs(from.x), std::abs(from.y)) <= 0.5 * patch ? ray.energy : 0.0;
    }
    return all > 0.0 ? image.energy * inside / all / (patch * patch) : 0.0;
}

optics::TraceLens<double> with_coating(optics::TraceLens<double> lens, int surface,
                                       const optics::TraceCoating<double>& coating) {
    optics::TraceSurface<double>& coated = lens.surfaces[static_cast<std::size_t>(surface)];
    if (coated.special < 0) {
        coated.special = static_cast<int>(lens.specials.size());
        lens.specials.emplace_back();
    }
    lens.specials[static_cast<std::size_t>(coated.special)].coating = coating;
    return lens;
}

/// Every so many of the rays, about `most` of them: of thousands of ghosts, not all are kept.
std::vector<LandedRay> thinned(const std::vector<LandedRay>& rays, std::size_t most) {
    std::vector<LandedRay> few;
    const std::size_t stride = 1 + rays.size() / most;
    for (std::size_t i = 0; i < rays.size(); i += stride) {
        few.push_back(rays[i]);
    }
    return few;
}

/// The ghost's energy with its light's polarisation carried along the path: as its kept rays, which stand for equal
/// areas of the front, have it.
double polarised_energy(const GhostScene& scene, const Ghost& ghost) {
    double averaged = 0.0;
    double carried = 0.0;
    for (const LandedRay& ray : ghost.light.first_grid) {
        averaged += ray.energy;
        carried +=
            ray.energy * optics::polarisation_factor(scene.lens, ghost.path, scene.beam.ray(ray.offset), scene.mirrors);
    }
    return averaged > 0.0 ? ghost.light.energy * carried / averaged : ghost.light.energy;
}

/// The rays of the ghosts that carry all but a thousandth of the light, to be weighed again with other coatings: these
/// do not change a ray's way.
class WeighedRays {
  public:
    WeighedRays(const GhostScene& scene, const std::vector<Ghost>& ghosts, double energy) {
        double left = energy;
        for (const Ghost& ghost : ghosts) {
            if (left <= 1e-3 * energy) {
                break;
            }
            left -= ghost.light.energy;
            if (ghost.light.first_grid.empty()) {
                continue;
            }
            Part part{.path = ghost.path, .offsets = {}, .energy = ghost.light.energy};
            for (const LandedRay& ray : ghost.light.first_grid) {
                part.offsets.push_back(ray.offset);
            }
            part.weight = weight(scene, part);
            energy_ += part.energy;
            parts_.push_back(std::move(part));
        }
    }

    /// What of the light is gone in a scene that differs by its reflectances alone.
    [[nodiscard]] double gone_in(const GhostScene& other) const {
        double left = 0.0;
        for (const Part& part : parts_) {
            left += part.energy * weight(other, part) / part.weight;
        }
        return energy_ > 0.0 ? 1.0 - left / energy_ : 0.0;
    }

  private:
    struct Part {
        optics::GhostPath path;
        std::vector<Vec2d> offsets;
        double energy = 0.0;
        double weight = 0.0;
    };

    static double weight(const GhostScene& scene, const Part& part) {
        double sum = 0.0;
        for (const Vec2d& offset : part.offsets) {
            const auto landed = landing(scene, part.path, offset);
            sum += landed ? landed->transmittance : 0.0;
        }
        return sum;
    }

    std::vector<Part> parts_;
    double energy_ = 0.0;
};

SurfaceContribution surface_contribution(const GhostScene& scene, const WeighedRays& rays, int surface,
                                         double wavelength_nm) {
    SurfaceContribution contribution{.surface = surface};
    GhostScene other = scene;
    const int sensor = static_cast<int>(scene.lens.surfaces.size());
    if (surface == sensor || optics::reflects_by_blades(scene.lens.surfaces[static_cast<std::size_t>(surface)])) {
        (surface == sensor ? other.mirrors.sensor : other.mirrors.blades) = 0.0;
        contribution.perfect = rays.gone_in(other);
        return contribution;
    }
    other.device = nullptr;  // which has the lens as it is
    other.lens = with_coating(scene.lens, surface, {.layers = {}, .reflectance = 0.0});
    contribution.perfect = rays.gone_in(other);
    constexpr double kIndex = 1.38;  // of magnesium fluoride (Macleod, Thin-Film Optical Filters)
    constexpr double kCentreNm = 550.0;
    other.lens = with_coating(scene.lens, surface,
                              {.layers = {{kIndex, 0.25 * kCentreNm / kIndex / wavelength_nm}}, .reflectance = {}});
    contribution.quarter_wave = rays.gone_in(other);
    return contribution;
}

std::vector<SurfaceContribution> surface_contributions(const GhostScene& scene, const GhostSurvey& survey,
                                                       const GhostSettings& settings) {
    const WeighedRays rays(scene, survey.ghosts, survey.energy);
    const std::vector<int> surfaces = reflectors(scene);
    std::vector<SurfaceContribution> contributions(surfaces.size());
    parallel_for(static_cast<int>(surfaces.size()), settings.threads, [&](int i) {
        const int surface = surfaces[static_cast<std::size_t>(i)];
        SurfaceContribution& contribution = contributions[static_cast<std::size_t>(i)];
        contribution = surface_contribution(scene, rays, surface, settings.reference_wavelength_nm);
        for (const Ghost& ghost : survey.ghosts) {
            const bool reflects = std::ranges::find(ghost.path, surface) != ghost.path.end();
            contribution.involved += reflects && survey.energy > 0.0 ? ghost.light.energy / survey.energy : 0.0;
        }
    });
    std::ranges::stable_sort(contributions, std::ranges::greater(), &SurfaceContribution::perfect);
    return contributions;
}

std::shared_ptr<GhostDevice> ghost_device(const optics::TraceLens<double>& lens,
                                          const std::shared_ptr<device::SharedDevice>& device) {
    if (!device || device->has_failed()) {
        return nullptr;
    }
    try {
        return std::make_shared<GhostDevice>(device, lens);
    } catch (const device::Error& error) {
        device->refuse(error.what());
        return nullptr;
    }
}

}  // namespace

GhostScene ghost_scene(const optics::Lens& lens, const GhostSettings& settings, double wavelength_nm) {
    optics::require_refraction_alone(lens, "a ghost");
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, wavelength_nm);
    const double diameter = optics::paraxial_data(optics::at_wavelength<double>(lens, settings.reference_wavelength_nm))
                                .entrance_pupil_diameter;
    if (!std::isfinite(diameter)) {
        throw InputError(
            fmt::format("{}: the entrance pupil lies at infinity and has no size, to which the energy of "
                        "ghosts could be referred",
                        lens.name));
    }
    return {.lens = traced,
            .beam = FrontBeam(traced, settings.source_angle),
            .mirrors = settings.mirrors,
            .image_radius = settings.image_radius,
            .pupil_area = 0.25 * std::numbers::pi * diameter * diameter * std::cos(settings.source_angle),
            .device = ghost_device(traced, settings.device)};
}

std::optional<double> image_radius(const optics::Lens& lens, double wavelength_nm) {
    if (lens.stated.image_circle_mm && *lens.stated.image_circle_mm > 0.0) {
        return 0.5 * *lens.stated.image_circle_mm;
    }
    const optics::ChiefRays chiefs(lens, wavelength_nm);
    const auto outermost = chiefs.at_field(chiefs.largest_field() * (1.0 - 1e-6));
    const double radius = outermost ? length(outermost->image_point) : 0.0;
    return radius > 0.0 ? std::optional(radius) : std::nullopt;
}

GhostSurvey survey_ghosts(const optics::Lens& lens, const GhostSettings& settings) {
    const GhostScene scene = ghost_scene(lens, settings, settings.reference_wavelength_nm);
    std::vector<GhostScene> further;
    for (const double wavelength_nm : settings.wavelengths_nm) {
        further.push_back(ghost_scene(lens, settings, wavelength_nm));
    }
    GhostSurvey survey;
    std::vector<optics::GhostPath> paths = ghosts_of_two(scene);
    if (settings.reflections == 4) {
        RankedGhosts four = ghosts_of_four(scene, settings.tolerance, settings.threads);
        paths.insert(paths.end(), four.paths.begin(), four.paths.end());
        survey.skipped_energy_bound = four.skipped_energy_bound;
    }
    survey.image = light_along(scene, {}, settings.sampling);
    const double brightest = image_peak(survey.image, Footprint(settings.image_radius).patch());

    survey.ghosts.resize(paths.size());
    const auto make_worker = [&] {
        return [&, footprint = Footprint(settings.image_radius)](int i) mutable {
            Ghost& ghost = survey.ghosts[static_cast<std::size_t>(i)];
            ghost.path = paths[static_cast<std::size_t>(i)];
            ghost.paraxial = optics::paraxial_ghost(scene.lens, ghost.path, settings.chief_angle);
            ghost.light = light_along(scene, ghost.path, settings.sampling, &footprint);
            ghost.light.first_grid = thinned(ghost.light.first_grid, kWeighedRays);
            if (settings.polarised) {
                ghost.polarised_energy = polarised_energy(scene, ghost);
            }
            if (brightest > 0.0) {
                ghost.peak_over_image = ghost.light.peak / brightest;
            }
            for (const GhostScene& at : further) {
                GhostSampling fewer = settings.sampling;
                fewer.rays /= 4;
                ghost.energies.push_back(light_along(at, ghost.path, fewer).energy);
            }
        };
    };
    parallel_for_workers(static_cast<int>(paths.size()), settings.threads, make_worker, [](int /*finished*/) {});
    std::ranges::stable_sort(survey.ghosts, std::ranges::greater(), [](const Ghost& g) { return g.light.energy; });
    for (const Ghost& ghost : survey.ghosts) {
        survey.energy += ghost.light.energy;
        survey.polarised_energy += ghost.polarised_energy;
    }
    survey.surfaces = surface_contributions(scene, survey, settings);
    return survey;
}

}  // namespace lensproof::analysis
