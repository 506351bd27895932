#include "calibration/light/light_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr int kCellsAlongFrame = 48;
constexpr double kDark = 0.02;
constexpr int kCellMargin = 2;  // cells: an edge can cross one cell and leave a sliver in the next
constexpr double kClippedFraction = 0.01;
constexpr float kFullScale = 1.0F;
constexpr double kWhitePart = 0.6;  // of a square's side, so that blur and the corners' errors stay outside
constexpr int kFewestPixels = 4;

bool is_clipped(const formats::Image& image, int channel) {
    std::size_t count = 0;
    for (std::size_t i = static_cast<std::size_t>(channel); i < image.pixels.size(); i += image.channels.size()) {
        count += image.pixels[i] == kFullScale ? 1 : 0;
    }
    return static_cast<double>(count) > kClippedFraction * image.width * image.height;
}

// Mean and its standard error, pixel by pixel.
class Mean {
  public:
    void add(double value) {  // Welford's recurrence
        ++count_;
        const double from_old = value - mean_;
        mean_ += from_old / count_;
        squares_ += from_old * (value - mean_);
    }
    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] double mean() const { return mean_; }
    [[nodiscard]] double error() const { return count_ > 1 ? std::sqrt(squares_ / (count_ - 1.0) / count_) : 0.0; }

  private:
    int count_ = 0;
    double mean_ = 0.0;
    double squares_ = 0.0;
};

enum class Cell { dark, unusable, lit };

}  // namespace

LightGroup flat_field_samples(const formats::Image& image, int channel) {
    LightGroup group;
    if (image.width < 1 || image.height < 1 || channel < 0 || channel >= image.channel_count()) {
        return group;
    }
    const bool clipped = is_clipped(image, channel);
    const int side = std::max(1, (std::max(image.width, image.height) + kCellsAlongFrame - 1) / kCellsAlongFrame);
    const int columns = std::max(1, image.width / side);
    const int rows = std::max(1, image.height / side);
    std::vector<LightSample> samples;
    std::vector<Cell> state;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const int x0 = column * side + (image.width - columns * side) / 2;  // the cells stand centred in the frame
            const int y0 = row * side + (image.height - rows * side) / 2;
            Mean mean;
            bool saturated = false;
            for (int y = std::max(y0, 0); y < std::min(y0 + side, image.height); ++y) {
                for (int x = std::max(x0, 0); x < std::min(x0 + side, image.width); ++x) {
                    const float value = image.at(x, y, channel);
                    saturated = saturated || (clipped && value == kFullScale);
                    if (std::isfinite(value)) {
                        mean.add(value);
                    }
                }
            }
            const bool usable = !saturated && 2 * mean.count() >= side * side;
            state.push_back(usable ? Cell::lit : Cell::unusable);
            samples.push_back({.pixel_px = {x0 + 0.5 * (side - 1), y0 + 0.5 * (side - 1)},
                               .value = mean.mean(),
                               .relative_error = mean.mean() > 0.0 ? mean.error() / mean.mean() : 0.0,
                               .chart_mm = {}});
        }
    }
    std::vector<double> values;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (state[i] == Cell::lit) {
            values.push_back(samples[i].value);
        }
    }
    if (values.empty()) {
        return group;
    }
    const double bright = quantile(values, 0.95);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (state[i] == Cell::lit && !(samples[i].value > kDark * bright)) {
            state[i] = Cell::dark;
        }
    }
    const auto beside_dark = [&](int column, int row) {
        for (int r = std::max(row - kCellMargin, 0); r <= std::min(row + kCellMargin, rows - 1); ++r) {
            for (int c = std::max(column - kCellMargin, 0); c <= std::min(column + kCellMargin, columns - 1); ++c) {
                if (state[static_cast<std::size_t>(r) * columns + c] == Cell::dark) {
                    return true;
                }
            }
        }
        return false;
    };
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const std::size_t i = static_cast<std::size_t>(row) * columns + column;
            if (state[i] == Cell::lit && samples[i].value > 0.0 && !beside_dark(column, row)) {
                group.samples.push_back(samples[i]);
            }
        }
    }
    return group;
}

namespace {

// Mean over a patch given by the images of its four corners (in order around it).
std::optional<LightSample> patch_sample(const formats::Image& image, int channel, const Vec2d (&corner)[4],
                                        bool clipped) {
    const auto at = [&](double u, double v) {  // bilinear; the patch is small
        return Vec2d{(1 - u) * (1 - v) * corner[0].x + u * (1 - v) * corner[1].x + u * v * corner[2].x +
                         (1 - u) * v * corner[3].x,
                     (1 - u) * (1 - v) * corner[0].y + u * (1 - v) * corner[1].y + u * v * corner[2].y +
                         (1 - u) * v * corner[3].y};
    };
    const double side = std::max({std::hypot(corner[1].x - corner[0].x, corner[1].y - corner[0].y),
                                  std::hypot(corner[2].x - corner[1].x, corner[2].y - corner[1].y),
                                  std::hypot(corner[3].x - corner[2].x, corner[3].y - corner[2].y),
                                  std::hypot(corner[0].x - corner[3].x, corner[0].y - corner[3].y)});
    const int steps = std::clamp(static_cast<int>(side), 1, 100);  // about one probe per pixel
    Mean mean;
    for (int j = 0; j < steps; ++j) {
        for (int i = 0; i < steps; ++i) {
            const Vec2d p = at((i + 0.5) / steps, (j + 0.5) / steps);
            const int x = static_cast<int>(std::lround(p.x));
            const int y = static_cast<int>(std::lround(p.y));
            if (x < 0 || y < 0 || x >= image.width || y >= image.height) {
                return std::nullopt;
            }
            const float value = image.at(x, y, channel);
            if (!std::isfinite(value) || (clipped && value == kFullScale)) {
                return std::nullopt;
            }
            mean.add(value);
        }
    }
    if (mean.count() < kFewestPixels || !(mean.mean() > 0.0)) {
        return std::nullopt;
    }
    return LightSample{
        .pixel_px = at(0.5, 0.5), .value = mean.mean(), .relative_error = mean.error() / mean.mean(), .chart_mm = {}};
}

// The part of a white cell between four points that is surely white, as a fraction of its side; 0: none.
double white_part(const scene::ChartTraits& known) {
    const auto* spots = std::get_if<scene::Spots>(&known.look);
    if (known.white == scene::WhiteCells::all && spots != nullptr) {
        // A centred square whose corners stay clear of the discs by 15 % of their radius.
        const double side = 1.0 - 1.15 * spots->radius_pitches * std::numbers::sqrt2;
        return side > 0.15 ? side : 0.0;
    }
    return known.white == scene::WhiteCells::odd ? kWhitePart : 0.0;
}

}  // namespace

LightGroup chart_white_samples(const formats::Image& image, int channel, const ChartPoints& points,
                               const scene::Chart& chart) {
    LightGroup group{.on_chart = true, .samples = {}};
    const scene::ChartTraits known = scene::traits(chart);
    const scene::GridSize grid = known.points;
    const std::vector<Vec2d> chart_points = scene::feature_points(chart);
    if (chart_points.empty() || points.found.size() != chart_points.size() ||
        points.image_px.size() != chart_points.size() || channel < 0 || channel >= image.channel_count()) {
        return group;
    }
    const double part = white_part(known);
    const bool clipped = is_clipped(image, channel);
    for (int row = 0; row + 1 < grid.rows && part > 0.0; ++row) {
        for (int column = 0; column + 1 < grid.columns; ++column) {
            if (known.white == scene::WhiteCells::odd && (row + column) % 2 == 0) {
                continue;
            }
            const std::size_t i = static_cast<std::size_t>(row) * grid.columns + column;
            const std::size_t around[4] = {i, i + 1, i + 1 + grid.columns, i + grid.columns};
            if (!std::all_of(std::begin(around), std::end(around), [&](std::size_t k) { return points.found[k]; })) {
                continue;
            }
            Vec2d middle;
            Vec2d chart_middle;
            for (const std::size_t k : around) {
                middle = {middle.x + 0.25 * points.image_px[k].x, middle.y + 0.25 * points.image_px[k].y};
                chart_middle = {chart_middle.x + 0.25 * chart_points[k].x, chart_middle.y + 0.25 * chart_points[k].y};
            }
            Vec2d corner[4];
            for (int k = 0; k < 4; ++k) {
                const Vec2d& p = points.image_px[around[k]];
                corner[k] = {middle.x + part * (p.x - middle.x), middle.y + part * (p.y - middle.y)};
            }
            if (auto sample = patch_sample(image, channel, corner, clipped)) {
                sample->chart_mm = chart_middle;
                group.samples.push_back(*sample);
            }
        }
    }
    return group;
}

}  // namespace lensproof::calibration
