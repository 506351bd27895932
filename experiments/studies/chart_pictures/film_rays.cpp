#include "experiments/studies/chart_pictures/film_rays.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/analysis/field_light.h"
#include "engine/base/input_error.h"

namespace lensproof::studies {

namespace {

constexpr int kBeamRings = 10;  // of a beam's rays

/// A point of lens space as the meridional plane has it, and the way back: there the point lies at y ≤ 0, and images
/// to y ≥ 0.
struct Meridian {
    explicit Meridian(const Vec3d& point) {
        const double radius = std::hypot(point.x, point.y);
        if (radius > 0.0) {
            up = {-point.x / radius, -point.y / radius};
        }
        object = {0.0, -radius, point.z};
    }
    [[nodiscard]] Vec2d back(Vec2d p) const { return {p.x * up.y + p.y * up.x, -p.x * up.x + p.y * up.y}; }

    Vec2d up{0.0, 1.0};
    Vec3d object;
};

std::optional<optics::FieldBundle> bundle_of(const optics::ChiefRays& chief_rays, const Vec3d& object) {
    const std::optional<optics::ChiefRay> chief = chief_rays.from_point(object);
    return chief ? std::optional(optics::FieldBundle{.chief = *chief, .object_distance = -object.z}) : std::nullopt;
}

}  // namespace

FilmRays::FilmRays(const render::Camera& camera, int bands) {
    const std::optional<optics::Lens>& lens = camera.lens();
    if (!lens || !lens->is_rotationally_symmetric) {
        throw InputError(
            fmt::format("{}: a chart's features are held to the rays of a rotationally symmetric lens alone",
                        lens ? lens->name : "a camera without a lens"));
    }
    const std::vector<Vec3d> weights = camera.albedo_weights();
    const spectral::WavelengthStrata& strata = camera.grid().strata;
    for (int band = 0; band < bands; ++band) {
        const int first = band * strata.count / bands;
        const int end = (band + 1) * strata.count / bands;
        if (first == end) {
            continue;
        }
        Vec3d rgb;
        double mean_nm = 0.0;
        for (int i = first; i < end; ++i) {
            rgb = rgb + weights[static_cast<std::size_t>(i)];
            mean_nm += strata.midpoint(i) / (end - first);
        }
        bands_.push_back({optics::at_wavelength<double>(*lens, mean_nm), optics::ChiefRays(*lens, mean_nm), rgb});
    }
}

std::optional<FilmRays::Chief> FilmRays::chief(const Vec3d& point) const {
    const Meridian meridian(point);
    const std::optional<optics::ChiefRay> chief = green().chief_rays.from_point(meridian.object);
    return chief ? std::optional(Chief{meridian.back(chief->image_point), chief->field_angle}) : std::nullopt;
}

void FilmRays::add(const Vec3d& point, double fraction, std::vector<FilmLight>& light) const {
    const Meridian meridian(point);
    for (const Band& band : bands_) {
        const auto bundle = bundle_of(band.chief_rays, meridian.object);
        if (!bundle) {
            continue;
        }
        for (const analysis::SpotRay& ray :
             analysis::spot_rays(band.lens, *bundle, analysis::beam_outline(band.lens, *bundle), kBeamRings)) {
            light.push_back({meridian.back(ray.point), fraction * ray.weight * band.rgb});
        }
    }
}

double FilmRays::solid_angle(const Vec3d& point) const {
    const auto bundle = bundle_of(green().chief_rays, Meridian(point).object);
    return bundle ? analysis::field_light(green().lens, *bundle, bundle->chief.image_point).image.area : 0.0;
}

}  // namespace lensproof::studies
