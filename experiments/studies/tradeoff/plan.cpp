#include "experiments/studies/tradeoff/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <span>

#include "engine/base/input_error.h"
#include "experiments/studies/tradeoff/effect_kinds.h"
#include "experiments/studies/tradeoff/smooth_light.h"

namespace lensproof::studies {

namespace {

/// A way to render that leaves effects out, and which it has.
struct CandidateRender {
    Rung rung;
    std::vector<std::string> has;
};

/// From the cheapest on. Losses along the axis and cos⁴ are in all of them.
const std::vector<CandidateRender>& candidates() {
    static const std::vector<CandidateRender> all = [] {
        std::vector<CandidateRender> list;
        const auto named = [](const char* name) { return *std::ranges::find(ladder(), name, &Rung::name); };
        const std::vector<std::string> profile = {"distortion", "lateral-colour", "vignetting"};
        std::vector<std::string> sharp = profile;
        sharp.emplace_back("defocus");
        list.push_back({named("pinhole"), {}});
        list.push_back({named("thin-lens"), {"defocus"}});
        list.push_back({named("pinhole-profile"), profile});
        list.push_back({named("thin-lens-profile"), sharp});
        std::vector<std::string> all_of_it = sharp;
        all_of_it.insert(all_of_it.end(), {"aberration-blur", "axial-colour"});
        list.push_back({named("exact-float"), all_of_it});
        list.push_back({named(kReferenceRung), all_of_it});
        return list;
    }();
    return all;
}

bool belongs_to_camera(const std::string& effect) {
    return std::ranges::count(
               std::array{"distortion", "lateral-colour", "vignetting", "defocus", "aberration-blur", "axial-colour"},
               effect) > 0;
}

bool is_reference_render(const CandidateRender& candidate) {
    return candidate.rung.name == kReferenceRung;
}

/// Fewer bounces or wavelengths.
struct Reduced {
    int value = 0;         // that is enough
    Contribution without;  // of the largest value that is not, or of the least of all where that is enough
    double ns_per_sample = 0.0;
};

/// What the planned samples of a pass are fewer by.
double fewer(const PlannedRender& planned, const std::string& pass) {
    const auto smooth = std::ranges::find(planned.smooth, pass, &render::SmoothPass::pass);
    return smooth == planned.smooth.end() ? 1.0 : smooth->fewer;
}

/// Of a planned render: its stray passes are in it where `full` has any.
PlannedCheck check(const Pilot& pilot, const PlannedRender& planned, const std::vector<std::string>& passes,
                   const Pilot::Pictures& full) {
    const PilotSettings& settings = pilot.settings();
    const render::SceneSetup setup = planned_setup(pilot.setup(), planned);
    const render::Camera camera(setup.camera, setup.spectral, render::PixelFilter{}, settings.cache, true);
    const FieldErrors field = field_errors(pilot.camera(), camera, pilot.points(), settings.probe);
    const Pilot::Pictures pictures = pilot.render(setup, passes, settings.seeds);  // as those of the full model
    const PictureErrors found = picture_errors(pictures.rgb, full.rgb, settings.probe.threads);
    const Measured& image = field.frame.image_px;
    const Measured& blur = field.frame.blur_px;
    const Measured whole = {std::abs(found.exposure_ev.value), found.exposure_ev.standard_error};
    double spared_ns = 0.0;
    for (const auto& [pass, ns] : pictures.stray_ns) {
        spared_ns += ns - ns / fewer(planned, pass);
    }
    return {
        .error = {.px = {std::hypot(image.value, blur.value), std::hypot(image.standard_error, blur.standard_error)},
                  .ev = std::ranges::max(field.frame.exposure_ev, whole, {}, &Measured::value),
                  .ciede2000 = found.ciede2000.bias},
        .ns_per_sample = pictures.ns_per_sample - spared_ns,
        .full_ns_per_sample = full.ns_per_sample};
}

/// Adds what smoothing takes from these passes.
void add_smoothing(const Pilot& pilot, const PlannedRender& planned, const std::vector<std::string>& passes,
                   Contribution& error) {
    const auto add = [](Measured& sum, const Measured& more) {
        sum = {sum.value + more.value, std::hypot(sum.standard_error, more.standard_error)};
    };
    for (const render::SmoothPass& smooth : planned.smooth) {
        if (std::ranges::count(passes, smooth.pass) == 0) {
            continue;
        }
        const auto samples = static_cast<std::uint32_t>(pilot.settings().smooth_samples);
        const PassFilms films = pass_films(pilot, smooth.pass, pilot.settings().seeds, {.first = 0, .end = samples});
        const Contribution lost = veil_contribution(pilot, films.smoothness(pilot).lost(smooth.sigma_px));
        add(error.ev, lost.ev);
        add(error.ciede2000, lost.ciede2000);
    }
}

/// Parts of a time that are saved.
double saved_percent(double full, double reduced) {
    return full > 0.0 ? std::clamp(100.0 * (1.0 - reduced / full), 0.0, 100.0) : 0.0;
}

class Planner {
  public:
    Planner(const render::SceneSetup& setup, const Tolerance& tolerance, const PilotSettings& settings)
        : pilot_(setup, settings), tolerance_(tolerance) {}

    Plan make() {
        plan_.tolerance = tolerance_;
        plan_.render.rung = {.name = kReferenceRung};
        plan_.render.max_bounces = pilot_.setup().max_bounces;
        for (Effect& effect : lens_effects(pilot_)) {
            plan(std::move(effect));
        }
        std::vector<Effect> stray = stray_effects(pilot_, tolerance_, films_);
        full_ns_ = pilot_.full().ns_per_sample;
        for (const Effect& effect : stray) {
            full_ns_ += effect.ns_per_sample;
        }
        decide_stray_light(std::move(stray));
        choose_smoothings();
        const auto cheapest = std::ranges::find_if(candidates(), [&](const CandidateRender& candidate) {
            return is_reference_render(candidate) || without(candidate).keeps(tolerance_);
        });
        budget_ = without(*cheapest);
        choose_wavelengths();
        choose_bounces();
        choose_camera({cheapest, candidates().end()});
        plan_.noise_ev = std::log2(1.0 + pilot_.noise_of_sample() /
                                             std::sqrt(static_cast<double>(pilot_.setup().samples_per_pixel)));
        return std::move(plan_);
    }

  private:
    /// Renders of the scene with less of something, from the least on, until what that leaves out may be left out too.
    template <class With>
    Reduced enough_of(const std::vector<int>& values, int all, const With& with) {
        Reduced found{.value = all, .without = {}, .ns_per_sample = pilot_.full().ns_per_sample};
        for (const int value : values) {
            if (value >= all) {
                break;
            }
            const Pilot::Pictures pictures = pilot_.render(with(value), {}, 0);
            found.without = difference(pilot_, pictures.rgb);
            LeftOut more = budget_;
            more.add(found.without);
            if (more.keeps(tolerance_)) {
                budget_ = more;
                return {.value = value, .without = found.without, .ns_per_sample = pictures.ns_per_sample};
            }
        }
        return found;
    }

    void choose_wavelengths() {
        const int all = pilot_.setup().spectral.strata();
        const Reduced found = enough_of({4, 8, 16, 32}, all, [&](int count) {
            return on_rung(pilot_.setup(), {.name = kReferenceRung, .wavelengths = count});
        });
        if (found.value < all) {
            plan_.render.rung.wavelengths = found.value;
        }
        plan_reduced("wavelengths", found, all, "wavelengths");
    }

    void choose_bounces() {
        const int all = pilot_.setup().max_bounces;
        if (pilot_.setup().chart) {
            plan({.name = "global-illumination", .contribution = {}}).why =
                "a chart in an even world is lit without scattering";
            return;
        }
        const Reduced found = enough_of({1, 2, 3, 4, 6, 8}, all, [&](int bounces) {
            render::SceneSetup setup = pilot_.setup();
            setup.max_bounces = bounces;
            return setup;
        });
        plan_.render.max_bounces = found.value;
        plan_reduced("global-illumination", found, all, "scatterings on a path");
    }

    PlannedEffect& plan(Effect effect) {
        plan_.effects.emplace_back().effect = std::move(effect);
        return plan_.effects.back();
    }

    void plan_reduced(const std::string& name, const Reduced& found, int all, const std::string& what) {
        PlannedEffect& planned = plan({.name = name, .contribution = found.without});
        planned.is_modelled = found.value == all;
        planned.saves_percent = saved_percent(full_ns_, full_ns_ - pilot_.full().ns_per_sample + found.ns_per_sample);
        const std::string more = excess(found.without, tolerance_);
        planned.why = found.value < all ? fmt::format("{} {} are enough of {}", found.value, what, all)
                      : !more.empty()
                          ? fmt::format("fewer than {} err by {}", all, more)
                          : fmt::format("there are but {}, or fewer are too few beside what is left out already", all);
    }

    /// Light that does not go straight: a pass each, which a render has or has not. The faintest are left out first.
    void decide_stray_light(std::vector<Effect> stray) {
        std::ranges::stable_sort(stray, {},
                                 [&](const Effect& effect) { return over_tolerance(effect.contribution, tolerance_); });
        for (Effect& effect : stray) {
            PlannedEffect& planned = plan(std::move(effect));
            const Effect& found = planned.effect;
            LeftOut with = budget_;
            with.add(found.contribution);
            planned.saves_percent = saved_percent(full_ns_, full_ns_ - found.ns_per_sample);
            if (with.keeps(tolerance_)) {
                budget_ = with;
                planned.why = fmt::format("at most {}", words_of(found.contribution));
            } else if (found.pass.empty()) {
                planned.why =
                    fmt::format("{}, but it has no pass here: {}", words_of(found.contribution), found.no_pass);
            } else {
                planned.is_modelled = true;
                plan_.render.passes.push_back(found.pass);
                const std::string more = excess(found.contribution, tolerance_);
                planned.why = more.empty() ? fmt::format("{}, too much beside what is left out already",
                                                         words_of(found.contribution))
                                           : more;
            }
        }
    }

    /// Of passes that are rendered: spread as widely as their light is smooth, with fewer samples.
    void choose_smoothings() {
        for (PlannedEffect& planned : plan_.effects) {
            if (!planned.is_modelled || planned.effect.pass.empty()) {
                continue;
            }
            const PilotSettings& settings = pilot_.settings();
            if (!take_smoothing(planned, settings.few_smooth_samples)) {
                take_smoothing(planned, settings.smooth_samples);
            }
        }
    }

    /// The widest that films of so many samples show to be within the tolerance. Whether there is nothing to be gained
    /// by more.
    bool take_smoothing(PlannedEffect& planned, int samples) {
        const std::string& pass = planned.effect.pass;
        const SmoothLight light = films_.of(pass, samples).smoothness(pilot_);
        Contribution lost;
        for (const double sigma_px : kSmoothings) {
            lost = veil_contribution(pilot_, light.lost(sigma_px));
            LeftOut with = budget_;
            with.add(lost);
            if (with.keeps(tolerance_)) {
                budget_ = with;
                plan_.render.smooth.push_back({pass, sigma_px, kFewerWhereSmooth});
                planned.why += fmt::format("; smooth as it is, spread over {:g} px it needs 1/{} of the samples",
                                           sigma_px, kFewerWhereSmooth);
                return true;
            }
        }
        return !keeps(surely(lost), tolerance_);
    }

    /// The cheapest of these cameras that the check does not refuse.
    void choose_camera(std::span<const CandidateRender> cameras) {
        const Pilot::Pictures full = pilot_.render(pilot_.setup(), {}, pilot_.settings().seeds);
        const double stray_ns = kept_stray_ns();
        for (const CandidateRender& candidate : cameras) {
            PlannedRender planned = plan_.render;
            planned.rung.model = candidate.rung.model;
            planned.rung.name = candidate.rung.name;
            try {
                const PlannedCheck checked = check(pilot_, planned, {}, full);
                if (!is_reference_render(candidate) && !keeps(surely(checked.error), tolerance_)) {
                    plan_.refused.push_back(
                        fmt::format("{}: {}", candidate.rung.name, excess(surely(checked.error), tolerance_)));
                    continue;
                }
                plan_.render = planned;
                plan_.checked = checked.error;
                plan_.speed_up = full_ns_ / (checked.ns_per_sample + stray_ns);
                say_of_camera(candidate,
                              saved_percent(full_ns_, full_ns_ - full.ns_per_sample + checked.ns_per_sample));
                return;
            } catch (const InputError& error) {  // this lens has no such model
                plan_.refused.push_back(fmt::format("{}: {}", candidate.rung.name, error.what()));
            }
        }
    }

    /// Of the passes that are rendered, a sample.
    [[nodiscard]] double kept_stray_ns() const {
        double ns = 0.0;
        for (const PlannedEffect& planned : plan_.effects) {
            ns += planned.is_modelled ? planned.effect.ns_per_sample / fewer(plan_.render, planned.effect.pass) : 0.0;
        }
        return ns;
    }

    /// What is left out so far, and what that camera lacks.
    [[nodiscard]] LeftOut without(const CandidateRender& candidate) const {
        LeftOut left_out = budget_;
        for (const PlannedEffect& planned : plan_.effects) {
            if (belongs_to_camera(planned.effect.name) && std::ranges::count(candidate.has, planned.effect.name) == 0) {
                left_out.add(planned.effect.contribution);
            }
        }
        return left_out;
    }

    void say_of_camera(const CandidateRender& candidate, double saves_percent) {
        for (PlannedEffect& planned : plan_.effects) {
            const std::string& name = planned.effect.name;
            if (!planned.why.empty()) {
                continue;
            }
            planned.is_modelled = true;
            if (name == "sensor") {
                planned.why = pilot_.setup().sensor ? words_of(planned.effect.contribution) +
                                                          "; it works on the finished film, and takes no samples"
                                                    : "the scene has no [sensor]";
                continue;
            }
            if (const std::string& whole = planned.effect.part_of; !whole.empty()) {
                planned.is_modelled = std::ranges::count(candidate.has, whole) > 0;
                planned.why = fmt::format("{}, a part of {}", words_of(planned.effect.contribution), whole);
                continue;
            }
            if (!belongs_to_camera(name)) {  // losses on the axis and cos⁴, which every camera here has
                planned.why =
                    fmt::format("{}, and no model is cheaper without it", words_of(planned.effect.contribution));
                continue;
            }
            planned.is_modelled = std::ranges::count(candidate.has, name) > 0;
            if (!planned.is_modelled) {
                planned.saves_percent = saves_percent;
                planned.why =
                    fmt::format("{}, which {} may lack", words_of(planned.effect.contribution), candidate.rung.name);
            } else {
                const std::string more = excess(planned.effect.contribution, tolerance_);
                planned.why = more.empty() ? fmt::format("{}; {} has it with what else is needed",
                                                         words_of(planned.effect.contribution), candidate.rung.name)
                                           : more;
            }
        }
    }

    Pilot pilot_;
    KeptFilms films_{pilot_};
    Tolerance tolerance_;
    LeftOut budget_;
    double full_ns_ = 0.0;  // of a sample with all passes
    Plan plan_;
};

}  // namespace

PlannedCheck check_plan(const render::SceneSetup& setup, const PlannedRender& planned,
                        const std::vector<std::string>& passes, const PilotSettings& settings) {
    const Pilot pilot(setup, settings);
    std::vector<std::string> kept;
    std::ranges::copy_if(passes, std::back_inserter(kept),
                         [&](const std::string& pass) { return std::ranges::count(planned.passes, pass) > 0; });
    PlannedCheck found = check(pilot, planned, kept, pilot.render(pilot.setup(), passes, settings.seeds));
    add_smoothing(pilot, planned, kept, found.error);
    return found;
}

Plan plan_render(const render::SceneSetup& setup, const Tolerance& tolerance, const PilotSettings& settings) {
    if (setup.camera.focal_length_mm) {
        throw InputError(
            "the scene's camera has a focal length in the place of a lens; expected a lens, of which a "
            "plan says what is needed");
    }
    const auto start = std::chrono::steady_clock::now();
    Plan plan = Planner(setup, tolerance, settings).make();
    plan.probe_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return plan;
}

std::vector<PlannedRender> dearer_renders(const PlannedRender& planned, const render::SceneSetup& full) {
    std::vector<PlannedRender> dearer;
    const auto own = std::ranges::find(candidates(), planned.rung.name,
                                       [](const CandidateRender& candidate) { return candidate.rung.name; });
    for (const CandidateRender& candidate : std::span(own + 1, candidates().end())) {
        dearer.push_back(planned);
        dearer.back().rung.name = candidate.rung.name;
        dearer.back().rung.model = candidate.rung.model;
    }
    PlannedRender& whole = dearer.emplace_back(planned);
    whole.rung = {.name = kReferenceRung};
    whole.max_bounces = full.max_bounces;
    return dearer;
}

std::vector<std::string> accountable_passes(const Plan& plan) {
    std::vector<std::string> passes;
    for (const PlannedEffect& planned : plan.effects) {
        if (!planned.effect.pass.empty() && (planned.is_modelled || !planned.effect.is_bound)) {
            passes.push_back(planned.effect.pass);
        }
    }
    return passes;
}

render::SceneSetup planned_setup(render::SceneSetup setup, const PlannedRender& planned) {
    setup.max_bounces = planned.max_bounces;
    return on_rung(std::move(setup), planned.rung);
}

}  // namespace lensproof::studies
