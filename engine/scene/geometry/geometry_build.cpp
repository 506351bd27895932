#include <fmt/format.h>

#include <iterator>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/scene/geometry/geometry_data.h"

namespace lensproof::scene {

namespace {

constexpr double kFarthest = 1e12;

void enclose(Box& box, const Vec3d& point) {
    box.low = {std::min(box.low.x, point.x), std::min(box.low.y, point.y), std::min(box.low.z, point.z)};
    box.high = {std::max(box.high.x, point.x), std::max(box.high.y, point.y), std::max(box.high.z, point.z)};
}

constexpr Box kNothing{.low = {kInfinity, kInfinity, kInfinity}, .high = {-kInfinity, -kInfinity, -kInfinity}};

Box around(const Vec3d& centre, const Vec3d& half) {
    return {.low = centre - half, .high = centre + half};
}

Box bounds_of(const Sphere& sphere, const AffineMap& to_world) {
    const Matrix3& m = to_world.linear;
    return around(to_world.translation, sphere.radius_mm * Vec3d{length(m[0]), length(m[1]), length(m[2])});
}

Box bounds_of(const Quad& quad, const AffineMap& to_world) {
    const auto half = [&](const Vec3d& row) {
        return 0.5 * (std::abs(row.x) * quad.width_mm + std::abs(row.y) * quad.height_mm);
    };
    const Matrix3& m = to_world.linear;
    return around(to_world.translation, {half(m[0]), half(m[1]), half(m[2])});
}

Box bounds_of(const TriangleMesh& mesh, const AffineMap& to_world) {
    Box box = kNothing;
    for (const Vec3<float>& position : mesh.positions) {
        enclose(box, map_point(to_world, converted<double>(position)));
    }
    return box;
}

/// Moves a mesh into world coordinates, once and for all.
void move(TriangleMesh& mesh, const AffineMap& to_world, const AffineMap& to_local) {
    for (Vec3<float>& position : mesh.positions) {
        position = converted<float>(map_point(to_world, converted<double>(position)));
    }
    for (Vec3<float>& normal : mesh.normals) {
        normal = converted<float>(normalized(transposed_times(to_local.linear, converted<double>(normal))));
    }
    if (determinant(to_world.linear) < 0.0) {
        for (auto& triangle : mesh.triangles) {
            std::swap(triangle[1], triangle[2]);  // a mirror image's outward side stays outside
        }
    }
}

void check_size(const Shape& shape, std::size_t index) {
    const auto* sphere = std::get_if<Sphere>(&shape);
    const auto* quad = std::get_if<Quad>(&shape);
    if ((sphere != nullptr && !(sphere->radius_mm > 0.0)) ||
        (quad != nullptr && !(quad->width_mm > 0.0 && quad->height_mm > 0.0))) {
        throw InputError(fmt::format("shape {} of the scene has no size", index));
    }
}

AffineMap checked_inverse(const SceneObject& object, std::size_t index) {
    const std::optional<AffineMap> back = inverse(object.to_world);
    if (!back || !std::isfinite(largest_coordinate(object.to_world.translation))) {
        throw InputError(fmt::format("object {} of the scene: its transform flattens it or is not finite", index));
    }
    return *back;
}

void repair_mesh(SceneGeometry::Data& data, TriangleMesh& mesh) {
    std::ranges::move(repair(mesh), std::back_inserter(data.remarks));
    mesh.positions.reserve(mesh.positions.size() + 1);  // Embree reads 16 bytes where the last has 12
}

void check_shapes(SceneGeometry::Data& data) {
    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        check_size(data.shapes[i], i);
        if (auto* mesh = std::get_if<TriangleMesh>(&data.shapes[i])) {
            repair_mesh(data, *mesh);
        }
    }
}

/// Finds each object's map, and moves the meshes that stand in the scene once.
void place_objects(SceneGeometry::Data& data, const std::vector<SceneObject>& objects) {
    data.uses.assign(data.shapes.size(), 0);
    for (const SceneObject& object : objects) {
        if (object.shape >= data.shapes.size()) {
            throw InputError(fmt::format("object {} of the scene is shape {}, of {}", &object - objects.data(),
                                         object.shape, data.shapes.size()));
        }
        ++data.uses[object.shape];
    }
    data.bounds = objects.empty() ? Box{} : kNothing;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        PlacedObject placed{.object = objects[i]};
        AffineMap to_local = checked_inverse(placed.object, i);
        Shape& shape = data.shapes[placed.object.shape];
        if (auto* mesh = std::get_if<TriangleMesh>(&shape); mesh != nullptr && data.uses[placed.object.shape] == 1) {
            move(*mesh, placed.object.to_world, to_local);
            repair_mesh(data, *mesh);  // in the world's floats, a triangle may have lost its area
            placed.object.to_world = to_local = {};
        }
        placed.shape = &shape;
        data.objects.push_back(placed);
        data.objects.back().place = {.to_world = placed.object.to_world, .to_local = to_local};
    }
}

/// Its rows are of unit length and at right angles.
bool is_rigid(const Matrix3& linear) {
    constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
    const auto is_near = [](double a, double b) { return std::abs(a - b) <= kRounding; };
    const auto& [x, y, z] = linear;
    return is_near(dot(x, x), 1.0) && is_near(dot(y, y), 1.0) && is_near(dot(z, z), 1.0) && is_near(dot(x, y), 0.0) &&
           is_near(dot(y, z), 0.0) && is_near(dot(z, x), 0.0);
}

void bound_objects(SceneGeometry::Data& data) {
    for (PlacedObject& placed : data.objects) {
        const AffineMap& to_world = placed.place.to_world;
        placed.bounds = std::visit([&](const auto& shape) { return bounds_of(shape, to_world); }, *placed.shape);
        const Vec3d stretch = principal_stretches(to_world.linear);
        placed.place.rounding_growth = stretch.x / stretch.z;
        placed.place.is_rigid = is_rigid(to_world.linear);
        placed.place.reach_mm = std::max(reach(placed.bounds), largest_coordinate(to_world.translation));
        if (!(placed.place.reach_mm <= kFarthest)) {
            throw InputError(fmt::format("object {} of the scene lies as far out as {} mm, expected {} at most",
                                         &placed - data.objects.data(), placed.place.reach_mm, kFarthest));
        }
        enclose(data.bounds, placed.bounds.low);
        enclose(data.bounds, placed.bounds.high);
        if (std::holds_alternative<TriangleMesh>(*placed.shape)) {
            data.mesh_reach_mm = std::max(data.mesh_reach_mm, placed.place.reach_mm);
        }
    }
}

/// Marks small meshes, the smallest first, as long as they have few triangles together. A mesh that is instanced is in
/// coordinates of its own, and Embree's, like all that are left.
void choose_few_triangles(SceneGeometry::Data& data) {
    constexpr std::size_t kFewTriangles = 48;  // of one ray in some 70 ns by AVX-512, 100 by AVX2; Embree takes 120
    std::vector<std::uint32_t> meshes;
    for (std::uint32_t i = 0; i < data.objects.size(); ++i) {
        if (std::holds_alternative<TriangleMesh>(*data.objects[i].shape) &&
            data.uses[data.objects[i].object.shape] == 1) {
            meshes.push_back(i);
        }
    }
    const auto size = [&](std::uint32_t object) { return data.mesh(object).triangles.size(); };
    std::ranges::stable_sort(meshes, {}, size);
    std::size_t count = 0;
    const auto first_too_many = std::ranges::find_if(meshes, [&](std::uint32_t object) {
        count += size(object);
        return count > kFewTriangles;
    });
    std::for_each(meshes.begin(), first_too_many,
                  [&](std::uint32_t object) { data.objects[object].is_of_few_triangles = true; });
}

/// Of a ray that both maps only carry from a frame to the other: each of the shape's axes by itself, so that axes which
/// stay at right angles may be stretched by different factors. The general bound would be seen in float.
double growth_axis_by_axis(const ObjectPlace& place) {
    double growth = 1.0;
    const std::array<Vec3d, 3> axes = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    for (std::size_t i = 0; i < axes.size(); ++i) {
        growth = std::max(growth, length(place.to_world.linear * axes[i]) * length(place.to_local.linear[i]));
    }
    return growth;
}

/// Where Embree's word is taken, what a ray leaves has to lie behind it in float.
void state_roundings(SceneGeometry::Data& data) {
    for (PlacedObject& placed : data.objects) {
        if (data.precision == HitPrecision::in_float && std::holds_alternative<TriangleMesh>(*placed.shape) &&
            !placed.is_of_few_triangles) {
            placed.place.epsilon = std::numeric_limits<float>::epsilon();
            placed.place.rounding_growth = growth_axis_by_axis(placed.place);
        }
    }
}

/// Of quads, and of flat meshes that stand in the scene once where all of them have so few triangles that their facets
/// stay in the caches.
void find_facets(SceneGeometry::Data& data) {
    constexpr std::size_t kMostTriangles = 8192;  // of 176 bytes
    const auto flat_mesh = [&](const PlacedObject& placed) {
        const auto* mesh = std::get_if<TriangleMesh>(placed.shape);
        return mesh != nullptr && mesh->normals.empty() && data.uses[placed.object.shape] == 1 ? mesh : nullptr;
    };
    std::size_t triangles = 0;
    for (const PlacedObject& placed : data.objects) {
        const TriangleMesh* mesh = flat_mesh(placed);
        triangles += mesh != nullptr ? mesh->triangles.size() : 0;
    }
    for (PlacedObject& placed : data.objects) {
        const TriangleMesh* mesh = flat_mesh(placed);
        if (const auto* quad = std::get_if<Quad>(placed.shape)) {
            placed.facets = {facet_of(*quad, placed.place)};
        }
        for (std::uint32_t i = 0; mesh != nullptr && triangles <= kMostTriangles && i < mesh->triangles.size(); ++i) {
            placed.facets.push_back(facet_of(*mesh, i, placed.place));
        }
    }
}

embree::Geometry new_geometry(const SceneGeometry::Data& data, RTCGeometryType type) {
    embree::Geometry geometry(rtcNewGeometry(data.device.get(), type));
    if (!geometry) {
        throw std::bad_alloc();
    }
    return geometry;
}

embree::Scene new_scene(const SceneGeometry::Data& data) {
    embree::Scene scene(rtcNewScene(data.device.get()));
    if (!scene) {
        throw std::bad_alloc();
    }
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    return scene;
}

void attach(RTCScene scene, const embree::Geometry& geometry, std::uint32_t id) {
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene, geometry.get(), id);
}

void attach_mesh(const SceneGeometry::Data& data, RTCScene scene, const TriangleMesh& mesh, std::uint32_t id) {
    const embree::Geometry geometry = new_geometry(data, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                               sizeof(mesh.positions[0]), mesh.positions.size());
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(mesh.triangles[0]), mesh.triangles.size());
    if (data.precision == HitPrecision::in_double) {
        rtcSetGeometryIntersectFilterFunction(geometry.get(), judge_triangle);
        rtcSetGeometryOccludedFilterFunction(geometry.get(), judge_triangle);
    }
    attach(scene, geometry, id);
}

void attach_instance(SceneGeometry::Data& data, std::uint32_t object) {
    const PlacedObject& placed = data.objects[object];
    embree::Scene& inner = data.instanced[placed.object.shape];
    if (!inner) {
        inner = new_scene(data);
        attach_mesh(data, inner.get(), data.mesh(object), 0);
        rtcCommitScene(inner.get());
    }
    const embree::Geometry geometry = new_geometry(data, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry.get(), inner.get());
    const Matrix3& m = placed.place.to_world.linear;
    const Vec3d& t = placed.place.to_world.translation;
    std::array<float, 12> rows{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::array<double, 4> row = {m[i].x, m[i].y, m[i].z, i == 0 ? t.x : i == 1 ? t.y : t.z};
        std::ranges::transform(row, &rows[4 * i], [](double value) { return static_cast<float>(value); });
    }
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows.data());
    attach(data.scene.get(), geometry, object);
}

void attach_analytic(SceneGeometry::Data& data) {
    const embree::Geometry geometry = new_geometry(data, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(data.analytic.size()));
    rtcSetGeometryUserData(geometry.get(), &data);
    rtcSetGeometryBoundsFunction(geometry.get(), bound_analytic, nullptr);
    rtcSetGeometryIntersectFunction(geometry.get(), intersect_analytic);
    rtcSetGeometryOccludedFunction(geometry.get(), occlude_analytic);
    attach(data.scene.get(), geometry, static_cast<std::uint32_t>(data.objects.size()));
}

AnalyticObject analytic_object(const PlacedObject& placed, std::uint32_t index) {
    AnalyticObject made{.to_local = placed.place.to_local, .object = index};
    if (const auto* sphere = std::get_if<Sphere>(placed.shape)) {
        made.radius_mm = sphere->radius_mm;
    } else {
        const auto& quad = std::get<Quad>(*placed.shape);
        made.half_mm = {0.5 * quad.width_mm, 0.5 * quad.height_mm};
    }
    return made;
}

void add_few_triangles(SceneGeometry::Data& data, std::uint32_t object) {
    const TriangleMesh& mesh = data.mesh(object);
    for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
        data.triangles.add(sides(mesh, k));
        data.triangle_of.push_back({object, k});
    }
}

/// Hands Embree the object, unless each ray is tested against it.
void add_object(SceneGeometry::Data& data, std::uint32_t object) {
    const PlacedObject& placed = data.objects[object];
    if (!std::holds_alternative<TriangleMesh>(*placed.shape)) {
        data.analytic.push_back(analytic_object(placed, object));
    } else if (placed.is_of_few_triangles) {
        add_few_triangles(data, object);
    } else {
        data.has_embree_geometry = true;
        if (data.uses[placed.object.shape] == 1) {
            attach_mesh(data, data.scene.get(), data.mesh(object), object);
        } else {
            attach_instance(data, object);
        }
    }
}

void build(SceneGeometry::Data& data) {
    data.device.reset(rtcNewDevice(nullptr));
    if (!data.device) {
        throw std::runtime_error("Embree cannot start on this machine");
    }
    data.scene = new_scene(data);
    data.instanced.resize(data.shapes.size());
    data.triangles.reach_mm = data.mesh_reach_mm;
    for (std::uint32_t i = 0; i < data.objects.size(); ++i) {
        add_object(data, i);
    }
    constexpr std::size_t kFew = 6;
    data.tests_analytic_one_by_one = data.analytic.size() <= kFew;
    if (!data.tests_analytic_one_by_one) {
        data.has_embree_geometry = true;
        attach_analytic(data);
    }
    rtcCommitScene(data.scene.get());
    if (const RTCError error = rtcGetDeviceError(data.device.get()); error == RTC_ERROR_OUT_OF_MEMORY) {
        throw std::bad_alloc();
    } else if (error != RTC_ERROR_NONE) {
        throw std::runtime_error(fmt::format("Embree could not build the scene (its error {})", int{error}));
    }
}

}  // namespace

SceneGeometry::SceneGeometry(std::vector<Shape> shapes, std::vector<SceneObject> objects, HitPrecision precision) {
    auto data = std::make_unique<Data>();
    data->precision = precision;
    data->shapes = std::move(shapes);
    check_shapes(*data);
    place_objects(*data, objects);
    bound_objects(*data);
    choose_few_triangles(*data);
    state_roundings(*data);
    find_facets(*data);
    build(*data);
    data_ = std::move(data);
}

}  // namespace lensproof::scene
