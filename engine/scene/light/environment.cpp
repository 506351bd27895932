#include "engine/scene/light/environment.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

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

/// Makes weights their running sums over their total, which is returned; even steps where there is no weight.
template <class Weights>
double accumulate_to_one(Weights first, Weights last) {
    const double total = std::accumulate(first, last, 0.0);
    double sum = 0.0;
    const auto count = static_cast<double>(last - first);
    for (Weights at = first; at != last; ++at) {
        sum += total > 0.0 ? *at / total : 1.0 / count;
        *at = sum;
    }
    *(last - 1) = 1.0;
    return total;
}

/// Where a number in [0, 1) falls among running sums: the step, and how far into it.
struct Step {
    std::size_t index = 0;
    double fraction = 0.0;
};

/// Looked for from where an even picture has it, outwards: bisecting a large map from its ends would miss the cache at
/// each step.
template <class Sums>
Step step_at(Sums first, Sums last, double u) {
    constexpr std::ptrdiff_t kCacheLine = 8;  // of doubles
    const std::ptrdiff_t count = last - first;
    std::ptrdiff_t low = std::min(static_cast<std::ptrdiff_t>(u * static_cast<double>(count)), count - 1);
    std::ptrdiff_t high = low + 1;
    for (std::ptrdiff_t reach = kCacheLine; low > 0 && first[low - 1] > u; reach *= 2) {
        low = std::max(low - reach, std::ptrdiff_t{0});
    }
    for (std::ptrdiff_t reach = kCacheLine; high < count && !(first[high - 1] > u); reach *= 2) {
        high = std::min(high + reach, count);
    }
    const Sums found = std::min(std::upper_bound(first + low, first + high, u), last - 1);
    const double before = found == first ? 0.0 : *(found - 1);
    return {static_cast<std::size_t>(found - first), std::clamp((u - before) / (*found - before), 0.0, 1.0)};
}

template <class Sums>
double width_of(Sums first, std::size_t index) {
    return index == 0 ? first[0] : first[index] - first[index - 1];
}

/// Of each pixel, over the grid's wavelengths.
std::vector<double> mean_radiances(const ImageTexture& picture) {
    std::vector<double> means;
    means.reserve(picture.texel.size());
    for (const ImageTexture::Texel& texel : picture.texel) {
        double sum = 0.0;
        for (std::size_t i = 0; i < picture.white.value.size(); ++i) {
            sum += texel.scale * texel.shape.at(picture.abscissa.value[i]) * picture.white.value[i];
        }
        means.push_back(sum / static_cast<double>(picture.white.value.size()));
    }
    return means;
}

/// The largest of a pixel and its neighbours, so that no place is darker in the choice than what bilinear look-ups
/// make of it there.
double brightest_around(const std::vector<double>& means, const TexelGrid& grid, int x, int y) {
    double brightest = 0.0;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const auto row = static_cast<std::size_t>(std::clamp(y + dy, 0, grid.height - 1));
            const auto column = static_cast<std::size_t>((x + dx + grid.width) % grid.width);
            brightest = std::max(brightest, means[row * static_cast<std::size_t>(grid.width) + column]);
        }
    }
    return brightest;
}

}  // namespace

Environment::Environment(ImageTexture picture, const Vec3d& up, double rotate_deg)
    : picture_(std::move(picture)), frame_(frame_about(up, rotate_deg)) {
    const auto width = static_cast<std::size_t>(picture_.grid.width);
    const auto height = static_cast<std::size_t>(picture_.grid.height);
    pixels_.resize(width * height);
    rows_.resize(height);
    const std::vector<double> means = mean_radiances(picture_);
    for (std::size_t y = 0; y < height; ++y) {
        const double sine = std::sin(kPi * (static_cast<double>(y) + 0.5) / static_cast<double>(height));
        double sum = 0.0;
        for (std::size_t x = 0; x < width; ++x) {
            const double bright = brightest_around(means, picture_.grid, static_cast<int>(x), static_cast<int>(y));
            pixels_[y * width + x] = bright;
            sum += bright;
        }
        accumulate_to_one(pixels_.begin() + static_cast<std::ptrdiff_t>(y * width),
                          pixels_.begin() + static_cast<std::ptrdiff_t>((y + 1) * width));
        rows_[y] = sum * sine;
    }
    const double total = accumulate_to_one(rows_.begin(), rows_.end());
    mean_power_ = total * 2.0 * kPi * kPi / static_cast<double>(width * height);
    if (!(mean_power_ > 0.0)) {
        throw InputError("the environment's picture is black");
    }
}

Vec2d Environment::uv_of(const Vec3d& direction) const {
    const Vec3d local = frame_.to_local(direction);
    const double turn = std::atan2(local.y, local.x) / (2.0 * kPi);  // counter-clockwise: to the left in the picture
    const double u = 0.5 - turn;
    return {u - std::floor(u), 1.0 - std::acos(std::clamp(local.z, -1.0, 1.0)) / kPi};
}

spectral::SpectralSample Environment::radiance(const Vec3d& direction, const spectral::PathWavelengths& path) const {
    return value_at(picture_, uv_of(direction), path);
}

double Environment::pdf_in_picture(std::size_t pixel, std::size_t row) const {
    const auto width = static_cast<std::size_t>(picture_.grid.width);
    const auto begin = pixels_.begin() + static_cast<std::ptrdiff_t>(row * width);
    return width_of(rows_.begin(), row) * width_of(begin, pixel) * static_cast<double>(width * rows_.size());
}

Environment::Draw Environment::draw(double u1, double u2) const {
    const auto width = static_cast<std::size_t>(picture_.grid.width);
    const Step row = step_at(rows_.begin(), rows_.end(), u1);
    const auto begin = pixels_.begin() + static_cast<std::ptrdiff_t>(row.index * width);
    const Step pixel = step_at(begin, begin + static_cast<std::ptrdiff_t>(width), u2);
    const double polar = kPi * (static_cast<double>(row.index) + row.fraction) / static_cast<double>(rows_.size());
    const double u = (static_cast<double>(pixel.index) + pixel.fraction) / static_cast<double>(width);
    const double turn = 2.0 * kPi * (0.5 - u);
    const double sine = std::sin(polar);
    const Vec3d local{sine * std::cos(turn), sine * std::sin(turn), std::cos(polar)};
    return {frame_.to_world(local),
            sine > 0.0 ? pdf_in_picture(pixel.index, row.index) / (2.0 * kPi * kPi * sine) : 0.0};
}

double Environment::pdf(const Vec3d& direction) const {
    const Vec2d uv = uv_of(direction);
    const auto index_of = [](double at, int count) {
        return static_cast<std::size_t>(std::clamp(static_cast<int>(at * count), 0, count - 1));
    };
    const std::size_t row = index_of(1.0 - uv.y, picture_.grid.height);
    const double sine = length(cross(direction, frame_.z));
    return sine > 0.0 ? pdf_in_picture(index_of(uv.x, picture_.grid.width), row) / (2.0 * kPi * kPi * sine) : 0.0;
}

}  // namespace lensproof::scene
