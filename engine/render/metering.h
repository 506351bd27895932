// engine/render/metering.h — how long a scene is to be exposed, where it does not say so.
#pragma once
#include <filesystem>

#include "engine/base/cache.h"
#include "engine/render/scene_setup.h"

namespace lensproof::render {

/// Middle grey: the fraction of saturation that a metered picture's log-average brightness comes to (E. Reinhard, M.
/// Stark, P. Shirley, J. Ferwerda, "Photographic tone reproduction for digital images", SIGGRAPH 2002, their key a).
inline constexpr double kMiddleGrey = 0.18;

/// Finds the exposure time of a scene whose exposure is automatic (`CameraSettings::is_exposure_automatic`), which then
/// is so no more; leaves others as they are.
///
/// By a pilot of at most 96 × 96 pixels and 64 samples, always of the same seed, by camera paths through the thin lens
/// that stands for the lens: the log-average over its pixels of their mean of R, G and B becomes kMiddleGrey, pixels
/// darker than a thousandth of the mean counting as that bright. To a third of a stop, 2^(k/3) s, so that it is the
/// same for every model of the lens, every machine, shard and run. Returns whether it has found one. Throws InputError
/// where the pilot sees no light, or as PreparedScene does.
bool meter(SceneSetup& setup, const Cache& cache, int threads);

/// Throws InputError naming `file` where the exposure is automatic: of studies, whose pictures share one.
void expect_stated_exposure(const SceneSetup& setup, const std::filesystem::path& file);

}  // namespace lensproof::render
