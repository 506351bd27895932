#include "engine/scene/material/mix_material.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/scene/material/material.h"

namespace lensproof::scene {

namespace {

double fraction_at(const MixMaterial::Part& part, const Vec2d& uv) {
    double fraction = 1.0;
    for (const MixMaterial::Factor& factor : part.factors) {
        const double value = value_at(factor.fraction, uv);
        fraction *= factor.is_complement ? 1.0 - value : value;
    }
    return fraction;
}

std::vector<MixMaterial::Part> parts_of(const Material& material) {
    if (const auto* mix = std::get_if<MixMaterial>(&material.surface)) {
        return mix->parts;
    }
    return {MixMaterial::Part{.material = std::get<SimpleMaterial>(material.surface), .factors = {}}};
}

}  // namespace

MixMaterial mixed(const Material& first, const Material& second, const ScalarTexture& fraction) {
    MixMaterial mix;
    for (const bool is_complement : {true, false}) {
        for (MixMaterial::Part& part : parts_of(is_complement ? first : second)) {
            part.factors.push_back({.fraction = fraction, .is_complement = is_complement});
            mix.parts.push_back(std::move(part));
        }
    }
    if (mix.parts.size() > kMostMixed) {
        throw InputError(fmt::format("a mix of {} materials, expected at most {}", mix.parts.size(), kMostMixed));
    }
    return mix;
}

MixBsdf at_point(const MixMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    MixBsdf mix;
    for (const MixMaterial::Part& part : material.parts) {
        const double fraction = fraction_at(part, uv);
        if (fraction > 0.0) {
            mix.fraction[mix.count] = fraction;
            mix.part[mix.count] =
                std::visit([&](const auto& simple) -> SimpleBsdf { return at_point(simple, uv, path); }, part.material);
            ++mix.count;
        }
    }
    return mix;
}

void read_keys(MixDescription& mix, TomlTable& table, const NameIndex& earlier) {
    const std::vector<std::string> of = table.texts("of");
    if (of.size() != 2) {
        table.fail("of", fmt::format("names {} materials, expected two that stand before this one", of.size()));
    }
    mix.first = earlier.find(table, "of", of[0]);
    mix.second = earlier.find(table, "of", of[1]);
    mix.fraction = table.number_or("share", mix.fraction, kUpToOne);
}

MixMaterial make_material(const MixDescription& mix, const MaterialMaker& maker) {
    return mixed(maker.earlier[mix.first], maker.earlier[mix.second], mix.fraction);
}

}  // namespace lensproof::scene
