// engine/scene/geometry/packet/analytic_kernel.h — rays against spheres, quads and triangles, for compilers to
// vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include "engine/base/infinity.h"
#include "engine/base/pack.h"
#include "engine/scene/geometry/packet/analytic_kernels.h"

namespace lensproof::scene {

template <class Numbers>
Stretch<Numbers> load_stretch(const RayColumns& rays, std::size_t i) {
    const auto vector = [&](const std::array<RayColumns::Column, 3>& of) {
        return Vec3<Numbers>{Numbers::load(of[0].data() + i), Numbers::load(of[1].data() + i),
                             Numbers::load(of[2].data() + i)};
    };
    return {.origin = vector(rays.origin),
            .direction = vector(rays.direction),
            .from = Numbers::load(rays.from.data() + i),
            .to = Numbers::load(rays.to.data() + i)};
}

template <class Numbers>
AffineFunction<Vec3, Numbers> load_function(const TriangleBlock::Function& function, std::size_t lane) {
    return {.gradient = {Numbers::load(function.x.data() + lane), Numbers::load(function.y.data() + lane),
                         Numbers::load(function.z.data() + lane)},
            .at_origin = Numbers::load(function.at_origin.data() + lane)};
}

template <class Numbers>
Vec3<Numbers> everywhere(const Vec3d& v) {
    return {Numbers(v.x), Numbers(v.y), Numbers(v.z)};
}
template <class Numbers>
Vec2<Numbers> everywhere(const Vec2d& v) {
    return {Numbers(v.x), Numbers(v.y)};
}
template <class Numbers, template <class> class Vector>
AffineFunction<Vector, Numbers> everywhere(const AffineFunction<Vector, double>& function) {
    return {.gradient = everywhere<Numbers>(function.gradient), .at_origin = Numbers(function.at_origin)};
}
template <class Numbers>
TriangleInPlane<Vec2, Numbers> everywhere(const TriangleInPlane<Vec2, double>& triangle) {
    return {.b1 = everywhere<Numbers>(triangle.b1), .b2 = everywhere<Numbers>(triangle.b2)};
}
template <class Numbers>
TriangleRim<Numbers> everywhere(const TriangleRim<double>& rim) {
    return {.least_b1 = Numbers(rim.least_b1), .least_b2 = Numbers(rim.least_b2), .most_sum = Numbers(rim.most_sum)};
}

/// The nearest meetings so far of the lanes' rays, whose stretches end there.
template <class Abi>
struct NearestOf {
    using Numbers = Pack<double, Abi>;
    Stretch<Numbers> ray;
    Numbers b1{0.0};
    Numbers b2{0.0};
    Numbers which{-1.0};

    void offer(const Crossing<Numbers>& crossing, const Numbers& of) {
        const auto& [is_met, meeting] = crossing;
        ray.to = select(is_met, meeting.at, ray.to);
        b1 = select(is_met, meeting.b1, b1);
        b2 = select(is_met, meeting.b2, b2);
        which = select(is_met, of, which);
    }
    void store(MeetingColumns& met, std::size_t i) const {
        ray.to.store(met.at.data() + i);
        b1.store(met.b1.data() + i);
        b2.store(met.b2.data() + i);
        which.store(met.which.data() + i);
    }
};

/// Whether the lanes' rays have met anything.
template <class Abi>
struct AnyOf {
    using Numbers = Pack<double, Abi>;
    Stretch<Numbers> ray;
    MaskOf<Numbers> is_met{false};

    void offer(const Crossing<Numbers>& crossing, const Numbers& /*of*/) { is_met = is_met || crossing.is_met; }
    void store(MeetingColumns& met, std::size_t i) const {
        select(is_met, Numbers(0.0), Numbers(-1.0)).store(met.which.data() + i);
    }
};

/// Found: NearestOf or AnyOf.
template <class Found>
[[gnu::flatten]] void meet_objects(std::span<const AnalyticObject> objects, const RayColumns& rays,
                                   MeetingColumns& met) {
    using Numbers = typename Found::Numbers;
    for (std::size_t i = 0; i < rays.size; i += Numbers::kLanes) {
        Found found{.ray = load_stretch<Numbers>(rays, i)};
        for (std::size_t k = 0; k < objects.size(); ++k) {
            found.offer(meet(objects[k], found.ray), Numbers(static_cast<double>(k)));
        }
        found.store(met, i);
    }
}

/// `rim_of(triangle)`: where it ends for these rays, the i-th and so on.
template <class Found, class RimOf>
void offer_triangles(const FewTriangles& few, const RayColumns& rays, std::size_t i, const RimOf& rim_of,
                     Found& found) {
    using Numbers = typename Found::Numbers;
    std::size_t k = 0;
    for (const TrianglePlane& plane : few.planes) {
        const PlaneMeeting<Numbers> meeting = meet_plane(everywhere<Numbers>(plane.height), found.ray);
        if (!any(meeting.is_met)) {
            k = plane.end;
            continue;
        }
        const auto coordinate = [&](std::size_t of) {
            return Numbers::load(rays.origin[of].data() + i) +
                   meeting.at * Numbers::load(rays.direction[of].data() + i);
        };
        const Vec2<Numbers> point{coordinate(plane.across[0]), coordinate(plane.across[1])};
        for (; k < plane.end; ++k) {
            const FlatTriangle& triangle = few.triangles[k];
            found.offer(meet_in_plane(everywhere<Numbers>(triangle.in_plane), rim_of(triangle), meeting, point),
                        Numbers(static_cast<double>(k)));
        }
    }
}

template <class Found>
[[gnu::flatten]] void meet_triangles(const FewTriangles& few, const RayColumns& rays, MeetingColumns& met) {
    using Numbers = typename Found::Numbers;
    for (std::size_t i = 0; i < rays.size; i += Numbers::kLanes) {
        Found found{.ray = load_stretch<Numbers>(rays, i)};
        const Numbers reach = few.reach_from(found.ray.origin);
        if (all(reach <= Numbers(few.near_reach()))) {
            const auto near_rim = [](const FlatTriangle& of) { return everywhere<Numbers>(of.near_rim); };
            offer_triangles(few, rays, i, near_rim, found);
        } else {
            const auto rim = [&](const FlatTriangle& of) {
                return grown_rim(Numbers(of.b1_slope), Numbers(of.b2_slope), reach);
            };
            offer_triangles(few, rays, i, rim, found);
        }
        found.store(met, i);
    }
}

template <class Abi>
[[gnu::flatten]] FirstMeeting meet_first_triangle(const FewTriangles& few, const Stretch<double>& ray) {
    using Numbers = Pack<double, Abi>;
    NearestOf<Abi> nearest{.ray = {.origin = everywhere<Numbers>(ray.origin),
                                   .direction = everywhere<Numbers>(ray.direction),
                                   .from = Numbers(ray.from),
                                   .to = Numbers(ray.to)}};
    const Numbers reach(few.reach_from(ray.origin));
    Numbers here = Numbers::iota();
    for (const TriangleBlock& block : few.blocks) {
        for (std::size_t lane = 0; lane < TriangleBlock::kLanes; lane += Numbers::kLanes) {
            const TriangleInPlane<Vec3, Numbers> triangles{.b1 = load_function<Numbers>(block.b1, lane),
                                                           .b2 = load_function<Numbers>(block.b2, lane)};
            const TriangleRim<Numbers> rims = grown_rim(Numbers::load(block.b1_slope.data() + lane),
                                                        Numbers::load(block.b2_slope.data() + lane), reach);
            const PlaneMeeting<Numbers> meeting = meet_plane(load_function<Numbers>(block.height, lane), nearest.ray);
            const Vec3<Numbers> point = nearest.ray.origin + meeting.at * nearest.ray.direction;
            nearest.offer(meet_in_plane(triangles, rims, meeting, point), here);
            here = here + Numbers(Numbers::kLanes);
        }
    }
    const auto is_met = nearest.which >= Numbers(0.0);
    if (!any(is_met)) {
        return {};
    }
    const Numbers none(kInfinity);
    const double at = least(select(is_met, nearest.ray.to, none));
    const auto triangle = static_cast<int>(least(select(is_met && nearest.ray.to <= Numbers(at), nearest.which, none)));
    const int lane = triangle % Numbers::kLanes;
    return {.meeting = {.at = at, .b1 = nearest.b1[lane], .b2 = nearest.b2[lane]}, .which = triangle};
}

template <>
AnalyticKernels analytic_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, double>;
    return {.first = {.objects = meet_objects<NearestOf<Abi>>, .triangles = meet_triangles<NearestOf<Abi>>},
            .any = {.objects = meet_objects<AnyOf<Abi>>, .triangles = meet_triangles<AnyOf<Abi>>},
            .meet_first_triangle = meet_first_triangle<Abi>};
}

}  // namespace lensproof::scene
