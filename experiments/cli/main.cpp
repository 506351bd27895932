// experiments/cli/main.cpp — the program `lensproof`: picks the command, turns failures into exit statuses.
#include <fcntl.h>
#include <fmt/format.h>
#include <glog/logging.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>

#include "engine/base/input_error.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"
#include "experiments/runner/provenance.h"

namespace lensproof::cli {
namespace {

/// Says why the program ends. Where standard error is closed too, the exit status has to do.
void say(const std::string& message) {
    print_message("lensproof: {}\n", message);
}

/// A standard stream that is closed would lend its number to the next file opened, and that file would get the text.
/// In its place stands one that refuses to be written.
void occupy_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) == -1 && ::open("/dev/null", O_RDONLY) == -1) {
            return;
        }
    }
}

/// Whether the path in the message, which came from the command line or a file, is what is wrong.
bool is_unusable_path(const std::error_code& code) {
    return code == std::errc::filename_too_long || code == std::errc::not_a_directory ||
           code == std::errc::too_many_symbolic_link_levels;
}

/// Whether standard output is a pipe that nobody reads any more.
bool has_reader_gone() {
    pollfd output{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
    return ::poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

/// What is left in the buffers may still fail to be written, on a full disk. A reader that has gone has all it wanted.
int flushed(int status) {
    errno = 0;
    std::cout.flush();
    if ((std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) || has_reader_gone()) {
        return status;
    }
    say(fmt::format("standard output cannot be written: {}", std::strerror(errno != 0 ? errno : EIO)));
    return kInternalFailure;
}

std::string version_text() {
    return fmt::format("lensproof {}\ncommit {}\nbuilt by {} against {}", runner::program_version(),
                       runner::source_commit(), runner::compiler_version(), runner::library_versions());
}

int run(int argc, char** argv) {
    Program program(
        "lensproof",
        "lensproof: does the simulated lens behave like the real one, where not, by how much, and how sure are we?",
        version_text, "Try it: lensproof demo");
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
    add_tradeoff_command(program);
    add_plan_command(program);
    add_lenses_command(program);
    add_glasses_command(program);
    add_coatings_command(program);
    add_completion_command(program);
    add_manual_command(program);
    return program.run(argc, argv);
}

}  // namespace
}  // namespace lensproof::cli

int main(int argc, char** argv) {
    // A reader that closes the pipe early (`| head`) is no reason to die by a signal in the middle of a file.
    // A limit on a file's size is a write that fails.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    lensproof::cli::occupy_standard_streams();
    FLAGS_minloglevel = google::GLOG_FATAL;  // Ceres warns of steps that it then takes otherwise
    try {
        return lensproof::cli::flushed(lensproof::cli::run(argc, argv));
    } catch (const lensproof::InputError& error) {
        lensproof::cli::say(error.what());
        return lensproof::cli::kUnusableInput;
    } catch (const std::filesystem::filesystem_error& error) {
        lensproof::cli::say(error.what());
        return lensproof::cli::is_unusable_path(error.code()) ? lensproof::cli::kUnusableInput
                                                              : lensproof::cli::kInternalFailure;
    } catch (const std::bad_alloc&) {
        lensproof::cli::say("out of memory");
    } catch (const std::exception& error) {
        lensproof::cli::say(error.what());
    }
    return lensproof::cli::kInternalFailure;
}
