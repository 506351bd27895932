#include "experiments/runner/step_shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <thread>

#include "engine/base/input_error.h"
#include "engine/base/parallel.h"

namespace lensproof::runner {

namespace {

/// In turns, since those that are new tend to lie together; a few at a time, since neighbours share a lens.
std::vector<findings::PlannedStep> steps_of_shard(const Experiment& experiment, int index, int count,
                                                  const findings::RunSettings& settings) {
    std::vector<findings::PlannedStep> all;
    for (const auto& [table, study] : experiment.studies) {
        for (findings::PlannedStep& step : study.steps ? study.steps(settings) : std::vector<findings::PlannedStep>{}) {
            if (step.carry_out) {
                all.push_back(std::move(step));
            }
        }
    }
    constexpr std::size_t kTurns = 4;
    constexpr std::size_t kMostTogether = 16;
    const auto shards = static_cast<std::size_t>(count);
    const std::size_t together = std::clamp(all.size() / (kTurns * shards), std::size_t{1}, kMostTogether);
    std::vector<findings::PlannedStep> mine;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i / together % shards == static_cast<std::size_t>(index - 1)) {
            mine.push_back(std::move(all[i]));
        }
    }
    return mine;
}

/// What throws, in words.
template <class Work>
std::optional<findings::Failure> failure_of(const std::string& label, const Work& work) {
    try {
        work();
        return std::nullopt;
    } catch (const InputError& error) {
        return findings::Failure{.study = label, .message = error.what(), .is_of_input = true};
    } catch (const std::exception& error) {
        return findings::Failure{.study = label, .message = error.what()};
    }
}

}  // namespace

StepShard carry_out_shard(const Experiment& experiment, int index, int count, const findings::RunSettings& settings,
                          const findings::RunProgress& progress) {
    const std::vector<findings::PlannedStep> mine = steps_of_shard(experiment, index, count, settings);
    settings.steps.expect(mine);
    const int size = static_cast<int>(mine.size());
    const int threads =
        settings.threads > 0 ? settings.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const int at_once = std::clamp(threads, 1, std::max(1, size));
    findings::RunSettings of_one = settings;
    of_one.threads = std::max(1, threads / at_once);

    const std::string label = fmt::format("share {}/{}", index, count);
    std::mutex mutex;
    double done = 0.0;
    const auto tell = [&](const std::string&, double) {
        const std::scoped_lock lock(mutex);
        progress(label, done);
    };
    std::vector<std::optional<findings::Failure>> failures(mine.size());
    parallel_for(
        size, at_once,
        [&](int at) {
            const findings::PlannedStep& step = mine[static_cast<std::size_t>(at)];
            failures[static_cast<std::size_t>(at)] = failure_of(step.label, [&] { step.carry_out(of_one, tell); });
        },
        [&](int finished) {
            const std::scoped_lock lock(mutex);
            done = static_cast<double>(finished) / size;
            progress(label, done);
        });

    StepShard shard{.steps = mine.size()};
    for (std::optional<findings::Failure>& failure : failures) {
        if (failure) {
            shard.failures.push_back(*std::move(failure));
        }
    }
    for (const auto& [table, study] : experiment.studies) {
        if (!study.steps) {
            shard.left.push_back(study.name);
        }
    }
    return shard;
}

}  // namespace lensproof::runner
