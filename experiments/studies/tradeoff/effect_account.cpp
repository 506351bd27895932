#include "experiments/studies/tradeoff/effect_account.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"
#include "experiments/studies/tradeoff/picture_error.h"
#include "experiments/studies/tradeoff/pilot_changes.h"
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

struct Pair {
    const char* without = nullptr;
    const char* with = nullptr;
};

constexpr const char* kThinLens = "thin-lens";
constexpr const char* kClosedDown = "closed-down";  // the lens itself, whose rays are nearly its chief rays
constexpr double kClosedDownTo = 64.0;              // f-number

/// Models that differ in nothing but these effects: in where light is, in how much there is, and in how pictures look,
/// which are as far out of focus as the scene's.
struct Tellers {
    std::vector<std::string> effects;
    Pair places;
    Pair light;
    Pair seen;
};

const std::vector<Tellers>& tellers() {
    static const std::vector<Tellers> all = {{{"defocus"}, {}, {}, {"pinhole", kThinLens}},
                                             {{"distortion", "lateral-colour", "vignetting"},
                                              {"pinhole", kClosedDown},
                                              {"pinhole", "pinhole-profile"},
                                              {kThinLens, "thin-lens-profile"}},
                                             {{"aberration-blur", "axial-colour"},
                                              {kClosedDown, kReferenceRung},
                                              {"thin-lens-profile", kReferenceRung},
                                              {"thin-lens-profile", kReferenceRung}}};
    return all;
}

/// How far the images of points are moved and widened, rms over colours too.
Measured image_change(const PointLooks& without, const PointLooks& with) {
    return rms_over_points(without, with, [](const auto& one, const auto& other, std::size_t i) {
        double squares = 0.0;
        double colours = 0.0;
        for (std::size_t c = 0; c < one[i].light.size(); ++c) {
            if (one[i].light[c] > 0.0 && other[i].light[c] > 0.0) {
                const Vec2d moved = other[i].centroid[c] - one[i].centroid[c];
                const double wider = std::pow(other[i].spread_px[c], 2) - std::pow(one[i].spread_px[c], 2);
                squares += moved.x * moved.x + moved.y * moved.y + std::max(0.0, wider);
                colours += 1.0;
            }
        }
        return colours > 0.0 ? std::optional(std::sqrt(squares / colours)) : std::nullopt;
    });
}

Measured exposure_change(const PointLooks& without, const PointLooks& with) {
    return rms_over_points(without, with, [](const auto& one, const auto& other, std::size_t i) {
        return one[i].even_light > 0.0 && other[i].even_light > 0.0
                   ? std::optional(std::log2(other[i].even_light / one[i].even_light))
                   : std::nullopt;
    });
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
        for (const Tellers& telling : tellers()) {
            try {
                add(telling.effects, told_by(telling));
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

    [[nodiscard]] render::SceneSetup setup_of(const std::string& model) const {
        return on_rung(pilot_.setup(), *std::ranges::find(ladder(), model, &Rung::name));
    }

    [[nodiscard]] PointLooks look_by(const std::string& model) const {
        const bool is_closed = model == kClosedDown;
        render::SceneSetup setup = setup_of(is_closed ? kReferenceRung : model);
        setup.camera.f_number = is_closed ? std::max(setup.camera.f_number, kClosedDownTo) : setup.camera.f_number;
        return look_at_points({setup.camera, setup.spectral, {}, pilot_.settings().cache, true}, pilot_.points(),
                              pilot_.settings().probe);
    }

    /// Windows by a model, a thin lens being as bright as a pinhole: its flat pupil is darker (experiments/README.md).
    [[nodiscard]] std::vector<formats::Image> windows_by(const std::string& model, std::uint64_t first_seed) const {
        const PilotSettings& settings = pilot_.settings();
        std::vector<formats::Image> pictures =
            window_pictures(setup_of(model), first_seed,
                            {.samples = settings.samples, .threads = settings.probe.threads, .cache = settings.cache});
        if (model == kThinLens) {
            const auto middle = std::ranges::min_element(pilot_.points(), {}, &ProbePoint::image_height);
            const auto axial = [&](const char* of) {
                return look_by(of).back()[static_cast<std::size_t>(middle - pilot_.points().begin())].even_light;
            };
            const double gain = axial("pinhole") / axial(kThinLens);
            for (formats::Image& picture : pictures) {
                picture = with_gain(picture, [gain](int, int) { return Vec3d{gain, gain, gain}; });
            }
        }
        return pictures;
    }

    [[nodiscard]] Contribution told_by(const Tellers& telling) const {
        const std::uint64_t seed = pilot_.settings().probe.seed;
        const PictureErrors seen =
            picture_errors(windows_by(telling.seen.without, seed), windows_by(telling.seen.with, seed + 2),
                           pilot_.settings().probe.threads);
        Contribution told{.px = {}, .ev = {}, .ciede2000 = seen.ciede2000.bias};
        if (telling.places.with != nullptr) {  // points are in focus: there a thin lens has no discs
            told.px = image_change(look_by(telling.places.without), look_by(telling.places.with));
            told.ev = exposure_change(look_by(telling.light.without), look_by(telling.light.with));
        }
        return told;
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

bool covers(const Measured& predicted, const Measured& measured, bool is_bound, double slack) {
    const double more = measured.value - predicted.value;
    return (is_bound ? more : std::abs(more)) <=
           std::max(slack, 2.0 * std::hypot(predicted.standard_error, measured.standard_error));
}

}  // namespace lensproof::studies
