#include "engine/formats/prescription/barrel_toml.h"

namespace lensproof::formats {

namespace {

constexpr Bounds kFraction{.min = 0.0, .max = 1.0};

/// What the table does not state is as in `others`.
optics::WallFinish read_finish(TomlTable& table, const optics::WallFinish& others) {
    return {.albedo = table.number_or("albedo", others.albedo, kFraction),
            .gloss = table.number_or("gloss", others.gloss, kFraction),
            .roughness = table.number_or("roughness", others.roughness, kFraction)};
}

}  // namespace

optics::BarrelFinish read_barrel(TomlTable& table) {
    const optics::WallFinish walls = read_finish(table, {});
    const auto part = [&](const char* key) {
        auto own = table.optional_table(key);
        if (!own) {
            return walls;
        }
        const optics::WallFinish finish = read_finish(*own, walls);
        own->finish();
        return finish;
    };
    const optics::BarrelFinish barrel{.tube = part("tube"), .edges = part("edges"), .blades = part("blades")};
    table.finish();
    return barrel;
}

}  // namespace lensproof::formats
