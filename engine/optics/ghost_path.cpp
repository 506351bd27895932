#include "engine/optics/ghost_path.h"

#include <fmt/format.h>

namespace lensproof::optics {

std::string path_fault(const GhostPath& path, int surfaces) {
    const auto name = [&](int index) {
        return index == surfaces ? std::string("the sensor") : fmt::format("surface {}", index + 1);
    };
    if (path.empty() || path.size() % 2 != 0) {
        return "an odd number of reflections sends light away from the sensor, expected an even one";
    }
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i] < 0 || path[i] > surfaces) {
            return fmt::format("surface {} does not exist, expected 1 to {}, or image for the sensor", path[i] + 1,
                               surfaces);
        }
        const bool comes_back = i % 2 == 1;
        if (i > 0 && (comes_back ? path[i] >= path[i - 1] : path[i] <= path[i - 1])) {
            return fmt::format("{} cannot follow {}: light runs {} from there, and meets only those {} it",
                               name(path[i]), name(path[i - 1]), comes_back ? "back" : "forward",
                               comes_back ? "in front of" : "behind");
        }
    }
    return {};
}

}  // namespace lensproof::optics
