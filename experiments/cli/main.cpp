// experiments/cli/main.cpp — the program `lensproof`: says why it failed, and ends with its exit status.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

#include "experiments/cli/command.h"
#include "experiments/cli/program.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {
namespace {

/// Says why the program ends. Where standard error is closed too, the exit status has to do.
void say(const Outcome& outcome) {
    print_message("lensproof: {}\n", outcome.message);
    if (!outcome.hint.empty()) {
        print_message("{}\n", outcome.hint);
    }
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
    say({.status = kInternalFailure,
         .message = fmt::format("standard output cannot be written: {}", std::strerror(errno != 0 ? errno : EIO))});
    return kInternalFailure;
}

}  // namespace
}  // namespace lensproof::cli

int main(int argc, char** argv) {
    // A reader that closes the pipe early (`| head`) is no reason to die by a signal in the middle of a file.
    // A limit on a file's size is a write that fails.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    lensproof::cli::occupy_standard_streams();
    std::vector<std::string> arguments;
    const char* const* const first = argv + std::min(argc, 1);
    lensproof::cli::Outcome outcome =
        lensproof::cli::outcome_of([&arguments, first] {  // two words, which need no memory
            for (const char* const* word = first; *word != nullptr; ++word) {
                arguments.emplace_back(*word);
            }
            return 0;
        });
    if (outcome.message.empty()) {
        outcome = lensproof::cli::run_program(arguments, std::cout);
    }
    if (outcome.message.empty()) {
        return lensproof::cli::flushed(outcome.status);
    }
    lensproof::cli::say(outcome);
    return outcome.status;
}
