// experiments/cli/command.h — what the program's commands share.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "engine/optics/finding.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/optics/lens.h"
#include "experiments/cli/command_line.h"

namespace lensproof::cli {

/// Exit statuses, as the command line's contract has them.
enum ExitStatus { kDone = 0, kCheckFailed = 1, kUnusableInput = 2, kInternalFailure = 3 };

/// The options that every command takes.
struct CommonOptions {
    std::string json_file;                    // "-": standard output, and nothing else there
    std::ostream* standard_result = nullptr;  // which is this stream
    bool quiet = false;
    int threads = 0;
    std::uint64_t seed = 0;
};

/// Adds --json, --quiet, --threads and --seed to `command`.
void add_common_options(Command& command, CommonOptions& options);

/// Adds --glass-catalogue FILE, which may be repeated.
void add_glass_catalogue_option(Command& command, std::vector<std::string>& files);

/// The glasses that ship, behind those of the user's files, of which the last comes first. What a file has that is left
/// out goes to standard error.
optics::GlassCatalogue read_glass_catalogues(const std::vector<std::string>& files);

/// Adds --coating, which may be repeated: formats::with_coatings says what it may be.
void add_coating_option(Command& command, std::vector<std::string>& wishes);

/// Adds --index NAME=VALUE, which may be repeated and takes no more than that one argument.
void add_index_option(Command& command, std::vector<std::string>& texts);

/// What --index was given. Throws InputError unless each is a name and an index from 1 to 10.
optics::IndexOverrides parse_indices(const std::vector<std::string>& texts);

/// Throws InputError where --json cannot be written, before long work begins.
void check_json_name(const CommonOptions& options);

/// Writes the machine-readable result where --json asked for it, the last thing that a command does. Bytes that are not
/// UTF-8, as in some files' names, are replaced. Throws std::runtime_error where it had to be put elsewhere.
void write_json_result(const CommonOptions& options, const Json& result);
/// The same with a list in `result`, empty there and on its top level, whose values `each` tells one by one: so that
/// memory does not grow with them.
void write_json_result(const CommonOptions& options, const Json& result, std::string_view list,
                       const std::function<void(const std::function<void(const Json&)>&)>& each);

/// Throws std::runtime_error where a result lies elsewhere than was asked for: it says why, and where.
void check_place(const Delivery& delivery);

/// Every key is there; what does not apply is null: the surface of a finding about the lens as a whole, say.
Json finding_json(const optics::Finding& finding);

/// A list of those.
Json findings_json(const std::vector<optics::Finding>& findings);

/// Says on standard error, unless --quiet, what there is to know of a lens: "lensproof: NAME: warning, surface 3: …".
void print_findings(const CommonOptions& options, const optics::Lens& lens);

/// Whether a person-readable result may go to standard output (not when the JSON goes there).
bool prints_text(const CommonOptions& options);

/// Each adds its command.
void add_chart_command(Program& program);
void add_check_command(Program& program);
void add_analyze_command(Program& program);
void add_trace_command(Program& program);
void add_ghosts_command(Program& program);
void add_render_command(Program& program);
void add_measure_command(Program& program);
void add_merge_command(Program& program);
void add_compare_command(Program& program);
void add_fit_command(Program& program);
void add_convert_command(Program& program);
void add_export_command(Program& program);
void add_run_command(Program& program);
void add_demo_command(Program& program);
void add_twins_command(Program& program);
void add_tradeoff_command(Program& program);
void add_plan_command(Program& program);
void add_lenses_command(Program& program);
void add_glasses_command(Program& program);
void add_coatings_command(Program& program);
void add_completion_command(Program& program);
void add_manual_command(Program& program);

}  // namespace lensproof::cli
