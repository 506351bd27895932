// engine/optics/meridional_bundle.h — the rays of a field point in the meridional plane, from rim to rim.
#pragma once
#include "engine/base/infinity.h"
#include "engine/optics/field_bundle.h"

namespace lensproof::optics {

/// The rays of one object point in the plane of its chief ray, told apart by their offset (mm) across it, positive
/// towards +y.
struct MeridionalBundle : FieldBundle {
    double lower = 0.0;  // offsets of the outermost rays that pass every rim; lower ≤ 0 ≤ upper
    double upper = 0.0;
};

/// The bundle around `chief`, which passes. Its ends are found by bisection, so the offsets that pass are taken to be
/// one interval: a ray that misses, is clipped, stopped or totally reflected bounds it.
MeridionalBundle meridional_bundle(const TraceLens<double>& lens, const ChiefRay& chief,
                                   double object_distance = kInfinity);

}  // namespace lensproof::optics
