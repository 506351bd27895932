#include "experiments/cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/glass/glass_file.h"
#include "engine/formats/glass/shipped_glasses.h"

namespace lensproof::cli {

namespace {

/// Digits only: the library turns -1 and 1e30 into some other seed.
std::string complain_unless_seed(const std::string& text) {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
    const bool good = error == std::errc() && end == text.data() + text.size();
    return good ? "" : fmt::format("\"{}\", expected a whole number from 0 to 2^64 - 1", text);
}

std::string complain_unless_positive(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool good = !text.empty() && end == text.c_str() + text.size() && std::isfinite(value) && value > 0.0;
    return good ? "" : fmt::format("\"{}\", expected a finite number above 0", text);
}

std::string complain_unless_number(const std::string& text) {
    const std::optional<double> value = parse_number(text);
    const bool good = value && std::isfinite(*value);
    return good ? "" : fmt::format("\"{}\", expected a number", printable(text));
}

}  // namespace

const CLI::Validator kNumberOption(complain_unless_number, "NUMBER");
const CLI::Validator kPositiveOption(complain_unless_positive, "POSITIVE");

void add_common_options(CLI::App& command, CommonOptions& options) {
    command.add_option("--json", options.json_file, "Write the machine-readable result to FILE (-: standard output)")
        ->type_name("FILE");
    command.add_flag("--quiet", options.quiet, "No progress on standard error");
    command.add_option("--threads", options.threads, "Threads to use (0: one a core)")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    command.add_option("--seed", options.seed, "Seed of everything random")
        ->check(CLI::Validator(complain_unless_seed, "UINT"))
        ->capture_default_str();
}

void add_glass_catalogue_option(CLI::App& command, std::vector<std::string>& files) {
    command
        .add_option("--glass-catalogue", files,
                    "Glasses of your own, looked up first: .agf (Zemax), .yml (refractiveindex.info) or .csv; may be "
                    "repeated")
        ->type_name("FILE")
        ->allow_extra_args(false);
}

optics::GlassCatalogue read_glass_catalogues(const std::vector<std::string>& files) {
    optics::GlassCatalogue catalogue = formats::shipped_glasses();
    for (const std::string& file : files) {
        formats::GlassFile read = formats::read_glass_file(file);
        constexpr std::size_t kShownNotes = 5;
        for (std::size_t i = 0; i < std::min(kShownNotes, read.notes.size()); ++i) {
            fmt::print(stderr, "lensproof: {}\n", read.notes[i]);
        }
        if (read.notes.size() > kShownNotes) {
            fmt::print(stderr, "lensproof: {}: {} more such notes\n", file, read.notes.size() - kShownNotes);
        }
        catalogue.add(std::move(read.glasses));
    }
    return catalogue;
}

void add_index_option(CLI::App& command, std::vector<std::string>& texts) {
    command.add_option("--index", texts, "NAME=VALUE: a constant index in place of a glass; may be repeated")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);  // what follows is a lens
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

void write_json_result(const CommonOptions& options, const nlohmann::ordered_json& result) {
    if (options.json_file.empty()) {
        return;
    }
    const std::string text = result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (options.json_file == "-") {
        fmt::print("{}", text);
    } else {
        write_file(options.json_file, text);
    }
}

nlohmann::ordered_json finding_json(const optics::Finding& finding) {
    return {
        {"code", finding.code},
        {"severity", optics::severity_name(finding.severity)},
        {"surface", finding.surface > 0 ? nlohmann::ordered_json(finding.surface) : nlohmann::ordered_json(nullptr)},
        {"message", finding.message},
        {"value", number_or_null(finding.value)},
        {"limit", number_or_null(finding.limit)},
        {"unit", finding.unit}};
}

bool prints_text(const CommonOptions& options) {
    return options.json_file != "-";
}

}  // namespace lensproof::cli
