// engine/analysis/light_raster.h — light that is spread over triangles, summed up over the pixels of a sensor.
#pragma once
#include <array>
#include <vector>

#include "engine/base/large_pages.h"
#include "engine/base/vec.h"

namespace lensproof::analysis {

/// Square pixels, centred on the axis and turned upright as a camera does it: column u and row v, counted from the top
/// left, lie about x = −(u − (width − 1)/2) pitch, y = (v − (height − 1)/2) pitch in lens space.
///
/// A triangle's light is spread evenly over it, and each pixel has the fraction that it covers, exactly: where a map
/// folds and the triangle has no area, what it adds stays finite. What lies beyond the sensor is lost.
///
/// A triangle costs as many steps as its sides cross pixels, whatever its area: kept are the differences from each
/// pixel to the next in its row, which only the sides have (R. Levien's accumulation buffer, font-rs).
class LightRaster {
  public:
    LightRaster(int width, int height, double pitch_mm);

    /// `corners` in mm on the sensor's plane.
    void add(const std::array<Vec2d, 3>& corners, double energy);
    void add(const LightRaster& other);
    void clear();

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] double pitch_mm() const { return pitch_; }
    /// From the axis to a corner, mm.
    [[nodiscard]] double half_diagonal_mm() const;
    /// Energy a pixel, rows from the top.
    [[nodiscard]] std::vector<double> pixels() const;

  private:
    void add_side(Vec2d from, Vec2d to, double density);
    void add_sliver(const std::array<Vec2d, 3>& corners, double energy);
    void add_point(Vec2d at, double energy);

    int width_;
    int height_;
    double pitch_;
    std::vector<double, LargePages<double>> differences_;  // width + 2 a row
};

}  // namespace lensproof::analysis
