#include "engine/render/camera/lens_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <optional>

#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/illumination.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::render {

namespace {

constexpr int kSteps = 128;           // of chief rays over the film's radius, and of pupils over the field
constexpr int kLightSteps = 64;       // of the light that is traced
constexpr int kFineLightSteps = 512;  // of its curve, which may fall within a few of a hundred of the radius
constexpr int kMostLightColours = 7;  // at which it is traced

/// The chief rays of a lens at one wavelength, by the angle under which they leave the stop: out to `farthest`, where
/// field or height stop to grow, or to a ray that is far enough.
struct ChiefFamily {
    optics::ChiefRays rays;
    double farthest = 0.0;

    template <class IsEnough>
    ChiefFamily(const optics::Lens& lens, double nm, const IsEnough& is_enough) : rays(lens, nm, optics::Rims::follow) {
        constexpr double kStride = 0.005;
        std::optional<optics::ChiefRay> last = rays.from_stop(0.0);
        while (last && !is_enough(*last)) {
            const auto next = rays.from_stop(farthest + kStride);
            if (!next) {  // it ends within this stride
                farthest =
                    bisected({farthest, farthest + kStride}, 40, [&](double angle) {
                        const auto ray = rays.from_stop(angle);
                        return ray && ray->image_height > last->image_height && ray->field_angle > last->field_angle;
                    }).inside;
                return;
            }
            if (!(next->image_height > last->image_height) || !(next->field_angle > last->field_angle)) {
                return;
            }
            farthest += kStride;
            last = next;
        }
    }

    [[nodiscard]] optics::ChiefRay last() const { return rays.from_stop(farthest).value(); }

    /// The ray at which `quantity`, which grows from 0, is so much.
    template <class Quantity>
    [[nodiscard]] optics::ChiefRay where(double wanted, const Quantity& quantity) const {
        const auto residual = [&](double angle) { return quantity(*rays.from_stop(angle)) - wanted; };
        const double at_last = residual(farthest);
        if (!(at_last > 0.0)) {
            return last();
        }
        std::uintmax_t steps = 100;
        const auto is_exact = [](double a, double b) { return b - a <= 4e-16 * b; };
        const auto bracket =
            boost::math::tools::toms748_solve(residual, 0.0, farthest, -wanted, at_last, is_exact, steps);
        return *rays.from_stop(bracket.second);
    }
};

double height_of(const optics::ChiefRay& ray) {
    return ray.image_height;
}

double field_of(const optics::ChiefRay& ray) {
    return ray.field_angle;
}

/// The light at one wavelength: up to where it ends, over s = (2/π) asin(radius / end), in which it ends smoothly.
struct TracedLight {
    double end_mm = 0.0;
    std::vector<double> at;  // kLightSteps + 1
    double transmittance = 1.0;
};

double light_radius(const TracedLight& light, double s) {
    return light.end_mm * std::sin(0.5 * kPi * s);
}

TracedLight traced_light(const optics::TraceLens<double>& lens, double film_radius_mm) {
    const auto is_lit = [&](double radius) { return optics::image_bundle(lens, radius).transmitted > 0.0; };
    TracedLight light{.end_mm = film_radius_mm, .at = {}};
    if (!is_lit(film_radius_mm)) {
        constexpr int kParts = 16;
        int part = kParts - 1;
        while (part > 0 && !is_lit(film_radius_mm * part / kParts)) {
            --part;
        }
        constexpr int kHalvings = 12;  // down to 2e-5 of the radius
        light.end_mm =
            bisected({film_radius_mm * part / kParts, film_radius_mm * (part + 1) / kParts}, kHalvings, is_lit).inside;
    }
    const bool ends = light.end_mm < film_radius_mm;
    for (int i = 0; i <= kLightSteps; ++i) {
        const optics::Bundle bundle = optics::image_bundle(lens, light_radius(light, 1.0 * i / kLightSteps));
        light.at.push_back(ends && i == kLightSteps ? 0.0 : bundle.transmitted);
        if (i == 0 && bundle.projected_solid_angle > 0.0) {
            light.transmittance = bundle.transmitted / bundle.projected_solid_angle;
        }
    }
    return light;
}

/// Of some light over wavelengths that lie evenly, at `position` in steps: through the four nearest (Lagrange).
TracedLight between(const std::vector<TracedLight>& lights, double position) {
    const auto count = static_cast<int>(lights.size());
    const int first = std::clamp(static_cast<int>(position) - 1, 0, std::max(0, count - 4));
    const int end = std::min(count, first + 4);
    const double some_end = lights[static_cast<std::size_t>(first)].end_mm;
    // Of differences, so that what all have in common keeps its last bit: the film's radius.
    TracedLight mean{.end_mm = some_end, .at = std::vector<double>(kLightSteps + 1), .transmittance = 0.0};
    for (int i = first; i < end; ++i) {
        double weight = 1.0;
        for (int j = first; j < end; ++j) {
            weight *= i == j ? 1.0 : (position - j) / (i - j);
        }
        const TracedLight& light = lights[static_cast<std::size_t>(i)];
        mean.end_mm += weight * (light.end_mm - some_end);
        mean.transmittance += weight * light.transmittance;
        for (std::size_t k = 0; k < mean.at.size(); ++k) {
            mean.at[k] += weight * light.at[k];
        }
    }
    return mean;
}

RadialCurve illumination_curve(const TracedLight& light, double end_mm) {
    const RadialCurve over_s = monotone_curve(1.0, light.at);
    std::vector<double> values;
    for (int i = 0; i <= kFineLightSteps; ++i) {
        const double s = std::asin(std::min(1.0, end_mm * i / kFineLightSteps / light.end_mm)) / (0.5 * kPi);
        values.push_back(std::max(0.0, over_s.at(std::min(1.0, s)).value));
    }
    return monotone_curve(end_mm, values);
}

std::vector<TracedLight> traced_lights(const optics::Lens& lens, const std::vector<double>& nm, double film_radius_mm) {
    std::vector<TracedLight> lights(nm.size());
    parallel_for(
        static_cast<int>(nm.size()), 0,
        [&](int i) {
            const auto at = static_cast<std::size_t>(i);
            lights[at] = traced_light(optics::at_wavelength<double>(lens, nm[at]), film_radius_mm);
        },
        [](int) {});
    if (std::ranges::any_of(lights, [](const TracedLight& light) { return !(light.at[0] > 0.0); })) {
        throw InputError(fmt::format("{} has no light on its axis, which the profile models start from", lens.name));
    }
    return lights;
}

RadialProfile radial_profile(const optics::Lens& lens, double nm, const TracedLight& light) {
    const ChiefFamily family(lens, nm, [&](const optics::ChiefRay& ray) { return ray.image_height > light.end_mm; });
    const double end_mm = std::min(light.end_mm, family.last().image_height);
    std::vector<double> angles = {0.0};
    for (int i = 1; i <= kSteps; ++i) {
        angles.push_back(family.where(end_mm * i / kSteps, height_of).field_angle);
    }
    return {.field_angle = RisingCurve(smooth_curve(end_mm, angles, Parity::odd)),
            .illumination = illumination_curve(light, end_mm),
            .transmittance = light.transmittance};
}

/// Of the line by which lenses are focused and stopped down.
RadialCurve pupil_curve(const optics::Lens& lens, double largest_field) {
    const ChiefFamily family(lens, spectral::kLineD,
                             [&](const optics::ChiefRay& ray) { return ray.field_angle > largest_field; });
    const double end = std::min(largest_field, family.last().field_angle);
    const optics::ParaxialData data = optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD));
    if (!std::isfinite(data.entrance_pupil_z)) {
        throw InputError(
            fmt::format("the entrance pupil of {} lies at infinity, which the profile models do not cover", lens.name));
    }
    std::vector<double> z = {lens.surfaces.front().vertex_z + data.entrance_pupil_z};
    for (int i = 1; i <= kSteps; ++i) {
        const Ray<double> ray = family.where(end * i / kSteps, field_of).front;
        z.push_back(ray.origin.z - ray.origin.y * ray.direction.z / ray.direction.y);
    }
    return smooth_curve(end, z, Parity::even);
}

}  // namespace

LensProfile traced_profile(const optics::Lens& lens, const std::vector<double>& wavelengths_nm, double film_radius_mm) {
    if (!lens.is_rotationally_symmetric) {
        throw InputError(
            fmt::format("{} is not rotationally symmetric; its profile would have to be, expected the "
                        "exact model",
                        lens.name));
    }
    optics::require_refraction_alone(lens, "a radial profile");
    const auto count = static_cast<int>(wavelengths_nm.size());
    const int colours = std::min(count, kMostLightColours);
    std::vector<double> traced_nm;
    for (int i = 0; i < colours; ++i) {
        const double t = colours > 1 ? 1.0 * i / (colours - 1) : 0.0;
        traced_nm.push_back(std::lerp(wavelengths_nm.front(), wavelengths_nm.back(), t));
    }
    const std::vector<TracedLight> lights = traced_lights(lens, traced_nm, film_radius_mm);
    LensProfile profile{.at = std::vector<RadialProfile>(wavelengths_nm.size()),
                        .pupil_z = {},
                        .front_z = lens.surfaces.front().vertex_z};
    parallel_for(
        count, 0,
        [&](int i) {
            const double position = count > 1 ? (colours - 1.0) * i / (count - 1) : 0.0;
            profile.at[static_cast<std::size_t>(i)] =
                radial_profile(lens, wavelengths_nm[static_cast<std::size_t>(i)], between(lights, position));
        },
        [](int) {});
    double largest_field = 0.0;
    for (const RadialProfile& at : profile.at) {
        largest_field = std::max(largest_field, at.field_angle.at(at.field_angle.end()).value);
    }
    profile.pupil_z = pupil_curve(lens, largest_field);
    return profile;
}

}  // namespace lensproof::render
