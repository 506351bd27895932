#include "engine/device/launch.cuh"
#include "engine/optics/device/trace_job.h"

using namespace lensproof::optics;

LENSPROOF_DEVICE_JOB(EventJob<float>);
LENSPROOF_DEVICE_JOB(EventJob<double>);
