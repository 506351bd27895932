#include "experiments/runner/kept_steps.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/data_root.h"
#include "engine/base/file.h"
#include "engine/base/hash.h"
#include "step_digest.h"

namespace lensproof::runner {

namespace fs = std::filesystem;

namespace {

/// Of the glasses, coatings, spectra and markers that every study may look up.
std::string shipped_data_digest() {
    std::vector<fs::path> files;
    for (const char* folder : {"lenses/glass", "lenses/coatings", "engine/spectral/data", "engine/scene/data"}) {
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(data_root() / folder)) {
            if (entry.is_regular_file()) {
                files.push_back(entry.path());
            }
        }
    }
    std::ranges::sort(files);
    std::string digests;
    for (const fs::path& file : files) {
        digests += file.filename().string() + hash_text(read_file(file));
    }
    return hash_text(digests);
}

}  // namespace

findings::Steps steps_kept_in(const fs::path& folder, bool anew) {
    constexpr std::uintmax_t kLimitBytes = std::uintmax_t{2} << 30U;
    return {Cache(folder, kLimitBytes), std::string(kStepDigest) + shipped_data_digest(), anew, Cache::standard()};
}

}  // namespace lensproof::runner
