#include "experiments/findings/steps.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "engine/base/hash.h"
#include "engine/base/text.h"

namespace lensproof::findings {

namespace {

/// Of a file of any size; what cannot be read is as good as empty.
std::string hash_of_file(const std::filesystem::path& file) {
    std::error_code error;  // a pipe would wait for ever
    std::ifstream stream;
    if (std::filesystem::is_regular_file(file, error)) {
        stream.open(file, std::ios::binary);
    }
    std::string chunk(std::size_t{1} << 16U, '\0');
    std::uint64_t hash = 0;
    while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), stream.gcount() > 0) {
        hash = hash_of(std::string_view(chunk).substr(0, static_cast<std::size_t>(stream.gcount())), hash);
    }
    return fmt::format("{:016x}", hash);
}

/// A step by what it does, whatever the program and the files: it takes about as long.
std::string work_of(std::string_view kind, const StepInput& input) {
    return fmt::format("{}\n{}", kind, input.settings.dump());
}

constexpr const char* kTimes = "step-seconds";

}  // namespace

std::string Steps::key_of(const StepInput& input) const {
    Json files = Json::list();
    for (const std::filesystem::path& file : input.files) {
        files.push_back(hash_of_file(file));
    }
    return Json{{"program", program_}, {"settings", input.settings}, {"files", std::move(files)}}.dump();
}

bool Steps::is_kept(const PlannedStep& step) const {
    return !anew_ && kept_.find(step.kind, key_of(step.input));
}

double Steps::expected_seconds(const PlannedStep& step) const {
    if (is_kept(step)) {
        return 0.0;
    }
    const std::optional<std::string> before = times_.find(kTimes, work_of(step.kind, step.input));
    return before ? parse_number(*before).value_or(step.usual_seconds) : step.usual_seconds;
}

void Steps::expect(const std::vector<PlannedStep>& steps) const {
    for (const PlannedStep& step : steps) {
        const double seconds = expected_seconds(step);
        const std::scoped_lock lock(count_->mutex);
        count_->expected[work_of(step.kind, step.input)] = seconds;
        count_->all_seconds = count_->all_seconds + seconds;
    }
}

void Steps::finished(std::string_view kind, const StepInput& input, double seconds) const {
    constexpr double kWorthKnowing = 0.5;  // s; a file for every short step would cost more than it tells
    const std::string work = work_of(kind, input);
    if (seconds >= kWorthKnowing) {
        times_.store(kTimes, work, fmt::format("{:.3g}", seconds));
    }
    const std::scoped_lock lock(count_->mutex);
    if (const auto expected = count_->expected.find(work); expected != count_->expected.end()) {
        count_->finished_seconds = count_->finished_seconds + expected->second;
        count_->expected.erase(expected);
    }
}

}  // namespace lensproof::findings
