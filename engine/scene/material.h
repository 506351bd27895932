// stub until merged
#pragma once
#include <variant>
#include "engine/scene/bsdf/bsdf.h"
namespace lensproof {
struct DiffuseMaterial { GridSpectrum albedo; };
using Material = std::variant<DiffuseMaterial>;
inline Bsdf bsdf_at(const Material& m, const Vec2d&, const PathWavelengths& p) { return DiffuseBsdf{std::get<DiffuseMaterial>(m).albedo(p)}; }
}
