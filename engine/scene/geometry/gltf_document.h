// engine/scene/geometry/gltf_document.h — a glTF file as JSON and bytes, as its readers here want it.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/json.h"

namespace lensproof::scene {

/// The JSON of a file: all of it, or the first chunk of the binary form. The rest is not read. Throws InputError where
/// it is none, or of another version than 2.
Json gltf_json(const std::filesystem::path& file);

/// The bytes of the binary form's second chunk; none in the other form, or where there is no such chunk.
std::string glb_buffer(const std::filesystem::path& file);

/// The binary form with other JSON in the place of its own; the JSON alone in the other form.
std::string gltf_with_json(const std::filesystem::path& file, const Json& json);

/// What a URI of "data:…;base64,…" holds. Throws InputError "`place`: …" where it is none.
std::string data_uri_bytes(std::string_view uri, const std::string& place);

/// A relative URI as a file's name: without %20 and the like.
std::string percent_decoded(std::string_view uri);

}  // namespace lensproof::scene
