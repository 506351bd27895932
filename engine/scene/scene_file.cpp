#include "engine/scene/scene_file.h"

#include "engine/scene/scene_file_parts.h"

namespace lensproof::scene {

SceneDescription read_scene(TomlTable& top) {
    NameIndex materials("material");
    NameIndex objects("object");
    SceneDescription scene;
    scene.materials = read_materials(top, materials);
    scene.objects = read_objects(top, materials, objects);
    scene.lights = read_lights(top, objects);
    return scene;
}

}  // namespace lensproof::scene
