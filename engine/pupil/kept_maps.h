// engine/pupil/kept_maps.h — maps of pupils and entrances that are found once a lens and kept on disk.
#pragma once
#include <vector>

#include "engine/base/cache.h"
#include "engine/base/infinity.h"
#include "engine/pupil/entrance_map.h"
#include "engine/pupil/pupil_map.h"

namespace lensproof::pupil {

/// The map that PupilMap's constructor makes, to the last bit: from the cache where it holds one of these very numbers,
/// made by a program of these very sources (of engine/optics and engine/pupil); else it is made, and kept. Masks of the
/// stop do not count, as they do not for the map.
PupilMap kept_pupil_map(const Cache& cache, const std::vector<optics::TraceLens<double>>& band, bool by_radius,
                        double sensor_radius_mm, const PupilMapSettings& settings = {});

/// The same for EntranceMap.
EntranceMap kept_entrance_map(const Cache& cache, const std::vector<optics::TraceLens<double>>& band, bool by_angle,
                              double distance_mm = kInfinity, const PupilMapSettings& settings = {});

}  // namespace lensproof::pupil
