#include "engine/render/camera/packet/path_job.h"

#include "engine/device/launch.cuh"

using namespace lensproof::render;

LENSPROOF_DEVICE_JOB(PathJob<float, false>);
LENSPROOF_DEVICE_JOB(PathJob<float, true>);
LENSPROOF_DEVICE_JOB(PathJob<double, false>);
LENSPROOF_DEVICE_JOB(PathJob<double, true>);
