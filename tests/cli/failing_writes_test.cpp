// tests/cli/failing_writes_test.cpp — disks that are full, folders that refuse, calls that fail one after the other.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>

#include "tests/cli/program.h"
#include "tests/complaint.h"
#include "tests/places.h"

namespace lensproof::failing_writes_test {

namespace fs = std::filesystem;

/// The largest file that this process and its children may write, for a while.
class FileLimit {
  public:
    explicit FileLimit(rlim_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
    FileLimit(const FileLimit&) = delete;
    FileLimit& operator=(const FileLimit&) = delete;

  private:
    rlimit before_{};
};

/// A command, its results, and what else it may leave.
struct Job {
    std::vector<std::string> arguments;
    std::vector<std::string> files;
    std::vector<std::string> others;
};

constexpr std::size_t kMessage = 1000;  // what the program says goes to a file, too

/// What the user had under those names.
constexpr const char* kBefore = "the user's";

class FailingWrites : public ::testing::Test {
  protected:
    FailingWrites() {
        place_.file("scene.toml", small_scene());
        place_.file("experiment.toml", small_experiment());
        fs::create_directory(temporary_);
    }

    /// Pictures of a chart to measure, and the chart.
    void make_pictures() {
        EXPECT_EQ(place_.run({"run", "experiment.toml", "-o", "made", "--quiet"}).status, 0);
        fs::rename(place_.path() / "made/images/a", place_.path() / "pictures");
        place_.file("chart.toml", "[chart]\nkind = \"checkerboard\"\nsquares = [12, 9]\nsquare_mm = 560.0\n");
    }

    /// What the files hold where nothing fails.
    std::map<std::string, std::string> whole(const Job& job) {
        const Outcome outcome = place_.run(job.arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::map<std::string, std::string> content;
        for (const std::string& file : job.files) {
            content[file] = place_.content(file);
            EXPECT_NE(content[file], "") << file;
        }
        return content;
    }

    /// Runs the job where the user has files of those names, and expects that each is afterwards what it was, or whole
    /// (JSON may name other places); that nothing else lies about; and a message where it went wrong. Returns the exit
    /// status.
    int run(const Job& job, const std::map<std::string, std::string>& expected, const std::string& about) {
        for (const std::string& file : job.files) {
            place_.file(file, kBefore);
        }
        for (const std::string& file : job.others) {
            fs::remove_all(place_.path() / file);
        }
        fs::remove_all(temporary_);
        fs::create_directory(temporary_);
        const std::vector<std::string> before = place_.names();
        const Variable temporary("TMPDIR", temporary_.string());
        std::optional<FileLimit> limit;
        if (largest_file_) {
            limit.emplace(*largest_file_);
        }
        const Outcome outcome = place_.run(job.arguments);
        limit.reset();
        EXPECT_TRUE(outcome.status >= 0 && outcome.status <= 3) << about << ": " << outcome.status << outcome.err;
        EXPECT_TRUE(outcome.status == 0 || says(outcome.err, "lensproof: ")) << about;
        for (const auto& [file, content] : expected) {
            const std::string now = place_.content(file);
            const bool is_whole = file.ends_with(".json") ? nlohmann::json::accept(now) : now == content;
            EXPECT_TRUE(is_whole || (outcome.status != 0 && now == kBefore)) << about << ": " << file;
        }
        const std::string lies_in = "the result lies in ";
        if (const std::size_t at = outcome.err.find(lies_in); at != std::string::npos) {
            const std::size_t begin = at + lies_in.size();
            const fs::path elsewhere = outcome.err.substr(begin, outcome.err.find('\n', begin) - begin);
            const auto result = std::ranges::find_if(
                expected, [&](const auto& file) { return fs::path(file.first).filename() == elsewhere.filename(); });
            EXPECT_TRUE(fs::is_directory(elsewhere) || result->first.ends_with(".json") ||
                        place_.content(elsewhere.string()) == result->second)
                << about << ": " << elsewhere;
        }
        said_ += outcome.err;
        for (const std::string& name : place_.names()) {
            const bool is_known = std::ranges::count(before, name) > 0 || std::ranges::count(job.others, name) > 0 ||
                                  name.starts_with("temporary/");
            EXPECT_TRUE(is_known) << about << ": " << name;
        }
        return outcome.status;
    }

    /// Runs the job with the first, second, … call of a kind failing, until there are no more; each is `widening`
    /// times as far on. Returns how many calls there are, to that factor.
    int fail_in_turn(const Job& job, const std::map<std::string, std::string>& expected, const std::string& kind,
                     double widening) {
        const fs::path mark = temporary_ / "failed";
        const Variable library("LD_PRELOAD", failing_calls_library().string());
        const Variable marked("LENSPROOF_FAILED", mark.string());
        int call = 1;
        for (;; call = std::max(call + 1, static_cast<int>(widening * call))) {
            const Variable fail("LENSPROOF_FAIL", kind + std::to_string(call));
            const int status = run(job, expected, job.arguments[0] + ", " + kind + std::to_string(call));
            if (!fs::exists(mark)) {
                EXPECT_EQ(status, 0);
                return call;
            }
        }
    }

    std::optional<rlim_t> largest_file_;
    std::string said_;
    Workplace place_;
    fs::path temporary_ = place_.path() / "temporary";
};

const Job kRender = {{"render", "scene.toml", "-o", "a.exr", "--json", "a.json", "--preview", "p.png", "--checkpoint",
                      "c.state", "--quiet"},
                     {"a.exr", "a.png", "a.json"},
                     {"p.png", "c.state"}};
const Job kConvert = {{"convert", "tessar", "t.zmx"}, {"t.zmx"}, {}};
const Job kChart = {{"chart", "checkerboard", "-o", "b.pdf", "--quiet"}, {"b.pdf", "b.toml"}, {}};
const Job kRun = {
    {"run", "experiment.toml", "-o", "out", "--fresh", "--quiet"}, {"out/report.html", "out/report.json"}, {}};
// Of the pictures that the run leaves.
const Job kMeasure = {{"measure", "pictures", "--chart", "chart.toml", "--model", "brown-conrady", "--no-self-test",
                       "-o", "m.json", "--json", "again.json", "--quiet"},
                      {"m.json", "again.json"},
                      {}};

// The system's own limit on a file's size, at any byte: what a library leaves in its buffers until the end counts.
TEST_F(FailingWrites, AtAnyByteNothingIsHalfWritten) {
    make_pictures();
    for (const Job& job : {kRender, kConvert, kChart, kMeasure}) {
        const std::map<std::string, std::string> expected = whole(job);
        for (const auto& [file, content] : expected) {
            for (const std::size_t written : {content.size() / 2, content.size() - 40, content.size() - 1}) {
                if (written > kMessage) {
                    largest_file_ = written;
                    EXPECT_EQ(run(job, expected, file + " of " + std::to_string(written) + " bytes"), 3);
                }
            }
        }
        largest_file_.reset();
    }
}

// As a disk fails that is full for a moment, or from then on: each call that opens, writes, flushes, renames or makes a
// folder, in turn.
TEST_F(FailingWrites, AtAnyCallNothingIsHalfWritten) {
    if (failing_calls_library().empty()) {
        GTEST_SKIP() << "the address sanitizer wants to be loaded first";
    }
    make_pictures();
    for (const auto& [job, widening] :
         {std::pair{kRender, 1.3}, {kConvert, 1.3}, {kChart, 1.5}, {kMeasure, 1.3}, {kRun, 5.0}}) {
        const std::map<std::string, std::string> expected = whole(job);
        for (const std::string kind : {"write ", "writes "}) {
            EXPECT_GT(fail_in_turn(job, expected, kind, widening), 5) << job.arguments[0];
        }
    }
    EXPECT_TRUE(says(said_, "p.png cannot be written: No space left on device; the render goes on without"));
    EXPECT_FALSE(says(said_, ".part")) << "no message names a temporary file";
    EXPECT_TRUE(says(said_, "; the result lies in " + temporary_.string()));
}

// Memory that is refused, at one allocation, for once.
TEST_F(FailingWrites, AtAnyAllocationNothingIsHalfWritten) {
    if (failing_calls_library().empty()) {
        GTEST_SKIP() << "the address sanitizer wants to be loaded first";
    }
    make_pictures();
    for (const auto& [job, widening] : {std::pair{kRender, 1.5}, {kConvert, 1.5}, {kMeasure, 3.0}, {kRun, 5.0}}) {
        EXPECT_GT(fail_in_turn(job, whole(job), "new ", widening), 1000) << job.arguments[0];
    }
}

}  // namespace lensproof::failing_writes_test
