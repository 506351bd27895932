#include <cmath>
#include <utility>

#include "experiments/studies/tradeoff/plan.h"

namespace lensproof::studies {

namespace {

Json limit_json(double limit) {
    return std::isfinite(limit) ? Json(limit) : Json(nullptr);
}

}  // namespace

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
    for (const render::SmoothPass& smooth : plan.render.smooth) {
        json["smooth"][smooth.pass] = {{"sigma_px", smooth.sigma_px}, {"fewer_samples", smooth.fewer}};
    }
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
    if (plan.spots.pixels > 0) {
        json["spots"] = {{"pixels", plan.spots.pixels},
                         {"error", parts(plan.spots.error, &Measured::value)},
                         {"standard_error", parts(plan.spots.error, &Measured::standard_error)},
                         {"is_revised", plan.spots.is_revised}};
    }
    json["refused"] = plan.refused;
    json["noise_ev"] = plan.noise_ev;
    if (times == PlanTimes::told) {
        json["speed_up"] = plan.speed_up;
        json["probe_seconds"] = plan.probe_seconds;
    }
    return json;
}

}  // namespace lensproof::studies
