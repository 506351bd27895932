#include "experiments/studies/stray_light/stray_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "experiments/studies/stray_light/stray_pictures.h"

namespace lensproof::studies {

namespace {

std::string percent(const Estimate& fraction) {
    return fmt::format("{:.3g} ± {:.1g} %", 100.0 * fraction.value, 100.0 * fraction.standard_error);
}

findings::Subject subject_of(const StrayScene& scene, const StrayVariant& variant, const VariantFindings& found) {
    findings::Subject subject{
        .id = fmt::format("{}-{}", scene.name, variant.name), .kind = "render", .label = variant.label};
    const Estimate all = found.light(kPicture);
    for (const PassPicture& pass : found.passes) {
        subject.facts.push_back({pass.pass + ", of the picture's light", percent(ratio(pass.light, all))});
    }
    if (const std::optional<double> noise = found.noise()) {
        subject.facts.push_back({"noise, printed", fmt::format("{:.2g} %", 100.0 * *noise)});
    }
    if (found.streaks) {
        subject.facts.push_back(
            {"streaks from the edges' normals",
             fmt::format("{:.2f} ± {:.1g}°", found.streaks->offset_deg, found.streaks->offset_error_deg)});
        subject.facts.push_back({"halo falls with the distance to the power",
                                 fmt::format("{:.2f} ± {:.1g}", found.streaks->slope, found.streaks->slope_error)});
    }
    subject.pictures = pictures_of(scene, variant, found);
    if (found.veiling_glare) {
        subject.facts.push_back({"veiling glare index", percent(*found.veiling_glare)});
    }
    for (const auto& [fate, fraction] : found.fates) {
        subject.facts.push_back({"light that comes in: " + fate, percent(fraction)});
    }
    return subject;
}

Json variant_json(const StrayVariant& variant, const VariantFindings& found) {
    Json json{{"name", variant.name}};
    for (const findings::Axis& axis : variant.at) {
        json["at"][axis.key] = axis.json(0);
    }
    for (const PassPicture& pass : found.passes) {
        json["light"][pass.pass] = {{"mean", pass.light.value}, {"standard_error", pass.light.standard_error}};
    }
    if (const std::optional<double> noise = found.noise()) {
        json["noise_percent"] = 100.0 * *noise;
    }
    for (const GhostEnergy& ghost : found.ghosts) {
        json["ghosts"].push_back({{"surfaces", ghost.surfaces},
                                  {"energy", ghost.energy.value},
                                  {"energy_standard_error", ghost.energy.standard_error}});
    }
    if (found.veiling_glare) {
        json["veiling_glare_percent"] = 100.0 * found.veiling_glare->value;
        json["veiling_glare_standard_error_percent"] = 100.0 * found.veiling_glare->standard_error;
    }
    if (!found.features.empty()) {
        json["features"] = features_json(found.features);
    }
    if (found.streaks) {
        json["streaks"] = {{"offset_deg", found.streaks->offset_deg},
                           {"offset_error_deg", found.streaks->offset_error_deg},
                           {"slope", found.streaks->slope},
                           {"slope_error", found.streaks->slope_error}};
    }
    for (const PictureGrowth& point : found.growth) {
        json["growth"].push_back(to_json(point));
    }
    for (const auto& [fate, fraction] : found.fates) {
        json["energy"][fate + "_percent"] = 100.0 * fraction.value;
        json["energy"][fate + "_standard_error_percent"] = 100.0 * fraction.standard_error;
    }
    return json;
}

}  // namespace

findings::Findings stray_findings(const StrayScene& scene, const std::vector<VariantFindings>& variants,
                                  findings::Quality quality) {
    findings::Findings found{.checks = stray_checks(scene, variants, quality),
                             .subjects_title = "Scenes",
                             .not_shown = {"Passes are of unpolarised light, and of rays: what interferes between them "
                                           "is left out.",
                                           "Makers do not publish their coatings: every preset is assumed."}};
    Json table{{"name", scene.name}, {"passes", scene.passes}};
    findings::Subject all{.id = scene.name, .kind = "scene", .label = scene.title};
    all.pictures = pictures_of_all(scene, variants);
    if (!all.pictures.empty()) {
        found.subjects.push_back(std::move(all));
    }
    for (std::size_t i = 0; i < variants.size(); ++i) {
        found.subjects.push_back(subject_of(scene, scene.variants[i], variants[i]));
        table["variants"].push_back(variant_json(scene.variants[i], variants[i]));
    }
    found.inputs.push_back(scene.file);
    for (const StrayVariant& variant : scene.variants) {
        std::ranges::move(files_of(variant), std::back_inserter(found.inputs));
    }
    found.tables = {{"stray_light", Json::list({std::move(table)})}};
    return found;
}

std::vector<findings::Study> read_stray_light(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("stray_light")) {
        const StrayScene scene = read_stray_scene(table, file);
        const auto carry_out = [scene](const findings::RunSettings& settings, const findings::RunProgress& progress,
                                       const findings::Findings&) {
            std::vector<VariantFindings> variants;
            std::ranges::transform(scene.variants, std::back_inserter(variants), [&](const StrayVariant& variant) {
                return render_variant(scene, variant, settings, progress);
            });
            return stray_findings(scene, variants, settings.quality);
        };
        studies.push_back({scene.name, carry_out, [scene](const findings::RunSettings& settings) {
                               std::vector<findings::PlannedStep> steps;
                               for (const StrayVariant& variant : scene.variants) {
                                   std::ranges::move(steps_of_variant(scene, variant, settings),
                                                     std::back_inserter(steps));
                               }
                               return steps;
                           }});
    }
    return studies;
}

}  // namespace lensproof::studies
