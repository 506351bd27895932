#include "engine/scene/lens_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/input_error.h"

namespace lensproof::scene {

std::vector<std::string> lens_model_names() {
    return {"exact", "paraxial", "thin-lens", "pinhole"};  // in the order of the enumeration
}

LensModel lens_model_named(const std::string& name) {
    const auto names = lens_model_names();
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
        throw InputError(fmt::format("\"{}\" is no camera model, expected one of {}", name, fmt::join(names, ", ")));
    }
    return static_cast<LensModel>(found - names.begin());
}

std::string name_of(LensModel model) {
    return lens_model_names()[static_cast<std::size_t>(model)];
}

}  // namespace lensproof::scene
