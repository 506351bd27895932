#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/power_law.h"
#include "experiments/studies/stray_light/stray_study.h"

namespace lensproof::studies {

namespace {

std::size_t index_of(const StrayScene& scene, const std::string& variant) {
    return std::ranges::find(scene.variants, variant, &StrayVariant::name) - scene.variants.begin();
}

const std::string& label_of(const StrayScene& scene, const std::string& variant) {
    return scene.variants[index_of(scene, variant)].label;
}

Estimate light_of(const StrayCheck& check, const VariantFindings& variant, const std::string& pass) {
    return check.what == StrayCheck::Of::pass
               ? variant.light(pass)
               : variant.ghost_energy(check.surface, check.what == StrayCheck::Of::ghosts_of_surface);
}

std::string words_of(const StrayCheck& check) {
    switch (check.what) {
        case StrayCheck::Of::ghosts_of_surface:
            return fmt::format("ghosts that surface {} reflects", check.surface);
        case StrayCheck::Of::ghosts_beside_surface:
            return fmt::format("ghosts without surface {}", check.surface);
        case StrayCheck::Of::pass:
            break;
    }
    return check.pass == check.over_pass ? check.pass : fmt::format("{} over {}", check.pass, check.over_pass);
}

findings::Check about(const StrayScene& scene, const std::string& variant, const findings::Bound& bound) {
    findings::Check check;
    check.group = scene.title;
    check.subject = fmt::format("{}-{}", scene.name, variant);
    check.limit = bound.limit;
    check.expectation = bound.expectation;
    check.target = bound.target;
    return check;
}

findings::Check light_check(const StrayScene& scene, const StrayCheck& wanted,
                            const std::vector<VariantFindings>& variants) {
    const Estimate found = ratio(light_of(wanted, variants[index_of(scene, wanted.variant)], wanted.pass),
                                 light_of(wanted, variants[index_of(scene, wanted.over_variant)], wanted.over_pass));
    const std::string compared =
        wanted.variant == wanted.over_variant
            ? label_of(scene, wanted.variant)
            : fmt::format("{} over {}", label_of(scene, wanted.variant), label_of(scene, wanted.over_variant));
    findings::Check check = about(scene, wanted.variant, wanted.bound);
    check.label = fmt::format("{}: {}", words_of(wanted), compared);
    check.value = found.value;
    check.sigma = found.standard_error;
    check.explanation = "Light over light.";
    return check;
}

findings::Check noise_check(const StrayScene& scene, const StrayVariant& variant, double noise) {
    findings::Check check = about(scene, variant.name, {.limit = *scene.noise_percent});
    check.label = fmt::format("noise, printed: {}", variant.label);
    check.value = 100.0 * noise;
    check.unit = "%";
    check.explanation =
        "As it is printed: the standard error of a pixel's displayed value (sRGB), over white, rms over the frame.";
    return check;
}

void add_streak_checks(const StrayScene& scene, const StrayVariant& variant, const StreakLook& streaks,
                       std::vector<findings::Check>& checks) {
    constexpr double kOff_deg = 0.5;   // a streak is some degrees wide
    constexpr double kSlopeOff = 0.3;  // of eight rings of a noisy picture; edge_diffraction holds the slope to 5 %
    findings::Check direction =
        about(scene, variant.name, {.expectation = findings::Expectation::within, .limit = kOff_deg});
    direction.label = fmt::format("streaks from the edges' normals: {}", variant.label);
    direction.value = streaks.offset_deg;
    direction.sigma = streaks.offset_error_deg;
    direction.unit = "°";
    direction.explanation = "In the picture: the phase of the light around the lamp, the mean of eight rings.";
    checks.push_back(std::move(direction));
    findings::Check fall =
        about(scene, variant.name, {.expectation = findings::Expectation::within, .limit = kSlopeOff, .target = -3.0});
    fall.label = fmt::format("streaks, exponent of their fall: {}", variant.label);
    fall.value = streaks.slope;
    fall.sigma = streaks.slope_error;
    fall.explanation =
        "In the picture: of the light that goes round the lamp as the streaks do, over the distance from it. Far from "
        "the lamp's image an edge's light falls with the third power.";
    checks.push_back(std::move(fall));
}

findings::Check growth_check(const StrayScene& scene, const StrayVariant& variant,
                             const std::vector<PictureGrowth>& growth) {
    // Errors that are small beside white fall with −1/2 or faster. What is rarely met and then bright is cut at white,
    // and falls slower the rarer it is.
    constexpr double kSlowest = -0.2;
    const PowerLaw law = growth_law(growth);
    findings::Check check = about(scene, variant.name, {.limit = kSlowest});
    check.label = fmt::format("error over samples, exponent: {}", variant.label);
    check.value = law.exponent;
    check.sigma = law.standard_error;
    check.explanation =
        fmt::format("From {} to {} samples a pixel and pass.", growth.front().samples, growth.back().samples);
    return check;
}

}  // namespace

PowerLaw growth_law(const std::vector<PictureGrowth>& growth) {
    std::vector<Vec2d> points;
    std::ranges::transform(growth, std::back_inserter(points), [](const PictureGrowth& point) {
        return Vec2d{static_cast<double>(point.samples), point.error};
    });
    return power_law(points);
}

std::vector<VariantFeatures> features_of(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    std::vector<VariantFeatures> features;
    for (std::size_t i = 0; i < variants.size(); ++i) {
        features.push_back({scene.variants[i].name, scene.variants[i].label, variants[i].features});
    }
    return features;
}

std::vector<findings::Check> stray_checks(const StrayScene& scene, const std::vector<VariantFindings>& variants,
                                          findings::Quality quality) {
    std::vector<findings::Check> checks;
    for (const StrayCheck& check : scene.checks) {
        checks.push_back(light_check(scene, check, variants));
    }
    for (std::size_t i = 0; i < variants.size(); ++i) {
        const StrayVariant& variant = scene.variants[i];
        const std::optional<double> noise = variants[i].noise();
        if (scene.noise_percent && noise && quality == findings::Quality::full) {
            checks.push_back(noise_check(scene, variant, *noise));
        }
        if (variants[i].streaks) {
            add_streak_checks(scene, variant, *variants[i].streaks, checks);
        }
        if (!variants[i].growth.empty()) {
            checks.push_back(growth_check(scene, variant, variants[i].growth));
        }
    }
    for (std::size_t i = 0; i < checks.size(); ++i) {
        checks[i].id = fmt::format("{}-{}", scene.name, i + 1);
    }
    if (scene.chart) {
        std::ranges::move(chart_checks(*scene.chart, scene.name, scene.title, features_of(scene, variants), quality),
                          std::back_inserter(checks));
    }
    return checks;
}

}  // namespace lensproof::studies
