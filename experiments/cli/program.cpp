#include "experiments/cli/program.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/formats/image/image.h"
#include "experiments/cli/command.h"
#include "experiments/runner/provenance.h"

namespace lensproof::cli {

namespace {

/// What commands set for the whole process, as it was before.
class ProcessSettings {
  public:
    ProcessSettings() {
        FLAGS_minloglevel = google::GLOG_FATAL;  // Ceres warns of steps that it then takes otherwise
    }
    ~ProcessSettings() {
        FLAGS_minloglevel = level_;
        formats::largest_picture_mib() = largest_picture_mib_;
    }
    ProcessSettings(const ProcessSettings&) = delete;
    ProcessSettings& operator=(const ProcessSettings&) = delete;

  private:
    int level_ = FLAGS_minloglevel;
    std::optional<double> largest_picture_mib_ = formats::largest_picture_mib();
};

/// Whether the path in the message, which came from the command line or a file, is what is wrong.
bool is_unusable_path(const std::error_code& code) {
    return code == std::errc::filename_too_long || code == std::errc::not_a_directory ||
           code == std::errc::too_many_symbolic_link_levels;
}

std::string version_text() {
    return fmt::format("lensproof {}\ncommit {}\nbuilt by {} against {}", runner::program_version(),
                       runner::source_commit(), runner::compiler_version(), runner::library_versions());
}

int run(const std::vector<std::string>& arguments, std::ostream& result) {
    Program program(
        "lensproof",
        "lensproof: does the simulated lens behave like the real one, where not, by how much, and how sure are we?",
        version_text, "Try it: lensproof demo", result);
    add_demo_command(program);
    add_check_command(program);
    add_convert_command(program);
    add_analyze_command(program);
    add_trace_command(program);
    add_ghosts_command(program);
    add_render_command(program);
    add_merge_command(program);
    add_chart_command(program);
    add_measure_command(program);
    add_fit_command(program);
    add_compare_command(program);
    add_export_command(program);
    add_run_command(program);
    add_twins_command(program);
    add_tradeoff_command(program);
    add_plan_command(program);
    add_lenses_command(program);
    add_glasses_command(program);
    add_coatings_command(program);
    add_completion_command(program);
    add_manual_command(program);
    return program.run(arguments);
}

}  // namespace

Outcome outcome_of(const std::function<int()>& work) {
    try {
        return {.status = work(), .message = {}};
    } catch (const UsageError& error) {
        return {.status = kUnusableInput, .message = error.what(), .hint = error.hint()};
    } catch (const InputError& error) {
        return {.status = kUnusableInput, .message = error.what()};
    } catch (const std::filesystem::filesystem_error& error) {
        return {.status = is_unusable_path(error.code()) ? kUnusableInput : kInternalFailure, .message = error.what()};
    } catch (const std::bad_alloc&) {
        return {.status = kInternalFailure, .message = "out of memory"};
    } catch (const std::exception& error) {
        return {.status = kInternalFailure, .message = error.what()};
    }
}

Outcome run_program(const std::vector<std::string>& arguments, std::ostream& result) {
    const ProcessSettings settings;
    return outcome_of([&] { return run(arguments, result); });
}

}  // namespace lensproof::cli
