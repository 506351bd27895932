// tests/cli/program.h — runs the program `lensproof` and keeps what it said.
#pragma once
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/test_folder.h"

namespace lensproof {

/// Where a spawned program's standard stream goes.
enum class Stream { captured, closed, full_disk, reader_gone };

struct Outcome {
    int status = -1;  // the exit status; minus the signal's number where one ended it
    std::string out;
    std::string err;
    long peak_kib = 0;  // of its memory, or of this test's where that had more when the program was started
};

/// Runs the program with `arguments` in the folder `where` and waits for it. A stream that is not captured stays empty.
Outcome run_program(const std::vector<std::string>& arguments, const std::filesystem::path& where,
                    Stream out = Stream::captured, Stream err = Stream::captured);

/// What the program writes where its standard error is a terminal; its standard output is thrown away. Nothing where no
/// terminal can be opened (/dev/pts is not mounted).
std::optional<std::string> said_to_a_terminal(const std::vector<std::string>& arguments,
                                              const std::filesystem::path& where);

/// The program while it runs, its standard streams thrown away.
class RunningProgram {
  public:
    RunningProgram(const std::vector<std::string>& arguments, const std::filesystem::path& where);
    ~RunningProgram();
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

    void send(int signal) const;
    /// Whether it has ended.
    bool has_ended();
    /// Waits for its end: the exit status; minus the signal's number where one ended it.
    int wait();

  private:
    int child_ = -1;
    bool has_ended_ = false;
    int status_ = 0;  // as waitpid gives it
};

/// A variable of the environment, for a while.
class Variable {
  public:
    Variable(const char* name, const std::string& value) : name_(name) {
        const char* before = std::getenv(name);
        before_ = before != nullptr ? std::optional<std::string>(before) : std::nullopt;
        ::setenv(name, value.c_str(), 1);
    }
    ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    const char* name_;
    std::optional<std::string> before_;
};

/// A folder of its own for a test; gone with all that is in it at the end of its life.
class Workplace {
  public:
    /// Writes `content` to `name` (folders on the way are made) and returns the name.
    std::string file(const std::string& name, std::string_view content) const;
    /// The bytes of `name`; empty where there is none.
    [[nodiscard]] std::string content(const std::string& name) const;
    [[nodiscard]] bool has(const std::string& name) const;
    /// Everything in it, sorted.
    [[nodiscard]] std::vector<std::string> names() const;
    [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
    /// Runs the program here.
    [[nodiscard]] Outcome run(const std::vector<std::string>& arguments, Stream out = Stream::captured,
                              Stream err = Stream::captured) const;
    /// What the program says here where it is asked for JSON, and has to end well.
    [[nodiscard]] nlohmann::json json(std::vector<std::string> arguments) const;

  private:
    TestFolder folder_;
};

/// Runs the program in `place` and expects it to refuse: status 2, nothing on standard output, one message that holds
/// every one of `words`, and no new file.
void expect_refused(const Workplace& place, const std::vector<std::string>& arguments,
                    const std::vector<std::string>& words);

/// `text` with its first `from` replaced by `to`; fails the test where there is none.
std::string with(std::string text, const std::string& from, const std::string& to);

/// A scene of 8 × 6 pixels that renders in no time: a checkerboard through the Tessar.
std::string small_scene();

/// Three views of a chart, 160 × 120 pixels: about the smallest experiment that measures something.
std::string small_experiment();

/// A biconvex singlet in the project's form; line 5 is its first surface.
constexpr const char* kSinglet = R"(name = "singlet"
source = "made up for a test"

surfaces = [
  { radius_mm =  50.0, thickness_mm =  5.0, glass = "BK7", semi_diameter_mm = 10.0 },
  { radius_mm = -50.0, thickness_mm =  5.0,                semi_diameter_mm = 10.0 },
  { stop = true,       thickness_mm = 40.0,                semi_diameter_mm =  8.0 },
]
)";

}  // namespace lensproof
