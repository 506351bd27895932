#include "experiments/studies/tradeoff/effects.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

#include "engine/optics/ghost_path.h"
#include "engine/optics/paraxial.h"
#include "engine/optics/trace.h"
#include "engine/render/film/film_image.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/studies/tradeoff/pilot_changes.h"
#include "experiments/studies/tradeoff/processor_time.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

using formats::Image;

Pilot::Pilot(const render::SceneSetup& setup, const PilotSettings& settings)
    : setup_(on_rung(setup, {.name = kReferenceRung})),
      small_(with_pixels(setup_, settings.pixels)),
      settings_(settings),
      camera_(std::make_unique<render::Camera>(setup_.camera, setup_.spectral, render::PixelFilter{}, settings.cache,
                                               true)),
      points_(probe_points(*camera_, settings.points)),
      full_(render(setup_, 0)) {
    find_depth();
}

Pilot::Pictures Pilot::render(const render::SceneSetup& setup, int first_seed) const {
    const render::PreparedScene scene(with_pixels(setup, settings_.pixels), render::PixelFilter{}, settings_.cache);
    Pictures pictures;
    const double start = processor_seconds();
    for (int seed = 0; seed < settings_.seeds; ++seed) {
        const render::Film film = render::render_film(
            scene.render(settings_.probe.seed + static_cast<std::uint64_t>(first_seed + seed), false),
            {.first = 0, .end = static_cast<std::uint32_t>(settings_.samples)}, settings_.probe.threads);
        pictures.rgb.push_back(render::film_rgb(film));
    }
    const double samples = static_cast<double>(width()) * height() * settings_.samples * settings_.seeds;
    pictures.ns_per_sample = 1e9 * (processor_seconds() - start) / samples;
    return pictures;
}

void Pilot::find_depth() {
    depth_.assign(static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()),
                  std::numeric_limits<double>::quiet_NaN());
    if (setup_.chart) {
        std::ranges::fill(depth_, setup_.chart->placement.distance_mm);
        return;
    }
    render::SceneSetup sharp = small_;
    sharp.max_bounces = 0;
    const render::PreparedScene scene(sharp, render::PixelFilter{}, settings_.cache);
    const render::Film film =
        render::render_film(scene.render(settings_.probe.seed, true), {.first = 0, .end = 4}, settings_.probe.threads);
    for (int y = 0; y < height(); ++y) {
        for (int x = 0; x < width(); ++x) {
            if (film.coverage(x, y) > 0.0) {
                depth_[index(x, y)] = film.features(x, y).depth_mm;
            }
        }
    }
}

double Pilot::image_height(int x, int y) const {
    const render::Sensor& sensor = small_.camera.sensor;
    return std::hypot(x - sensor.axis().x, y - sensor.axis().y) * sensor.pixel_pitch_mm / sensor.half_diagonal_mm();
}

Vec2d Pilot::outwards(int x, int y) const {
    const Vec2d from = Vec2d{static_cast<double>(x), static_cast<double>(y)} - small_.camera.sensor.axis();
    const double distance = std::hypot(from.x, from.y);
    return distance > 0.0 ? (1.0 / distance) * from : Vec2d{};
}

double Pilot::noise_of_sample() const {
    return relative_noise(full_.rgb) * std::sqrt(static_cast<double>(settings_.samples));
}

namespace {

Measured rms(const std::vector<double>& values) {
    double sum = 0.0;
    double fourth = 0.0;
    for (const double value : values) {
        sum += value * value;
        fourth += value * value * value * value;
    }
    const auto n = static_cast<double>(std::max<std::size_t>(1, values.size()));
    return root({sum / n, std::sqrt(std::max(0.0, fourth / n - std::pow(sum / n, 2)) / n)});
}

/// What the pilot's picture loses or gains by a change that is done to each of its seeds.
Measured seen(const Pilot& pilot, const std::function<Image(const Image&)>& change) {
    std::vector<Image> changed;
    std::ranges::transform(pilot.full().rgb, std::back_inserter(changed), change);
    return picture_errors(changed, pilot.full().rgb, pilot.settings().probe.threads).ciede2000.bias;
}

/// Of light along the axis, at each stratum: what surfaces and glass leave, the glass alone, and what of it comes by
/// two reflections and by four at most.
struct AxialLight {
    Vec3d white;  // R, G, B of a lens without losses
    Vec3d all;
    Vec3d glass;  // absorption alone
    double ghosts = 0.0;
    double faint_ghosts = 0.0;
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

/// The light of all pairs of surfaces over that which goes straight through.
double axial_ghosts(const optics::TraceLens<double>& lens, const optics::StrayMirrors<double>& mirrors) {
    const Ray<double> axis{{0.0, 0.0, lens.surfaces.front().vertex_z - 1.0}, {0.0, 0.0, 1.0}};
    const auto straight = optics::trace<optics::Direction::forward>(lens, axis);
    const int surfaces = static_cast<int>(lens.surfaces.size());
    double sum = 0.0;
    for (int last = 1; last <= surfaces; ++last) {
        for (int first = 0; first < last; ++first) {
            const optics::GhostPath path{last, first};
            if (optics::path_fault(path, surfaces).empty()) {
                const auto ghost =
                    optics::trace_ghost<optics::Direction::forward, optics::Rims::follow>(lens, path, axis, mirrors);
                sum += ghost.status == optics::RayStatus::ok ? ghost.transmittance : 0.0;
            }
        }
    }
    return straight.transmittance > 0.0 ? sum / straight.transmittance : 0.0;
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
    if (!lens.has_mirrors()) {
        light.ghosts =
            axial_ghosts(optics::at_wavelength<double>(lens, spectral::kLineD), pilot.setup().camera.mirrors);
        light.faint_ghosts = light.ghosts * light.ghosts;
    }
    return light;
}

Vec3d ratio(const Vec3d& a, const Vec3d& b) {
    const auto over = [](double x, double y) { return y != 0.0 ? x / y : 1.0; };
    return {over(a.x, b.x), over(a.y, b.y), over(a.z, b.z)};
}

/// One constant gain for all of the picture.
Effect gain_effect(const Pilot& pilot, const std::string& name, const Vec3d& gain) {
    return {.name = name,
            .contribution = {
                .px = {}, .ev = {std::abs(std::log2(gain.y)), 0.0}, .ciede2000 = seen(pilot, [&](const Image& picture) {
                                                                        return with_gain(
                                                                            picture, [&](int, int) { return gain; });
                                                                    })}};
}

void add_losses(const Pilot& pilot, const AxialLight& light, std::vector<Effect>& effects) {
    const Vec3d surfaces = ratio(light.glass, light.all);  // without Fresnel's losses there would be so much more
    effects.push_back(gain_effect(pilot, "fresnel-loss", {surfaces.y, surfaces.y, surfaces.y}));
    effects.push_back(gain_effect(pilot, "coating-colour", {surfaces.x / surfaces.y, 1.0, surfaces.z / surfaces.y}));
    effects.push_back(gain_effect(pilot, "absorption", ratio(light.white, light.glass)));
}

/// Light of ghosts as an even veil, as bright as the share of the picture's mean.
Effect veil_effect(const Pilot& pilot, const std::string& name, double share) {
    Vec3d mean;
    const Image& first = pilot.full().rgb.front();
    const double pixels = static_cast<double>(first.width) * first.height;
    std::vector<double> luminances;
    for (int y = 0; y < first.height; ++y) {
        for (int x = 0; x < first.width; ++x) {
            mean = mean + (1.0 / pixels) * Vec3d{static_cast<double>(first.at(x, y, 0)),
                                                 static_cast<double>(first.at(x, y, 1)),
                                                 static_cast<double>(first.at(x, y, 2))};
        }
    }
    // Where there is light: what a veil does to a black corner is told by the colours.
    double squares = 0.0;
    double light = 0.0;
    for (int y = 0; y < first.height; ++y) {
        for (int x = 0; x < first.width; ++x) {
            const auto green = static_cast<double>(first.at(x, y, 1));
            if (green > 0.0) {
                squares += green * std::pow(std::log2(1.0 + share * mean.y / green), 2);
                light += green;
            }
        }
    }
    Effect effect{.name = name, .is_bound = true};
    effect.contribution.ev = {light > 0.0 ? std::sqrt(squares / light) : 0.0, 0.0};
    effect.contribution.ciede2000 = seen(pilot, [&](Image picture) {
        for (std::size_t i = 0; i + 2 < picture.pixels.size(); i += 3) {
            picture.pixels[i] += static_cast<float>(share * mean.x);
            picture.pixels[i + 1] += static_cast<float>(share * mean.y);
            picture.pixels[i + 2] += static_cast<float>(share * mean.z);
        }
        return picture;
    });
    return effect;
}

/// How a blur of that rms radius, in the scene's pixels, is seen.
Effect blur_effect(const Pilot& pilot, const std::string& name, const PixelSpread& spread_px) {
    std::vector<double> all;
    for (int y = 0; y < pilot.height(); ++y) {
        for (int x = 0; x < pilot.width(); ++x) {
            all.push_back(spread_px(x, y));
        }
    }
    const auto blurred = [&](const Image& picture) { return with_spread(picture, spread_px); };
    return {.name = name, .contribution = {.px = rms(all), .ev = {}, .ciede2000 = seen(pilot, blurred)}};
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

/// Radial shifts of R, G and B.
Effect shift_effect(const Pilot& pilot, const std::string& name, const std::array<RadialMean, 3>& shift_px) {
    std::vector<double> all;
    for (int y = 0; y < pilot.height(); ++y) {
        for (int x = 0; x < pilot.width(); ++x) {
            double square = 0.0;
            for (const RadialMean& shift : shift_px) {
                square += std::pow(shift.at(pilot.image_height(x, y)), 2) / 3.0;
            }
            all.push_back(std::sqrt(square));
        }
    }
    return {.name = name,
            .contribution = {.px = rms(all), .ev = {}, .ciede2000 = seen(pilot, [&](const Image& picture) {
                                                           return with_shift(picture, [&](int x, int y, int c) {
                                                               const double by =
                                                                   shift_px[static_cast<std::size_t>(c)].at(
                                                                       pilot.image_height(x, y));
                                                               return by * pilot.outwards(x, y);
                                                           });
                                                       })}};
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

/// The rms width of an Airy disc does not exist; its core is a Gaussian's of σ = 0.42 λN.
Effect diffraction(const Pilot& pilot) {
    constexpr double kSigma = 0.42;
    const double um = kSigma * 0.55 * pilot.setup().camera.f_number;
    const double px = std::sqrt(2.0) * 1e-3 * um / pilot.setup().camera.sensor.pixel_pitch_mm;
    return blur_effect(pilot, "diffraction", [px](int, int) { return px; });
}

/// Brightness over the frame that falls as `light` says, 1 on the axis: without it the picture would be brighter.
Effect falloff_effect(const Pilot& pilot, const std::string& name, const RadialMean& light) {
    std::vector<double> ev;
    for (int y = 0; y < pilot.height(); ++y) {
        for (int x = 0; x < pilot.width(); ++x) {
            ev.push_back(std::log2(std::max(1e-3, light.at(pilot.image_height(x, y)))));
        }
    }
    return {.name = name,
            .contribution = {.px = {}, .ev = rms(ev), .ciede2000 = seen(pilot, [&](const Image& picture) {
                                                          return with_gain(picture, [&](int x, int y) {
                                                              const double gain =
                                                                  1.0 /
                                                                  std::max(1e-3, light.at(pilot.image_height(x, y)));
                                                              return Vec3d{gain, gain, gain};
                                                          });
                                                      })}};
}

void add_falloff(const Pilot& pilot, const std::vector<PointLook>& exact, const std::vector<PointLook>& thin,
                 std::vector<Effect>& effects) {
    const auto nearest = std::ranges::min_element(pilot.points(), {}, &ProbePoint::image_height);
    const auto middle = static_cast<std::size_t>(nearest - pilot.points().begin());
    const RadialMean cos4 = over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
        return thin[i].even_light > 0.0 ? std::optional(thin[i].even_light / thin[middle].even_light) : std::nullopt;
    });
    const RadialMean rims = over_heights(pilot, [&](std::size_t i) -> std::optional<double> {
        const double of_thin = thin[i].even_light / thin[middle].even_light;
        return of_thin > 0.0 ? std::optional(exact[i].even_light / exact[middle].even_light / of_thin) : std::nullopt;
    });
    effects.push_back(falloff_effect(pilot, "vignetting", rims));
    effects.push_back(falloff_effect(pilot, "cos4", cos4));
}

/// By a pass of its own where the lens's walls are not black.
Effect barrel(const Pilot& pilot) {
    Effect effect{.name = "barrel", .contribution = {}};
    const PilotSettings& settings = pilot.settings();
    if (pilot.setup().chart || pilot.camera().lens()->barrel.is_black()) {
        return effect;
    }
    const render::PreparedScene scene(with_pixels(pilot.setup(), settings.pixels), render::PixelFilter{},
                                      settings.cache);
    std::vector<Image> with;
    for (int seed = 0; seed < settings.seeds; ++seed) {
        const std::vector<render::Render> passes =
            scene.render(std::vector<std::string>{"imaged", "barrel"},
                         settings.probe.seed + static_cast<std::uint64_t>(seed), false);
        const Image light = render::film_rgb(render::render_film(
            passes[1], {.first = 0, .end = static_cast<std::uint32_t>(settings.samples)}, settings.probe.threads));
        with.push_back(pilot.full().rgb[static_cast<std::size_t>(seed)]);
        std::ranges::transform(with.back().pixels, light.pixels, with.back().pixels.begin(), std::plus<>());
    }
    effect.contribution = difference(pilot, with);
    return effect;
}

}  // namespace

Contribution difference(const Pilot& pilot, const std::vector<Image>& without) {
    const PictureErrors found = picture_errors(without, pilot.full().rgb, pilot.settings().probe.threads);
    return {.px = {},
            .ev = {std::abs(found.exposure_ev.value), found.exposure_ev.standard_error},
            .ciede2000 = found.ciede2000.bias};
}

std::vector<Effect> lens_effects(const Pilot& pilot) {
    const PilotSettings& settings = pilot.settings();
    const render::SceneSetup thin_setup =
        on_rung(pilot.setup(), {.name = "thin-lens", .model = render::LensModel::thin_lens});
    const render::Camera thin_camera(thin_setup.camera, thin_setup.spectral, render::PixelFilter{}, settings.cache,
                                     true);
    const std::vector<PointLook> exact = look_at_points(pilot.camera(), pilot.points(), settings.probe);
    const std::vector<PointLook> thin = look_at_points(thin_camera, pilot.points(), settings.probe);
    const AxialLight light = axial_light(pilot);
    std::vector<Effect> effects;
    add_geometry(pilot, exact, thin, effects);
    effects.push_back(defocus(pilot));
    effects.push_back(diffraction(pilot));
    add_falloff(pilot, exact, thin, effects);
    add_losses(pilot, light, effects);
    effects.push_back(veil_effect(pilot, "ghosts", light.ghosts));
    effects.push_back(veil_effect(pilot, "faint-ghosts", light.faint_ghosts));
    effects.push_back(barrel(pilot));
    return effects;
}

}  // namespace lensproof::studies
