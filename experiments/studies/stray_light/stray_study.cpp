#include "experiments/studies/stray_light/stray_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::studies {

namespace {

constexpr int kShownWidth = 1200;    // px, of a variant's picture
constexpr int kSheetWidth = 1800;    // and of all together
constexpr std::size_t kListed = 20;  // ghosts in a chart

std::string percent(const Estimate& share) {
    return fmt::format("{:.3g} ± {:.1g} %", 100.0 * share.value, 100.0 * share.standard_error);
}

/// Their errors are independent.
Estimate ratio(const Estimate& over, const Estimate& under) {
    const double value = over.value / under.value;
    return {value, std::hypot(over.standard_error, value * under.standard_error) / std::abs(under.value)};
}

std::size_t index_of(const StrayScene& scene, const std::string& variant) {
    return std::ranges::find(scene.variants, variant, &StrayVariant::name) - scene.variants.begin();
}

const std::string& label_of(const StrayScene& scene, const std::string& variant) {
    return scene.variants[index_of(scene, variant)].label;
}

std::string id_of(const StrayScene& scene, const StrayVariant& variant) {
    return fmt::format("{}-{}", scene.name, variant.name);
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

double brightening(const StrayScene& scene, const std::string& pass) {
    const auto found = scene.brightening_ev.find(pass);
    return found == scene.brightening_ev.end() ? 0.0 : found->second;
}

formats::Image brightened(formats::Image image, double ev) {
    const auto gain = static_cast<float>(std::exp2(ev));
    std::ranges::transform(image.pixels, image.pixels.begin(), [&](float value) { return gain * value; });
    return image;
}

/// The part of a picture that the scene's table wants to be shown.
formats::Image shown_part(const StrayScene& scene, formats::Image image) {
    if (scene.crop.empty()) {
        return image;
    }
    const auto place = [](double share, int size) { return static_cast<int>(std::lround(share * size)); };
    const int left = place(scene.crop[0], image.width);
    const int top = place(scene.crop[1], image.height);
    formats::Image part = formats::make_image(std::max(1, place(scene.crop[2], image.width) - left),
                                              std::max(1, place(scene.crop[3], image.height) - top), image.channels);
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(part.width) * part.channel_count();
    for (int y = 0; y < part.height; ++y) {
        const int from = std::min(top + y, image.height - 1);
        std::copy_n(&image.at(std::min(left, image.width - part.width), from, 0), row, &part.at(0, y, 0));
    }
    return part;
}

std::string caption_of(const std::string& pass, double ev) {
    return ev == 0.0 ? pass : fmt::format("{}, {:+g} EV", pass, ev);
}

/// Pictures of one size in rows of `columns`, with a white line between them.
formats::Image contact_sheet(const std::vector<formats::Image>& pictures, int columns) {
    constexpr int kLine = 4;  // px
    const int width = pictures.front().width;
    const int height = pictures.front().height;
    const int count = static_cast<int>(pictures.size());
    const int across = std::min(columns, count);
    const int rows = (count + across - 1) / across;
    formats::Image sheet = formats::make_image(across * (width + kLine) - kLine, rows * (height + kLine) - kLine,
                                               pictures.front().channels);
    std::ranges::fill(sheet.pixels, 1.0F);
    for (int i = 0; i < count; ++i) {
        const formats::Image& picture = pictures[static_cast<std::size_t>(i)];
        const int left = (i % across) * (width + kLine);
        const int top = (i / across) * (height + kLine);
        const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(width) * picture.channel_count();
        for (int y = 0; y < height; ++y) {
            std::copy_n(picture.pixels.begin() + y * row, row, &sheet.at(left, top + y, 0));
        }
    }
    return sheet;
}

/// The variants' names, row by row.
std::string sheet_words(const StrayScene& scene) {
    std::string words;
    for (std::size_t i = 0; i < scene.variants.size(); ++i) {
        words += i == 0 ? "" : i % static_cast<std::size_t>(scene.columns) == 0 ? "; " : ", ";
        words += scene.variants[i].label;
    }
    return words;
}

std::vector<findings::Picture> contact_sheets(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    std::vector<findings::Picture> sheets;
    const auto add = [&](const std::string& pass, double ev, const auto& image_of) {
        std::vector<formats::Image> images;
        std::ranges::transform(variants, std::back_inserter(images),
                               [&](const VariantFindings& variant) { return shown_part(scene, image_of(variant)); });
        sheets.push_back(findings::shown_picture(fmt::format("{}/{}.png", scene.name, pass),
                                                 fmt::format("{}: {}", caption_of(pass, ev), sheet_words(scene)),
                                                 contact_sheet(images, scene.columns), kSheetWidth));
    };
    add(kPicture, 0.0, [](const VariantFindings& variant) { return picture_of(variant.passes); });
    for (std::size_t i = 0; i < scene.passes.size(); ++i) {
        const double ev = brightening(scene, scene.passes[i]);
        add(scene.passes[i], ev, [&](const VariantFindings& variant) { return brightened(variant.passes[i].rgb, ev); });
    }
    return sheets;
}

/// Energies of the ghosts, in the order that the first variant has them in.
findings::Picture ghost_chart(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    const std::size_t count = std::min(kListed, variants.front().ghosts.size());
    draw::PlotChart chart{
        .title = "Ghosts of two reflections, one by one",
        .caption = fmt::format("A distant light {:g}° from the axis, 550 nm", *scene.ghosts_deg),
        .x = {.label = fmt::format("Ghost, the strongest of {} first", scene.variants.front().label)},
        .y = {.label = "Energy over that of the entrance pupil", .scale = draw::AxisScale::logarithmic}};
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) {
        names.push_back(fmt::format("{}: {}", i + 1, fmt::join(variants.front().ghosts[i].surfaces, ",")));
    }
    chart.note = fmt::format("Surfaces in the order of reflection: {}", fmt::join(names, "; "));
    for (std::size_t v = 0; v < variants.size(); ++v) {
        draw::ChartCurve curve{.label = scene.variants[v].label,
                               .points = {},
                               .colour = draw::series_colour(v),
                               .line = draw::CurveLine::none,
                               .marker = static_cast<draw::CurveMarker>(1 + v % 5)};
        for (std::size_t i = 0; i < count; ++i) {
            const auto same =
                std::ranges::find(variants[v].ghosts, variants.front().ghosts[i].surfaces, &GhostEnergy::surfaces);
            if (same != variants[v].ghosts.end()) {
                curve.points.push_back({static_cast<double>(i + 1), same->energy.value});
            }
        }
        chart.curves.push_back(std::move(curve));
    }
    constexpr draw::ChartSize kSize{.width = 860.0, .height = 480.0};
    return {.name = scene.name + "/ghosts.svg",
            .caption = "Each ghost by itself",
            .width = kSize.width,
            .height = kSize.height,
            .bytes = draw::chart_svg(chart, kSize)};
}

findings::Subject subject_of(const StrayScene& scene, const StrayVariant& variant, const VariantFindings& found) {
    findings::Subject subject{.id = id_of(scene, variant), .kind = "render", .label = variant.label};
    const Estimate all = found.light(kPicture);
    for (const PassPicture& pass : found.passes) {
        subject.facts.push_back({pass.pass + ", of the picture's light", percent(ratio(pass.light, all))});
        const double ev = brightening(scene, pass.pass);
        subject.pictures.push_back(findings::shown_picture(fmt::format("{}/{}.png", subject.id, pass.pass),
                                                           caption_of(pass.pass, ev),
                                                           shown_part(scene, brightened(pass.rgb, ev)), kShownWidth));
    }
    subject.pictures.insert(subject.pictures.begin(),
                            findings::shown_picture(fmt::format("{}/picture.png", subject.id), "all together",
                                                    shown_part(scene, picture_of(found.passes)), kShownWidth));
    subject.facts.push_back({"noise of a pixel, the median", fmt::format("{:.2g} %", 100.0 * found.noise())});
    if (found.veiling_glare) {
        subject.facts.push_back({"veiling glare index", percent(*found.veiling_glare)});
    }
    for (const auto& [fate, share] : found.fates) {
        subject.facts.push_back({"light that comes in: " + fate, percent(share)});
    }
    return subject;
}

Json variant_json(const StrayVariant& variant, const VariantFindings& found) {
    Json json{{"name", variant.name}};
    for (const PassPicture& pass : found.passes) {
        json["light"][pass.pass] = {{"mean", pass.light.value}, {"standard_error", pass.light.standard_error}};
    }
    json["noise_percent"] = 100.0 * found.noise();
    for (const GhostEnergy& ghost : found.ghosts) {
        json["ghosts"].push_back({{"surfaces", ghost.surfaces},
                                  {"energy", ghost.energy.value},
                                  {"energy_standard_error", ghost.energy.standard_error}});
    }
    if (found.veiling_glare) {
        json["veiling_glare_percent"] = 100.0 * found.veiling_glare->value;
        json["veiling_glare_standard_error_percent"] = 100.0 * found.veiling_glare->standard_error;
    }
    for (const auto& [fate, share] : found.fates) {
        json["energy"][fate + "_percent"] = 100.0 * share.value;
        json["energy"][fate + "_standard_error_percent"] = 100.0 * share.standard_error;
    }
    return json;
}

}  // namespace

std::vector<findings::Check> stray_checks(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    std::vector<findings::Check> checks;
    for (const StrayCheck& check : scene.checks) {
        const Estimate found = ratio(light_of(check, variants[index_of(scene, check.variant)], check.pass),
                                     light_of(check, variants[index_of(scene, check.over_variant)], check.over_pass));
        const std::string compared =
            check.variant == check.over_variant
                ? label_of(scene, check.variant)
                : fmt::format("{} over {}", label_of(scene, check.variant), label_of(scene, check.over_variant));
        checks.push_back({.id = fmt::format("{}-{}", scene.name, checks.size() + 1),
                          .group = scene.title,
                          .subject = fmt::format("{}-{}", scene.name, check.variant),
                          .label = fmt::format("{}: {}", words_of(check), compared),
                          .value = found.value,
                          .sigma = found.standard_error,
                          .unit = "",
                          .limit = check.bound.limit,
                          .expectation = check.bound.expectation,
                          .target = check.bound.target,
                          .explanation = "Light over light."});
    }
    return checks;
}

findings::Findings stray_findings(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    findings::Findings found{.checks = stray_checks(scene, variants), .subjects_title = "Scenes"};
    Json table{{"name", scene.name}, {"passes", scene.passes}};
    findings::Subject all{.id = scene.name, .kind = "scene", .label = scene.title};
    if (variants.size() > 1) {
        all.pictures = contact_sheets(scene, variants);
    }
    if (scene.ghosts_deg && !variants.front().ghosts.empty()) {
        all.pictures.push_back(ghost_chart(scene, variants));
    }
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
    for (TomlTable& table : file.top.tables("stray_light")) {
        const StrayScene scene = read_stray_scene(table, file);
        const auto carry_out = [scene](const findings::RunSettings& settings, const findings::RunProgress& progress,
                                       const findings::Findings&) {
            std::vector<VariantFindings> variants;
            std::ranges::transform(scene.variants, std::back_inserter(variants), [&](const StrayVariant& variant) {
                return render_variant(scene, variant, settings, progress);
            });
            return stray_findings(scene, variants);
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
