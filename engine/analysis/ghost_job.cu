#include "engine/analysis/ghost_job.h"
#include "engine/device/launch.cuh"

LENSPROOF_DEVICE_JOB(lensproof::analysis::LandingJob);
LENSPROOF_DEVICE_JOB(lensproof::analysis::MarginJob);
LENSPROOF_DEVICE_JOB(lensproof::analysis::RimRayJob);
