#include "engine/scene/light/environment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"

namespace lensproof::scene {

namespace {

/// z along `up`, x where the picture's middle column looks.
Basis frame_about(const Vec3d& up, double rotate_deg) {
    const Vec3d x{1.0, 0.0, 0.0};
    const Vec3d level = x - dot(x, up) * up;
    const Vec3d ahead = length(level) > 1e-6 ? normalized(level) : Basis(up).x;
    const double angle = radians(rotate_deg);
    return {up, std::cos(angle) * ahead + std::sin(angle) * cross(up, ahead)};
}

/// A picture's directions are drawn by cells: its pixels, or as few of them together as keep the table of cells (4
/// bytes each) in a processor's cache. Of 4096 × 2048 pixels they are 2 × 2.
constexpr std::size_t kMostCells = std::size_t{1} << 21U;

int pixels_a_cell(const TexelGrid& grid) {
    const auto cells = [&](int side) {
        return static_cast<std::size_t>((grid.width + side - 1) / side) *
               static_cast<std::size_t>((grid.height + side - 1) / side);
    };
    int side = 1;
    while (cells(side) > kMostCells) {
        ++side;
    }
    return side;
}

/// The cells along one axis of `pixels`: each touches the pixels in [begin, end).
struct Cells {
    int count = 0;
    int pixels = 0;

    [[nodiscard]] int begin(int cell) const { return static_cast<int>(std::int64_t{cell} * pixels / count); }
    [[nodiscard]] int end(int cell) const {
        return static_cast<int>(((std::int64_t{cell} + 1) * pixels + count - 1) / count);
    }
};

/// The mean squares over four points of each pixel of a row, a quarter of a pixel from its centre either way, where a
/// bilinear look-up has 9, 3, 3 and 1 sixteenths of the nearest pixels; added to `sums`.
void add_squares(const float* above, const float* here, const float* below, std::vector<double>& sums) {
    const std::size_t width = sums.size();
    for (std::size_t x = 0; x < width; ++x) {
        const std::size_t left = x > 0 ? x - 1 : width - 1;
        const std::size_t right = x + 1 < width ? x + 1 : 0;
        for (const float* other : {above, below}) {
            const double middle = 0.75 * here[x] + 0.25 * other[x];
            const double a = 0.75 * middle + 0.25 * (0.75 * here[left] + 0.25 * other[left]);
            const double b = 0.75 * middle + 0.25 * (0.75 * here[right] + 0.25 * other[right]);
            sums[x] += 0.25 * (a * a + b * b);
        }
    }
}

/// Of each cell the root of its mean squared radiance, the weight of least variance for what is even within a cell
/// (f²/p is least in the mean where p² goes as the mean of f²). No cell that a look-up finds light in is without
/// weight.
std::vector<float> cell_weights(const std::vector<float>& means, const Cells& columns, const Cells& rows) {
    std::vector<float> weights;
    weights.reserve(static_cast<std::size_t>(columns.count) * static_cast<std::size_t>(rows.count));
    std::vector<double> sums(static_cast<std::size_t>(columns.pixels));
    const auto row_of = [&](int y) {
        return means.data() + std::ptrdiff_t{std::clamp(y, 0, rows.pixels - 1)} * columns.pixels;
    };
    for (int row = 0; row < rows.count; ++row) {
        std::ranges::fill(sums, 0.0);
        for (int y = rows.begin(row); y < rows.end(row); ++y) {
            add_squares(row_of(y - 1), row_of(y), row_of(y + 1), sums);
        }
        for (int column = 0; column < columns.count; ++column) {
            const auto begin = sums.begin() + columns.begin(column);
            const auto end = sums.begin() + columns.end(column);
            const auto touched = static_cast<double>((end - begin) * (rows.end(row) - rows.begin(row)));
            weights.push_back(static_cast<float>(std::sqrt(std::accumulate(begin, end, 0.0) / touched)));
        }
    }
    return weights;
}

/// Proportional to a pixel's or a cell's solid angle in each row.
std::vector<double> row_areas(int height) {
    std::vector<double> areas;
    areas.reserve(static_cast<std::size_t>(height));
    for (int row = 0; row < height; ++row) {
        areas.push_back(std::sin(kPi * (row + 0.5) / height));
    }
    return areas;
}

double sum_of(const std::vector<float>& weights, int width, const std::vector<double>& row_factors) {
    double sum = 0.0;
    auto row = weights.begin();
    for (const double factor : row_factors) {
        sum += factor * std::accumulate(row, row + width, 0.0);
        row += width;
    }
    return sum;
}

/// Of the angle from the picture's poles, also near these.
double sine_of(const Vec3d& local) {
    return std::sqrt(local.x * local.x + local.y * local.y);
}

/// Where a cell is as probable as `probability` says, at `sine` from the picture's poles: per solid angle.
double per_solid_angle(double probability, const PixelDistribution& cells, double sine) {
    const double per_uv = probability * static_cast<double>(cells.width() * cells.height());
    return sine > 0.0 ? per_uv / (2.0 * kPi * kPi * sine) : 0.0;
}

}  // namespace

Environment::Environment(ImageTexture picture, const Vec3d& up, double rotate_deg)
    : picture_(std::move(picture)), frame_(frame_about(up, rotate_deg)) {
    const TexelGrid& grid = picture_.grid;
    const std::vector<float> means = mean_over_grid(picture_);
    mean_power_ =
        sum_of(means, grid.width, row_areas(grid.height)) * 2.0 * kPi * kPi / static_cast<double>(means.size());
    if (!(mean_power_ > 0.0)) {
        throw InputError("the environment's picture is black");
    }
    const int side = pixels_a_cell(grid);
    const Cells columns{.count = (grid.width + side - 1) / side, .pixels = grid.width};
    const Cells rows{.count = (grid.height + side - 1) / side, .pixels = grid.height};
    cells_ = PixelDistribution(columns.count, cell_weights(means, columns, rows), row_areas(rows.count));
}

Environment::Draw Environment::draw(double u1, double u2) const {
    const PixelDistribution::Draw at = cells_.draw(u1, u2);
    const Vec2d uv{at.x, 1.0 - at.y};
    fetch(picture_, uv);
    const double polar = kPi * at.y;
    const double turn = 2.0 * kPi * (0.5 - at.x);  // counter-clockwise: to the left in the picture
    const double sine = std::sin(polar);
    const Vec3d local{sine * std::cos(turn), sine * std::sin(turn), std::cos(polar)};
    return {frame_.to_world(local), uv, per_solid_angle(at.probability, cells_, sine)};
}

Vec2d Environment::uv_of(const Vec3d& local) {
    const double turn = 0.5 - std::atan2(local.y, local.x) / (2.0 * kPi);
    return {turn - std::floor(turn), 1.0 - std::atan2(sine_of(local), local.z) / kPi};
}

Environment::Cell Environment::cell_at(const Vec2d& uv) const {
    const auto index_of = [](double at, std::size_t count) {
        return std::min(static_cast<std::size_t>(at * static_cast<double>(count)), count - 1);
    };
    return {index_of(uv.x, cells_.width()), index_of(1.0 - uv.y, cells_.height())};
}

Vec2d Environment::expect(const Vec3d& direction) const {
    const Vec2d uv = uv_of(frame_.to_local(direction));
    const Cell cell = cell_at(uv);
    cells_.expect_probability(cell.column, cell.row);
    fetch(picture_, uv);
    return uv;
}

Environment::Seen Environment::seen(const Vec3d& direction, const Vec2d& uv,
                                    const spectral::PathWavelengths& path) const {
    const Cell cell = cell_at(uv);
    const double sine = sine_of(frame_.to_local(direction));
    return {radiance_at(uv, path), per_solid_angle(cells_.probability(cell.column, cell.row), cells_, sine)};
}

}  // namespace lensproof::scene
