// engine/analysis/wavefront_map.h — a wavefront on an even grid over the exit pupil, as plots show it.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/analysis/sampled_pupil.h"

namespace lensproof::analysis {

/// Path differences against the reference sphere (signs: Wavefront), on an even grid of direction cosines of the rays
/// that arrive, less those of the chief ray.
struct WavefrontMap : PupilGrid {
    PupilStatus status = PupilStatus::no_light;  // `aliased` matters to PSF and MTF, not to the map
    double wavelength_nm = 0.0;
    std::vector<double> opd_waves;     // 0 outside the beam
    std::vector<std::uint8_t> inside;  // 1 where at least half of the cell lies in the beam

    [[nodiscard]] double at(int row, int column) const { return opd_waves[cell(row, column)]; }
    [[nodiscard]] bool is_inside(int row, int column) const { return inside[cell(row, column)] != 0; }
};

/// The map with `samples` cells across the wider side of the beam. Empty where no light passes.
WavefrontMap wavefront_map(const PolychromaticField& field, const PolychromaticField::Part& part, int samples = 64);

}  // namespace lensproof::analysis
