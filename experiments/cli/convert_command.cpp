// experiments/cli/convert_command.cpp — `lensproof convert IN OUT`: a prescription from one form to another.
#include <fmt/format.h>

#include <memory>

#include "engine/base/json.h"
#include "engine/formats/prescription/prescription_file.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

struct ConvertOptions {
    CommonOptions common;
    std::string in;
    std::string out;
    std::string zoom;
};

Json to_json(const std::vector<optics::Finding>& findings) {
    Json list = Json::list();
    for (const optics::Finding& finding : findings) {
        list.push_back(finding_json(finding));
    }
    return list;
}

void say(const std::vector<optics::Finding>& findings, const std::filesystem::path& file) {
    for (const optics::Finding& finding : findings) {
        const std::string surface = finding.surface > 0 ? fmt::format("surface {}: ", finding.surface) : "";
        print_message("{}: {}{} ({})\n", optics::severity_name(finding.severity), surface, finding.message,
                      file.filename().string());
    }
}

int convert(const ConvertOptions& options) {
    check_json_name(options.common);
    formats::check_prescription_name(options.out);
    const std::filesystem::path in = formats::find_lens_file(options.in);
    optics::Prescription prescription = formats::read_prescription(in);
    if (!options.zoom.empty()) {
        const std::size_t position = optics::find_zoom_position(prescription, options.zoom);
        prescription = optics::at_zoom_position(std::move(prescription), position);
    }
    const std::vector<optics::Finding> lost = formats::write_prescription(prescription, options.out);
    say(prescription.remarks, in);
    say(lost, options.out);
    write_json_result(options.common, {{"in", in.string()},
                                       {"out", options.out},
                                       {"remarks", to_json(prescription.remarks)},
                                       {"lost", to_json(lost)}});
    if (prints_text(options.common) && !options.common.quiet) {
        print("{}: {} surfaces\n", options.out, prescription.surfaces.size());
    }
    return kDone;
}

}  // namespace

void add_convert_command(Program& program) {
    Command command = program.add_command("convert", "Write a prescription in another form");
    auto options = std::make_shared<ConvertOptions>();
    command.footer(
        "Reads .toml, .zmx, .zar, .seq, .dat (pbrt), .json (Optiland), .roa (rayoptics), .fx (lensoptics) and .csv, "
        "writes .toml, .zmx, .dat and .csv.\n"
        "What the reader did not understand, and what the form of OUT cannot say, goes to standard error: as a warning "
        "where rays then go another way, else as an info.\n"
        "Example: lensproof convert patent.fx patent.toml");
    command.add_option("IN", options->in, "A prescription file, or the name of a lens that ships").required();
    command.add_option("OUT", options->out, "The file to write; its extension tells the form").required();
    command.add_option("--zoom", options->zoom,
                       "Write one zoom position alone, by its name or its number from 1. Forms without zoom hold the "
                       "first one otherwise");
    add_common_options(command, options->common);
    command.runs([options] { return convert(*options); });
}

}  // namespace lensproof::cli
