// experiments/studies/cameras/photos.h — [[photos]]: sets of photos, measured, and held against what is known of their
// cameras from elsewhere.
#pragma once
#include "experiments/findings/study.h"

namespace lensproof::studies {

std::vector<findings::Study> read_photos(findings::ExperimentFile& file);

}  // namespace lensproof::studies
