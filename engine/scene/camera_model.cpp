#include "engine/scene/camera_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/io/input_error.h"

namespace lensproof {

std::vector<std::string> camera_model_names() {
    return {"exact", "paraxial", "thin-lens", "pinhole"};  // in the order of the enumeration
}

CameraModel camera_model_named(const std::string& name) {
    const auto names = camera_model_names();
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
        throw InputError(fmt::format("\"{}\" is no camera model, expected one of {}", name, fmt::join(names, ", ")));
    }
    return static_cast<CameraModel>(found - names.begin());
}

std::string name_of(CameraModel model) {
    return camera_model_names()[static_cast<std::size_t>(model)];
}

}  // namespace lensproof
