#include "tests/cli/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "tests/complaint.h"
#include "tests/places.h"

namespace lensproof {

namespace fs = std::filesystem;

namespace {

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// In the child: puts what `stream` asks for in the place of a descriptor.
void redirect(int descriptor, Stream stream, const char* capture) {
    if (stream == Stream::closed) {
        ::close(descriptor);
        return;
    }
    if (stream == Stream::reader_gone) {
        std::array<int, 2> pipe{};
        if (::pipe(pipe.data()) == 0) {
            ::close(pipe[0]);
            ::dup2(pipe[1], descriptor);
            ::close(pipe[1]);
        }
        return;
    }
    const int to = stream == Stream::captured ? ::open(capture, O_WRONLY | O_CREAT | O_TRUNC, 0600)
                                              : ::open("/dev/full", O_WRONLY);
    ::dup2(to, descriptor);
    ::close(to);
}

/// In the child: becomes the program.
[[noreturn]] void become_program(const std::vector<std::string>& arguments, const fs::path& where) {
    std::vector<std::string> words = {program_file()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    std::ranges::transform(words, std::back_inserter(argv), [](std::string& word) { return word.data(); });
    argv.push_back(nullptr);
    if (::chdir(where.c_str()) == 0) {
        ::execv(argv[0], argv.data());
    }
    ::_exit(127);
}

int exit_status(int status) {
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace

Outcome run_program(const std::vector<std::string>& arguments, const fs::path& where, Stream out, Stream err) {
    // Files rather than pipes: neither stream can fill up and block the program.
    const TestFolder captures;
    const std::string out_file = (captures.path() / "out").string();
    const std::string err_file = (captures.path() / "err").string();

    const pid_t child = ::fork();
    if (child == 0) {
        redirect(STDOUT_FILENO, out, out_file.c_str());
        redirect(STDERR_FILENO, err, err_file.c_str());
        become_program(arguments, where);
    }
    int status = 0;
    rusage used{};
    ::wait4(child, &status, 0, &used);
    Outcome outcome{.status = exit_status(status),
                    .out = bytes_of(out_file),
                    .err = bytes_of(err_file),
                    .peak_kib = used.ru_maxrss};
    return outcome;
}

std::optional<std::string> said_to_a_terminal(const std::vector<std::string>& arguments, const fs::path& where) {
    int ours = -1;
    int its = -1;
    if (::openpty(&ours, &its, nullptr, nullptr, nullptr) != 0) {
        return std::nullopt;
    }
    const pid_t child = ::fork();
    if (child == 0) {
        redirect(STDOUT_FILENO, Stream::captured, "/dev/null");
        ::dup2(its, STDERR_FILENO);
        ::close(ours);
        ::close(its);
        become_program(arguments, where);
    }
    ::close(its);
    std::string said;
    std::array<char, 4096> some{};
    for (ssize_t count = 0; (count = ::read(ours, some.data(), some.size())) > 0;) {  // fails once the program is gone
        said.append(some.data(), static_cast<std::size_t>(count));
    }
    ::close(ours);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(exit_status(status), 0) << said;
    return said;
}

RunningProgram::RunningProgram(const std::vector<std::string>& arguments, const fs::path& where) : child_(::fork()) {
    if (child_ == 0) {
        redirect(STDOUT_FILENO, Stream::captured, "/dev/null");
        redirect(STDERR_FILENO, Stream::captured, "/dev/null");
        become_program(arguments, where);
    }
}

RunningProgram::~RunningProgram() {
    send(SIGKILL);
    wait();
}

void RunningProgram::send(int signal) const {
    if (!has_ended_) {
        ::kill(child_, signal);
    }
}

bool RunningProgram::has_ended() {
    has_ended_ = has_ended_ || ::waitpid(child_, &status_, WNOHANG) == child_;
    return has_ended_;
}

int RunningProgram::wait() {
    if (!has_ended_) {
        ::waitpid(child_, &status_, 0);
        has_ended_ = true;
    }
    return exit_status(status_);
}

std::string Workplace::file(const std::string& name, std::string_view content) const {
    fs::create_directories((folder_.path() / name).parent_path());
    std::ofstream stream(folder_.path() / name, std::ios::binary);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    return name;
}

std::string Workplace::content(const std::string& name) const {
    return bytes_of(folder_.path() / name);
}

bool Workplace::has(const std::string& name) const {
    return fs::exists(folder_.path() / name);
}

std::vector<std::string> Workplace::names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
        names.push_back(entry.path().lexically_relative(folder_.path()).string());
    }
    std::ranges::sort(names);
    return names;
}

Outcome Workplace::run(const std::vector<std::string>& arguments, Stream out, Stream err) const {
    return run_program(arguments, folder_.path(), out, err);
}

nlohmann::json Workplace::json(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? nlohmann::json::parse(outcome.out, nullptr, false) : nlohmann::json();
}

void expect_refused(const Workplace& place, const std::vector<std::string>& arguments,
                    const std::vector<std::string>& words) {
    const std::vector<std::string> before = place.names();
    const Outcome outcome = place.run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.rfind("lensproof: ", 0), 0U) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), outcome.err.find("\nTry: ") == std::string::npos ? 1 : 2)
        << outcome.err;
    for (const std::string& word : words) {
        EXPECT_TRUE(says(outcome.err, word));
    }
    EXPECT_EQ(place.names(), before);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << "no \"" << from << "\" to replace";
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string small_scene() {
    return R"([camera]
lens = "tessar"
f_number = 8.0
focus_distance_mm = 10000.0
sensor_mm = [72.0, 54.0]
pixels = [8, 6]
shutter_s = 0.08
iso = 100.0
response = "camera"

[chart]
kind = "checkerboard"
squares = [12, 9]
square_mm = 560.0

[pose]
distance_mm = 10000.0

[render]
samples_per_pixel = 4
layers = 4
)";
}

std::string small_experiment() {
    std::string text = with(small_scene(), "[camera]",
                            "title = \"t\"\n[[simulations]]\nname = \"a\"\nmodel = \"brown-conrady\"\n"
                            "flat_field = false\n[simulations.camera]");
    text = with(with(text, "[chart]", "[simulations.chart]"), "[8, 6]", "[160, 120]");
    return with(text, "[pose]\ndistance_mm = 10000.0",
                "[[simulations.views]]\ndistance_mm = 10000.0\n"
                "[[simulations.views]]\ndistance_mm = 10500.0\ntilt_deg = [30.0, 0.0, 0.0]\n"
                "[[simulations.views]]\ndistance_mm = 10500.0\ntilt_deg = [0.0, 30.0, 0.0]");
}

}  // namespace lensproof
