#include "experiments/studies/photographed_lenses/photographed_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/base/csv.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "experiments/studies/photographed_lenses/photographed_plots.h"

namespace lensproof::studies {

namespace {

constexpr double kRightMedian_um = 12.0;  // an independent trial over 110 pairs had 9.7
constexpr double kBeatenPercent = 90.0;   // the median of pairs' shares was 97
constexpr Bounds kCrop{.min = 0.1, .max = 100.0};
constexpr const char* kPopulation = "population";

std::optional<optics::Projection> projection_named(const std::string& name) {
    if (name == "fisheye") {  // lensfun's word
        return optics::Projection::equidistant;
    }
    for (const optics::Projection projection : optics::kProjections) {
        if (name == optics::projection_name(projection)) {
            return projection;
        }
    }
    return std::nullopt;
}

std::vector<LensPair> pairs_of_manifest(const std::filesystem::path& manifest, const std::filesystem::path& database) {
    std::vector<LensPair> pairs;
    CsvTable table = CsvTable::read(manifest);
    while (const std::optional<CsvRow> row = table.next()) {
        const std::filesystem::path name =
            std::filesystem::path("prescriptions") / (row->text("prescription") + ".csv");
        LensPair pair{
            .lens = referred_file(manifest, name).lexically_normal().string(),
            .photographed = {.model = row->text("lensfun_model"), .crop_factor = row->optional_number("crop", kCrop)},
            .lensfun_data = database};
        pair.photographed.projection = projection_named(row->text("projection"));
        if (!pair.photographed.projection) {
            row->fail("projection", "rectilinear, fisheye, equidistant, equisolid, stereographic or orthographic");
        }
        pairs.push_back(std::move(pair));
    }
    return pairs;
}

LensPair pair_of_table(TomlTable& table, const std::filesystem::path& database) {
    LensPair pair{.lens = formats::read_lens_name(table),
                  .photographed = {.crop_factor = table.optional_number("crop_factor", kCrop)},
                  .lensfun_data = database};
    if (table.has("dng")) {
        pair.dng = referred_file(table.file(), table.text("dng")).lexically_normal();
        pair.photographed.model = pair.dng.filename().string();
        return pair;
    }
    pair.photographed.model = table.text("model");
    if (table.has("projection")) {
        std::vector<std::string> names;
        std::ranges::transform(optics::kProjections, std::back_inserter(names), optics::projection_name);
        pair.photographed.projection = projection_named(table.choice("projection", names));
    }
    return pair;
}

Json pair_json(const PairResult& result) {
    Json json = comparison_json(result.comparison);
    json["id"] = pair_id(result.pair);
    json["wrong"] = Json::list();
    for (const WrongLens& other : result.wrong) {
        json["wrong"].push_back({{"lens", other.name}, {"residual_rms_um", other.residual_um}});
    }
    json["share_beaten"] = result.fraction_beaten();
    json["doubt"] = result.doubt.empty() ? Json(nullptr) : Json(result.doubt);
    return json;
}

Json summary_json(const PopulationSummary& summary) {
    return {{"pairs", summary.pairs},
            {"wrong_comparisons", summary.wrong},
            {"right_median_um", summary.right_median_um},
            {"right_median_standard_error_um", summary.right_median_error_um},
            {"wrong_median_um", summary.wrong_median_um},
            {"wrong_median_standard_error_um", summary.wrong_median_error_um},
            {"ranked_pairs", summary.ranked},
            {"beaten_median_percent", 100.0 * summary.beaten_median},
            {"right_within_limit_percent", 100.0 * summary.right_within_limit},
            {"wrong_within_limit_percent", 100.0 * summary.wrong_within_limit}};
}

findings::Check population_check(const std::string& id, const std::string& label, double value, double sigma,
                                 const std::string& unit, double limit, findings::Expectation expectation,
                                 const std::string& explanation) {
    return {.id = id,
            .group = "Prescriptions against photographs of their products",
            .subject = kPopulation,
            .label = label,
            .value = value,
            .sigma = sigma,
            .unit = unit,
            .limit = limit,
            .expectation = expectation,
            .explanation = explanation};
}

std::vector<findings::Check> population_checks(const PopulationSummary& summary) {
    std::vector<findings::Check> checks{population_check(
        "right-median", "median residual of distortion", summary.right_median_um, summary.right_median_error_um, "µm",
        kRightMedian_um, findings::Expectation::at_most,
        fmt::format("Over {} pairs, rms over the image height after one focal length was fitted.", summary.pairs))};
    if (summary.ranked > 0) {
        checks.push_back(population_check(
            "beaten", "other lenses that the right one beats, median", 100.0 * summary.beaten_median, 0.0, "%",
            kBeatenPercent, findings::Expectation::at_least,
            fmt::format(
                "Over the {} pairs that have three other lenses of like focal length and format or more; the others' "
                "median is {:.1f} µm.",
                summary.ranked, summary.wrong_median_um)));
    }
    return checks;
}

std::string worst_pairs(const std::vector<PairResult>& results) {
    std::vector<std::pair<double, std::string>> named;
    for (const PairResult& result : results) {
        const auto residual = result.residual_um();
        if (residual && *residual > result.comparison.judgement.limit_um) {
            named.emplace_back(*residual,
                               fmt::format("{} ({:.1f} µm)", result.comparison.photographed.model, *residual));
        }
    }
    std::ranges::sort(named, std::greater{});
    std::string words;
    for (const auto& [residual, name] : named) {
        words += (words.empty() ? "" : "; ") + name;
    }
    return words.empty() ? "none" : words;
}

findings::Subject population_subject(const std::vector<PairResult>& results, const PopulationSummary& summary) {
    return {.id = kPopulation,
            .kind = "population",
            .label = fmt::format("All {} pairs", results.size()),
            .facts = {{"median residual, right prescriptions", fmt::format("{:.1f} µm", summary.right_median_um)},
                      {"median residual, other lenses", fmt::format("{:.1f} µm", summary.wrong_median_um)},
                      {"within the limit",
                       fmt::format("{:.0f} % of the right prescriptions, {:.0f} % of the others",
                                   100.0 * summary.right_within_limit, 100.0 * summary.wrong_within_limit)},
                      {"beyond the limit", worst_pairs(results)}},
            .pictures = {{.name = "population.svg",
                          .caption = "How far prescriptions are from photographed lenses",
                          .width = kPhotographedChartWidth,
                          .height = kPhotographedChartHeight,
                          .bytes = population_chart(results)}}};
}

findings::Subject pair_subject(const PairResult& result) {
    const MeasuredComparison& comparison = result.comparison;
    const std::string id = pair_id(result.pair);
    findings::Subject subject{.id = id,
                              .kind = "lens",
                              .label = fmt::format("{}, crop factor {:.4g}", comparison.photographed.model,
                                                   comparison.photographed.crop_factor)};
    subject.facts.push_back({"prescription", comparison.lens});
    if (const auto& found = comparison.distortion) {
        subject.facts.push_back({"distortion, rms and largest difference",
                                 fmt::format("{:.1f} µm, {:.1f} µm; limit {:.1f} µm", found->residual.rms_um,
                                             found->residual.largest_um, comparison.judgement.limit_um)});
        subject.facts.push_back({"focal length over the simulated one", fmt::format("{:.4f}", found->scale)});
    }
    subject.facts.push_back({"verdict", fmt::format("{}: {}", findings::verdict_name(comparison.judgement.verdict),
                                                    comparison.judgement.reason)});
    if (const auto beaten = result.fraction_beaten()) {
        subject.facts.push_back(
            {"against other lenses",
             fmt::format("nearer than {:.0f} % of {}; the nearest of them is {} ({:.1f} µm)", 100.0 * *beaten,
                         result.wrong.size(), result.wrong.front().name, result.wrong.front().residual_um)});
    }
    if (const auto& colour = comparison.lateral_colour) {
        subject.facts.push_back(
            {"lateral colour, rms difference",
             fmt::format("red {:.1f} µm, blue {:.1f} µm", colour->red.residual.rms_um, colour->blue.residual.rms_um)});
    }
    if (!result.doubt.empty()) {
        subject.facts.push_back({"to be doubted", result.doubt});
    }
    subject.pictures = {{.name = id + ".svg",
                         .caption = "Distortion over the image height",
                         .width = kPhotographedChartWidth,
                         .height = kPhotographedChartHeight,
                         .bytes = pair_chart(result)}};
    return subject;
}

std::pair<std::string, double> entry_of(const LensPair& pair) {
    return {lower_case(pair.photographed.model), pair.photographed.crop_factor.value_or(0.0)};
}

}  // namespace

PhotographedSettings read_photographed_table(TomlTable& table) {
    PhotographedSettings settings;
    if (table.has("others")) {
        settings.others = table.texts("others");
        for (const std::string& lens : settings.others) {
            formats::find_lens_file(lens);
        }
        table.finish();
        return settings;
    }
    std::filesystem::path database;
    if (table.has("lensfun_data")) {
        database = referred_file(table.file(), table.text("lensfun_data")).lexically_normal();
    }
    if (!table.has("pairs")) {
        settings.pairs.push_back(pair_of_table(table, database));
        table.finish();
        return settings;
    }
    const std::filesystem::path manifest = referred_file(table.file(), table.text("pairs")).lexically_normal();
    const bool is_optional = table.boolean_or("optional", false);
    table.finish();
    if (!is_optional || is_there(manifest)) {
        settings.pairs = pairs_of_manifest(manifest, database);
    }
    return settings;
}

findings::Findings photographed_findings(const std::vector<PairResult>& results) {
    const PopulationSummary summary = summarize(results);
    findings::Findings found{.checks = population_checks(summary), .subjects_title = "Photographed lenses"};
    found.not_shown = {
        "A patent's example is not always the lens that was sold, and an entry is a volunteer's fit of one copy.",
        "Agreement of distortion says little of the lens's sharpness."};
    found.subjects.push_back(population_subject(results, summary));
    std::ranges::transform(results, std::back_inserter(found.subjects), pair_subject);
    Json pairs = Json::list();
    std::ranges::transform(results, std::back_inserter(pairs), pair_json);
    found.tables = {{"photographed_lenses", {{"summary", summary_json(summary)}, {"pairs", std::move(pairs)}}}};
    for (const PairResult& result : results) {
        std::ranges::copy(formats::files_of_lens(result.pair.lens), std::back_inserter(found.inputs));
        if (!result.pair.dng.empty()) {
            found.inputs.push_back(result.pair.dng);
        }
    }
    return found;
}

std::vector<findings::Study> read_photographed_lenses(findings::ExperimentFile& file) {
    PhotographedSettings wanted;
    std::set<std::pair<std::string, double>> entries;
    for (TomlTable& table : file.tables("photographed_lenses")) {
        PhotographedSettings read = read_photographed_table(table);
        std::erase_if(read.pairs, [&](const LensPair& pair) { return entries.contains(entry_of(pair)); });
        for (const LensPair& pair : read.pairs) {
            file.add_subject(table, pair.dng.empty() ? "model" : "dng", pair_id(pair));
            entries.insert(entry_of(pair));
        }
        std::ranges::move(read.pairs, std::back_inserter(wanted.pairs));
        std::ranges::move(read.others, std::back_inserter(wanted.others));
    }
    if (wanted.pairs.empty()) {
        return {};
    }
    return {{"photographed_lenses",
             [wanted = std::move(wanted)](const findings::RunSettings& settings, const findings::RunProgress& progress,
                                          const findings::Findings&) {
                 progress("photographed lenses", 0.0);
                 findings::Findings found =
                     photographed_findings(compare_pairs(wanted.pairs, wanted.others, settings.threads));
                 progress("photographed lenses", 1.0);
                 return found;
             }}};
}

}  // namespace lensproof::studies
