#include "engine/scene/material/mix_material.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/scene/material/material.h"

namespace lensproof::scene {

namespace {

std::vector<MixMaterial::Part> parts_of(const Material& material) {
    if (const auto* mix = std::get_if<MixMaterial>(&material.surface)) {
        return mix->parts;
    }
    return {MixMaterial::Part{.material = std::get<SimpleMaterial>(material.surface)}};
}

}  // namespace

MixMaterial mixed(const Material& first, const Material& second, double fraction) {
    MixMaterial mix;
    for (const auto& [material, of_it] : {std::pair(&first, 1.0 - fraction), {&second, fraction}}) {
        for (MixMaterial::Part& part : parts_of(*material)) {
            part.fraction *= of_it;
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
        if (part.fraction > 0.0) {
            mix.fraction[mix.count] = part.fraction;
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
