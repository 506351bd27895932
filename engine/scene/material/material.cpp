#include "engine/scene/material/material.h"

#include "engine/base/overloaded.h"

namespace lensproof::scene {

bool reads_uv(const Material& material) {
    const auto reads = [](const auto& surface) { return reads_uv(surface); };
    return std::visit(Overloaded{[&](const SimpleMaterial& simple) { return std::visit(reads, simple); }, reads},
                      material.surface);
}

Bsdf bsdf_at(const Material& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    const auto at = [&](const auto& surface) -> Bsdf { return at_point(surface, uv, path); };
    return std::visit(Overloaded{[&](const SimpleMaterial& simple) { return std::visit(at, simple); }, at},
                      material.surface);
}

}  // namespace lensproof::scene
