#include "engine/scene/material/material.h"

#include "engine/base/overloaded.h"

namespace lensproof::scene {

Bsdf bsdf_at(const Material& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    const auto at = [&](const auto& surface) -> Bsdf { return at_point(surface, uv, path); };
    return std::visit(Overloaded{[&](const SimpleMaterial& simple) { return std::visit(at, simple); }, at},
                      material.surface);
}

}  // namespace lensproof::scene
