#include "experiments/studies/tradeoff/effects.h"

#include <algorithm>
#include <cmath>
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

/// A number of the probe's points over the image height.
template <class Of>
RadialMean over_heights(const Pilot& pilot, const Of& of) {
    std::vector<RadialMean::Sample> samples;
    for (std::size_t i = 0; i < pilot.points().size(); ++i) {
        if (const std::optional<double> value = of(i)) {
            samples.push_back({pilot.points()[i].image_height, *value});
        }
    }
    constexpr int kRings = 8;
    return {std::move(samples), kRings};
}

double outward(const Pilot& pilot, std::size_t point, const Vec2d& shift) {
    const Vec2d from = pilot.points()[point].at_px - pilot.setup().camera.sensor.axis();
    const double distance = std::hypot(from.x, from.y);
    return distance > 0.0 ? (shift.x * from.x + shift.y * from.y) / distance : 0.0;
}

void add_geometry(const Pilot& pilot, const std::vector<PointLook>& exact, const std::vector<PointLook>& thin,
                  std::vector<Effect>& effects) {
    const auto is_lit = [&](std::size_t i) { return exact[i].light[1] > 0.0 && thin[i].light[1] > 0.0; };
    const RadialMean distortion = over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
        return is_lit(i) ? std::optional(outward(pilot, i, exact[i].centroid[1] - thin[i].centroid[1])) : std::nullopt;
    });
    effects.push_back(shift_effect(pilot, "distortion", {distortion, distortion, distortion}));
    const auto against_green = [&](std::size_t c) {
        return over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
            return is_lit(i) && exact[i].light[c] > 0.0
                       ? std::optional(outward(pilot, i, exact[i].centroid[c] - exact[i].centroid[1]))
                       : std::nullopt;
        });
    };
    effects.push_back(shift_effect(pilot, "lateral-colour", {against_green(0), against_green(1), against_green(2)}));
    const RadialMean blur = over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
        return is_lit(i) ? std::optional(exact[i].spread_px[1]) : std::nullopt;
    });
    const auto height_of = [&](int x, int y) { return pilot.image_height(x, y); };
    effects.push_back(blur_effect(pilot, "aberration-blur", [&](int x, int y) { return blur.at(height_of(x, y)); }));
    // What red and blue are wider than green by.
    const RadialMean axial = over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
        const auto& spread = exact[i].spread_px;
        return is_lit(i) ? std::optional(std::sqrt(std::max(
                               0.0, 0.5 * (spread[0] * spread[0] + spread[2] * spread[2]) - spread[1] * spread[1])))
                         : std::nullopt;
    });
    effects.push_back(blur_effect(pilot, "axial-colour", [&](int x, int y) { return axial.at(height_of(x, y)); }));
}

/// A thin lens's discs at the depths that the pilot saw, rms radius in px: the diameter is f²/(N (s − f)) |d − s| / d.
Effect defocus(const Pilot& pilot) {
    const render::CameraSettings& settings = pilot.setup().camera;
    const optics::ParaxialData data =
        optics::paraxial_data(optics::at_wavelength<double>(pilot.camera().lens().value(), spectral::kLineD));
    const double focus = settings.focus_distance_mm;
    return blur_effect(pilot, "defocus",
                       [&, efl = std::abs(data.efl), aperture = data.entrance_pupil_diameter](int x, int y) {
                           const double depth = pilot.depth_mm(x, y);
                           const double nearness = std::isfinite(depth) && depth > 0.0 ? 1.0 / depth : 0.0;
                           const double focal_nearness = std::isfinite(focus) ? 1.0 / focus : 0.0;
                           const double image_mm = efl / (1.0 - efl * focal_nearness);
                           const double disc_mm = aperture * image_mm * std::abs(nearness - focal_nearness);
                           return disc_mm / std::sqrt(8.0) / settings.sensor.pixel_pitch_mm;
                       });
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
        effects.push_back(blur_effect(pilot, name, [&](int x, int y) {
            return px * std::abs(at_corner) * std::pow(pilot.image_height(x, y), power_of_field);
        }));
        effects.back().part_of = "aberration-blur";
    };
    add("spherical-aberration", total.s1 / 6.0, 0);
    add("coma", std::sqrt(2.0 / 3.0) * total.s2, 1);
    add("astigmatism", std::sqrt(0.5) * total.s3, 2);
    add("field-curvature", std::sqrt(0.5) * (2.0 * total.s3 + total.s4), 2);
}

void add_falloff(const Pilot& pilot, const std::vector<PointLook>& exact, const std::vector<PointLook>& thin,
                 std::vector<Effect>& effects) {
    const auto nearest = std::ranges::min_element(pilot.points(), {}, &ProbePoint::image_height);
    const auto middle = static_cast<std::size_t>(nearest - pilot.points().begin());
    const RadialMean cos4 = over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
        return thin[i].even_light > 0.0 ? std::optional(thin[i].even_light / thin[middle].even_light) : std::nullopt;
    });
    // Both pass the same along the axis.
    const RadialMean rims = over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
        return thin[i].even_light > 0.0 ? std::optional(exact[i].even_light / thin[i].even_light) : std::nullopt;
    });
    effects.push_back(falloff_effect(pilot, "vignetting", rims));
    effects.push_back(falloff_effect(pilot, "cos4", cos4));
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
    const render::SceneSetup thin_setup =
        on_rung(pilot.setup(), {.name = "thin-lens", .model = render::LensModel::thin_lens});
    const render::Camera thin_camera(thin_setup.camera, thin_setup.spectral, render::PixelFilter{}, settings.cache,
                                     true);
    const std::vector<PointLook> exact = look_at_points(pilot.camera(), pilot.points(), settings.probe);
    const std::vector<PointLook> thin = look_at_points(thin_camera, pilot.points(), settings.probe);
    std::vector<Effect> effects;
    add_geometry(pilot, exact, thin, effects);
    add_third_order(pilot, effects);
    effects.push_back(defocus(pilot));
    add_falloff(pilot, exact, thin, effects);
    add_losses(pilot, axial_light(pilot), effects);
    effects.push_back(sensor(pilot));
    return effects;
}

}  // namespace lensproof::studies
