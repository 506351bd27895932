#include "engine/scene/geometry/mesh_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <cstring>
#include <filesystem>

#include "engine/base/write_file.h"
#include "engine/scene/geometry/mesh_material.h"
#include "engine/scene/geometry/surface_sampler.h"
#include "tests/complaint.h"
#include "tests/engine/scene/scene_shapes.h"

namespace lensproof::scene::mesh_file_test {

namespace fs = std::filesystem;

/// A folder of its own for each test, gone after it.
class MeshFileTest : public testing::Test {
  protected:
    MeshFileTest() { fs::create_directories(folder_); }
    ~MeshFileTest() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const std::string& content) const {
        write_file(folder_ / name, content);
        return folder_ / name;
    }

  private:
    fs::path folder_ = fs::path(testing::TempDir()) /
                       fmt::format("meshes_{}", testing::UnitTest::GetInstance()->current_test_info()->name());
};

// A box of 2 × 3 × 4 from the origin, its six sides as polygons of four, seen counter-clockwise from outside; the top
// is a part of its own, with uvs and normals.
const std::string kBoxObj = R"(# a box
mtllib none.mtl
v 0 0 0
v 2 0 0
v 2 3 0
v 0 3 0
v 0 0 4
v 2 0 4
v 2 3 4
v 0 3 4
o sides
usemtl grey
f 1 4 3 2
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
o top
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
f 5/1/1 6/2/1 7/3/1 8/4/1
)";

std::string box_ply_header(const std::string& format, int faces = 6) {
    return fmt::format(
        "ply\nformat {} 1.0\ncomment a box\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        format, faces);
}

const float kBoxCorners[8][3] = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0},
                                 {0, 0, 4}, {2, 0, 4}, {2, 3, 4}, {0, 3, 4}};
const int kBoxSides[6][4] = {{0, 3, 2, 1}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}};

std::string box_ply() {
    std::string text = box_ply_header("ascii");
    for (const auto& [x, y, z] : kBoxCorners) {
        text += fmt::format("{} {} {}\n", x, y, z);
    }
    for (const auto& [a, b, c, d] : kBoxSides) {
        text += fmt::format("4 {} {} {} {}\n", a, b, c, d);
    }
    return text;
}

template <class T>
void append_bytes(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string box_binary_ply() {
    std::string bytes = box_ply_header("binary_little_endian");
    append_bytes(bytes, kBoxCorners);
    for (const auto& side : kBoxSides) {
        bytes += '\4';
        append_bytes(bytes, side);
    }
    return bytes;
}

/// The box's vertices as floats and its twelve triangles as 16-bit indices.
std::string box_buffer() {
    std::string bytes;
    append_bytes(bytes, kBoxCorners);
    for (const auto& [a, b, c, d] : kBoxSides) {
        for (const int index : {a, b, c, a, c, d}) {
            append_bytes(bytes, static_cast<std::uint16_t>(index));
        }
    }
    return bytes;
}

/// glTF of the box in half its size, under two nodes: the outer doubles it, the inner moves it by (1, 0, 0). `uri`
/// says where the buffer is.
std::string box_gltf(const std::string& uri) {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"name": "outer", "scale": [2, 2, 2], "children": [1]}, {"name": "inner", "translation": [1, 0, 0], "mesh": 0}],
"meshes": [{"name": "box", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
"materials": [{"name": "red"}],
"accessors": [
{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [2, 3, 4]},
{"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
"buffers": [{)" +
           uri + R"("byteLength": 168}]})";
}

std::string box_glb() {
    std::string json = box_gltf("");
    json.append((4 - json.size() % 4) % 4, ' ');
    const std::string buffer = box_buffer();
    std::string bytes = "glTF";
    append_bytes(bytes, std::uint32_t{2});
    append_bytes(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
    append_bytes(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    append_bytes(bytes, static_cast<std::uint32_t>(buffer.size()));
    bytes += std::string("BIN\0", 4) + buffer;
    return bytes;
}

/// The mesh's volume by Gauss' theorem, which also tells that it is closed and faces outwards; and its bounds.
struct Measured {
    double volume = 0.0;
    double area = 0.0;
    Box bounds;
};

Measured measured(const TriangleMesh& mesh) {
    const SceneGeometry scene = test::scene_of(mesh);
    Measured result{.area = SurfaceSampler(scene, 0).area_mm2(), .bounds = scene.bounds()};
    for (const auto& [a, b, c] : mesh.triangles) {
        result.volume += dot(converted<double>(mesh.positions[a]),
                             cross(converted<double>(mesh.positions[b]), converted<double>(mesh.positions[c]))) /
                         6.0;
    }
    return result;
}

// One box in four forms: 24 mm³, 52 mm², with the scale of each form's unit.
TEST_F(MeshFileTest, EveryFormHoldsTheSameBox) {
    const auto expect_box = [](const MeshFile& read, double unit_mm, const Vec3d& corner) {
        const Measured box = measured(read.mesh);
        const double mm3 = unit_mm * unit_mm * unit_mm;
        EXPECT_EQ(read.mesh.triangles.size(), 12U);
        // Coordinates are floats of at most 6 units, six products of them in a volume.
        EXPECT_NEAR(box.volume, 24.0 * mm3, 24.0 * mm3 * 1e-5);
        EXPECT_NEAR(box.area, 52.0 * unit_mm * unit_mm, 52.0 * unit_mm * unit_mm * 1e-6);
        EXPECT_EQ(box.bounds.low, unit_mm * corner);
        EXPECT_EQ(box.bounds.high, unit_mm * (corner + Vec3d{2, 3, 4}));
    };
    expect_box(read_mesh(write("box.obj", kBoxObj)), 1.0, {0, 0, 0});
    expect_box(read_mesh(write("box.obj", kBoxObj), {.mm_per_unit = 25.0}), 25.0, {0, 0, 0});
    // What OBJ may say otherwise: corners counted back, fourth coordinates, colours, lines that go on, and lines of
    // three points, which Assimp writes beyond their end.
    const auto for_each = [](std::string text, const std::string& old, const std::string& put) {
        for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at + put.size())) {
            text.replace(at, old.size(), put);
        }
        return text;
    };
    for (const auto& [name, obj] : {std::pair{"back", for_each(kBoxObj, "f 1 4 3 2", "f -8 -5 -6 -7")},
                                    {"fourth", for_each(kBoxObj, "v 2 3 4", "v 4 6 8 2")},
                                    {"coloured", for_each(kBoxObj, "v 2 3 4", "v 2 3 4 0.5 0.5 0.5")},
                                    {"on", for_each(kBoxObj, "f 2 3 ", "f 2 \\\n3 ")},
                                    {"returns", for_each(kBoxObj, "\n", "\r\n")},
                                    {"digits", for_each(kBoxObj, "v 2 3 4", "v 2.0000000000000000000000000000 3 4")},
                                    {"lines", kBoxObj + "l 1/1/1 2/2/1 3\nl 1 2 3 4 5\np 1\nf 1 2\n"},
                                    {"half", for_each(kBoxObj, "6/2/1 7/3/1 8/4/1", "6//1 7/3/1 8/4")}}) {
        expect_box(read_mesh(write(std::string(name) + ".obj", obj)), 1.0, {0, 0, 0});
    }
    expect_box(read_mesh(write("box.ply", box_ply())), 1.0, {0, 0, 0});
    expect_box(read_mesh(write("binary.PLY", box_binary_ply())), 1.0, {0, 0, 0});
    // Elements that meshes do not have may stand before theirs.
    const auto with = [](std::string ply, const std::string& values) {
        const std::string others = "element camera 2\nproperty float view_px\nproperty list uchar uchar flags\n";
        ply.insert(ply.find("element vertex"), others);
        return ply.insert(ply.find("end_header\n") + 11, values);
    };
    expect_box(read_mesh(write("camera.ply", with(box_ply(), "7 2 1 1\n8 0\n"))), 1.0, {0, 0, 0});
    expect_box(
        read_mesh(write("binary_camera.ply", with(box_binary_ply(), std::string("\0\0\0\0\2\1\1\0\0\0\0\0", 12)))), 1.0,
        {0, 0, 0});
    // Blanks where Assimp looks for a line's first letter, comments anywhere, and an element of nothing, however many.
    const auto put = [](std::string ply, const std::string& before, const std::string& what) {
        return ply.insert(ply.find(before), what);
    };
    expect_box(read_mesh(write("returns.ply", put(box_ply(), "end_header", "\n\r\r\rcomment\r\r"))), 1.0, {0, 0, 0});
    for (const std::string& ply : {box_ply(), box_binary_ply()}) {
        const std::string none = fmt::format("element edge {}\n", ply == box_ply() ? "0" : "1979999999999999999999993");
        expect_box(read_mesh(write("none.ply", put(ply, "element face", none))), 1.0, {0, 0, 0});
    }
    // Digits without end, and whole numbers that are written as others.
    const std::string digits = for_each(box_ply(), "\n2 3 4\n", "\n2 00000000000000000000000000000003 4\n");
    expect_box(read_mesh(write("digits.ply", for_each(digits, "\n4 0 3 ", "\n4.0 0e0 3e0 "))), 1.0, {0, 0, 0});
    // A list where a number is expected is not read, of which there may be none.
    const std::string flags = "property list uchar uchar material_index\n";
    std::string listed = put(box_ply(), "property list", flags);
    for (std::size_t at = listed.find("\n4 "); at != std::string::npos; at = listed.find("\n4 ", at + 1)) {
        listed.insert(at + 1, "0 ");
    }
    expect_box(read_mesh(write("listed.ply", listed)), 1.0, {0, 0, 0});
    write("box.bin", box_buffer());
    // The outer node doubles what the inner has moved by 1: the box of 4 × 6 × 8 from x = 2, in metres.
    expect_box(read_mesh(write("box.gltf", box_gltf(R"("uri": "box.bin", )"))), 2000.0, {1, 0, 0});
    expect_box(read_mesh(write("box.glb", box_glb()), {.mm_per_unit = 0.5}), 1.0, {1, 0, 0});
}

TEST_F(MeshFileTest, PartsAreFoundByName) {
    const fs::path obj = write("box.obj", kBoxObj);
    const MeshFile top = read_mesh(obj, {.part = "top"});
    EXPECT_EQ(top.mesh.triangles.size(), 2U);
    EXPECT_NEAR(measured(top.mesh).area, 6.0, 1e-6);
    ASSERT_EQ(top.mesh.uvs.size(), top.mesh.positions.size());
    for (std::size_t i = 0; i < top.mesh.uvs.size(); ++i) {
        EXPECT_EQ(top.mesh.uvs[i].x, top.mesh.positions[i].x / 2.0F);
        EXPECT_EQ(top.mesh.uvs[i].y, top.mesh.positions[i].y / 3.0F);
        EXPECT_EQ(top.mesh.normals[i], (Vec3<float>{0, 0, 1}));
    }
    EXPECT_EQ(read_mesh(write("box.glb", box_glb()), {.part = "inner"}).mesh.triangles.size(), 12U);
    const std::string refusal = complaint_about([&] { read_mesh(obj, {.part = "lid"}); });
    EXPECT_NE(refusal.find("no triangles in a part 'lid'"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("sides, top"), std::string::npos) << refusal;
}

// Smooth normals turn a corner into a mean of its three sides, unless the crease angle is below their 90°.
TEST_F(MeshFileTest, NormalsAreThoseAskedFor) {
    const fs::path ply = write("box.ply", box_ply());
    EXPECT_TRUE(read_mesh(ply).mesh.normals.empty());
    EXPECT_TRUE(read_mesh(write("box.obj", kBoxObj), {.normals = MeshNormals::flat}).mesh.normals.empty());
    const TriangleMesh smooth = read_mesh(ply, {.normals = MeshNormals::smooth, .crease_deg = 100.0}).mesh;
    ASSERT_EQ(smooth.normals.size(), smooth.positions.size());
    EXPECT_EQ(smooth.positions.size(), 8U);
    for (std::size_t i = 0; i < smooth.normals.size(); ++i) {
        const Vec3<float> out = smooth.positions[i] - Vec3<float>{1.0F, 1.5F, 2.0F};
        for (const float along :
             {smooth.normals[i].x * out.x, smooth.normals[i].y * out.y, smooth.normals[i].z * out.z}) {
            EXPECT_GT(along, 0.0F);
        }
    }
    const TriangleMesh creased = read_mesh(ply, {.normals = MeshNormals::smooth, .crease_deg = 80.0}).mesh;
    EXPECT_EQ(creased.positions.size(), 24U);
    for (const Vec3<float>& normal : creased.normals) {
        EXPECT_NEAR(std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}), 1.0F, 1e-6F);
    }
    // The box has normals on its top only: the other sides get their own.
    const TriangleMesh mixed = read_mesh(write("box.obj", kBoxObj)).mesh;
    EXPECT_EQ(mixed.normals.size(), mixed.positions.size());
    EXPECT_TRUE(test::scene_of(mixed).remarks().empty());
}

TEST_F(MeshFileTest, WhatIsNotUsedIsNamed) {
    const auto remarks = read_mesh(write("box.glb", box_glb())).remarks;
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_NE(remarks[0].find("box.glb: 1 materials are ignored"), std::string::npos);
    const auto lines = read_mesh(write("lines.obj", kBoxObj + "o wire\nl 1 2\nl 2 3\n")).remarks;
    ASSERT_FALSE(lines.empty());
    EXPECT_NE(lines.back().find("2 lines and points are left out"), std::string::npos) << lines.back();
    EXPECT_TRUE(read_mesh(write("box.ply", box_ply())).remarks.empty());
}

TEST_F(MeshFileTest, UnusableFilesAreRefusedByName) {
    const auto refusal = [&](const std::string& name, const std::string& content) {
        const fs::path file = write(name, content);
        return complaint_about([&] { test::scene_of(read_mesh(file).mesh); });
    };
    const auto expect_named = [&](const std::string& name, const std::string& content, const std::string& reason = "") {
        const std::string said = refusal(name, content);
        EXPECT_NE(said.find(name + ":"), std::string::npos) << name << ": " << said;
        EXPECT_NE(said.find(reason), std::string::npos) << said;
    };
    expect_named("empty.obj", "");
    expect_named("empty.ply", "");
    expect_named("empty.gltf", "");
    expect_named("empty.glb", "");
    expect_named("words.ply", "this is no mesh");
    expect_named("words.gltf", "{\"asset\": 3}");
    expect_named("box.stl", "solid", "expected .gltf, .glb, .obj or .ply");
    expect_named("points.obj", "v 0 0 0\nv 1 1 1\n");
    const std::string corners = "v 0 0 0\nv 1 1 1\nv 1 0 0\n";
    expect_named("index.obj", corners + "f 1 2 7\n", "line 4: a face goes to the vertex 7 of 3");
    expect_named("before.obj", corners + "f 1 2 -4\n", "line 4: 'f 1 2 -4'");
    expect_named("zero.obj", corners + "f 1 2 0\n", "line 4");
    expect_named("none.obj", corners + "f 1 2 /3\n", "line 4");
    expect_named("four.obj", corners + "f 1/1/1/1 2 3\n", "line 4");
    expect_named("texture.obj", corners + "f 1/1 2/1 3/1\n", "texture coordinate 1 of 0");
    expect_named("weight.obj", "v 0 0 0 0\n", "line 1");
    expect_named("letter.obj", "v 0 0 a\n", "line 1: 'v 0 0 a'");
    // Another format's reader must not be asked, whatever is in it.
    expect_named("obj.gltf", corners + "f 1 2 3\n");
    expect_named("obj.ply", kBoxObj, "does not begin with 'ply'");
    expect_named("nan.obj", "v 0 0 0\nv nan 1 1\nv 1 0 0\nf 1 2 3\n", "vertex");
    expect_named("index.ply",
                 box_ply_header("ascii", 1) + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 99\n");
    expect_named("flat.ply",
                 box_ply_header("ascii", 1) + "0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n",
                 "no triangle that has an area");
    expect_named("gone.gltf", box_gltf(R"("uri": "nowhere.bin", )"));
    std::string many = box_ply_header("ascii", 6);
    many.replace(many.find("vertex 8"), 8, "vertex 4000000000");
    expect_named("many.ply", many);
    std::string more = box_binary_ply();
    more.replace(more.find("vertex 8"), 8, "vertex 2000000000");
    expect_named("more.ply", more);
    const auto with = [](std::string text, const std::string& old, const std::string& put) {
        return text.replace(text.find(old), old.size(), put);
    };
    expect_named("float_count.ply", with(box_ply(), "list uchar", "list float"), "property list float");
    expect_named("half_count.ply", with(box_ply(), "\n4 ", "\n4.5 "), "the face 0 is '4.5");
    expect_named("half_corner.ply", with(box_ply(), "\n4 0 ", "\n4 0.5 "), "the face 0 is '4 0.5");
    expect_named("no_number.ply", with(box_ply(), "\n4 0 ", "\n4 a "), "the face 0 is '4 a");
    expect_named("less.ply", with(with(box_binary_ply(), "list uchar", "list char"), "\4", "\377"),
                 "less than nothing");
    expect_named("twice.ply", with(box_ply(), "element face", "element vertex 9\nelement face"),
                 "promises vertex twice");
    expect_named("no_format.ply", with(box_ply(), "format ascii 1.0\n", ""));
    write("box.bin", box_buffer());
    const std::string gltf = box_gltf(R"("uri": "box.bin", )");
    expect_named("count.gltf", with(gltf, R"("count": 8)", R"("count": 4000000000)"));
    expect_named("indices.gltf", with(gltf, R"("count": 36)", R"("count": 360000000)"));
    expect_named("offset.gltf", with(gltf, R"("byteOffset": 96)", R"("byteOffset": 160)"));
    expect_named("scheme.gltf", box_gltf(R"("uri": "http://", )"), "names http://, expected a file beside it");
    expect_named("short.glb", std::string("glTF\2\0\0\0\x40\0\0\0\xF0\0\xFF\xFEJSON{}", 22), "cut off");
    expect_named("first.gltf", with(gltf, R"("version": "2.0")", R"("version": "1.0")"), "no glTF of version 2");
    expect_named("loop.gltf", with(gltf, R"("children": [1])", R"("children": [0])"));
    EXPECT_NE(complaint_about([] { read_mesh("no/such.obj"); }).find("no/such.obj: no such file"), std::string::npos);
    EXPECT_NE(complaint_about([] { read_mesh(testing::TempDir()); }).find("is a folder"), std::string::npos);
}

// Assimp opens files by their names, the mesh's own and those that it says: it would wait for a pipe's writer, and read
// a device without end.
TEST_F(MeshFileTest, DevicesAndPipesAreRefused) {
    const fs::path folder = write("any", "").parent_path();
    for (const std::string extension : {"obj", "ply", "gltf", "glb", "mtl", "bin"}) {
        const fs::path pipe = folder / ("pipe." + extension);
        ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
        fs::create_symlink("/dev/zero", folder / ("zero." + extension));
    }
    for (const std::string name : {"pipe", "zero"}) {
        for (const std::string extension : {".obj", ".ply", ".gltf", ".glb"}) {
            const std::string own = name + extension;
            EXPECT_TRUE(says(complaint_about([&] { read_mesh(folder / own); }),
                             own + ": is a device or a pipe, expected a mesh's file"));
        }
        const fs::path gltf = write("names.gltf", box_gltf("\"uri\": \"" + name + ".bin\", "));
        const std::string complaint = complaint_about([&] { read_mesh(gltf); });
        EXPECT_TRUE(says(complaint, "names.gltf: names "));
        EXPECT_TRUE(says(complaint, name + ".bin, a device or a pipe, expected a file"));
        // An OBJ file's materials are nobody's business here, and not opened.
        const fs::path obj = write("names.obj", "mtllib " + name + ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        EXPECT_EQ(read_mesh(obj).mesh.triangles.size(), 1U);
    }
}

/// A glTF file of these nodes, the last of which is a triangle, as JSON or in the binary form.
std::string nodes_gltf(const std::string& nodes, const std::string& roots = "0") {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [)" + roots + R"(]}], "nodes": [)" +
           nodes +
           R"(], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}]})";
}
std::string as_glb(std::string json) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t value) {
        const auto bits = static_cast<std::uint32_t>(value);
        return std::string(reinterpret_cast<const char*>(&bits), sizeof bits);
    };
    return "glTF" + word(2) + word(20 + json.size()) + word(json.size()) + "JSON" + json;
}

/// `levels` nodes each of which holds the next `times` times, and a triangle below them.
std::string chain(int levels, int times) {
    std::string nodes;
    for (int i = 1; i <= levels; ++i) {
        nodes += R"({"children": [)" + std::to_string(i);
        for (int k = 1; k < times; ++k) {
            nodes += ", " + std::to_string(i);
        }
        nodes += "]}, ";
    }
    return nodes + R"({"mesh": 0})";
}

// A tree of nodes costs stack for each level and memory for each node, shared ones each time: 24 levels of two make
// 1.8 KB ask for 2²⁵ nodes. What is refused says so by name, in both forms; what is allowed is read, 2¹² shared
// triangles of it.
TEST_F(MeshFileTest, TreesOfNodesAreBounded) {
    std::string roots = "0";
    for (int i = 0; i < 1000; ++i) {
        roots += ", 0";
    }
    const std::pair<std::string, std::string> bad[] = {{nodes_gltf(chain(20'000, 1)), "more than 256 deep"},
                                                       {nodes_gltf(chain(24, 2)), "more than 250000 nodes"},
                                                       {nodes_gltf(chain(200, 2)), "more than 250000 nodes"},
                                                       {nodes_gltf(chain(8, 2), roots), "more than 250000 nodes"},
                                                       {nodes_gltf(R"({"children": [0]})"), "inside itself"}};
    for (const auto& [text, words] : bad) {
        const auto complaint = [&](const std::string& name, const std::string& content) {
            const fs::path file = write(name, content);
            return complaint_about([&] { read_mesh(file); });
        };
        EXPECT_TRUE(says(complaint("tree.gltf", text), "tree.gltf: "));
        EXPECT_TRUE(says(complaint("tree.gltf", text), words));
        EXPECT_TRUE(says(complaint("tree.glb", as_glb(text)), words));
    }
    EXPECT_EQ(read_mesh(write("deep.gltf", nodes_gltf(chain(255, 1)))).mesh.triangles.size(), 1U);
    EXPECT_EQ(read_mesh(write("shared.gltf", nodes_gltf(chain(12, 2)))).mesh.triangles.size(), 4096U);
    EXPECT_TRUE(says(complaint_about([&] { read_mesh(write("nested.gltf", std::string(200'000, '['))); }),
                     "nested.gltf: more than 64 brackets"));
}

// Whatever JSON a file is, it is refused for what it is not, wherever it is looked into first.
TEST_F(MeshFileTest, OtherJsonIsNoGltf) {
    for (const char* text : {"3", "[]", "null", R"({"asset": 5})", R"({"asset": {"version": 2}})"}) {
        SCOPED_TRACE(text);
        const fs::path file = write("other.gltf", text);
        EXPECT_TRUE(says(complaint_about([&] { read_mesh(file); }), "is no glTF of version 2"));
        EXPECT_TRUE(says(complaint_about([&] { gltf_references(file, true); }), "is no glTF of version 2"));
    }
}

// Cut anywhere, a file is refused by name or is a mesh that can be traced; nothing else happens. Binary forms, and
// those that count, tell every cut.
TEST_F(MeshFileTest, CutFilesAreRefusedOrWhole) {
    write("box.bin", box_buffer());
    const std::pair<std::string, std::string> samples[] = {{"box.obj", kBoxObj},
                                                           {"ascii.ply", box_ply()},
                                                           {"binary.ply", box_binary_ply()},
                                                           {"box.gltf", box_gltf(R"("uri": "box.bin", )")},
                                                           {"box.glb", box_glb()}};
    for (const auto& [name, content] : samples) {
        for (int part = 1; part < 50; ++part) {
            const fs::path file = write("cut_" + name, content.substr(0, content.size() * part / 50));
            try {
                const SceneGeometry scene = test::scene_of(read_mesh(file).mesh);
                intersect(scene, {1, 1, 9}, {0, 0, -1}, 0.0, 20.0);
                EXPECT_EQ(name, "box.obj") << part << "/50";
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find("cut_" + name), std::string::npos) << error.what();
            }
        }
    }
}

// A first value whose first byte looks like a line's end: one file in 256, of which every value would be another. The
// bytes move a 1 by 4e-6 at most.
TEST_F(MeshFileTest, ABinaryPlyMayBeginWithAnyByte) {
    for (const char first : {'\n', '\r', ' ', '\0'}) {
        std::string bytes =
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
        bytes += std::string{first, 0, '\x80', '\x3F'} + std::string(12, '\0');  // (1, 0, 0), (0, …
        bytes += std::string{0, 0, '\x80', '\x3F'} + std::string(12, '\0');      // 1, 0), (0, 0, …
        bytes += std::string{0, 0, '\x80', '\x3F', 3} + std::string("\0\0\0\0\1\0\0\0\2\0\0\0", 12);  // 1)
        const SceneGeometry scene({read_mesh(write("any.ply", bytes)).mesh}, {{.shape = 0}});
        EXPECT_NEAR(SurfaceSampler(scene, 0).area_mm2(), std::sqrt(0.75), 1e-5) << int{first};
    }
}

}  // namespace lensproof::scene::mesh_file_test
