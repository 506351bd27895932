#include "engine/scene/geometry/confined_mesh.h"

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/confined.h"

namespace lensproof::scene {

namespace {

// A message each: the options' part and their numbers; the mesh's columns as they lie in memory; the remarks, and an
// empty one behind them.

struct Numbers {
    double mm_per_unit;  // 0: as the form has it
    double crease_deg;
    MeshNormals normals;
};

template <class T>
void send_column(MessageChannel& channel, const std::vector<T>& column) {
    channel.send({reinterpret_cast<const char*>(column.data()), column.size() * sizeof(T)});
}

template <class T>
std::vector<T> receive_column(MessageChannel& channel) {
    const std::string bytes = channel.receive();
    std::vector<T> column(bytes.size() / sizeof(T));
    if (!column.empty()) {
        std::memcpy(column.data(), bytes.data(), column.size() * sizeof(T));
    }
    return column;
}

void read(const std::filesystem::path& file, MessageChannel& channel) {
    MeshOptions options{.mm_per_unit = {}, .part = channel.receive()};
    Numbers numbers{};
    channel.receive(reinterpret_cast<char*>(&numbers), sizeof numbers);
    options.normals = numbers.normals;
    options.crease_deg = numbers.crease_deg;
    if (numbers.mm_per_unit > 0.0) {
        options.mm_per_unit = numbers.mm_per_unit;
    }
    const MeshFile read = read_mesh_here(file, options);
    send_column(channel, read.mesh.positions);
    send_column(channel, read.mesh.normals);
    send_column(channel, read.mesh.uvs);
    send_column(channel, read.mesh.triangles);
    for (const std::string& remark : read.remarks) {
        channel.send(remark);
    }
    channel.send("");
}

}  // namespace

MeshFile read_mesh_confined(const std::filesystem::path& file, const MeshOptions& options) {
    MessageChannel channel = start_confined(read, file, std::filesystem::absolute(file).parent_path());
    channel.send(options.part);
    const Numbers numbers{options.mm_per_unit.value_or(0.0), options.crease_deg, options.normals};
    channel.send({reinterpret_cast<const char*>(&numbers), sizeof numbers});
    MeshFile read{.mesh = {.name = file.string()}};
    read.mesh.positions = receive_column<Vec3<float>>(channel);
    read.mesh.normals = receive_column<Vec3<float>>(channel);
    read.mesh.uvs = receive_column<Vec2<float>>(channel);
    read.mesh.triangles = receive_column<std::array<std::uint32_t, 3>>(channel);
    for (std::string remark = channel.receive(); !remark.empty(); remark = channel.receive()) {
        read.remarks.push_back(remark);
    }
    return read;
}

}  // namespace lensproof::scene
