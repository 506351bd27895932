#include "engine/scene/light/light_file.h"

#include "engine/base/overloaded.h"

namespace lensproof::scene {

namespace {

/// Of two lights of kinds that stand beside each other.
void check_beside(const auto& /*light*/, const auto& /*earlier*/, const std::string& /*where*/, const TomlTable&) {}

}  // namespace

std::vector<LightDescription> read_lights(TomlTable& top, const NameIndex& objects) {
    std::vector<LightDescription> lights;
    for (TomlTable& table : top.tables("lights")) {
        const std::string kind = table.choice("kind", kind_names<LightKind>());
        LightDescription light{
            .kind = of_kind<LightKind>(kind, [&](auto& of_kind) { read_keys(of_kind, table, objects); }),
            .where = table.where()};
        table.finish();
        for (const LightDescription& earlier : lights) {
            std::visit([&](const auto& a, const auto& b) { check_beside(a, b, earlier.where, table); }, light.kind,
                       earlier.kind);
        }
        lights.push_back(std::move(light));
    }
    return lights;
}

LightSource make_light(const LightDescription& light, const LightMaker& maker) {
    const Overloaded source{[]<class... Kinds>(std::variant<Kinds...> one) {
                                return std::visit([](auto& made) { return LightSource(std::move(made)); }, one);
                            },
                            [](auto made) { return LightSource(std::move(made)); }};
    return std::visit([&](const auto& kind) { return source(make_light(kind, maker)); }, light.kind);
}

std::vector<std::filesystem::path> named_files(const LightDescription& light) {
    std::vector<std::filesystem::path> files;
    std::visit(
        [&](const auto& kind) {
            if constexpr (requires { kind.emission; }) {
                if (kind.emission.radiance) {
                    files.push_back(kind.emission.radiance->file);
                }
            }
            if constexpr (requires { kind.image; }) {
                if (kind.image) {
                    files.push_back(*kind.image);
                }
            }
        },
        light.kind);
    return files;
}

}  // namespace lensproof::scene
