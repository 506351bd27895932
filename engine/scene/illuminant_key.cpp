#include "engine/scene/illuminant_key.h"

#include "engine/base/input_error.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::scene {

std::string read_illuminant(TomlTable& table, const std::string& key) {
    std::string name = table.text_or(key, "D65");
    try {
        spectral::illuminant(name);
    } catch (const InputError& error) {
        table.fail(key, error.what());
    }
    return name;
}

}  // namespace lensproof::scene
