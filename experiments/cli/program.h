// experiments/cli/program.h — the command line as a function: for `main`, and for programs that hold it.
#pragma once
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace lensproof::cli {

/// How a command ended.
struct Outcome {
    int status = 0;       // an ExitStatus (command.h)
    std::string message;  // why, where it failed; empty where it did what it was asked for
    std::string hint{};   // and a line that says where to read more; empty: there is none
};

/// What work() returns; or what became of it where it threw, which is said of InputError and of any std::exception.
Outcome outcome_of(const std::function<int()>& work);

/// Runs the program's command that the arguments name, without the program's own name before them. What `--json -` asks
/// for goes to `result`; texts for people go to standard output and standard error. Leaves the process as it was, but
/// for what `--untrusted` does to it; one at a time. Throws Stopped where it was asked to stop (engine/base/stop.h),
/// and nothing else.
Outcome run_program(const std::vector<std::string>& arguments, std::ostream& result);

}  // namespace lensproof::cli
