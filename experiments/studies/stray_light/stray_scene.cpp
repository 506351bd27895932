#include "experiments/studies/stray_light/stray_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/render/integrators/passes.h"
#include "engine/render/metering.h"
#include "engine/render/scene_setup.h"
#include "engine/scene/scene_build.h"

namespace lensproof::studies {

namespace {

constexpr int kMostVariants = 100;

std::vector<std::string> pass_names() {
    std::vector<std::string> names;
    for (const render::Pass& pass : render::passes()) {
        if (!pass.is_sum) {
            names.push_back(pass.name);
        }
    }
    return names;
}

StrayVariant read_variant(findings::Varied& varied, const TomlTable& scene, const StrayScene& owner,
                          findings::ExperimentFile& file) {
    TomlTable& table = varied.table;
    StrayVariant variant{
        .name = findings::read_name(table), .label = {}, .setup = {}, .stated = {}, .at = std::move(varied.at)};
    const std::string words = findings::words_of(variant.at);
    const std::string label = table.text_or("label", words.empty() ? variant.name : "");
    variant.label = fmt::format("{}{}{}", label, label.empty() || words.empty() ? "" : ", ", words);
    const std::optional<TomlTable> changed = table.optional_table("scene");
    const TomlTable whole = changed ? scene.overlaid(*changed) : scene;
    variant.setup = render::read_scene_setup(whole);
    render::expect_stated_exposure(variant.setup, scene.file());
    if (variant.setup.chart && owner.passes != std::vector<std::string>{"imaged"}) {
        throw InputError(
            fmt::format("{}: is a [chart] in an even world, which has the pass imaged alone, expected a "
                        "scene with lights, or passes = [\"imaged\"]",
                        scene.file().string()));
    }
    variant.stated = whole.stated();
    file.add_subject(table, "name", fmt::format("{}-{}", owner.name, variant.name));
    table.finish();
    return variant;
}

/// A table of numbers by the passes' names.
template <class Read>
auto by_pass(TomlTable& table, const char* key, const std::vector<std::string>& passes, const Read& read) {
    std::map<std::string, decltype(read(table, std::string()))> found;
    if (auto numbers = table.optional_table(key)) {
        for (const std::string& pass : passes) {
            if (numbers->has(pass)) {
                found[pass] = read(*numbers, pass);
            }
        }
        numbers->finish();
    }
    return found;
}

/// One integrator of all passes, or a table of them by passes' names.
std::map<std::string, std::string> read_paths(TomlTable& table, std::vector<std::string> passes) {
    std::erase_if(passes, [](const std::string& pass) { return !render::pass_named(pass).goes_straight; });
    const auto read = [](TomlTable& paths, const std::string& key) {
        return paths.choice(key, {"camera", "light", "both"});
    };
    if (!table.has("paths") || table.is_table("paths")) {
        return by_pass(table, "paths", passes, read);
    }
    std::map<std::string, std::string> same;
    for (const std::string& pass : passes) {
        same[pass] = read(table, "paths");
    }
    return same;
}

std::vector<std::string> variant_names(const StrayScene& scene) {
    std::vector<std::string> names;
    std::ranges::transform(scene.variants, std::back_inserter(names), &StrayVariant::name);
    return names;
}

/// A picture of streaks tells of a lamp and of blades.
void expect_streaks(const TomlTable& table, const StrayScene& scene) {
    for (const char* pass : {"direct", "diffracted"}) {
        if (std::ranges::count(scene.passes, pass) == 0) {
            table.fail("streaks", fmt::format("are measured in light of the pass \"{}\", expected it in passes", pass));
        }
    }
    for (const StrayVariant& variant : scene.variants) {
        if (!variant.setup.camera.blades) {
            table.fail("streaks", fmt::format("are those of blades, which \"{}\" has none of, expected blades in its "
                                              "[camera]",
                                              variant.name));
        }
    }
}

StrayCheck read_check(TomlTable& table, const StrayScene& scene) {
    std::vector<std::string> lights = scene.passes;
    lights.emplace_back(kPicture);
    const std::vector<std::string> variants = variant_names(scene);
    StrayCheck check;
    if (table.has("light")) {
        check.pass = table.choice("light", lights);
        check.over_pass = table.has("over_light") ? table.choice("over_light", lights) : check.pass;
    } else {
        const bool involves = table.has("ghosts_of_surface");
        check.what = involves ? StrayCheck::Of::ghosts_of_surface : StrayCheck::Of::ghosts_beside_surface;
        const char* key = involves ? "ghosts_of_surface" : "ghosts_beside_surface";
        check.surface = table.integer(key, 1, 100'000);
        if (!scene.ghosts_deg) {
            table.fail(key, "stands in a table without ghosts_deg, which says whose ghosts are meant");
        }
    }
    check.variant = table.choice("of", variants);
    check.over_variant = table.has("over") ? table.choice("over", variants) : check.variant;
    if (check.variant == check.over_variant && check.pass == check.over_pass) {
        table.fail("of", "is set against itself, expected another variant in over, or another pass in over_light");
    }
    check.bound = findings::read_bound(table, kNotNegative);
    table.finish();
    return check;
}

}  // namespace

std::vector<std::filesystem::path> files_of(const StrayVariant& variant) {
    const std::string& lens = variant.setup.camera.lens;
    std::vector<std::filesystem::path> files = scene::named_files(variant.setup.scene);
    if (!lens.empty()) {
        std::ranges::move(formats::files_of_lens(lens), std::back_inserter(files));
    }
    return files;
}

StrayScene read_stray_scene(TomlTable& table, findings::ExperimentFile& file) {
    StrayScene scene{
        .name = findings::read_name(table), .title = {}, .file = {}, .passes = {}, .variants = {}, .checks = {}};
    scene.title = table.text_or("title", scene.name);
    file.add_subject(table, "name", scene.name);
    scene.file = referred_file(table.file(), table.text("scene"));
    const TomlTable world = TomlTable::read(scene.file);
    scene.passes = findings::names_of(table, "passes", pass_names());
    if (scene.passes.empty()) {
        scene.passes = {"imaged", "direct", "ghosts"};
    }
    scene.paths = read_paths(table, scene.passes);
    if (table.has("stray_filter")) {
        scene.stray_filter =
            render::PixelFilter::named(table.choice("stray_filter", render::PixelFilter::known_names()));
    }
    scene.samples_per_pixel =
        by_pass(table, "samples_per_pixel", scene.passes, [](TomlTable& numbers, const std::string& pass) {
            return numbers.integer(pass, 1, render::kMostSamplesPerPixel);
        });
    scene.brightening_ev = by_pass(table, "brightening_ev", scene.passes,
                                   [](TomlTable& numbers, const std::string& pass) { return numbers.number(pass); });
    std::vector<findings::Varied> variants = findings::varied_tables(table, "variants");
    if (variants.empty() || variants.size() > kMostVariants) {
        table.fail("variants", fmt::format("has {} tables, expected 1 to {}", variants.size(), kMostVariants));
    }
    for (findings::Varied& variant : variants) {
        scene.variants.push_back(read_variant(variant, world, scene, file));
    }
    scene.columns = table.integer_or("columns", static_cast<int>(std::min<std::size_t>(3, variants.size())), 1, 20);
    if (table.has("crop")) {
        scene.crop = table.numbers("crop", 4, {.min = 0.0, .max = 1.0});
        if (!(scene.crop[0] < scene.crop[2] && scene.crop[1] < scene.crop[3])) {
            table.fail("crop",
                       "has no inside, expected [left, top, right, bottom], shares of the frame from its upper left");
        }
    }
    scene.ghosts_deg = table.optional_number("ghosts_deg", {.min = 0.0, .max = 89.9});
    scene.has_veiling_glare = table.boolean_or("veiling_glare", false);
    scene.has_audit = table.boolean_or("audit", false);
    scene.has_streaks = table.boolean_or("streaks", false);
    if (scene.has_streaks) {
        expect_streaks(table, scene);
    }
    scene.growth_samples = table.integer_or("growth_samples", 0, 8, render::kMostSamplesPerPixel);
    scene.noise_percent = table.optional_number("noise_percent", kPositive);
    if (std::optional<TomlTable> chart = table.optional_table("chart")) {
        scene.chart = read_measured_chart(*std::move(chart), variant_names(scene));
    }
    for (TomlTable& check : table.tables("checks")) {
        scene.checks.push_back(read_check(check, scene));
    }
    table.finish();
    return scene;
}

}  // namespace lensproof::studies
