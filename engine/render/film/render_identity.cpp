#include "engine/render/film/render_identity.h"

#include <fmt/format.h>

#include <algorithm>

namespace lensproof::render {

std::optional<std::string> first_difference(const RenderIdentity& found, const RenderIdentity& expected) {
    for (const IdentityPart& part : expected) {
        const auto same = std::ranges::find(found, part.name, &IdentityPart::name);
        if (same == found.end()) {
            return fmt::format("it has no {}, expected {}", part.name, part.value);
        }
        if (same->value != part.value) {
            return fmt::format("its {} is {}, expected {}", part.name, same->value, part.value);
        }
    }
    return std::nullopt;
}

}  // namespace lensproof::render
