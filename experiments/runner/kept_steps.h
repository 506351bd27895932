// experiments/runner/kept_steps.h — where a run's steps are kept.
#pragma once
#include <filesystem>

#include "experiments/findings/steps.h"

namespace lensproof::runner {

/// In `folder`: 2 GiB at most, those used last. They are known by the sources that this program was built from and by
/// the data that ship with it. `anew`: those that are there are not taken.
///
/// The folder stands beside the report and not among the user's caches: what an hour has made is not to go because
/// another run needs the room, and who removes a report has removed all of it.
findings::Steps steps_kept_in(const std::filesystem::path& folder, bool anew);

}  // namespace lensproof::runner
