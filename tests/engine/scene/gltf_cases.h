// tests/engine/scene/gltf_cases.h — glTF files that tests make of materials.
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace lensproof::scene::test {

inline std::string base64(std::string_view bytes) {
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            bits = bits << 8U | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
        }
        for (unsigned j = 0; j < 4; ++j) {
            text += i + j > bytes.size() ? '=' : kDigits[bits >> (18U - 6U * j) & 63U];
        }
    }
    return text;
}

inline std::string data_uri(std::string_view bytes) {
    return "data:application/octet-stream;base64," + base64(bytes);
}

/// What lies in the buffer of `squares_gltf`.
inline std::string squares_buffer() {
    const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const float uvs[] = {0, 1, 1, 1, 1, 0, 0, 0};  // v downwards
    const std::uint16_t indices[] = {0, 1, 2, 0, 2, 3};
    std::string bytes(sizeof positions + sizeof uvs + sizeof indices, '\0');
    std::memcpy(bytes.data(), positions, sizeof positions);
    std::memcpy(bytes.data() + sizeof positions, uvs, sizeof uvs);
    std::memcpy(bytes.data() + sizeof positions + sizeof uvs, indices, sizeof indices);
    return bytes;
}

/// Three squares of 1 m, side by side along x, of the file's materials 1, 0 and none, each covered once by its uvs.
/// `materials` and what follows them: members of the top. `buffer`: the members of the first buffer that say where it
/// is, with a comma.
inline std::string squares_gltf(const std::string& materials, const std::string& buffer) {
    return fmt::format(
        R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0, 1, 2]}}],
"nodes": [{{"mesh": 0}}, {{"mesh": 1, "translation": [1, 0, 0]}}, {{"mesh": 2, "translation": [2, 0, 0]}}],
"meshes": [
{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "indices": 2, "material": 1}}]}},
{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "indices": 2, "material": 0}}]}},
{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "indices": 2}}]}}],
"accessors": [
{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
{{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"}},
{{"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}}],
"bufferViews": [{{"buffer": 0, "byteOffset": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 32}},
{{"buffer": 0, "byteOffset": 80, "byteLength": 12}}],
"buffers": [{{{}"byteLength": 92}}], {}}})",
        buffer, materials);
}

/// The same with its buffer inside.
inline std::string squares_gltf(const std::string& materials) {
    return squares_gltf(materials, fmt::format("\"uri\": \"{}\", ", data_uri(squares_buffer())));
}

}  // namespace lensproof::scene::test
