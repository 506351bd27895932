// engine/pupil/pupil_slices.h — a pupil map at the wavelengths that a renderer samples, for drawing many points fast.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/pupil/pupil_map.h"
#include "engine/pupil/pupil_slice.h"

namespace lensproof::pupil {

/// A PupilMap at the positions i / (n − 1) of its band: what it interpolates over the band is interpolated here once,
/// and laid out for packets. The map is held by reference.
class PupilSlices {
  public:
    PupilSlices(const PupilMap& map, int slices);
    PupilSlices(const PupilSlices&) = delete;
    PupilSlices& operator=(const PupilSlices&) = delete;

    /// What the map draws at the slice's position, but for rounding.
    [[nodiscard]] PupilDraw<double> sample(Vec2d sensor_point, int slice, double u, double v) const;

    /// The pdf that `sample` draws a point with, 1/mm²; 0 outside the disc and the region.
    [[nodiscard]] double pdf(Vec2d sensor_point, int slice, Vec2d pupil_point) const;

    [[nodiscard]] const PupilMap& map() const { return map_; }

    /// For inner loops, which draw and weigh with them as `sample` and `pdf` do, to the bit. Nothing where the lens is
    /// not rotationally symmetric, passes no light, or has more slices than are worth keeping: `sample` then asks the
    /// map.
    [[nodiscard]] const PupilSliceTables* tables() const { return regions_.empty() ? nullptr : &tables_; }

    /// How long these tables are, for whoever copies them.
    struct TableSizes {
        std::size_t slices;
        std::size_t nodes;
        std::size_t node_below;
        std::size_t regions;
        std::size_t panel_below;
        std::size_t panel_across;
    };
    [[nodiscard]] TableSizes table_sizes() const {
        return {.slices = per_end_.size(),
                .nodes = map_.regions().nodes().fractions.size(),
                .node_below = node_below_.size(),
                .regions = regions_.size(),
                .panel_below = panel_below_.size(),
                .panel_across = panel_across_.size()};
    }

  private:
    void add_slice(double position);

    const PupilMap& map_;
    int slices_;
    std::vector<double> per_end_;
    std::vector<double> per_step_;
    std::vector<std::int32_t> node_below_;
    std::vector<double> regions_;
    std::vector<std::uint8_t> panel_below_;
    std::vector<std::int32_t> panel_across_;
    std::vector<double> next_panel_;
    PupilSliceTables tables_;
};

}  // namespace lensproof::pupil
