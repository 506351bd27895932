#include "experiments/studies/tradeoff/effect_account.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"
#include "experiments/studies/tradeoff/picture_error.h"
#include "experiments/studies/tradeoff/spot_check.h"

namespace lensproof::studies {

void fields(JsonArchive& json, Contribution& contribution) {
    json.field("px", contribution.px).field("ev", contribution.ev).field("ciede2000", contribution.ciede2000);
}

void fields(JsonArchive& json, EffectAccount& account) {
    json.field("effects", account.effects)
        .field("is_bound", account.is_bound)
        .field("predicted", account.predicted)
        .field("measured", account.measured);
}

namespace {

/// Two models that differ in nothing but these effects.
struct Pair {
    std::vector<std::string> effects;
    const char* without;
    const char* with;
};

const std::vector<Pair>& pairs() {
    static const std::vector<Pair> all = {
        {{"defocus"}, "pinhole", "thin-lens"},
        {{"distortion", "lateral-colour", "vignetting"}, "pinhole", "pinhole-profile"},
        {{"aberration-blur", "axial-colour"}, "thin-lens-profile", kReferenceRung}};
    return all;
}

Measured together(const Measured& a, const Measured& b) {
    const double value = std::hypot(a.value, b.value);
    const double error = std::hypot(a.value * a.standard_error, b.value * b.standard_error);
    return {value, value > 0.0 ? error / value : std::hypot(a.standard_error, b.standard_error)};
}

const PlannedEffect& planned_effect(const Plan& plan, const std::string& name) {
    return *std::ranges::find_if(plan.effects,
                                 [&](const PlannedEffect& planned) { return planned.effect.name == name; });
}

class Accountant {
  public:
    Accountant(const render::SceneSetup& setup, const Plan& plan, const PilotSettings& settings)
        : plan_(plan), pilot_(setup, settings) {}

    std::vector<EffectAccount> all() {
        for (const Pair& pair : pairs()) {
            try {
                add(pair.effects, between(pair));
            } catch (const InputError&) {  // this lens has no such model
            }
        }
        const std::vector<std::string> passes = accountable_passes(plan_);
        for (const PlannedEffect& planned : plan_.effects) {
            if (std::ranges::count(passes, planned.effect.pass) > 0) {
                add({planned.effect.name}, difference(pilot_, pilot_.with_pass(planned.effect.pass).rgb));
            }
        }
        if (plan_.render.rung.wavelengths) {
            add_reduced("wavelengths", on_rung(pilot_.setup(),
                                               {.name = kReferenceRung, .wavelengths = plan_.render.rung.wavelengths}));
        }
        if (plan_.render.max_bounces < pilot_.setup().max_bounces) {
            render::SceneSetup fewer = pilot_.setup();
            fewer.max_bounces = plan_.render.max_bounces;
            add_reduced("global-illumination", fewer);
        }
        return std::move(accounts_);
    }

  private:
    void add(const std::vector<std::string>& effects, const Contribution& measured) {
        EffectAccount account{.effects = fmt::format("{}", fmt::join(effects, ", ")), .measured = measured};
        for (const std::string& name : effects) {
            const Effect& effect = planned_effect(plan_, name).effect;
            account.is_bound = effect.is_bound;
            account.predicted.px = together(account.predicted.px, effect.contribution.px);
            account.predicted.ev = together(account.predicted.ev, effect.contribution.ev);
            account.predicted.ciede2000 = together(account.predicted.ciede2000, effect.contribution.ciede2000);
        }
        if (!(measured.px.value > 0.0)) {  // nothing measures it
            account.predicted.px = {};
        }
        accounts_.push_back(std::move(account));
    }

    void add_reduced(const std::string& effect, const render::SceneSetup& setup) {
        add({effect}, difference(pilot_, pilot_.render(setup, {}, 0).rgb));
    }

    [[nodiscard]] Contribution between(const Pair& pair) const {
        const auto setup_of = [&](const char* name) {
            return on_rung(pilot_.setup(), *std::ranges::find(ladder(), name, &Rung::name));
        };
        const PilotSettings& settings = pilot_.settings();
        const render::SceneSetup without = setup_of(pair.without);
        const render::SceneSetup with = setup_of(pair.with);
        const render::Camera camera_without(without.camera, without.spectral, {}, settings.cache, true);
        const render::Camera camera_with(with.camera, with.spectral, {}, settings.cache, true);
        const FieldError field = field_errors(camera_with, camera_without, pilot_.points(), settings.probe).frame;
        const SpotCheckSettings windows{
            .samples = settings.samples, .threads = settings.probe.threads, .cache = settings.cache};
        const std::uint64_t seed = settings.probe.seed;
        const PictureErrors seen = picture_errors(window_pictures(without, seed, windows),
                                                  window_pictures(with, seed + 2, windows), settings.probe.threads);
        // Points are in focus: there a thin lens has no discs.
        const bool is_defocus = pair.effects.front() == "defocus";
        return {.px = is_defocus ? Measured{} : together(field.image_px, field.blur_px),
                .ev = is_defocus ? Measured{} : field.exposure_ev,
                .ciede2000 = seen.ciede2000.bias};
    }

    const Plan& plan_;
    Pilot pilot_;
    std::vector<EffectAccount> accounts_;
};

}  // namespace

std::vector<EffectAccount> account_effects(const render::SceneSetup& setup, const Plan& plan,
                                           const PilotSettings& settings) {
    return Accountant(setup, plan, settings).all();
}

bool covers(const Measured& predicted, const Measured& measured, bool is_bound) {
    const double more = measured.value - predicted.value;
    return (is_bound ? more : std::abs(more)) <= 2.0 * std::hypot(predicted.standard_error, measured.standard_error);
}

}  // namespace lensproof::studies
