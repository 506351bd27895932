#include "tests/fuzz/file_readers.h"

#include <optional>

#include "calibration/photographed/dng_corrections.h"
#include "engine/base/bytes.h"
#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/photo.h"
#include "engine/render/checkpoint.h"
#include "engine/scene/geometry/geometry.h"
#include "tests/engine/render/film/film_sample.h"
#include "tests/test_folder.h"

namespace lensproof::fuzzed {

namespace {

/// The one file of a process that its readers are given, by this name.
std::filesystem::path file_of(std::string_view bytes, const char* name) {
    static const TestFolder folder;
    std::filesystem::path file = folder.path() / name;
    write_file(file, bytes, Durability::usual);
    return file;
}

/// Pictures that a fuzzer has time for; larger ones take longer, and that is all.
constexpr double kLargestMib = 2.0;

formats::Image read_as_picture_and_photo(const std::filesystem::path& file) {
    formats::largest_picture_mib() = kLargestMib;
    formats::read_photo_header(file, std::nullopt);
    formats::read_photo(file, std::nullopt);
    return formats::read_image(file);
}

}  // namespace

formats::Image picture(std::string_view bytes, Name /*unused*/) {
    return read_as_picture_and_photo(file_of(bytes, "picture"));
}

formats::Image raw_picture(std::string_view bytes, Name /*unused*/) {
    return read_as_picture_and_photo(file_of(bytes, "picture.dng"));
}

calibration::PhotographedLens dng(std::string_view bytes, Name /*unused*/) {
    return calibration::read_dng_corrections(file_of(bytes, "picture.dng"), std::nullopt);
}

render::FilmFile film(std::string_view bytes, Name /*unused*/) {
    formats::largest_picture_mib() = kLargestMib;
    return render::read_film_exr(file_of(bytes, "film.exr"));
}

render::RenderState checkpoint(std::string_view bytes, Name /*unused*/) {
    std::string whole(bytes);
    append_bytes(whole, hash_of(bytes));
    render::RenderState state(render::full_film(2, 2, 1), {.first = 0, .end = 16});
    render::read_checkpoint(file_of(whole, "checkpoint"), {{"scene", "abc"}}, {&state, 1});
    return state;
}

scene::MeshFile gltf(std::string_view bytes, Name /*unused*/) {
    return scene::read_mesh(file_of(bytes, "mesh.gltf"));
}

scene::MeshFile glb(std::string_view bytes, Name /*unused*/) {
    return scene::read_mesh(file_of(bytes, "mesh.glb"));
}

scene::MeshFile obj(std::string_view bytes, Name /*unused*/) {
    return scene::read_mesh(file_of(bytes, "mesh.obj"));
}

scene::MeshFile ply(std::string_view bytes, Name /*unused*/) {
    return scene::read_mesh(file_of(bytes, "mesh.ply"));
}

runner::Experiment experiment(std::string_view bytes, Name /*unused*/) {
    return runner::read_experiment(file_of(bytes, "experiment.toml"));
}

}  // namespace lensproof::fuzzed

namespace lensproof {

void use(const scene::MeshFile& read) {
    try {
        const scene::SceneGeometry geometry({read.mesh}, {{}});
        scene::intersect(geometry, {0.0, 0.0, -1e3}, {0.0, 0.0, 1.0}, 0.0, 1e12);
    } catch (const InputError&) {
        return;  // refused, as a render would
    }
}

}  // namespace lensproof
