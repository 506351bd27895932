#include "experiments/studies/tradeoff/effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "engine/analysis/seidel.h"
#include "engine/optics/paraxial.h"
#include "engine/render/camera/gaussian_optics.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/studies/tradeoff/chief_images.h"
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
        const Vec3d& rgb = camera.film().rgb_weights[static_cast<std::size_t>(i)];
        light.white = light.white + rgb;
        light.all = light.all + render::axial_transmittance(lens, nm) * rgb;
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
    return rms_over_points(seen.exact, seen.model, of);
}

double outward(const Pilot& pilot, std::size_t point, const Vec2d& shift) {
    const Vec2d from = pilot.points()[point].at_px - pilot.setup().camera.sensor.axis();
    const double distance = std::hypot(from.x, from.y);
    return distance > 0.0 ? (shift.x * from.x + shift.y * from.y) / distance : 0.0;
}

/// A point's image in R, G and B: how far its chief rays land from where a pinhole puts them, how far those of a
/// colour's wavelengths from each other, and the rest of rays from these, mean squares in px². They add up to what the
/// exact camera does otherwise than a pinhole.
struct PointImage {
    std::array<Vec2d, 3> shift{};
    std::array<double, 3> squared_spread{};
    std::array<double, 3> squared_radius{};

    [[nodiscard]] Vec2d mean_shift() const { return (1.0 / 3.0) * (shift[0] + shift[1] + shift[2]); }
    /// From the mean, over all wavelengths.
    [[nodiscard]] double colour_shift() const {
        double squares = 0.0;
        for (std::size_t c = 0; c < shift.size(); ++c) {
            const Vec2d off = shift[c] - mean_shift();
            squares += off.x * off.x + off.y * off.y + squared_spread[c];
        }
        return std::sqrt(squares / 3.0);
    }
    /// Of the colour that is sharpest, and what all three are wider by.
    [[nodiscard]] double sharpest() const { return std::sqrt(std::ranges::min(squared_radius)); }
    [[nodiscard]] double colour_blur() const {
        const double mean = (squared_radius[0] + squared_radius[1] + squared_radius[2]) / 3.0;
        return std::sqrt(std::max(0.0, mean - std::ranges::min(squared_radius)));
    }
};

/// Where there are no chief rays the centroid stands for them, and where there is none of a colour's light, green.
PointImage image_of(const PointLook& exact, const PointLook& pinhole, const std::optional<ChiefImage>& chief) {
    PointImage image;
    for (std::size_t c = 0; c < image.shift.size(); ++c) {
        const std::size_t seen = exact.light[c] > 0.0 && pinhole.light[c] > 0.0 ? c : 1;
        const Vec2d at = chief ? chief->at[seen] : exact.centroid[seen];
        const Vec2d off = exact.centroid[seen] - at;
        image.shift[c] = at - pinhole.centroid[seen];
        image.squared_spread[c] = chief ? chief->squared_spread[seen] : 0.0;
        image.squared_radius[c] = std::max(0.0, exact.spread_px[seen] * exact.spread_px[seen] + off.x * off.x +
                                                    off.y * off.y - image.squared_spread[c]);
    }
    return image;
}

/// Beside a pinhole.
void add_geometry(const SeenPoints& seen, const std::vector<std::optional<ChiefImage>>& chief,
                  std::vector<Effect>& effects) {
    using Looks = std::vector<PointLook>;
    const Pilot& pilot = seen.pilot;
    // Only of points that both cameras see.
    const auto lit = [&](const auto& of) -> PointNumber {
        return [&, of](const Looks& exact, const Looks& pinhole, std::size_t i) -> std::optional<double> {
            if (!(exact[i].light[1] > 0.0 && pinhole[i].light[1] > 0.0)) {
                return std::nullopt;
            }
            return of(image_of(exact[i], pinhole[i], chief[i]), i);
        };
    };
    const auto length_of = [](const Vec2d& v) { return std::hypot(v.x, v.y); };
    const RadialMean distortion = over_heights(
        seen, lit([&](const PointImage& image, std::size_t i) { return outward(pilot, i, image.mean_shift()); }));
    effects.push_back(shift_effect(pilot, "distortion", {distortion, distortion, distortion},
                                   rms_over_points(seen, lit([&](const PointImage& image, std::size_t) {
                                                       return length_of(image.mean_shift());
                                                   }))));
    const auto colour = [&](std::size_t c) {
        return over_heights(seen, lit([&, c](const PointImage& image, std::size_t i) {
                                return outward(pilot, i, image.shift[c] - image.mean_shift());
                            }));
    };
    effects.push_back(shift_effect(
        pilot, "lateral-colour", {colour(0), colour(1), colour(2)},
        rms_over_points(seen, lit([](const PointImage& image, std::size_t) { return image.colour_shift(); }))));
    const auto add_blur = [&](const char* name, const PointNumber& of) {
        const RadialMean spread = over_heights(seen, of);
        effects.push_back(blur_effect(
            pilot, name, [&](int x, int y) { return spread.at(pilot.image_height(x, y)); }, rms_over_points(seen, of)));
    };
    add_blur("aberration-blur", lit([](const PointImage& image, std::size_t) { return image.sharpest(); }));
    add_blur("axial-colour", lit([](const PointImage& image, std::size_t) { return image.colour_blur(); }));
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
    const render::SceneSetup pinhole = on_rung(pilot.setup(), {.name = "pinhole", .model = render::LensModel::pinhole});
    const SeenPoints beside_pinhole{
        pilot, look_through(pilot.camera()),
        look_through({pinhole.camera, pinhole.spectral, render::PixelFilter{}, settings.cache, true})};
    std::vector<Effect> effects;
    add_geometry(beside_pinhole, chief_images(pilot.camera(), pilot.points(), settings.probe.threads), effects);
    add_third_order(pilot, effects);
    effects.push_back(defocus(pilot));
    add_falloff(beside_pinhole, effects);
    add_losses(pilot, axial_light(pilot), effects);
    effects.push_back(sensor(pilot));
    return effects;
}

}  // namespace lensproof::studies
