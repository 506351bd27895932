#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/optics/barrel.h"
#include "engine/optics/ghost_path.h"
#include "engine/optics/trace.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/studies/tradeoff/effect_kinds.h"
#include "experiments/studies/tradeoff/picture_error.h"

namespace lensproof::studies {

using formats::Image;

namespace {

constexpr const char* kNone = "charts in an even world and lenses with mirrors have none";

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

/// The fraction of the picture's mean.
struct Veil {
    Measured fraction;
    double ns_per_sample = 0.0;  // of the pass that renders it
};

/// As an even veil over the picture.
Effect veil_effect(const Pilot& pilot, const std::string& name, const Veil& veil) {
    return {.name = name, .contribution = veil_contribution(pilot, veil.fraction), .ns_per_sample = veil.ns_per_sample};
}

/// Of a pass, by a few samples: its light over all that goes straight.
Veil quick_veil(const Pilot& pilot, const std::string& pass) {
    const Pilot::Pictures with = pilot.with_pass(pass);
    const Measured ev = picture_errors(with.rgb, pilot.full().rgb, pilot.settings().probe.threads).exposure_ev;
    const double gain = std::exp2(ev.value);
    return {.fraction = {gain - 1.0, std::numbers::ln2 * gain * ev.standard_error},
            .ns_per_sample = with.ns_per_sample};
}

/// The same, by many where a few do not show it to be within the tolerance.
Veil veil_of(const Pilot& pilot, const std::string& pass, const Tolerance& tolerance, KeptFilms& films) {
    const Veil quick = quick_veil(pilot, pass);
    if (keeps(veil_contribution(pilot, quick.fraction), tolerance)) {
        return quick;
    }
    const PassFilms& many = films.of(pass, pilot.settings().few_smooth_samples);
    return {.fraction = many.fraction(pilot), .ns_per_sample = many.ns_per_sample};
}

std::vector<Effect> found_by_passes(const Pilot& pilot, const Tolerance& tolerance, KeptFilms& films) {
    const Veil ghosts = veil_of(pilot, "ghosts", tolerance, films);
    const double most = ghosts.fraction.value + 2.0 * ghosts.fraction.standard_error;
    std::vector<Effect> effects = {veil_effect(pilot, "ghosts", ghosts),
                                   veil_effect(pilot, "faint-ghosts", {{most * most, 0.0}, ghosts.ns_per_sample})};
    effects[1].is_bound = true;
    const bool is_black = optics::Barrel(*pilot.camera().lens()).is_black();
    if (!is_black) {
        effects.push_back(veil_effect(pilot, "barrel", veil_of(pilot, "barrel", tolerance, films)));
    }
    for (Effect& effect : effects) {
        effect.pass = effect.name;
    }
    if (is_black) {
        effects.push_back({.name = "barrel", .contribution = {}});
    }
    return effects;
}

/// Where no pass renders it: what pairs of surfaces reflect along the axis, as if all of it fell on the film.
std::vector<Effect> bounds(const Pilot& pilot, const std::string& no_pass) {
    const optics::Lens& lens = pilot.camera().lens().value();
    const double fraction = lens.has_mirrors() ? 0.0
                                               : axial_ghosts(optics::at_wavelength<double>(lens, spectral::kLineD),
                                                              pilot.setup().camera.mirrors);
    std::vector<Effect> effects = {veil_effect(pilot, "ghosts", {{fraction, 0.0}}),
                                   veil_effect(pilot, "faint-ghosts", {{fraction * fraction, 0.0}}),
                                   {.name = "barrel", .contribution = {}}};
    for (Effect& effect : effects) {
        effect.is_bound = true;
        effect.no_pass = no_pass;
    }
    return effects;
}

std::vector<Effect> ghosts_and_barrel(const Pilot& pilot, const Tolerance& tolerance, KeptFilms& films) {
    if (!pilot.has_passes()) {
        return bounds(pilot, kNone);
    }
    try {
        return found_by_passes(pilot, tolerance, films);
    } catch (const InputError& error) {
        return bounds(pilot, error.what());
    }
}

/// What the edges of the stop send farther than a pixel, of a distant point's light: P λ f / (2 π² A r), P being the
/// stop's perimeter and A its area (Keller's law; integrated over streaks and between them), as an even veil. P / A
/// of a polygon is that of the circle around it over cos(π/n).
Effect diffraction_veil(const Pilot& pilot, double ns_per_sample) {
    const render::CameraSettings& camera = pilot.setup().camera;
    constexpr double kLambda_mm = 550e-6;
    const double polygon = camera.blades ? 1.0 / std::cos(kPi / camera.blades->blades) : 1.0;
    const double beyond =
        4.0 * polygon * kLambda_mm * camera.f_number / (2.0 * kPi * kPi * camera.sensor.pixel_pitch_mm);
    Effect effect = veil_effect(pilot, "diffraction", {{std::min(1.0, beyond), 0.0}, ns_per_sample});
    effect.contribution.ev = {};  // light that is moved
    effect.is_bound = true;
    return effect;
}

/// The rms width of an Airy disc does not exist; its core is a Gaussian's of σ = 0.42 λN.
Contribution airy_core(const Pilot& pilot) {
    constexpr double kSigma = 0.42;
    const double um = kSigma * 0.55 * pilot.setup().camera.f_number;
    const double px = std::numbers::sqrt2 * 1e-3 * um / pilot.setup().camera.sensor.pixel_pitch_mm;
    return blur_effect(pilot, "diffraction", [px](int, int) { return px; }, {px, 0.0}).contribution;
}

}  // namespace

Contribution veil_contribution(const Pilot& pilot, const Measured& fraction) {
    const auto with = [&](double part) {
        std::vector<Image> veiled;
        std::ranges::transform(pilot.full().rgb, std::back_inserter(veiled),
                               [&](const Image& picture) { return with_veil(picture, part); });
        return difference(pilot, veiled);
    };
    Contribution found = with(fraction.value);
    if (fraction.standard_error > 0.0) {
        const Contribution more = with(fraction.value + fraction.standard_error);
        const auto widen = [](Measured& part, const Measured& of_more) {
            part.standard_error = std::hypot(part.standard_error, of_more.value - part.value);
        };
        widen(found.ev, more.ev);
        widen(found.ciede2000, more.ciede2000);
    }
    return found;
}

std::vector<Effect> stray_effects(const Pilot& pilot, const Tolerance& tolerance, KeptFilms& films) {
    std::vector<Effect> effects = ghosts_and_barrel(pilot, tolerance, films);
    effects.push_back(diffraction_veil(pilot, effects.front().ns_per_sample));
    Effect& diffraction = effects.back();
    const Contribution core = airy_core(pilot);
    diffraction.contribution.px = core.px;
    diffraction.contribution.ciede2000 =
        std::ranges::max(diffraction.contribution.ciede2000, core.ciede2000, {}, &Measured::value);
    diffraction.no_pass = pilot.has_passes() ? pilot.why_no_pass("diffracted") : kNone;
    diffraction.pass = diffraction.no_pass.empty() ? "diffracted" : "";
    return effects;
}

}  // namespace lensproof::studies
