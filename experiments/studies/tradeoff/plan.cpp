#include "experiments/studies/tradeoff/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>

#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof::studies {

namespace {

using formats::Image;

constexpr double kCovered = 2.0;  // standard errors that a contribution is taken to be larger by

double at_most(const Measured& measured) {
    return measured.value + kCovered * measured.standard_error;
}

/// What is left out so far: places and colours add up as independent errors do, exposures as they are.
struct LeftOut {
    double px = 0.0;
    double ev = 0.0;
    double ciede2000 = 0.0;

    void add(const Contribution& more) {
        px = std::hypot(px, at_most(more.px));
        ev += at_most(more.ev);
        ciede2000 = std::hypot(ciede2000, at_most(more.ciede2000));
    }
    [[nodiscard]] bool keeps(const Tolerance& tolerance) const {
        return px <= tolerance.px && ev <= tolerance.ev && ciede2000 <= tolerance.ciede2000;
    }
};

}  // namespace

Contribution surely(const Contribution& found) {
    const auto least = [](const Measured& measured) {
        return Measured{std::max(0.0, measured.value - kCovered * measured.standard_error), 0.0};
    };
    return {least(found.px), least(found.ev), least(found.ciede2000)};
}

bool keeps(const Contribution& found, const Tolerance& tolerance) {
    LeftOut alone;
    alone.add(found);
    return alone.keeps(tolerance);
}

namespace {

/// What keeps a contribution from being left out: "0.8 px of 0.5".
std::string excess(const Contribution& found, const Tolerance& tolerance) {
    std::vector<std::string> parts;
    const auto add = [&](const Measured& measured, double limit, const char* unit) {
        if (at_most(measured) > limit) {
            parts.push_back(fmt::format("{:.2g} {} where {:g} may be", at_most(measured), unit, limit));
        }
    };
    add(found.px, tolerance.px, "px");
    add(found.ev, tolerance.ev, "EV");
    add(found.ciede2000, tolerance.ciede2000, "CIEDE2000");
    return fmt::format("{}", fmt::join(parts, ", "));
}

/// A way to render that leaves effects out, and which it has.
struct Candidate {
    Rung rung;
    std::vector<std::string> has;
};

/// From the cheapest on. Losses along the axis and cos⁴ are in all of them.
const std::vector<Candidate>& candidates() {
    static const std::vector<Candidate> all = [] {
        std::vector<Candidate> list;
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

bool is_reference(const Candidate& candidate) {
    return candidate.rung.name == kReferenceRung;
}

/// Renders of the scene with fewer bounces or wavelengths, from the fewest on, until one keeps the tolerance.
struct Reduced {
    int value = 0;         // that is enough
    Contribution without;  // of the largest value that is not, or of the least of all where that is enough
    double ns_per_sample = 0.0;
};

template <class With>
Reduced enough_of(const Pilot& pilot, const std::vector<int>& values, int all, const Tolerance& tolerance,
                  const With& with) {
    Reduced found{.value = all, .without = {}, .ns_per_sample = pilot.full().ns_per_sample};
    for (const int value : values) {
        if (value >= all) {
            break;
        }
        const Pilot::Pictures pictures = pilot.render(with(value), 0);
        const Contribution without = difference(pilot, pictures.rgb);
        found.without = without;
        if (keeps(without, tolerance)) {
            found.value = value;
            found.ns_per_sample = pictures.ns_per_sample;
            break;
        }
    }
    return found;
}

/// What a candidate gets wrong, and what a sample of it costs.
struct Checked {
    Contribution error;
    double ns_per_sample = 0.0;
};

Checked check(const Pilot& pilot, const PlannedRender& planned, const std::vector<Image>& full) {
    const PilotSettings& settings = pilot.settings();
    const render::SceneSetup setup = planned_setup(pilot.setup(), planned);
    const render::Camera camera(setup.camera, setup.spectral, render::PixelFilter{}, settings.cache, true);
    const FieldErrors field = field_errors(pilot.camera(), camera, pilot.points(), settings.probe);
    const Pilot::Pictures pictures = pilot.render(setup, settings.seeds);  // as those of the full model
    const PictureErrors found = picture_errors(pictures.rgb, full, settings.probe.threads);
    const Measured& image = field.frame.image_px;
    const Measured& blur = field.frame.blur_px;
    return {
        .error = {.px = {std::hypot(image.value, blur.value), std::hypot(image.standard_error, blur.standard_error)},
                  .ev = field.frame.exposure_ev,
                  .ciede2000 = found.ciede2000.bias},
        .ns_per_sample = pictures.ns_per_sample};
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
        choose_wavelengths();
        choose_bounces();
        decide_stray_light();
        choose_camera();
        plan_.noise_ev = std::log2(1.0 + pilot_.noise_of_sample() /
                                             std::sqrt(static_cast<double>(pilot_.setup().samples_per_pixel)));
        return std::move(plan_);
    }

  private:
    void choose_wavelengths() {
        const int all = pilot_.setup().spectral.strata();
        const Reduced found = enough_of(pilot_, {4, 8, 16, 32}, all, tolerance_, [&](int count) {
            return on_rung(pilot_.setup(), {.name = kReferenceRung, .wavelengths = count});
        });
        if (found.value < all) {
            plan_.render.rung.wavelengths = found.value;
            budget_.add(found.without);
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
        const Reduced found = enough_of(pilot_, {1, 2, 3, 4, 6, 8}, all, tolerance_, [&](int bounces) {
            render::SceneSetup setup = pilot_.setup();
            setup.max_bounces = bounces;
            return setup;
        });
        plan_.render.max_bounces = found.value;
        if (found.value < all) {
            budget_.add(found.without);
        }
        plan_reduced("global-illumination", found, all, "scatterings on a path");
    }

    PlannedEffect& plan(Effect effect) {
        plan_.effects.emplace_back().effect = std::move(effect);
        return plan_.effects.back();
    }

    void plan_reduced(const std::string& name, const Reduced& found, int all, const std::string& what) {
        PlannedEffect& planned = plan({.name = name, .contribution = found.without});
        planned.is_modelled = found.value == all;
        planned.saves_percent = saved_percent(pilot_.full().ns_per_sample, found.ns_per_sample);
        const std::string more = excess(found.without, tolerance_);
        planned.why = found.value < all ? fmt::format("{} {} are enough of {}", found.value, what, all)
                      : more.empty()    ? fmt::format("there are but {}", all)
                                        : fmt::format("fewer than {} err by {}", all, more);
    }

    /// Light that does not go straight: a pass each, which a render has or has not.
    void decide_stray_light() {
        constexpr double kOfTwoPasses = 50.0;
        const bool can = !pilot_.setup().chart && !pilot_.camera().lens()->has_mirrors();
        const std::vector<std::pair<std::string, std::string>> passes = {{"ghosts", "ghosts"},
                                                                         {"faint-ghosts", "faint-ghosts"},
                                                                         {"barrel", "barrel"},
                                                                         {"diffraction", "diffracted"}};
        for (PlannedEffect& planned : plan_.effects) {
            const auto pass =
                std::ranges::find(passes, planned.effect.name, &std::pair<std::string, std::string>::first);
            if (pass == passes.end()) {
                continue;
            }
            LeftOut with = budget_;
            with.add(planned.effect.contribution);
            planned.saves_percent = kOfTwoPasses;
            if (with.keeps(tolerance_)) {
                budget_ = with;
                planned.why = fmt::format("at most {}; a pass of its own would take as many samples again",
                                          words(planned.effect.contribution));
            } else if (!can) {
                planned.why =
                    "it would matter, and has no pass here: charts in an even world and lenses with mirrors have none";
            } else {
                planned.is_modelled = true;
                plan_.render.passes.push_back(pass->second);
                const std::string more = excess(planned.effect.contribution, tolerance_);
                planned.why = more.empty() ? fmt::format("it may be {}, too much beside what is left out already",
                                                         words(planned.effect.contribution))
                                           : fmt::format("it may be {}", more);
            }
        }
    }

    /// The cheapest camera whose missing effects are within what is left, and which the check does not refuse.
    void choose_camera() {
        const Pilot::Pictures full = pilot_.render(pilot_.setup(), pilot_.settings().seeds);
        for (const Candidate& candidate : candidates()) {
            PlannedRender planned = plan_.render;
            planned.rung.model = candidate.rung.model;
            planned.rung.name = candidate.rung.name;
            if (!is_reference(candidate) && (!planned.passes.empty() || !is_predicted(candidate))) {
                continue;
            }
            try {
                const Checked checked = check(pilot_, planned, full.rgb);
                if (!is_reference(candidate) && !keeps(surely(checked.error), tolerance_)) {
                    plan_.refused.push_back(
                        fmt::format("{}: {}", candidate.rung.name, excess(surely(checked.error), tolerance_)));
                    continue;
                }
                plan_.render = planned;
                plan_.checked = checked.error;
                plan_.speed_up = full.ns_per_sample / checked.ns_per_sample;
                say_of_camera(candidate, saved_percent(full.ns_per_sample, checked.ns_per_sample));
                return;
            } catch (const InputError& error) {  // this lens has no such model
                plan_.refused.push_back(fmt::format("{}: {}", candidate.rung.name, error.what()));
            }
        }
    }

    [[nodiscard]] bool is_predicted(const Candidate& candidate) const {
        LeftOut left_out = budget_;
        for (const PlannedEffect& planned : plan_.effects) {
            if (belongs_to_camera(planned.effect.name) && std::ranges::count(candidate.has, planned.effect.name) == 0) {
                left_out.add(planned.effect.contribution);
            }
        }
        return left_out.keeps(tolerance_);
    }

    void say_of_camera(const Candidate& candidate, double saves_percent) {
        for (PlannedEffect& planned : plan_.effects) {
            const std::string& name = planned.effect.name;
            if (!planned.why.empty()) {
                continue;
            }
            if (!belongs_to_camera(name)) {  // losses on the axis and cos⁴, which every camera here has
                planned.is_modelled = true;
                planned.why = fmt::format("{}, and no model is cheaper without it", words(planned.effect.contribution));
                continue;
            }
            planned.is_modelled = std::ranges::count(candidate.has, name) > 0;
            if (!planned.is_modelled) {
                planned.saves_percent = saves_percent;
                planned.why =
                    fmt::format("{}, which {} may lack", words(planned.effect.contribution), candidate.rung.name);
            } else {
                const std::string more = excess(planned.effect.contribution, tolerance_);
                planned.why = more.empty() ? fmt::format("{}; {} has it with what else is needed",
                                                         words(planned.effect.contribution), candidate.rung.name)
                                           : more;
            }
        }
    }

    /// The largest of a contribution's parts, each by what is tolerated.
    [[nodiscard]] std::string words(const Contribution& found) const {
        std::vector<std::string> parts;
        const auto add = [&](const Measured& measured, const char* unit) {
            if (at_most(measured) > 0.0) {
                parts.push_back(fmt::format("{:.2g} {}", at_most(measured), unit));
            }
        };
        add(found.px, "px");
        add(found.ev, "EV");
        add(found.ciede2000, "CIEDE2000");
        return parts.empty() ? "nothing" : fmt::format("{}", fmt::join(parts, ", "));
    }

    Pilot pilot_;
    Tolerance tolerance_;
    LeftOut budget_;
    Plan plan_;
};

Json limit_json(double limit) {
    return std::isfinite(limit) ? Json(limit) : Json(nullptr);
}

}  // namespace

Tolerance parse_tolerance(const std::string& text) {
    if (text == "visible") {
        return {.px = 1.0, .ev = 0.03, .ciede2000 = 1.0};
    }
    const auto refuse = [&](const std::string& part) {
        throw InputError(
            fmt::format("--tolerance is \"{}\": {}, expected numbers above 0 with px, ev and de, such as "
                        "0.5px,0.02ev,1de, or visible",
                        text, part));
    };
    Tolerance tolerance;
    std::vector<std::string> seen;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        begin = end + 1;
        const std::string unit = part.substr(part.size() - std::min<std::size_t>(2, part.size()));
        const std::optional<double> number = parse_number(part.substr(0, part.size() - unit.size()));
        if (unit != "px" && unit != "ev" && unit != "de") {
            refuse(fmt::format("\"{}\" has no unit that is known", part));
        }
        if (!number || !std::isfinite(*number) || !(*number > 0.0)) {
            refuse(fmt::format("\"{}\" is no number above 0 and a unit", part));
        }
        if (std::ranges::count(seen, unit) > 0) {
            refuse(fmt::format("{} stands twice", unit));
        }
        seen.push_back(unit);
        (unit == "px" ? tolerance.px : unit == "ev" ? tolerance.ev : tolerance.ciede2000) = *number;
    }
    return tolerance;
}

PlannedCheck check_plan(const render::SceneSetup& setup, const PlannedRender& planned, const PilotSettings& settings) {
    const Pilot pilot(setup, settings);
    const Pilot::Pictures full = pilot.render(pilot.setup(), settings.seeds);
    const Checked checked = check(pilot, planned, full.rgb);
    return {.error = checked.error, .speed_up = full.ns_per_sample / checked.ns_per_sample};
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

render::SceneSetup planned_setup(render::SceneSetup setup, const PlannedRender& planned) {
    setup.max_bounces = planned.max_bounces;
    return on_rung(std::move(setup), planned.rung);
}

Json plan_json(const Plan& plan, PlanTimes times) {
    const auto parts = [](const Contribution& of, double Measured::*what) {
        return Json{{"px", of.px.*what}, {"ev", of.ev.*what}, {"ciede2000", of.ciede2000.*what}};
    };
    Json json{{"tolerance",
               {{"px", limit_json(plan.tolerance.px)},
                {"ev", limit_json(plan.tolerance.ev)},
                {"ciede2000", limit_json(plan.tolerance.ciede2000)}}},
              {"model", plan.render.rung.name},
              {"max_bounces", plan.render.max_bounces},
              {"passes", plan.render.passes},
              {"effects", Json::list()}};
    json["wavelengths"] = plan.render.rung.wavelengths ? Json(*plan.render.rung.wavelengths) : Json(nullptr);
    for (const PlannedEffect& planned : plan.effects) {
        Json effect{{"effect", planned.effect.name},
                    {"contribution", parts(planned.effect.contribution, &Measured::value)},
                    {"standard_error", parts(planned.effect.contribution, &Measured::standard_error)},
                    {"is_bound", planned.effect.is_bound},
                    {"decision", planned.is_modelled ? "model" : "leave-out"},
                    {"why", planned.why}};
        if (times == PlanTimes::told) {
            effect["saves_percent"] = planned.is_modelled ? 0.0 : planned.saves_percent;
        }
        json["effects"].push_back(std::move(effect));
    }
    json["checked"] = {{"error", parts(plan.checked, &Measured::value)},
                       {"standard_error", parts(plan.checked, &Measured::standard_error)}};
    json["refused"] = plan.refused;
    json["noise_ev"] = plan.noise_ev;
    if (times == PlanTimes::told) {
        json["speed_up"] = plan.speed_up;
        json["probe_seconds"] = plan.probe_seconds;
    }
    return json;
}

}  // namespace lensproof::studies
