// experiments/cli/chart_command.cpp — `lensproof chart KIND`: a chart to print, and the file that describes it.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/visible.h"
#include "engine/base/write_file.h"
#include "engine/scene/chart/chart_file.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/print/chart_words.h"

namespace lensproof::cli {

namespace {

struct ChartOptions {
    CommonOptions common;
    draw::ChartWish wish;
    std::map<std::string, std::string> counts;
    std::map<std::string, std::optional<double>> numbers;
    std::string paper = "A4";
    bool portrait = false;
    double margin_mm = 10.0;
    double dpi = 600.0;
    std::string output;
};

std::string option_of(std::string key) {
    std::replace(key.begin(), key.end(), '_', '-');
    return "--" + key;
}

draw::PrintLayout layout_of(const ChartOptions& options) {
    draw::PrintLayout layout{
        .paper = draw::parse_paper(options.paper), .margin_mm = options.margin_mm, .dpi = options.dpi};
    if (options.portrait) {
        std::swap(layout.paper.width_mm, layout.paper.height_mm);
    }
    if (2.0 * layout.margin_mm >= layout.paper.width_mm ||
        2.0 * layout.margin_mm + draw::kCaptionHeight_mm >= layout.paper.height_mm) {
        throw InputError(fmt::format("--margin {:g}: leaves nothing of a paper of {:g} × {:g} mm", layout.margin_mm,
                                     layout.paper.width_mm, layout.paper.height_mm));
    }
    return layout;
}

/// The chart of a text that the options made. What is wrong with it is said of the option: there is no file yet.
scene::Chart wished_chart(const std::string& toml) {
    constexpr std::string_view kPlace = ": chart.";
    TomlTable top = TomlTable::parse(toml, "");
    TomlTable table = top.table("chart");
    try {
        return scene::read_chart(table);
    } catch (const InputError& error) {
        const std::string said = error.what();
        const std::size_t place = said.find(kPlace);
        if (place == std::string::npos) {
            throw;
        }
        const std::string of_key = said.substr(place + kPlace.size());
        const std::size_t end = of_key.find_first_of("[: ");
        throw InputError(option_of(of_key.substr(0, end)) + of_key.substr(end));
    }
}

int make_chart(const ChartOptions& options) {
    check_json_name(options.common);
    const draw::PrintLayout layout = layout_of(options);
    draw::ChartWish wish = options.wish;
    for (const auto& [key, text] : options.counts) {
        if (!text.empty()) {
            wish.counts[key] = draw::parse_grid_size(option_of(key), text);
        }
    }
    for (const auto& [key, value] : options.numbers) {
        if (value) {
            wish.numbers[key] = *value;
        }
    }
    const std::string toml = draw::chart_toml(wish, layout);
    const std::filesystem::path file = options.output.empty() ? wish.kind + ".pdf" : options.output;
    std::filesystem::path description = file;
    description.replace_extension(".toml");
    check_output_name(file);
    check_output_name(description);
    // What is drawn is what the file says: read back from it.
    const scene::Chart chart = wished_chart(toml);
    draw::print_chart(chart, layout, draw::chart_caption(toml), file);
    write_file(description,
               "# " + visible(file.filename().string()) +
                   ", for `lensproof measure … --chart`. Lengths are those of a print at 100 %: measure its "
                   "scale.\n" +
                   toml);
    const Vec2d size = scene::pattern_size_mm(chart);
    write_json_result(options.common, {{"kind", wish.kind},
                                       {"file", file.string()},
                                       {"description", description.string()},
                                       {"paper_mm", {layout.paper.width_mm, layout.paper.height_mm}},
                                       {"pattern_mm", {size.x, size.y}}});
    if (prints_text(options.common) && !options.common.quiet) {
        print("{}: {}, {:g} × {:g} mm on {:g} × {:g} mm; print at 100 %\n{}: for measure --chart\n", file.string(),
              wish.kind, size.x, size.y, layout.paper.width_mm, layout.paper.height_mm, description.string());
    }
    return kDone;
}

}  // namespace

void add_chart_command(Program& program) {
    const auto options = std::make_shared<ChartOptions>();
    Command command = program.add_command("chart", "Write a chart to print, and the file that describes it");
    command.footer(
        "Example: lensproof chart charuco --squares 12x8 --square-mm 30 --paper A3 -o board.pdf\n"
        "writes board.pdf and, for `lensproof measure`, board.toml. What is not said is chosen to fill the page.");
    command.add_option("KIND", options->wish.kind, fmt::format("{}", fmt::join(draw::printable_kinds(), ", ")))
        .required();
    command.add_option("-o,--output", options->output, "PDF, SVG or PNG to write (default: KIND.pdf)")
        .type_name("FILE");
    command.add_option("--paper", options->paper, "A0 to A5, letter, tabloid, or WIDTHxHEIGHT in mm").shows_default();
    command.add_flag("--portrait", options->portrait, "The paper's shorter side across");
    command.add_option("--margin", options->margin_mm, "Least margin in mm")
        .check(kNumberOption)
        .check(kNotNegativeOption)
        .shows_default();
    command.add_option("--dpi", options->dpi, "Pixels per inch of a PNG").check(kPositiveOption).shows_default();
    const draw::ChartKeys keys = draw::printable_keys();
    for (const std::string& key : keys.counts) {
        command.add_option(option_of(key), options->counts[key], "Columns and rows, as in 10x7").type_name("CxR");
    }
    const auto add_number = [&](const std::string& key, const OptionCheck& check) {
        command.add_option(option_of(key), options->numbers[key], "As in the chart's file").check(check);
    };
    for (const std::string& key : keys.numbers) {
        add_number(key, kPositiveOption);
    }
    for (const std::string& key : keys.angles) {
        add_number(key, kNumberOption);
    }
    command.add_option("--dictionary", options->wish.dictionary, "Of a ChArUco board's markers, such as DICT_4X4_50");
    add_common_options(command, options->common);
    command.runs([options] { return make_chart(*options); });
}

}  // namespace lensproof::cli
