#include "engine/scene/geometry/confined_mesh.h"

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/confined.h"

namespace lensproof::scene {

namespace {

// A message each: the options' part and their numbers; how many parts there are, of each and of the whole its material
// and its columns as they lie in memory; the remarks, and an empty one behind them.

struct Numbers {
    double mm_per_unit;  // 0: as the form has it
    double crease_deg;
    MeshNormals normals;
    bool by_material;
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

void send_part(MessageChannel& channel, std::size_t material, const TriangleMesh& mesh) {
    channel.send({reinterpret_cast<const char*>(&material), sizeof material});
    send_column(channel, mesh.positions);
    send_column(channel, mesh.normals);
    send_column(channel, mesh.uvs);
    send_column(channel, mesh.triangles);
}

std::size_t receive_number(MessageChannel& channel) {
    std::size_t number = 0;
    channel.receive(reinterpret_cast<char*>(&number), sizeof number);
    return number;
}

MeshPart receive_part(MessageChannel& channel, const std::filesystem::path& file) {
    MeshPart part{.mesh = {.name = file.string()}, .material = receive_number(channel)};
    part.mesh.positions = receive_column<Vec3<float>>(channel);
    part.mesh.normals = receive_column<Vec3<float>>(channel);
    part.mesh.uvs = receive_column<Vec2<float>>(channel);
    part.mesh.triangles = receive_column<std::array<std::uint32_t, 3>>(channel);
    return part;
}

void read(const std::filesystem::path& file, MessageChannel& channel) {
    MeshOptions options{.mm_per_unit = {}, .part = channel.receive()};
    Numbers numbers{};
    channel.receive(reinterpret_cast<char*>(&numbers), sizeof numbers);
    options.normals = numbers.normals;
    options.crease_deg = numbers.crease_deg;
    options.by_material = numbers.by_material;
    if (numbers.mm_per_unit > 0.0) {
        options.mm_per_unit = numbers.mm_per_unit;
    }
    const MeshFile read = read_mesh_here(file, options);
    const std::size_t parts = read.parts.size();
    channel.send({reinterpret_cast<const char*>(&parts), sizeof parts});
    for (const MeshPart& part : read.parts) {
        send_part(channel, part.material, part.mesh);
    }
    send_part(channel, 0, read.mesh);
    for (const std::string& remark : read.remarks) {
        channel.send(remark);
    }
    channel.send("");
}

}  // namespace

MeshFile read_mesh_confined(const std::filesystem::path& file, const MeshOptions& options) {
    MessageChannel channel = start_confined(read, file, std::filesystem::absolute(file).parent_path());
    channel.send(options.part);
    const Numbers numbers{options.mm_per_unit.value_or(0.0), options.crease_deg, options.normals, options.by_material};
    channel.send({reinterpret_cast<const char*>(&numbers), sizeof numbers});
    MeshFile read;
    for (std::size_t i = receive_number(channel); i > 0; --i) {
        read.parts.push_back(receive_part(channel, file));
    }
    read.mesh = receive_part(channel, file).mesh;
    for (std::string remark = channel.receive(); !remark.empty(); remark = channel.receive()) {
        read.remarks.push_back(remark);
    }
    return read;
}

}  // namespace lensproof::scene
