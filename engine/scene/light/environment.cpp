#include "engine/scene/light/environment.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/elementary.h"
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

/// Of the angle from the picture's poles, also near these.
double sine_of(const Vec3d& local) {
    return std::sqrt(local.x * local.x + local.y * local.y);
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

Environment::Draw Environment::draw(double u1, double u2) const {
    const PixelDistribution::Draw drawn = places_.draw(u1, u2);
    const Vec2d uv{drawn.at.x, 1.0 - drawn.at.y};
    fetch(picture_, uv);
    const auto [cosine, sine] = cos_sin_within(kPi * drawn.at.y);
    // Counter-clockwise: to the left in the picture.
    const auto [ahead, left] = cos_sin_within(2.0 * kPi * (0.5 - drawn.at.x));
    return {frame_.to_world({sine * ahead, sine * left, cosine}), uv, per_solid_angle(drawn.pdf, sine)};
}

Vec2d Environment::uv_of(const Vec3d& local) {
    const double turn = 0.5 - std::atan2(local.y, local.x) / (2.0 * kPi);
    return {turn - std::floor(turn), 1.0 - std::atan2(sine_of(local), local.z) / kPi};
}

Vec2d Environment::expect(const Vec3d& direction) const {
    const Vec2d uv = uv_of(frame_.to_local(direction));
    fetch(picture_, uv);
    return uv;
}

Environment::Seen Environment::seen(const Vec3d& direction, const Vec2d& uv,
                                    const spectral::PathWavelengths& path) const {
    const double sine = sine_of(frame_.to_local(direction));
    return {radiance_at(uv, path), per_solid_angle(places_.pdf({uv.x, 1.0 - uv.y}), sine)};
}

}  // namespace lensproof::scene
