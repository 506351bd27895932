#include "engine/device/launch.cuh"
#include "engine/render/camera/packet/path_job.h"

using lensproof::optics::LensMakeup;
using namespace lensproof::render;

LENSPROOF_DEVICE_JOB(PathJob<float, LensMakeup::clear_spheres>);
LENSPROOF_DEVICE_JOB(PathJob<float, LensMakeup::spheres>);
LENSPROOF_DEVICE_JOB(PathJob<float, LensMakeup::any>);
LENSPROOF_DEVICE_JOB(PathJob<double, LensMakeup::clear_spheres>);
LENSPROOF_DEVICE_JOB(PathJob<double, LensMakeup::spheres>);
LENSPROOF_DEVICE_JOB(PathJob<double, LensMakeup::any>);
