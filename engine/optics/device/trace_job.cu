#include "engine/device/launch.cuh"
#include "engine/optics/device/trace_job.h"

using namespace lensproof::optics;

#define LENSPROOF_TRACE_JOBS(T, direction, rims)                                                         \
    LENSPROOF_DEVICE_JOB(TraceJob<T, direction, rims, Carry::geometry, LensMakeup::clear_spheres>);      \
    LENSPROOF_DEVICE_JOB(TraceJob<T, direction, rims, Carry::transmittance, LensMakeup::clear_spheres>); \
    LENSPROOF_DEVICE_JOB(TraceJob<T, direction, rims, Carry::all, LensMakeup::clear_spheres>);           \
    LENSPROOF_DEVICE_JOB(TraceJob<T, direction, rims, Carry::all, LensMakeup::spheres>);                 \
    LENSPROOF_DEVICE_JOB(TraceJob<T, direction, rims, Carry::all, LensMakeup::any>)

LENSPROOF_TRACE_JOBS(float, Direction::forward, Rims::clip);
LENSPROOF_TRACE_JOBS(float, Direction::reverse, Rims::clip);
LENSPROOF_TRACE_JOBS(float, Direction::forward, Rims::follow);
LENSPROOF_TRACE_JOBS(float, Direction::reverse, Rims::follow);
LENSPROOF_TRACE_JOBS(double, Direction::forward, Rims::clip);
LENSPROOF_TRACE_JOBS(double, Direction::reverse, Rims::clip);
LENSPROOF_TRACE_JOBS(double, Direction::forward, Rims::follow);
LENSPROOF_TRACE_JOBS(double, Direction::reverse, Rims::follow);
