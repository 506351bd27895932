#include "experiments/cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "engine/base/confined.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/formats/glass/glass_file.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/image/image.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

void distrust_inputs() {
    if (!distrust_files()) {
        print_message(
            "lensproof: --untrusted: this system has no Landlock (Linux 5.13): the readers of pictures "
            "and meshes are limited in memory and time, but may use files as this program may\n");
    }
}

}  // namespace

void add_common_options(Command& command, CommonOptions& options) {
    options.standard_result = &command.result();
    command.add_option("--json", options.json_file, "Write the machine-readable result to FILE (-: standard output)")
        .type_name("FILE");
    command.add_flag("--quiet", options.quiet, "No progress on standard error");
    command.add_option("--threads", options.threads, "Threads to use (0: one a core)")
        .check(in_range(0, 1024))
        .shows_default();
    command
        .add_option("--largest-picture", formats::largest_picture_mib(),
                    "MiB that a picture read may take in memory, in place of half of the machine's and of what its "
                    "file's size makes likely")
        .type_name("MIB")
        .check(kPositiveOption);
    command.add_flag("--untrusted", distrust_inputs,
                     "Decode pictures and meshes in processes that can do nothing else, and follow no reference out of "
                     "the folder of the file that makes it");
    command.add_option("--seed", options.seed, "Seed of everything random").check(kSeedOption).shows_default();
}

void add_glass_catalogue_option(Command& command, std::vector<std::string>& files) {
    command
        .add_option("--glass-catalogue", files,
                    "Glasses of your own, looked up first: .agf (Zemax), .yml (refractiveindex.info) or .csv; may be "
                    "repeated")
        .type_name("FILE")
        .takes_one_argument();
}

void add_coating_option(Command& command, std::vector<std::string>& wishes) {
    command
        .add_option(
            "--coating", wishes,
            "Coatings in the place of the lens's own: broadband on every face to air, 3=mgf2 on surface 3, none "
            "for bare; several between commas (see lensproof coatings)")
        .type_name("[SURFACE=]NAME,…")
        .takes_one_argument();
}

optics::GlassCatalogue read_glass_catalogues(const std::vector<std::string>& files) {
    optics::GlassCatalogue catalogue = formats::shipped_glasses();
    for (const std::string& file : files) {
        formats::GlassFile read = formats::read_glass_file(file);
        constexpr std::size_t kShownNotes = 5;
        for (std::size_t i = 0; i < std::min(kShownNotes, read.notes.size()); ++i) {
            print_message("lensproof: {}\n", read.notes[i]);
        }
        if (read.notes.size() > kShownNotes) {
            print_message("lensproof: {}: {} more such notes\n", file, read.notes.size() - kShownNotes);
        }
        catalogue.add(std::move(read.glasses));
    }
    return catalogue;
}

void add_index_option(Command& command, std::vector<std::string>& texts) {
    command.add_option("--index", texts, "NAME=VALUE: a constant index in place of a glass; may be repeated")
        .type_name("NAME=VALUE")
        .takes_one_argument();  // what follows is a lens
}

optics::IndexOverrides parse_indices(const std::vector<std::string>& texts) {
    optics::IndexOverrides overrides;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == 0 || equals == std::string::npos) {
            throw InputError(fmt::format("--index is \"{}\", expected NAME=VALUE", printable(text)));
        }
        const std::optional<double> index = parse_number(text.substr(equals + 1));
        if (!index || !(*index >= 1.0 && *index <= 10.0)) {
            throw InputError(fmt::format("--index {}: expected an index from 1 to 10", printable(text)));
        }
        overrides[text.substr(0, equals)] = *index;
    }
    return overrides;
}

void check_json_name(const CommonOptions& options) {
    if (!options.json_file.empty() && options.json_file != "-") {
        check_output_name(options.json_file);
    }
}

namespace {

void put_json(const CommonOptions& options, const std::function<void(std::ostream&)>& write) {
    if (const std::string& file = options.json_file; file == "-") {
        write(*options.standard_result);
    } else if (!file.empty()) {
        check_place(write_somewhere({file}, [&](const std::filesystem::path& place) { write_stream(place, write); }));
    }
}

}  // namespace

void write_json_result(const CommonOptions& options, const Json& result) {
    put_json(options, [&](std::ostream& out) { out << result.dump(2) << "\n"; });
}

void check_place(const Delivery& delivery) {
    if (!delivery.complaint.empty()) {
        throw std::runtime_error(fmt::format("{}; the result lies in {}", delivery.complaint, delivery.place.string()));
    }
}

void write_json_result(const CommonOptions& options, const Json& result, std::string_view list,
                       const std::function<void(const std::function<void(const Json&)>&)>& each) {
    const std::string text = result.dump(2) + "\n";
    const std::string mark = fmt::format("\"{}\": [", list);  // in no text, which has its quotes escaped
    const std::size_t inside = text.find(mark) + mark.size();
    put_json(options, [&](std::ostream& out) {
        out << text.substr(0, inside);
        const char* between = "\n";
        each([&](const Json& value) {
            out << std::exchange(between, ",\n");
            std::istringstream lines(value.dump(2));
            const char* line_end = "";
            for (std::string line; std::getline(lines, line);) {
                out << std::exchange(line_end, "\n") << "    " << line;
            }
        });
        out << (*between == ',' ? "\n  " : "") << text.substr(inside);
    });
}

Json finding_json(const optics::Finding& finding) {
    return {{"code", finding.code},
            {"severity", optics::severity_name(finding.severity)},
            {"surface", finding.surface > 0 ? Json(finding.surface) : Json(nullptr)},
            {"message", finding.message},
            {"value", finding.value},
            {"limit", finding.limit},
            {"unit", finding.unit}};
}

Json findings_json(const std::vector<optics::Finding>& findings) {
    Json json = Json::list();
    for (const optics::Finding& finding : findings) {
        json.push_back(finding_json(finding));
    }
    return json;
}

void print_findings(const CommonOptions& options, const optics::Lens& lens) {
    for (const optics::Finding& finding : lens.findings) {
        if (!options.quiet) {
            print_message("lensproof: {}: {}, surface {}: {}\n", lens.name, optics::severity_name(finding.severity),
                          finding.surface, finding.message);
        }
    }
}

bool prints_text(const CommonOptions& options) {
    return options.json_file != "-";
}

}  // namespace lensproof::cli
