#include <fmt/format.h>

#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "experiments/draw/analysis_plots.h"

namespace lensproof::draw {

void write_plots(const std::filesystem::path& folder, const std::map<std::string, std::string>& drawings) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error || !std::filesystem::is_directory(folder)) {
        throw InputError(fmt::format("{}: cannot be a folder for plots: {}", folder.string(),
                                     error ? error.message() : "it is a file"));
    }
    for (const auto& [name, svg] : drawings) {
        write_file(folder / name, svg);
    }
}

}  // namespace lensproof::draw
