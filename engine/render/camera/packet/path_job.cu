#include "engine/device/launch.cuh"
#include "engine/render/camera/packet/path_job.h"

using namespace lensproof::render;

LENSPROOF_DEVICE_JOB(PathJob<float, false>);
LENSPROOF_DEVICE_JOB(PathJob<float, true>);
LENSPROOF_DEVICE_JOB(PathJob<double, false>);
LENSPROOF_DEVICE_JOB(PathJob<double, true>);
