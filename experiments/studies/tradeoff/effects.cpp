#include "experiments/studies/tradeoff/effects.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "engine/analysis/seidel.h"
#include "engine/optics/paraxial.h"
#include "engine/optics/trace.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/studies/tradeoff/effect_kinds.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

namespace {

/// R, G, B of light along the axis: through a lens without losses, through its surfaces and glass, and the glass alone.
struct AxialLight {
    Vec3d white;
    Vec3d all;
    Vec3d glass;
};

double glass_transmittance(const optics::Lens& lens, double wavelength_nm) {
    double transmittance = 1.0;
    for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i) {
        const double thickness = lens.surfaces[i + 1].vertex_z - lens.surfaces[i].vertex_z;
        transmittance *=
            optics::internal_transmittance(lens.surfaces[i].medium, wavelength_nm, std::abs(thickness)).value_or(1.0);
    }
    return transmittance;
}

AxialLight axial_light(const Pilot& pilot) {
    const render::Camera& camera = pilot.camera();
    const optics::Lens& lens = camera.lens().value();
    const spectral::WavelengthStrata& strata = camera.grid().strata;
    AxialLight light;
    for (int i = 0; i < strata.count; ++i) {
        const double nm = strata.midpoint(i);
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, nm);
        const auto axis = optics::trace<optics::Direction::reverse>(
            traced, {{0.0, 0.0, traced.image_z}, {0.0, 0.0, -lens.final_heading()}});
        const double all = axis.status == optics::RayStatus::ok ? axis.transmittance : 1.0;
        const Vec3d& rgb = camera.film().rgb_weights[static_cast<std::size_t>(i)];
        light.white = light.white + rgb;
        light.all = light.all + all * rgb;
        light.glass = light.glass + glass_transmittance(lens, nm) * rgb;
    }
    return light;
}

Vec3d ratio(const Vec3d& a, const Vec3d& b) {
    const auto over = [](double x, double y) { return y != 0.0 ? x / y : 1.0; };
    return {over(a.x, b.x), over(a.y, b.y), over(a.z, b.z)};
}

void add_losses(const Pilot& pilot, const AxialLight& light, std::vector<Effect>& effects) {
    const Vec3d surfaces = ratio(light.glass, light.all);  // without Fresnel's losses there would be so much more
    effects.push_back(gain_effect(pilot, "fresnel-loss", {surfaces.y, surfaces.y, surfaces.y}));
    effects.push_back(gain_effect(pilot, "coating-colour", {surfaces.x / surfaces.y, 1.0, surfaces.z / surfaces.y}));
    effects.push_back(gain_effect(pilot, "absorption", ratio(light.white, light.glass)));
}

/// The exact camera and a model as they see the points.
struct SeenPoints {
    const Pilot& pilot;
    PointLooks exact;
    PointLooks model;
};

/// Of a point, from both cameras' looks at all of them; nothing where it has no such number.
using PointNumber = std::function<std::optional<double>(const std::vector<PointLook>& exact,
                                                        const std::vector<PointLook>& model, std::size_t point)>;

RadialMean over_heights(const SeenPoints& seen, const PointNumber& of) {
    std::vector<RadialMean::Sample> samples;
    for (std::size_t i = 0; i < seen.pilot.points().size(); ++i) {
        if (const std::optional<double> value = of(seen.exact.back(), seen.model.back(), i)) {
            samples.push_back({seen.pilot.points()[i].image_height, *value});
        }
    }
    constexpr int kRings = 8;
    return {std::move(samples), kRings};
}

Measured rms_over_points(const SeenPoints& seen, const PointNumber& of) {
    const int repetitions = static_cast<int>(seen.exact.size()) - 1;
    return root(jackknifed(repetitions, [&](int left_out) {
        const auto looks = static_cast<std::size_t>(left_out);
        double squares = 0.0;
        double count = 0.0;
        for (std::size_t i = 0; i < seen.pilot.points().size(); ++i) {
            if (const std::optional<double> value = of(seen.exact[looks], seen.model[looks], i)) {
                squares += *value * *value;
                count += 1.0;
            }
        }
        return squares / std::max(1.0, count);
    }));
}

double outward(const Pilot& pilot, std::size_t point, const Vec2d& shift) {
    const Vec2d from = pilot.points()[point].at_px - pilot.setup().camera.sensor.axis();
    const double distance = std::hypot(from.x, from.y);
    return distance > 0.0 ? (shift.x * from.x + shift.y * from.y) / distance : 0.0;
}

/// Beside a thin lens.
void add_geometry(const SeenPoints& seen, std::vector<Effect>& effects) {
    using Looks = std::vector<PointLook>;
    const Pilot& pilot = seen.pilot;
    // Only of points that both cameras see.
    const auto lit = [](const auto& of) -> PointNumber {
        return [of](const Looks& exact, const Looks& thin, std::size_t i) {
            return exact[i].light[1] > 0.0 && thin[i].light[1] > 0.0 ? std::optional<double>(of(exact, thin, i))
                                                                     : std::nullopt;
        };
    };
    const PointNumber moved = lit([&](const Looks& exact, const Looks& thin, std::size_t i) {
        return outward(pilot, i, exact[i].centroid[1] - thin[i].centroid[1]);
    });
    const RadialMean distortion = over_heights(seen, moved);
    effects.push_back(
        shift_effect(pilot, "distortion", {distortion, distortion, distortion}, rms_over_points(seen, moved)));
    const auto against_green = [&](const Looks& exact, std::size_t i, std::size_t c) {
        return exact[i].light[c] > 0.0 ? outward(pilot, i, exact[i].centroid[c] - exact[i].centroid[1]) : 0.0;
    };
    const auto colour = [&](std::size_t c) {
        return over_heights(
            seen, lit([&, c](const Looks& exact, const Looks&, std::size_t i) { return against_green(exact, i, c); }));
    };
    const PointNumber all_colours = lit([&](const Looks& exact, const Looks&, std::size_t i) {
        return std::hypot(against_green(exact, i, 0), against_green(exact, i, 2)) / std::sqrt(3.0);
    });
    effects.push_back(
        shift_effect(pilot, "lateral-colour", {colour(0), colour(1), colour(2)}, rms_over_points(seen, all_colours)));
    const auto add_blur = [&](const char* name, const PointNumber& of) {
        const RadialMean spread = over_heights(seen, of);
        effects.push_back(blur_effect(
            pilot, name, [&](int x, int y) { return spread.at(pilot.image_height(x, y)); }, rms_over_points(seen, of)));
    };
    add_blur("aberration-blur",
             lit([](const Looks& exact, const Looks&, std::size_t i) { return exact[i].spread_px[1]; }));
    // What red and blue are wider than green by.
    add_blur("axial-colour", lit([](const Looks& exact, const Looks&, std::size_t i) {
                 const auto& spread = exact[i].spread_px;
                 return std::sqrt(
                     std::max(0.0, 0.5 * (spread[0] * spread[0] + spread[2] * spread[2]) - spread[1] * spread[1]));
             }));
}

/// A thin lens's discs at the depths that the pilot saw, rms radius in px: the diameter is f²/(N (s − f)) |d − s| / d.
Effect defocus(const Pilot& pilot) {
    const render::CameraSettings& settings = pilot.setup().camera;
    const optics::ParaxialData data =
        optics::paraxial_data(optics::at_wavelength<double>(pilot.camera().lens().value(), spectral::kLineD));
    const double focus = settings.focus_distance_mm;
    const double focal_nearness = std::isfinite(focus) ? 1.0 / focus : 0.0;
    const double image_mm = std::abs(data.efl) / (1.0 - std::abs(data.efl) * focal_nearness);
    const auto disc_px = [&](int x, int y) {
        const double depth = pilot.depth_mm(x, y);
        const double nearness = std::isfinite(depth) && depth > 0.0 ? 1.0 / depth : 0.0;
        const double disc_mm = data.entrance_pupil_diameter * image_mm * std::abs(nearness - focal_nearness);
        return disc_mm / std::sqrt(8.0) / settings.sensor.pixel_pitch_mm;
    };
    return blur_effect(pilot, "defocus", disc_px, rms_over_pixels(pilot, disc_px));
}

/// What blurs in third order, rms over the pupil: transverse aberrations are ∂W/∂ρ / n'u' of
/// W = S1 ρ⁴/8 + S2 η ρ³ cos φ/2 + S3 η² ρ² cos² φ/2 + (S3 + S4) η² ρ²/4 (Welford, Aberrations of Optical Systems,
/// ch. 8), spherical aberration at its best focus, and astigmatism about the medial surface.
void add_third_order(const Pilot& pilot, std::vector<Effect>& effects) {
    const optics::Lens& lens = pilot.camera().lens().value();
    const render::Sensor& sensor = pilot.setup().camera.sensor;
    const auto at = [&](double nm) { return optics::at_wavelength<double>(lens, nm); };
    const optics::TraceLens<double> reference = at(spectral::kLineD);
    const double field = std::atan(sensor.half_diagonal_mm() / std::abs(optics::paraxial_data(reference).efl));
    const auto sums = analysis::seidel_sums(reference, at(spectral::kLineF), at(spectral::kLineC), field,
                                            pilot.setup().camera.focus_distance_mm);
    if (!sums) {
        return;
    }
    const auto& total = sums->total;
    const double px = 1.0 / (2.0 * std::abs(sums->image_slope) * sensor.pixel_pitch_mm);
    const auto add = [&](const char* name, double at_corner, int power_of_field) {
        const auto spread = [&](int x, int y) {
            return px * std::abs(at_corner) * std::pow(pilot.image_height(x, y), power_of_field);
        };
        effects.push_back(blur_effect(pilot, name, spread, rms_over_pixels(pilot, spread)));
        effects.back().part_of = "aberration-blur";
    };
    add("spherical-aberration", total.s1 / 6.0, 0);
    add("coma", std::sqrt(2.0 / 3.0) * total.s2, 1);
    add("astigmatism", std::sqrt(0.5) * total.s3, 2);
    add("field-curvature", std::sqrt(0.5) * (2.0 * total.s3 + total.s4), 2);
}

/// Beside a pinhole, which counts for all of the pupil of first order: what the lens's own is wider or narrower than
/// that on the axis is in the vignetting.
void add_falloff(const SeenPoints& seen, std::vector<Effect>& effects) {
    using Looks = std::vector<PointLook>;
    const auto nearest = std::ranges::min_element(seen.pilot.points(), {}, &ProbePoint::image_height);
    const auto middle = static_cast<std::size_t>(nearest - seen.pilot.points().begin());
    const auto add = [&](const char* name, const PointNumber& light) {
        const PointNumber ev = [&](const Looks& exact, const Looks& pinhole, std::size_t i) {
            const std::optional<double> there = light(exact, pinhole, i);
            return there ? std::optional(std::log2(std::max(1e-3, *there))) : std::nullopt;
        };
        effects.push_back(falloff_effect(seen.pilot, name, over_heights(seen, light), rms_over_points(seen, ev)));
    };
    add("vignetting", [](const Looks& exact, const Looks& pinhole, std::size_t i) {
        return pinhole[i].even_light > 0.0 ? std::optional(exact[i].even_light / pinhole[i].even_light) : std::nullopt;
    });
    add("cos4", [middle](const Looks&, const Looks& pinhole, std::size_t i) {
        return pinhole[i].even_light > 0.0 ? std::optional(pinhole[i].even_light / pinhole[middle].even_light)
                                           : std::nullopt;
    });
}

/// What the electronics behind the film do, where a scene has any: a pixel's noise, rms, of electrons, their reading
/// and rounding (RawSensor), and what is beyond saturation, cut.
Effect sensor(const Pilot& pilot) {
    Effect effect{.name = "sensor", .contribution = {}};
    if (!pilot.setup().sensor) {
        return effect;
    }
    const render::RawSensor& raw = *pilot.setup().sensor;
    const double saturated = raw.full_well_electrons * raw.base_iso / raw.camera.exposure.iso;
    const double dark = raw.dark_current_electrons_per_s * raw.camera.exposure.time_s;
    const double step = saturated / std::max(1, raw.white_level_dn - raw.black_level_dn);
    const double fixed = dark + raw.read_noise_electrons * raw.read_noise_electrons + step * step / 12.0;
    const std::array neutral = {raw.neutral.x, raw.neutral.y, raw.neutral.z};
    std::vector<double> ev;
    std::vector<formats::Image> cut = pilot.full().rgb;
    for (formats::Image& picture : cut) {
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            const double electrons = static_cast<double>(picture.pixels[i]) * neutral[i % 3] * saturated;
            if (electrons >= 1.0) {
                ev.push_back(std::log2(1.0 + std::sqrt(electrons + fixed) / electrons));
            }
            picture.pixels[i] = std::min(picture.pixels[i], static_cast<float>(1.0 / neutral[i % 3]));
        }
    }
    effect.contribution = difference(pilot, cut);
    effect.contribution.ev = rms(ev);
    return effect;
}

}  // namespace

std::vector<Effect> lens_effects(const Pilot& pilot) {
    const PilotSettings& settings = pilot.settings();
    const auto look_through = [&](const render::Camera& camera) {
        return look_at_points(camera, pilot.points(), settings.probe);
    };
    const auto look_by = [&](const char* name, render::LensModel model) {
        const render::SceneSetup setup = on_rung(pilot.setup(), {.name = name, .model = model});
        return look_through({setup.camera, setup.spectral, render::PixelFilter{}, settings.cache, true});
    };
    const PointLooks exact = look_through(pilot.camera());
    std::vector<Effect> effects;
    add_geometry({pilot, exact, look_by("thin-lens", render::LensModel::thin_lens)}, effects);
    add_third_order(pilot, effects);
    effects.push_back(defocus(pilot));
    add_falloff({pilot, exact, look_by("pinhole", render::LensModel::pinhole)}, effects);
    add_losses(pilot, axial_light(pilot), effects);
    effects.push_back(sensor(pilot));
    return effects;
}

}  // namespace lensproof::studies
