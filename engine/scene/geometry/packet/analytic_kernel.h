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

template <class Numbers, class Column>
Vec3<Numbers> load_vector(const Column& x, const Column& y, const Column& z, std::size_t i) {
    return {Numbers::load(x.data() + i), Numbers::load(y.data() + i), Numbers::load(z.data() + i)};
}

template <class Numbers>
Stretch<Numbers> load_stretch(const RayColumns& rays, std::size_t i) {
    return {.origin = load_vector<Numbers>(rays.origin_x, rays.origin_y, rays.origin_z, i),
            .direction = load_vector<Numbers>(rays.direction_x, rays.direction_y, rays.direction_z, i),
            .from = Numbers::load(rays.from.data() + i),
            .to = Numbers::load(rays.to.data() + i)};
}

template <class Numbers>
AffineFunction<Numbers> load_function(const TriangleBlock::Function& function, std::size_t lane) {
    return {.gradient = load_vector<Numbers>(function.x, function.y, function.z, lane),
            .at_origin = Numbers::load(function.at_origin.data() + lane)};
}

template <class Numbers>
Vec3<Numbers> everywhere(const Vec3d& v) {
    return {Numbers(v.x), Numbers(v.y), Numbers(v.z)};
}
template <class Numbers>
AffineFunction<Numbers> everywhere(const AffineFunction<double>& function) {
    return {.gradient = everywhere<Numbers>(function.gradient), .at_origin = Numbers(function.at_origin)};
}
template <class Numbers>
TriangleInPlane<Numbers> everywhere(const TriangleInPlane<double>& triangle) {
    return {.b1 = everywhere<Numbers>(triangle.b1),
            .b2 = everywhere<Numbers>(triangle.b2),
            .b1_slope = Numbers(triangle.b1_slope),
            .b2_slope = Numbers(triangle.b2_slope)};
}

/// As `largest_coordinate` of affine.h.
template <class Numbers>
Numbers largest_coordinate_of(const Vec3<Numbers>& v) {
    const auto larger = [](const Numbers& a, const Numbers& b) { return select(a < b, b, a); };
    return larger(larger(abs(v.x), abs(v.y)), abs(v.z));
}

/// The nearest meetings so far of the lanes' rays, whose stretches end there.
template <class Numbers>
struct NearestOf {
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

template <class Abi>
[[gnu::flatten]] void meet_objects(std::span<const AnalyticObject> objects, const RayColumns& rays,
                                   MeetingColumns& met) {
    using Numbers = Pack<double, Abi>;
    for (std::size_t i = 0; i < rays.size; i += Numbers::kLanes) {
        NearestOf<Numbers> nearest{.ray = load_stretch<Numbers>(rays, i)};
        for (std::size_t k = 0; k < objects.size(); ++k) {
            nearest.offer(meet(objects[k], nearest.ray), Numbers(static_cast<double>(k)));
        }
        nearest.store(met, i);
    }
}

template <class Abi>
[[gnu::flatten]] void meet_triangles(const FewTriangles& few, const RayColumns& rays, MeetingColumns& met) {
    using Numbers = Pack<double, Abi>;
    for (std::size_t i = 0; i < rays.size; i += Numbers::kLanes) {
        NearestOf<Numbers> nearest{.ray = load_stretch<Numbers>(rays, i)};
        const Numbers reach = largest_coordinate_of(nearest.ray.origin) + Numbers(few.reach_mm);
        std::size_t k = 0;
        for (const TrianglePlane& plane : few.planes) {
            const PlaneMeeting<Numbers> meeting = meet_plane(everywhere<Numbers>(plane.height), nearest.ray);
            for (; k < plane.end; ++k) {
                nearest.offer(meet_in_plane(everywhere<Numbers>(few.triangles[k]), meeting, reach),
                              Numbers(static_cast<double>(k)));
            }
        }
        nearest.store(met, i);
    }
}

template <class Abi>
[[gnu::flatten]] FirstMeeting meet_first_triangle(const FewTriangles& few, const Stretch<double>& ray) {
    using Numbers = Pack<double, Abi>;
    NearestOf<Numbers> nearest{.ray = {.origin = everywhere<Numbers>(ray.origin),
                                       .direction = everywhere<Numbers>(ray.direction),
                                       .from = Numbers(ray.from),
                                       .to = Numbers(ray.to)}};
    const Numbers reach(largest_coordinate(ray.origin) + few.reach_mm);
    Numbers here = Numbers::iota();
    for (const TriangleBlock& block : few.blocks) {
        for (std::size_t lane = 0; lane < TriangleBlock::kLanes; lane += Numbers::kLanes) {
            const TriangleInPlane<Numbers> triangles{.b1 = load_function<Numbers>(block.b1, lane),
                                                     .b2 = load_function<Numbers>(block.b2, lane),
                                                     .b1_slope = Numbers::load(block.b1_slope.data() + lane),
                                                     .b2_slope = Numbers::load(block.b2_slope.data() + lane)};
            const PlaneMeeting<Numbers> meeting = meet_plane(load_function<Numbers>(block.height, lane), nearest.ray);
            nearest.offer(meet_in_plane(triangles, meeting, reach), here);
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
    return {.meet_objects = meet_objects<Abi>,
            .meet_triangles = meet_triangles<Abi>,
            .meet_first_triangle = meet_first_triangle<Abi>};
}

}  // namespace lensproof::scene
