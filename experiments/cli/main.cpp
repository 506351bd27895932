// experiments/cli/main.cpp — the program `lensproof`: picks the command, turns failures into exit statuses.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "engine/io/input_error.h"
#include "experiments/cli/command.h"

namespace lensproof {
namespace {

int run(int argc, char** argv) {
    int status = kDone;
    CLI::App app{
        "lensproof: does the simulated lens behave like the real one, where not, by how much, and how sure are we?",
        "lensproof"};
    app.set_version_flag("--version", LENSPROOF_VERSION);
    app.require_subcommand(1);
    add_trace_command(app, status);
    add_render_command(app, status);
    add_measure_command(app, status);
    add_compare_command(app, status);
    add_run_command(app, status);
    add_lenses_command(app, status);
    add_glasses_command(app, status);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);  // --help, --version
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "lensproof: {}\nTry: lensproof --help\n", error.what());
        return kUnusableInput;
    }
    return status;
}

}  // namespace
}  // namespace lensproof

int main(int argc, char** argv) {
    // A reader that closes the pipe early (`| head`) is no reason to die by a signal in the middle of a file.
    std::signal(SIGPIPE, SIG_IGN);
    try {
        return lensproof::run(argc, argv);
    } catch (const lensproof::InputError& error) {
        fmt::print(stderr, "lensproof: {}\n", error.what());
        return lensproof::kUnusableInput;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "lensproof: out of memory\n");
    } catch (const std::exception& error) {
        fmt::print(stderr, "lensproof: {}\n", error.what());
    }
    return lensproof::kInternalFailure;
}
