// tests/engine/optics/some_ghosts.h — ways for rays to be tried along.
#pragma once
#include <algorithm>
#include <vector>

#include "engine/optics/ghost_path.h"

namespace lensproof::optics {

/// The ghosts of two reflections, and some of four.
inline std::vector<GhostPath> some_ghosts(int surfaces) {
    std::vector<GhostPath> paths;
    for (int a = 1; a < surfaces; ++a) {
        for (int b = 0; b < a; ++b) {
            paths.push_back({a, b});
            if ((a + b) % 3 == 0) {
                paths.push_back({a, b, std::min(b + 2, surfaces - 1), b});
            }
        }
    }
    return paths;
}

}  // namespace lensproof::optics
