#include "experiments/cli/command.h"

#include <fmt/format.h>

#include "engine/io/file.h"

namespace lensproof {

void add_common_options(CLI::App& command, CommonOptions& options) {
    command.add_option("--json", options.json_file, "Write the machine-readable result to FILE (-: standard output)")
        ->type_name("FILE");
    command.add_flag("--quiet", options.quiet, "No progress on standard error");
    command.add_option("--threads", options.threads, "Threads to use (0: one a core)")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    command.add_option("--seed", options.seed, "Seed of everything random")->capture_default_str();
}

void write_json_result(const CommonOptions& options, const nlohmann::ordered_json& result) {
    if (options.json_file.empty()) {
        return;
    }
    const std::string text = result.dump(2) + "\n";
    if (options.json_file == "-") {
        fmt::print("{}", text);
    } else {
        write_file(options.json_file, text);
    }
}

bool prints_text(const CommonOptions& options) {
    return options.json_file != "-";
}

}  // namespace lensproof
