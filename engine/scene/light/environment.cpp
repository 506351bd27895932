#include "engine/scene/light/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/scene/light/packet/map_kernels.h"

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

/// The mean squares over four points of each pixel of a row, a quarter of a pixel from its centre either way, where a
/// bilinear look-up has 9, 3, 3 and 1 sixteenths of the nearest pixels: no pixel that a look-up finds light in has
/// none.
std::vector<double> mean_squares(const float* above, const float* here, const float* below, std::size_t width) {
    std::vector<double> squares(width);
    for (std::size_t x = 0; x < width; ++x) {
        const std::size_t left = x > 0 ? x - 1 : width - 1;
        const std::size_t right = x + 1 < width ? x + 1 : 0;
        for (const float* other : {above, below}) {
            const double middle = 0.75 * here[x] + 0.25 * other[x];
            const double a = 0.75 * middle + 0.25 * (0.75 * here[left] + 0.25 * other[left]);
            const double b = 0.75 * middle + 0.25 * (0.75 * here[right] + 0.25 * other[right]);
            squares[x] += 0.25 * (a * a + b * b);
        }
    }
    return squares;
}

/// Proportional to a pixel's solid angle in each row.
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

/// Of a density over the picture, at `sine` from the picture's poles.
double per_solid_angle(double per_uv, double sine) {
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
    const std::vector<double> areas = row_areas(grid.height);
    places_ = PixelDistribution(grid.width, grid.height, [&](int row) {
        const auto row_of = [&](int y) {
            return means.data() + std::ptrdiff_t{std::clamp(y, 0, grid.height - 1)} * grid.width;
        };
        std::vector<double> squares =
            mean_squares(row_of(row - 1), row_of(row), row_of(row + 1), static_cast<std::size_t>(grid.width));
        for (double& square : squares) {
            square *= areas[row] * areas[row];
        }
        return squares;
    });
}

MapDraw Environment::draw(const Vec2d& numbers) const {
    const PixelDistribution::Draw drawn = places_.draw(numbers);
    const auto [direction, sine] = map_direction(drawn.at);
    return {frame_.to_world(direction), {this, drawn.at, per_solid_angle(drawn.pdf, sine)}};
}

MapPlace Environment::find(const Vec3d& direction) const {
    const auto [at, sine] = map_point(frame_.to_local(direction));
    return {this, at, per_solid_angle(places_.pdf(at), sine)};
}

void Environment::draw(std::span<const Vec2d> numbers, std::span<MapDraw> draws) const {
    std::array<PixelDistribution::Draw, MapColumns::kMost> drawn;
    MapColumns columns;
    for (; !numbers.empty(); numbers = numbers.subspan(columns.size), draws = draws.subspan(columns.size)) {
        columns.size = std::min(numbers.size(), MapColumns::kMost);
        places_.draw(numbers.first(columns.size), drawn);
        for (std::size_t i = 0; i < columns.size; ++i) {
            columns.at_x[i] = drawn[i].at.x;
            columns.at_y[i] = drawn[i].at.y;
        }
        map_kernels().find_directions(columns);
        for (std::size_t i = 0; i < columns.size; ++i) {
            draws[i] = {frame_.to_world({columns.x[i], columns.y[i], columns.z[i]}),
                        {this, drawn[i].at, per_solid_angle(drawn[i].pdf, columns.sine[i])}};
        }
    }
}

void Environment::find(std::span<const Vec3d> directions, std::span<MapPlace> places) const {
    MapColumns columns;
    std::array<Vec2d, MapColumns::kMost> points;
    std::array<double, MapColumns::kMost> pdfs{};
    for (; !directions.empty(); directions = directions.subspan(columns.size), places = places.subspan(columns.size)) {
        columns.size = std::min(directions.size(), MapColumns::kMost);
        for (std::size_t i = 0; i < columns.size; ++i) {
            const Vec3d local = frame_.to_local(directions[i]);
            columns.x[i] = local.x;
            columns.y[i] = local.y;
            columns.z[i] = local.z;
        }
        map_kernels().find_points(columns);
        for (std::size_t i = 0; i < columns.size; ++i) {
            points[i] = {columns.at_x[i], columns.at_y[i]};
        }
        places_.find_pdfs(std::span(points).first(columns.size), pdfs);
        for (std::size_t i = 0; i < columns.size; ++i) {
            places[i] = {this, points[i], per_solid_angle(pdfs[i], columns.sine[i])};
            fetch(places[i]);
        }
    }
}

}  // namespace lensproof::scene
