#include "experiments/studies/tradeoff/scene_case.h"

#include <algorithm>
#include <iterator>

#include "engine/formats/prescription/prescription_file.h"
#include "engine/render/metering.h"
#include "engine/scene/scene_build.h"
#include "experiments/findings/study.h"

namespace lensproof::studies {

SceneCase scene_case(const TomlTable& scene, const std::filesystem::path& file) {
    SceneCase whole{.name = {}, .stated = scene.stated(), .setup = render::read_scene_setup(scene), .files = {file}};
    render::expect_stated_exposure(whole.setup, file);
    if (!whole.setup.chart) {
        std::ranges::move(scene::named_files(whole.setup.scene), std::back_inserter(whole.files));
    }
    if (!whole.setup.camera.lens.empty()) {
        std::ranges::move(formats::files_of_lens(whole.setup.camera.lens), std::back_inserter(whole.files));
    }
    return whole;
}

SceneCase read_scene_case(TomlTable& table, const TomlTable& scene, const std::filesystem::path& file) {
    const std::string name = findings::read_name(table);
    const std::optional<TomlTable> changed = table.optional_table("scene");
    SceneCase changed_scene = scene_case(changed ? scene.overlaid(*changed) : scene, file);
    changed_scene.name = name;
    table.finish();
    return changed_scene;
}

}  // namespace lensproof::studies
