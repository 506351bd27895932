#include "engine/render/camera/camera_paths.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace lensproof::render {

CameraPathBuffer::CameraPathBuffer(int most) : capacity(most) {
    if (most < 1) {
        throw std::invalid_argument("a buffer of camera paths holds one at least");
    }
    const auto resize = [most](auto&... columns) { (columns.resize(optics::padded(most)), ...); };
    resize(pixel, sample, wavelength, film_x, film_y, weight, etendue);
    resize(origin.x, origin.y, origin.z, direction.x, direction.y, direction.z);
}

void CameraPathBuffer::leave_heroes_alone() {
    weights.resize(static_cast<std::size_t>(size));
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = {hero_weight(i)};
    }
}

Vec2d path_pixel(const CameraPathBuffer& paths, std::size_t path, const Sensor& sensor, bool is_box) {
    if (is_box) {
        const auto width = static_cast<std::uint32_t>(sensor.width);
        const std::uint32_t row = paths.pixel[path] / width;
        return {static_cast<double>(paths.pixel[path] % width), static_cast<double>(row)};
    }
    const Vec2d at = sensor.pixel({paths.film_x[path], paths.film_y[path]});
    return {std::floor(at.x + 0.5), std::floor(at.y + 0.5)};
}

FilmSamples::FilmSamples(FilmSampling film, int wavelengths, std::optional<SimdLevel> level)
    : sampling_{.sensor = film.sensor, .seed = film.seed, .wavelengths = wavelengths},
      filter_(std::move(film.filter)),
      kernels_(&path_kernels(level)) {}

void FilmSamples::start(const CameraPathRange& range, std::uint64_t skipped) {
    left_ = range.size() - skipped;
    if (left_ == 0) {
        return;
    }
    const CameraPathRange::Place at = range.place(skipped);
    cursor_ = {.pixel = at.pixel,
               .sample = at.sample,
               .first_sample = range.first_sample,
               .samples = range.samples,
               .row_end = range.first_pixel + at.row * (range.pixels + range.beside_row) + range.pixels,
               .row_pixels = range.pixels,
               .beside_row = range.beside_row};
}

void FilmSamples::draw(int room) {
    const int whole = room < optics::kMostLanes ? room : room / optics::kMostLanes * optics::kMostLanes;
    const auto count = static_cast<int>(std::min<std::uint64_t>(left_, std::min(whole, kPathChunk)));
    left_ -= static_cast<std::uint64_t>(count);
    kernels_->draw_samples(sampling_, count, cursor_, starts_);
    draw_from_filter();
}

void FilmSamples::draw_from_filter() {
    if (filter_.is_box()) {
        std::fill_n(starts_.filter_weight.begin(), starts_.size, 1.0);
        return;
    }
    const Sensor& sensor = sampling_.sensor;
    const auto width = static_cast<std::uint32_t>(sensor.width);
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts_.size); ++i) {
        const std::uint32_t row = starts_.pixel[i] / width;
        const std::uint32_t column = starts_.pixel[i] - row * width;
        const Vec2d centre = sensor.position(column, row);
        const PixelFilter::Draw across = filter_.draw((centre.x - starts_.film_x[i]) / sensor.pixel_pitch_mm + 0.5);
        const PixelFilter::Draw down = filter_.draw((starts_.film_y[i] - centre.y) / sensor.pixel_pitch_mm + 0.5);
        const Vec2d drawn = sensor.position(column + across.offset_px, row + down.offset_px);
        starts_.film_x[i] = drawn.x;
        starts_.film_y[i] = drawn.y;
        starts_.filter_weight[i] = across.weight * down.weight;
    }
}

}  // namespace lensproof::render
