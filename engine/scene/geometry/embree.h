// engine/scene/geometry/embree.h — Embree, version 3 or 4, told apart here and nowhere else.
#pragma once
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>
#include <type_traits>

namespace lensproof::scene::embree {

struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};

using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, Release>;
using Geometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, Release>;

#if RTC_VERSION_MAJOR >= 4
using Context = RTCRayQueryContext;

inline void init(Context& context) {
    rtcInitRayQueryContext(&context);
}
inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &ray, &arguments);
}
inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded1(scene, &ray, &arguments);
}
#else
using Context = RTCIntersectContext;

inline void init(Context& context) {
    rtcInitIntersectContext(&context);
}
inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray) {
    rtcIntersect1(scene, &context, &ray);
}
inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
    rtcOccluded1(scene, &context, &ray);
}
#endif

}  // namespace lensproof::scene::embree
