#include "engine/scene/geometry/geometry.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "engine/scene/geometry/geometry_data.h"

namespace lensproof::scene {

namespace {

/// What is asked of Embree, and the nearest answer so far; carried to the callbacks.
struct Query {
    embree::Context context;  // the first member: Embree hands its address back
    const SceneGeometry::Data* data = nullptr;
    Stretch ray;
    double behind_mm = 0.0;  // how far Embree's ray starts behind the true origin
    Meeting nearest;
    std::uint32_t object = RTC_INVALID_GEOMETRY_ID;
    std::uint32_t primitive = 0;
    bool is_occlusion = false;

    /// Takes a meeting if it is nearer; says whether it did.
    bool offer(const Meeting& meeting, std::uint32_t of_object, std::uint32_t of_primitive) {
        const bool is_tie = meeting.at == nearest.at && object != RTC_INVALID_GEOMETRY_ID &&
                            std::pair(of_object, of_primitive) < std::pair(object, primitive);
        if (object != RTC_INVALID_GEOMETRY_ID && !(meeting.at < nearest.at) && !is_tie) {
            return false;
        }
        nearest = meeting;
        object = of_object;
        primitive = of_primitive;
        return true;
    }

    /// How far Embree's ray has to go so that nothing nearer than `at` is lost to its rounding.
    [[nodiscard]] float embree_distance(double at) const {
        return static_cast<float>((at + 2.0 * behind_mm) * (1.0 + kFloatRoundings));
    }
};

Query& query_of(embree::Context* context) {
    return *static_cast<Query*>(static_cast<void*>(context));
}

std::optional<Meeting> meet_analytic(const PlacedObject& placed, const Stretch& ray) {
    const AffineMap& to_local = placed.place.to_local;
    const auto* sphere = std::get_if<Sphere>(placed.shape);
    return sphere != nullptr ? meet(*sphere, to_local, ray) : meet(*std::get_if<Quad>(placed.shape), to_local, ray);
}

ShapePoint point_met(const PlacedObject& placed, const Query& query) {
    if (const auto* mesh = std::get_if<TriangleMesh>(placed.shape)) {
        return shape_point(*mesh, query.primitive, query.nearest.b1, query.nearest.b2);
    }
    if (const auto* quad = std::get_if<Quad>(placed.shape)) {
        return shape_point(*quad, query.nearest.b1, query.nearest.b2);
    }
    const Stretch ray = mapped(placed.place.to_local, query.ray);
    return shape_point(std::get<Sphere>(*placed.shape), ray.origin + query.nearest.at * ray.direction);
}

bool is_usable(const Vec3d& origin, const Vec3d& direction) {
    constexpr double kFarthestOrigin = 1e15;
    return largest_coordinate(origin) <= kFarthestOrigin && dot(direction, direction) > 0.0 &&
           largest_coordinate(direction) < 2.0;
}

/// Prepares the query and Embree's ray for it.
RTCRay start(Query& query, const SceneGeometry::Data& data, const Stretch& ray) {
    embree::init(query.context);
    query.data = &data;
    query.ray = ray;
    query.behind_mm = kFloatRoundings * (largest_coordinate(ray.origin) + data.mesh_reach_mm);
    const auto origin = converted<float>(ray.origin - query.behind_mm * ray.direction);
    const auto direction = converted<float>(ray.direction);
    const float from = static_cast<float>(ray.from * (1.0 - kFloatRoundings));
    return {.org_x = origin.x,
            .org_y = origin.y,
            .org_z = origin.z,
            .tnear = std::max(from, 0.0F),
            .dir_x = direction.x,
            .dir_y = direction.y,
            .dir_z = direction.z,
            .tfar = query.embree_distance(ray.to),
            .mask = ~0U};
}

}  // namespace

void judge_triangle(const RTCFilterFunctionNArguments* arguments) {
    const RTCHit hit = rtcGetHitFromHitN(arguments->hit, 1, 0);
    Query& query = query_of(arguments->context);
    const bool is_instance = hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
    const std::uint32_t object = is_instance ? hit.instID[0] : hit.geomID;
    const ObjectPlace& place = query.data->objects[object].place;
    const Stretch ray = is_instance ? mapped(place.to_local, query.ray) : query.ray;
    const double near = kFloatRoundings * (largest_coordinate(query.ray.origin) + place.reach_mm);
    const auto meeting = meet(corners(query.data->mesh(object), hit.primID), hit.u, hit.v, near, ray);
    if (!meeting || (!query.is_occlusion && !query.offer(*meeting, object, hit.primID))) {
        arguments->valid[0] = 0;
    } else if (!query.is_occlusion) {
        float& embree_far = RTCRayN_tfar(arguments->ray, 1, 0);
        embree_far = std::max(embree_far, query.embree_distance(meeting->at));
    }
}

void intersect_analytic(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) {
        return;
    }
    Query& query = query_of(arguments->context);
    const std::uint32_t object = query.data->analytic[arguments->primID];
    const auto meeting = meet_analytic(query.data->objects[object], query.ray);
    if (meeting && query.offer(*meeting, object, 0)) {
        auto* ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit);
        ray->ray.tfar = std::min(ray->ray.tfar, query.embree_distance(meeting->at));
        ray->hit.geomID = arguments->geomID;
        ray->hit.primID = arguments->primID;
    }
}

void occlude_analytic(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) {
        return;
    }
    const Query& query = query_of(arguments->context);
    if (meet_analytic(query.data->objects[query.data->analytic[arguments->primID]], query.ray)) {
        RTCRayN_tfar(arguments->ray, 1, 0) = -std::numeric_limits<float>::infinity();
    }
}

void bound_analytic(const RTCBoundsFunctionArguments* arguments) {
    const auto& data = *static_cast<const SceneGeometry::Data*>(arguments->geometryUserPtr);
    const Box& box = data.objects[data.analytic[arguments->primID]].bounds;
    const double margin = kFloatRoundings * reach(data.bounds);
    const auto low = converted<float>(box.low - Vec3d{margin, margin, margin});
    const auto high = converted<float>(box.high + Vec3d{margin, margin, margin});
    *arguments->bounds_o = {low.x, low.y, low.z, 0.0F, high.x, high.y, high.z, 0.0F};
}

SceneGeometry::~SceneGeometry() = default;
SceneGeometry::SceneGeometry(SceneGeometry&&) noexcept = default;
SceneGeometry& SceneGeometry::operator=(SceneGeometry&&) noexcept = default;

std::size_t SceneGeometry::object_count() const {
    return data_->objects.size();
}

const SceneObject& SceneGeometry::object(std::uint32_t index) const {
    return data_->objects[index].object;
}

const Shape& SceneGeometry::shape(std::uint32_t object) const {
    return *data_->objects[object].shape;
}

const Box& SceneGeometry::bounds() const {
    return data_->bounds;
}

const std::vector<std::string>& SceneGeometry::remarks() const {
    return data_->remarks;
}

std::optional<SurfaceHit> intersect(const SceneGeometry& scene, const Vec3d& origin, const Vec3d& direction,
                                    double from_mm, double to_mm) {
    if (!is_usable(origin, direction)) {
        return std::nullopt;
    }
    Query query;
    RTCRayHit ray{.ray = start(query, scene.data(), {origin, direction, from_mm, to_mm})};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    if (scene.data().tests_analytic_one_by_one) {
        for (const std::uint32_t object : scene.data().analytic) {
            if (const auto meeting = meet_analytic(scene.data().objects[object], query.ray)) {
                query.offer(*meeting, object, 0);
            }
        }
        if (query.object != RTC_INVALID_GEOMETRY_ID) {
            ray.ray.tfar = query.embree_distance(query.nearest.at);
        }
    }
    if (scene.data().has_embree_geometry) {
        embree::intersect(scene.data().scene.get(), query.context, ray);
    }
    if (query.object == RTC_INVALID_GEOMETRY_ID) {
        return std::nullopt;
    }
    const PlacedObject& met = scene.data().objects[query.object];
    SurfaceHit hit = world_hit(met.place, point_met(met, query));
    hit.distance_mm = query.nearest.at;
    hit.material = met.object.material;
    hit.object = query.object;
    hit.primitive = query.primitive;
    return hit;
}

bool is_occluded(const SceneGeometry& scene, const Vec3d& from, const Vec3d& to) {
    // From one end whatever the order, so that both orders agree to the last bit.
    const bool is_in_order = std::tuple(from.x, from.y, from.z) < std::tuple(to.x, to.y, to.z);
    const Vec3d& origin = is_in_order ? from : to;
    const Vec3d along = is_in_order ? to - from : from - to;
    const double distance = length(along);
    const Vec3d direction = (1.0 / distance) * along;
    if (!is_usable(origin, direction)) {
        return false;
    }
    constexpr double kRoundings = 64.0 * std::numeric_limits<double>::epsilon();
    const double margin = kRoundings * (reach({from, to}) + reach(scene.bounds()));
    Query query;
    query.is_occlusion = true;
    RTCRay ray = start(query, scene.data(), {origin, direction, margin, distance - margin});
    if (scene.data().tests_analytic_one_by_one) {
        for (const std::uint32_t object : scene.data().analytic) {
            if (meet_analytic(scene.data().objects[object], query.ray)) {
                return true;
            }
        }
    }
    if (scene.data().has_embree_geometry) {
        embree::occluded(scene.data().scene.get(), query.context, ray);
    }
    return ray.tfar < 0.0F;
}

}  // namespace lensproof::scene
