// calibration/self_test/chart_map.h — where every part of a picture lies on a chart, and where no edge is near.
#pragma once
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/base/vec.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// The map from a rectangle of pixels to the chart, within 1e-3 px of the exact one: knots every 2 px, and in a cell of
/// four knots bilinear with the neighbours' second differences. Knots are exact, or where the map is that smooth cubic
/// between exact ones 16 px apart, which is held to 1e-4 px at two places of each block of 16 × 16 px.
class ChartMap {
  public:
    static constexpr int kKnot_px = 2;

    /// The point of the chart that the picture shows at `pixel`, mm; none where it shows nothing of the chart.
    using Exact = std::function<std::optional<Vec2d>(const Vec2d& pixel)>;

    /// The map of `pixels` at least, which may reach beyond the picture.
    ChartMap(const Exact& exact, const scene::Chart& chart, const cv::Rect& pixels);

    /// What one pixel shows.
    struct Pixel {
        Vec2d corner, along_x, along_y, twist;  // NaN where it shows nothing of the chart, all or in part
        Vec2d bend_x, bend_y;

        [[nodiscard]] bool is_complete() const { return !std::isnan(corner.x + twist.x); }
        /// At (u, v) of the pixel, each from 0 to 1.
        [[nodiscard]] Vec2d at(double u, double v) const {
            return {corner.x + u * (along_x.x + u * bend_x.x) + v * (along_y.x + u * twist.x + v * bend_y.x),
                    corner.y + u * (along_x.y + u * bend_x.y) + v * (along_y.y + u * twist.y + v * bend_y.y)};
        }
    };
    [[nodiscard]] Pixel pixel(int x, int y) const;

    /// The reflectance of the whole cell that pixel (x, y) lies in; NaN where it has an edge, or one is near.
    [[nodiscard]] float even_tone(int x, int y) const {
        return even_tones_.at<float>((y - first_.y) / kKnot_px, (x - first_.x) / kKnot_px);
    }
    /// The tone of all cells of these pixels; none where they differ or have edges.
    [[nodiscard]] std::optional<float> only_tone(const cv::Rect& pixels) const;

  private:
    struct Lattice;  // exact points at the blocks' corners, and beyond

    [[nodiscard]] const Vec2d& knot(int i, int j) const { return knots_[static_cast<std::size_t>(j) * columns_ + i]; }
    [[nodiscard]] Vec2d pixel_of_knot(int i, int j) const {
        return {first_.x + kKnot_px * i - 0.5, first_.y + kKnot_px * j - 0.5};
    }
    [[nodiscard]] Vec2d second_difference(int i, int j, int along_x, int along_y) const;
    void fill_knots(const Exact& exact, const Lattice& lattice);
    void find_even_cells(const scene::Chart& chart, const Lattice& lattice);

    cv::Point first_;  // pixel
    int columns_;      // of knots
    int rows_;
    std::vector<Vec2d> knots_;  // NaN where the picture shows nothing of the chart
    cv::Mat even_tones_;        // by a cell's top left knot
};

}  // namespace lensproof::calibration
