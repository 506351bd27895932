#include "engine/scene/geometry/geometry.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

#include "engine/base/infinity.h"
#include "engine/scene/geometry/geometry_data.h"
#include "engine/scene/geometry/packet/analytic_kernels.h"

namespace lensproof::scene {

namespace {

/// What a ray has met so far.
struct Nearest {
    Meeting<double> meeting;
    std::uint32_t object = RTC_INVALID_GEOMETRY_ID;  // none
    std::uint32_t primitive = 0;

    [[nodiscard]] bool is_one() const { return object != RTC_INVALID_GEOMETRY_ID; }

    /// Takes a meeting if it is nearer; says whether it did.
    bool offer(const Meeting<double>& other, std::uint32_t of_object, std::uint32_t of_primitive) {
        const bool is_tie =
            other.at == meeting.at && is_one() && std::pair(of_object, of_primitive) < std::pair(object, primitive);
        if (is_one() && !(other.at < meeting.at) && !is_tie) {
            return false;
        }
        *this = {other, of_object, of_primitive};
        return true;
    }
};

/// What is asked of Embree, and the nearest answer so far; carried to the callbacks.
struct Query {
    embree::Context context;  // the first member: Embree hands its address back
    const SceneGeometry::Data* data = nullptr;
    Stretch<double> ray;
    double behind_mm = 0.0;  // how far Embree's ray starts behind the true origin
    Nearest nearest;
    bool is_occlusion = false;

    /// How far Embree's ray has to go so that nothing nearer than `at` is lost to its rounding.
    [[nodiscard]] float embree_distance(double at) const {
        return static_cast<float>((at + 2.0 * behind_mm) * (1.0 + kFloatRoundings));
    }
    [[nodiscard]] float embree_far() const {
        if (is_occlusion && data->precision == HitPrecision::in_float) {
            // Nobody tells what stands at the end from what stands before it.
            return static_cast<float>(ray.to * (1.0 - kFloatRoundings));
        }
        return embree_distance(nearest.is_one() ? nearest.meeting.at : ray.to);
    }
};

Query& query_of(embree::Context* context) {
    return *static_cast<Query*>(static_cast<void*>(context));
}

inline bool is_usable(const Vec3d& origin, const Vec3d& direction) {
    constexpr double kFarthestOrigin = 1e15;
    return largest_coordinate(origin) <= kFarthestOrigin && dot(direction, direction) > 0.0 &&
           largest_coordinate(direction) < 2.0;
}

/// Embree's ray for a query.
RTCRay start(Query& query) {
    const Stretch<double>& ray = query.ray;
    embree::init(query.context);
    if (query.data->precision == HitPrecision::in_double) {
        query.behind_mm = kFloatRoundings * (largest_coordinate(ray.origin) + query.data->mesh_reach_mm);
    }
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
            .tfar = query.embree_far(),
            .mask = ~0U};
}

std::uint32_t object_of(const RTCHit& hit) {
    return hit.instID[0] != RTC_INVALID_GEOMETRY_ID ? hit.instID[0] : hit.geomID;
}

/// Where the true ray meets a triangle that Embree has found.
std::optional<Meeting<double>> judged(const Query& query, const RTCHit& hit) {
    const PlacedObject& placed = query.data->objects[object_of(hit)];
    const bool is_instance = hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
    const Stretch<double> ray = is_instance ? mapped(placed.place.to_local, query.ray) : query.ray;
    const double near = kFloatRoundings * (largest_coordinate(query.ray.origin) + placed.place.reach_mm);
    return placed.facets.empty()
               ? meet(sides(std::get<TriangleMesh>(*placed.shape), hit.primID), hit.u, hit.v, near, ray)
               : meet(placed.facets[hit.primID].sides, hit.u, hit.v, near, ray);
}

/// Whether the true ray meets it; then it counts if it is nearer.
bool take(Query& query, const RTCHit& hit) {
    const auto meeting = judged(query, hit);
    if (meeting) {
        query.nearest.offer(*meeting, object_of(hit), hit.primID);
    }
    return meeting.has_value();
}

/// Goes on from what is met already with what Embree knows of.
void ask_embree(const SceneGeometry::Data& data, const Stretch<double>& stretch, Nearest& nearest) {
    Query query{.data = &data, .ray = stretch, .nearest = nearest};
    RTCRayHit ray{.ray = start(query)};
    const auto finds_one = [&] {
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        embree::intersect(data.scene.get(), query.context, ray);
        return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    };
    if (data.precision == HitPrecision::in_double) {
        finds_one();
    } else {
        const float far = ray.ray.tfar;
        while (finds_one() && !take(query, ray.hit)) {
            ray.ray.tnear = std::nextafter(ray.ray.tfar, std::numeric_limits<float>::infinity());
            ray.ray.tfar = far;
        }
    }
    nearest = query.nearest;
}

bool embree_finds_any(const SceneGeometry::Data& data, const Stretch<double>& stretch) {
    Query query{.data = &data, .ray = stretch, .is_occlusion = true};
    RTCRay ray = start(query);
    embree::occluded(data.scene.get(), query.context, ray);
    return ray.tfar < 0.0F;
}

/// Of the few triangles: what lies in the seam around one is taken to its edge.
void offer_triangle(Nearest& nearest, const SceneGeometry::Data& data, const FirstMeeting& first) {
    if (first.is_one()) {
        const MeshTriangle& of = data.triangle_of[static_cast<std::size_t>(first.which)];
        const double b1 = std::max(first.meeting.b1, 0.0);
        const double b2 = std::max(first.meeting.b2, 0.0);
        const double sum = std::max(b1 + b2, 1.0);
        nearest.offer({.at = first.meeting.at, .b1 = b1 / sum, .b2 = b2 / sum}, of.object, of.primitive);
    }
}

/// Fills `hit` in its place: copies of it would wait for what was just written.
void describe(const SceneGeometry::Data& data, const Stretch<double>& ray, const Nearest& nearest, SurfaceHit& hit) {
    const PlacedObject& met = data.objects[nearest.object];
    const Meeting<double>& at = nearest.meeting;
    if (const auto* quad = std::get_if<Quad>(met.shape)) {
        met.facets.front().describe(std::clamp(at.b1 / quad->width_mm + 0.5, 0.0, 1.0),
                                    std::clamp(at.b2 / quad->height_mm + 0.5, 0.0, 1.0), hit);
    } else if (!met.facets.empty()) {
        met.facets[nearest.primitive].describe(at.b1, at.b2, hit);
    } else if (const auto* mesh = std::get_if<TriangleMesh>(met.shape)) {
        hit = world_hit(met.place, shape_point(*mesh, nearest.primitive, at.b1, at.b2));
    } else {
        const Stretch<double> local = mapped(met.place.to_local, ray);
        hit = world_hit(met.place, shape_point(std::get<Sphere>(*met.shape), local.origin + at.at * local.direction,
                                               met.object.reads_uv));
    }
    hit.distance_mm = at.at;
    hit.material = met.object.material;
    hit.object = nearest.object;
    hit.primitive = nearest.primitive;
}

/// What of two points is asked for: from one end whatever the order, so that both orders agree to the last bit. In
/// float from the one that is nearer to the world's origin, where floats are finer.
Stretch<double> stretch_between(const SceneGeometry& scene, const Vec3d& from, const Vec3d& to) {
    const auto rank = [&](const Vec3d& end) {
        const bool is_judged = scene.data().precision == HitPrecision::in_double;
        return std::tuple(is_judged ? 0.0 : largest_coordinate(end), end.x, end.y, end.z);
    };
    const bool is_in_order = rank(from) < rank(to);
    const Vec3d along = is_in_order ? to - from : from - to;
    const double distance = length(along);
    constexpr double kRoundings = 64.0 * std::numeric_limits<double>::epsilon();
    const double margin = kRoundings * (reach({from, to}) + reach(scene.bounds()));
    return {.origin = is_in_order ? from : to,
            .direction = (1.0 / distance) * along,
            .from = margin,
            .to = distance - margin};
}

/// What many rays meet before Embree is asked.
struct Columns {
    RayColumns rays;
    MeetingColumns objects;  // of the spheres and quads that are tested one by one
    MeetingColumns triangles;
};

/// Calls visit(i, columns, j) for each of `count` rays, which `ray_of(i)` says, the j-th of its columns.
template <class RayOf, class Visit>
void meet_in_columns(const SceneGeometry::Data& data, const AnalyticKernels::Meet& meet, std::size_t count,
                     const RayOf& ray_of, const Visit& visit) {
    Columns columns;
    for (std::size_t first = 0; first < count; first += RayColumns::kMost) {
        columns.rays.size = std::min(RayColumns::kMost, count - first);
        for (std::size_t j = 0; j < columns.rays.size; ++j) {
            columns.rays.set(j, ray_of(first + j));
        }
        meet.objects(data.one_by_one(), columns.rays, columns.objects);
        meet.triangles(data.triangles, columns.rays, columns.triangles);
        for (std::size_t j = 0; j < columns.rays.size; ++j) {
            visit(first + j, columns, j);
        }
    }
}

}  // namespace

void judge_triangle(const RTCFilterFunctionNArguments* arguments) {
    const RTCHit hit = rtcGetHitFromHitN(arguments->hit, 1, 0);
    Query& query = query_of(arguments->context);
    const auto meeting = judged(query, hit);
    if (!meeting || (!query.is_occlusion && !query.nearest.offer(*meeting, object_of(hit), hit.primID))) {
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
    const AnalyticObject& object = query.data->analytic[arguments->primID];
    const auto [is_met, meeting] = meet(object, query.ray);
    if (is_met && query.nearest.offer(meeting, object.object, 0)) {
        float& embree_far = reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray.tfar;
        embree_far = std::min(embree_far, query.embree_distance(meeting.at));
    }
}

void occlude_analytic(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) {
        return;
    }
    const Query& query = query_of(arguments->context);
    if (meet(query.data->analytic[arguments->primID], query.ray).is_met) {
        RTCRayN_tfar(arguments->ray, 1, 0) = -std::numeric_limits<float>::infinity();
    }
}

void bound_analytic(const RTCBoundsFunctionArguments* arguments) {
    const auto& data = *static_cast<const SceneGeometry::Data*>(arguments->geometryUserPtr);
    const Box& box = data.objects[data.analytic[arguments->primID].object].bounds;
    const double margin = kFloatRoundings * reach(data.bounds);
    const auto low = converted<float>(box.low - Vec3d{margin, margin, margin});
    const auto high = converted<float>(box.high + Vec3d{margin, margin, margin});
    *arguments->bounds_o = {low.x, low.y, low.z, 0.0F, high.x, high.y, high.z, 0.0F};
}

const std::vector<std::string>& hit_precision_names() {
    static const std::vector<std::string> names = {"double", "float"};
    return names;
}

const std::string& name_of(HitPrecision precision) {
    return hit_precision_names()[static_cast<std::size_t>(precision)];
}

HitPrecision hit_precision_named(const std::string& name) {
    return name == name_of(HitPrecision::in_float) ? HitPrecision::in_float : HitPrecision::in_double;
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
    const SceneGeometry::Data& data = scene.data();
    const Stretch<double> ray{origin, direction, from_mm, to_mm};
    Nearest nearest;
    for (const AnalyticObject& object : data.one_by_one()) {
        if (const auto [is_met, meeting] = meet(object, ray); is_met) {
            nearest.offer(meeting, object.object, 0);
        }
    }
    offer_triangle(nearest, data, analytic_kernels().meet_first_triangle(data.triangles, ray));
    if (data.has_embree_geometry) {
        ask_embree(data, ray, nearest);
    }
    std::optional<SurfaceHit> hit;
    if (nearest.is_one()) {
        describe(data, ray, nearest, hit.emplace());
    }
    return hit;
}

void intersect(const SceneGeometry& scene, std::span<const Ray<double>> rays,
               std::span<std::optional<SurfaceHit>> hits) {
    const SceneGeometry::Data& data = scene.data();
    const auto stretch = [&](std::size_t i) -> Stretch<double> {
        return {.origin = rays[i].origin, .direction = rays[i].direction, .to = kInfinity};
    };
    const auto describe_first = [&](std::size_t i, const Columns& columns, std::size_t j) {
        hits[i].reset();
        const Stretch<double> ray = columns.rays[j];
        if (!is_usable(ray.origin, ray.direction)) {
            return;
        }
        Nearest nearest;
        if (const auto [meeting, which] = columns.objects.first(j); which >= 0) {
            nearest = {meeting, data.analytic[static_cast<std::size_t>(which)].object};
        }
        offer_triangle(nearest, data, columns.triangles.first(j));
        if (data.has_embree_geometry) {
            ask_embree(data, ray, nearest);
        }
        if (nearest.is_one()) {
            describe(data, ray, nearest, hits[i].emplace());
        }
    };
    meet_in_columns(data, analytic_kernels().first, rays.size(), stretch, describe_first);
}

bool is_occluded(const SceneGeometry& scene, const Vec3d& from, const Vec3d& to) {
    const SceneGeometry::Data& data = scene.data();
    const Stretch<double> ray = stretch_between(scene, from, to);
    if (!is_usable(ray.origin, ray.direction)) {
        return false;
    }
    return std::ranges::any_of(data.one_by_one(),
                               [&](const AnalyticObject& object) { return meet(object, ray).is_met; }) ||
           analytic_kernels().meet_first_triangle(data.triangles, ray).is_one() ||
           (data.has_embree_geometry && embree_finds_any(data, ray));
}

void find_occluded(const SceneGeometry& scene, std::span<const Segment> segments,
                   std::span<std::uint8_t> are_occluded) {
    const SceneGeometry::Data& data = scene.data();
    const auto stretch = [&](std::size_t i) { return stretch_between(scene, segments[i].from, segments[i].to); };
    const auto judge = [&](std::size_t i, const Columns& columns, std::size_t j) {
        const Stretch<double> ray = columns.rays[j];
        const bool is_blocked =
            is_usable(ray.origin, ray.direction) && (columns.objects.is_any(j) || columns.triangles.is_any(j) ||
                                                     (data.has_embree_geometry && embree_finds_any(data, ray)));
        are_occluded[i] = is_blocked ? 1 : 0;
    };
    meet_in_columns(data, analytic_kernels().any, segments.size(), stretch, judge);
}

}  // namespace lensproof::scene
