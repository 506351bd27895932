// experiments/findings/steps.h — the steps of a run: what is finished once is not done again.
#pragma once
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/base/cache.h"
#include "engine/base/json_archive.h"

namespace lensproof::findings {

/// All that a step's result follows from, besides the program and what ships with it: settings, as the experiment's
/// file states them (TomlTable::stated), with the seed where it counts; and files, by their bytes. A threshold is none
/// of it: verdicts are made after the steps.
struct StepInput {
    Json settings;
    std::vector<std::filesystem::path> files{};
};

struct RunSettings;  // study.h

/// Reports what is being done ("tessar, view 2 of 6") and how much of it is.
using RunProgress = std::function<void(const std::string& step, double done)>;

/// A step that is still to be asked for. It may refer to what its study has read, and lives no longer than that.
struct PlannedStep {
    std::string kind;
    std::string label;
    StepInput input;
    double usual_seconds = 1.0;  // roughly, on two cores, where this machine has not done it before
    /// Does this step alone, among RunSettings::steps, as the study would: it waits for no other. None: the study has
    /// to.
    std::function<void(const RunSettings& settings, const RunProgress& progress)> carry_out{};
};

/// Parts of a run that take long: a picture rendered, a camera measured, a value of a sweep. Each is done once and kept
/// until something that it follows from changes, so that a run that was ended goes on where it was:
///
///     const Blur blur = settings.steps.step("blur", {.settings = {{"table", stated}, {"seed", settings.seed}},
///                                                    .files = formats::files_of_lens(lens)},
///                                           [&] { return measure_blur(lens, settings.seed); });
///
/// The result's type says its members to a JsonArchive. Every result is taken from its JSON, when it was just made as
/// when it was kept: so a report has the same bytes whichever it was. Copies count together; any number of threads and
/// of runs may share a folder (engine/base/cache.h).
class Steps {
  public:
    /// Keeps nothing.
    Steps() = default;

    /// `program`: what changes wherever the program, or data that ship with it, may lead to another result. `anew`:
    /// does every step again, and keeps what it finds.
    /// `times`: where it is written how long steps took, for the next run to say how long it will.
    Steps(Cache kept, std::string program, bool anew, Cache times = {})
        : kept_(std::move(kept)), program_(std::move(program)), anew_(anew), times_(std::move(times)) {}

    /// What make() gives. `kind`: a word of letters and hyphens; two calls that make different things of the same input
    /// have different ones. What make() throws is not kept; nor is a result that its JSON does not bring back (which
    /// has a number that is not finite, where the type does not expect one).
    template <class Make>
    std::invoke_result_t<Make> step(std::string_view kind, const StepInput& input, const Make& make) const {
        using Result = std::invoke_result_t<Make>;
        const std::string key = key_of(input);
        if (const std::optional<std::string> text = anew_ ? std::nullopt : kept_.find(kind, key)) {
            if (std::optional<Result> found = brought_back<Result>(*text)) {
                ++count_->kept;
                return *std::move(found);
            }
        }
        const auto start = std::chrono::steady_clock::now();
        Result made = make();
        ++count_->made;
        finished(kind, input, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        const std::string text = to_json(made).dump();
        std::optional<Result> found = brought_back<Result>(text);
        if (!found) {
            return made;
        }
        kept_.store(kind, key, text);
        return *std::move(found);
    }

    /// How many steps were there already, and how many were made.
    [[nodiscard]] int kept() const { return count_->kept; }
    [[nodiscard]] int made() const { return count_->made; }

    [[nodiscard]] bool is_kept(const PlannedStep& step) const;
    /// How long the step will take, as it did before on this machine, or as it usually does; 0 where it is kept.
    [[nodiscard]] double expected_seconds(const PlannedStep& step) const;

    /// Says what is to come, for `finished_seconds` to count.
    void expect(const std::vector<PlannedStep>& steps) const;
    /// Of what was expected: of all, and of what was made since; in the seconds that it was expected to take.
    [[nodiscard]] double all_seconds() const { return count_->all_seconds; }
    [[nodiscard]] double finished_seconds() const { return count_->finished_seconds; }

  private:
    [[nodiscard]] std::string key_of(const StepInput& input) const;
    void finished(std::string_view kind, const StepInput& input, double seconds) const;

    template <class Result>
    static std::optional<Result> brought_back(const std::string& text) {
        try {
            return from_json<Result>(JsonNode::parse(text, "step"));
        } catch (const InputError&) {
            return std::nullopt;
        }
    }

    struct Count {
        std::atomic<int> kept = 0;
        std::atomic<int> made = 0;
        std::mutex mutex;
        std::map<std::string, double> expected;  // seconds of a step that is not made yet
        std::atomic<double> all_seconds = 0.0;
        std::atomic<double> finished_seconds = 0.0;
    };

    Cache kept_;
    std::string program_;
    bool anew_ = false;
    Cache times_;
    std::shared_ptr<Count> count_ = std::make_shared<Count>();
};

}  // namespace lensproof::findings
