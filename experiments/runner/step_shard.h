// experiments/runner/step_shard.h — an experiment's steps shared out: for machines that keep them in one folder.
#pragma once
#include <string>
#include <vector>

#include "experiments/runner/experiment.h"

namespace lensproof::runner {

/// What came of a shard.
struct StepShard {
    std::size_t steps = 0;
    std::vector<findings::Failure> failures{};  // of a step each, by its label
    std::vector<std::string> left{};            // the studies that find their steps as they go
};

/// Does the `index`-th of `count` parts (from 1) of the steps that the studies know beforehand, each of which stands by
/// itself: several at once, which divide the threads between them. So it is not needed that any of the other parts was
/// done, or ever will be: whoever runs the experiment with the same folder of steps does what is not there. One that
/// throws is a failure, and the others go on; what is thrown from `progress`, which is called by one thread at a time,
/// and is no std::exception ends the shard.
StepShard carry_out_shard(const Experiment& experiment, int index, int count, const findings::RunSettings& settings,
                          const findings::RunProgress& progress);

}  // namespace lensproof::runner
