// engine/render/film/render_identity.h — what a render is of, so that nothing of another one is added to it.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace lensproof::render {

/// Everything that a sample follows from but its pixel and its index, in parts that a person knows: "scene", "lens",
/// "settings", "seed", "version". A value is a hash, or short enough to be shown.
struct IdentityPart {
    std::string name;
    std::string value;
    friend bool operator==(const IdentityPart&, const IdentityPart&) = default;
};
using RenderIdentity = std::vector<IdentityPart>;

/// The first part in which two renders differ: its name and both values, for a message. Nothing where they are the
/// same.
std::optional<std::string> first_difference(const RenderIdentity& found, const RenderIdentity& expected);

}  // namespace lensproof::render
