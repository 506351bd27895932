// tests/validation/shipped_settings.h — every lens that ships, at each of its zoom positions.
#pragma once
#include <string>
#include <vector>

#include "engine/formats/prescription/prescription_file.h"

namespace lensproof {

/// make(name, position) of each; of a lens without zoom, with an empty position.
template <class Make>
auto of_shipped_settings(const Make& make) {
    std::vector<decltype(make(std::string(), std::string()))> made;
    for (const std::string& name : formats::shipped_lens_names()) {
        const std::vector<optics::ZoomPosition> positions =
            formats::read_prescription(formats::find_lens_file(name)).zoom;
        for (const optics::ZoomPosition& position : positions) {
            made.push_back(make(name, position.name));
        }
        if (positions.empty()) {
            made.push_back(make(name, ""));
        }
    }
    return made;
}

}  // namespace lensproof
