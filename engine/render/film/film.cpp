#include "engine/render/film/film.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

namespace lensproof::render {

namespace {

// Of what a pixel's sums consist: RGB, Σ n_b m_b² of each, the spectral layers, the features.
constexpr std::size_t kLayers = 6;
constexpr std::size_t kMostReached = 5;  // pixels of an axis, by a filter
constexpr std::size_t kFeatureSums = 8;  // depth, coverage, albedo, normal

std::size_t colour_sums(const FilmLayout& layout) {
    return kLayers + layout.layer_nm.size();
}

std::size_t all_sums(const FilmLayout& layout) {
    return colour_sums(layout) + (layout.has_features ? kFeatureSums : 0);
}

/// A mean over n samples in `blocks` blocks, and its variance.
PixelEstimate estimate_from(const double* sums, double n, double blocks) {
    const auto variance = [&](int k) {
        const double mean = sums[k] / n;
        return blocks > 1.0 ? std::max(0.0, (sums[3 + k] / n - mean * mean) / (blocks - 1.0)) : 0.0;
    };
    return n > 0.0 ? PixelEstimate{.rgb = {sums[0] / n, sums[1] / n, sums[2] / n},
                                   .variance = {variance(0), variance(1), variance(2)}}
                   : PixelEstimate{};
}

/// The inverse of that.
void put_estimate(const PixelEstimate& estimate, double n, double blocks, double* sums) {
    const auto put = [&](int k, double mean, double variance) {
        sums[k] = n * mean;
        sums[3 + k] = n * (mean * mean + std::max(0.0, blocks - 1.0) * variance);
    };
    put(0, estimate.rgb.x, estimate.variance.x);
    put(1, estimate.rgb.y, estimate.variance.y);
    put(2, estimate.rgb.z, estimate.variance.z);
}

/// Adds the sum of n samples that count as one.
void add_together(const Vec3d& rgb, double n, double* sums) {
    sums[0] += rgb.x;
    sums[1] += rgb.y;
    sums[2] += rgb.z;
    sums[3] += rgb.x * rgb.x / n;
    sums[4] += rgb.y * rgb.y / n;
    sums[5] += rgb.z * rgb.z / n;
}

template <class Number>
void add_all(std::vector<Number>& to, const std::vector<Number>& from) {
    std::ranges::transform(to, from, to.begin(), std::plus<>());
}

/// Whether a filter of this radius reaches a pixel of an axis from a coordinate.
bool reaches(double at, double pixels, double radius) {
    return at >= -radius && at <= pixels - 1.0 + radius;
}

bool is_finite(std::span<const float, 4> irradiance) {
    return std::ranges::all_of(irradiance, [](float value) { return std::isfinite(value); });
}

/// The pixels of one axis that a filter reaches from a coordinate, and f there.
struct Reach {
    int first = 0;
    int count = 0;
    std::array<double, kMostReached> weights{};
};

Reach reach_of(double at, int pixels, const PixelFilter& filter) {
    const double radius = filter.radius_px();
    Reach reach;
    // Compared before it is made an integer: a point far away has no such.
    if (reaches(at, pixels, radius)) {
        reach.first = std::max(0, static_cast<int>(std::ceil(at - radius)));
        const int last = std::min(pixels - 1, static_cast<int>(std::floor(at + radius)));
        for (int pixel = reach.first; pixel <= last; ++pixel) {
            reach.weights[static_cast<std::size_t>(reach.count++)] = filter(at - pixel);
        }
    }
    return reach;
}

}  // namespace

std::size_t film_bytes_per_pixel(const FilmLayout& layout) {
    const std::size_t sums = all_sums(layout) + (layout.has_splats ? colour_sums(layout) : 0);
    return sums * sizeof(double) + sizeof(PixelCounts);
}

FilmTile::FilmTile(const FilmLayout& layout)
    : band_nm_(layout.band_nm),
      kept_fraction_(layout.kept_fraction),
      film_px_{static_cast<double>(layout.width), static_cast<double>(layout.height)},
      filter_radius_px_(layout.filter.radius_px()),
      stride_(all_sums(layout)),
      features_(colour_sums(layout)) {
    const std::size_t strata_per_layer = layout.rgb_weights.size() / std::max<std::size_t>(1, layout.layer_nm.size());
    for (std::size_t i = 0; i < layout.rgb_weights.size(); ++i) {
        lights_.push_back({.rgb_weights = layout.rgb_weights[i],
                           .layer = static_cast<std::uint32_t>(kLayers + i / strata_per_layer)});
    }
}

void FilmTile::add(std::size_t pixel, std::uint32_t sample, std::span<const std::uint16_t, 4> strata,
                   std::span<const float, 4> irradiance) {
    if (!is_finite(irradiance)) {
        ++left_out_;
        return;
    }
    double* sums = sums_.data() + pixel * stride_;
    Vec3d rgb;
    for (std::size_t i = 0; i < strata.size(); ++i) {
        const Light& light = lights_[strata[i]];
        const double quarter = 0.25 * kept_fraction_ * static_cast<double>(irradiance[i]);
        rgb = rgb + rgb_of(light, quarter);
        sums[light.layer] += quarter;
    }
    Block& block = block_of(pixel, sample);
    block.rgb = block.rgb + rgb;
}

void FilmTile::end_block(std::size_t pixel) {
    Block& block = blocks_[pixel];
    if (block.index != kNoBlock) {
        const std::uint32_t first = std::max(samples_.first, block.index * kSamplesPerBlock);
        const std::uint32_t end = std::min(samples_.end, (block.index + 1) * kSamplesPerBlock);
        add_together(block.rgb, end - first, sums_.data() + pixel * stride_);
        block = {};
    }
}

void FilmTile::finish() {
    const std::uint32_t samples = samples_.end - samples_.first;
    const std::uint32_t end_block_index = (samples_.end + kSamplesPerBlock - 1) / kSamplesPerBlock;
    const std::uint32_t blocks = samples > 0 ? end_block_index - samples_.first / kSamplesPerBlock : 0;
    for (std::size_t pixel = 0; pixel < counts_.size(); ++pixel) {
        end_block(pixel);
        counts_[pixel] = counts_[pixel] + PixelCounts{samples, blocks};
    }
}

void FilmTile::add_features(std::size_t pixel, const PixelFeatures& features) {
    double* sums = sums_.data() + pixel * stride_ + features_;
    const auto& [depth_mm, albedo, normal] = features;
    const std::array<double, kFeatureSums> more = {depth_mm, 1.0,      albedo.x, albedo.y,
                                                   albedo.z, normal.x, normal.y, normal.z};
    if (!std::ranges::all_of(more, [](double value) { return std::isfinite(value); })) {
        ++left_out_;
        return;
    }
    std::transform(more.begin(), more.end(), sums, sums, std::plus<>());
}

void FilmTile::splat(const std::array<Vec2d, 4>& at_px, std::span<const std::uint16_t, 4> strata,
                     std::span<const float, 4> irradiance, std::uint64_t light_path) {
    Splat splat{.at_px = at_px, .path = light_path};
    bool is_seen = false;
    for (std::size_t i = 0; i < strata.size(); ++i) {
        splat.irradiance[i] = static_cast<float>(kept_fraction_) * irradiance[i];
        splat.strata[i] = strata[i];
        const auto& [x, y] = at_px[i];
        if (irradiance[i] != 0.0F && !std::isfinite(irradiance[i] + x + y)) {
            ++left_out_;
            return;
        }
        is_seen = is_seen || (irradiance[i] != 0.0F && reaches(x, film_px_.x, filter_radius_px_) &&
                              reaches(y, film_px_.y, filter_radius_px_));
    }
    if (is_seen) {
        splats_.push_back(splat);
    }
}

Film::Film(FilmLayout layout)
    : layout_(std::move(layout)),
      stride_(all_sums(layout_)),
      splat_stride_(layout_.has_splats ? colour_sums(layout_) : 0),
      features_(colour_sums(layout_)) {
    const std::size_t pixels = static_cast<std::size_t>(layout_.width) * static_cast<std::size_t>(layout_.height);
    if (layout_.layer_nm.empty() || layout_.rgb_weights.size() % layout_.layer_nm.size() != 0) {
        throw std::invalid_argument("a film's spectral layers hold the same number of strata each");
    }
    sums_.resize(pixels * stride_);
    counts_.resize(pixels);
    splat_sums_.resize(pixels * splat_stride_);
}

void Film::load(const TileSamples& samples, FilmTile& tile) const {
    const PixelRect& rect = samples.rect;
    const auto pixels = static_cast<std::size_t>(rect.pixels());
    tile.samples_ = samples;
    tile.sums_.resize(pixels * stride_);
    tile.counts_.resize(pixels);
    tile.blocks_.assign(pixels, {});
    tile.splats_.clear();
    tile.light_paths_ = 0;
    tile.left_out_ = 0;
    tile.rays_ = 0;
    const auto width = static_cast<std::size_t>(rect.width);
    for (int row = 0; row < rect.height; ++row) {
        const std::size_t from = at(rect.x, rect.y + row);
        const std::size_t to = static_cast<std::size_t>(row) * width;
        std::copy_n(sums_.data() + from * stride_, width * stride_, tile.sums_.data() + to * stride_);
        std::copy_n(counts_.data() + from, width, tile.counts_.data() + to);
    }
}

void Film::store(const FilmTile& tile) {
    const PixelRect& rect = tile.rect();
    const auto width = static_cast<std::size_t>(rect.width);
    for (int row = 0; row < rect.height; ++row) {
        const std::size_t to = at(rect.x, rect.y + row);
        const std::size_t from = static_cast<std::size_t>(row) * width;
        std::copy_n(tile.sums_.data() + from * stride_, width * stride_, sums_.data() + to * stride_);
        std::copy_n(tile.counts_.data() + from, width, counts_.data() + to);
    }
    light_paths_ += tile.light_paths_;
    left_out_ += tile.left_out_;
    std::vector<PathLight> lit;
    for (auto first = tile.splats_.begin(); first != tile.splats_.end();) {
        const auto end =
            std::find_if(first, tile.splats_.end(), [&](const auto& splat) { return splat.path != first->path; });
        add_light_path({first, end}, lit);
        first = end;
    }
}

void Film::add_light_path(std::span<const FilmTile::Splat> splats, std::vector<PathLight>& lit) {
    lit.clear();
    for (const FilmTile::Splat& splat : splats) {
        add_splat(splat, lit);
    }
    for (const PathLight& light : lit) {
        add_together(light.rgb, 1.0, splat_sums_.data() + light.pixel * splat_stride_);
    }
}

void Film::add_splat(const FilmTile::Splat& splat, std::vector<PathLight>& lit) {
    const std::size_t strata_per_layer = layout_.rgb_weights.size() / layout_.layer_nm.size();
    for (std::size_t i = 0; i < splat.at_px.size(); ++i) {
        if (splat.irradiance[i] == 0.0F) {
            continue;
        }
        const Reach across = reach_of(splat.at_px[i].x, width(), layout_.filter);
        const Reach down = reach_of(splat.at_px[i].y, height(), layout_.filter);
        for (int row = 0; row < down.count; ++row) {
            for (int column = 0; column < across.count; ++column) {
                const double weight =
                    down.weights[static_cast<std::size_t>(row)] * across.weights[static_cast<std::size_t>(column)];
                const std::size_t pixel = at(across.first + column, down.first + row);
                const double irradiance = 0.25 * weight * static_cast<double>(splat.irradiance[i]);
                splat_sums_[pixel * splat_stride_ + kLayers + splat.strata[i] / strata_per_layer] += irradiance;
                const auto before = std::ranges::find(lit, pixel, &PathLight::pixel);
                PathLight& light = before == lit.end() ? lit.emplace_back(PathLight{pixel, {}}) : *before;
                light.rgb = light.rgb + (layout_.band_nm * irradiance) * layout_.rgb_weights[splat.strata[i]];
            }
        }
    }
}

bool Film::can_merge(const Film& other) const {
    const FilmLayout& of = other.layout_;
    return layout_.width == of.width && layout_.height == of.height && layout_.layer_nm == of.layer_nm &&
           layout_.has_splats == of.has_splats && layout_.has_features == of.has_features;
}

void Film::merge(const Film& other) {
    if (!can_merge(other)) {
        throw std::invalid_argument("films of different layouts do not add up");
    }
    add_all(sums_, other.sums_);
    add_all(counts_, other.counts_);
    add_all(splat_sums_, other.splat_sums_);
    light_paths_ += other.light_paths_;
    left_out_ += other.left_out_;
}

PixelEstimate Film::camera_estimate(int x, int y) const {
    return estimate_from(sums_.data() + at(x, y) * stride_, counts(x, y).samples, counts(x, y).blocks);
}

PixelEstimate Film::light_estimate(int x, int y) const {
    const auto paths = static_cast<double>(light_paths_);
    return layout_.has_splats ? estimate_from(splat_sums_.data() + at(x, y) * splat_stride_, paths, paths)
                              : PixelEstimate{};
}

PixelEstimate Film::estimate(int x, int y) const {
    const PixelEstimate camera = camera_estimate(x, y);
    if (!layout_.has_splats) {
        return camera;
    }
    const PixelEstimate light = light_estimate(x, y);
    return {.rgb = camera.rgb + light.rgb, .variance = camera.variance + light.variance};
}

void Film::layers(int x, int y, std::span<double> irradiance) const {
    // Per layer, the mean over the samples expected there, which keeps the layers' sum unbiased.
    const double expected = static_cast<double>(counts(x, y).samples) / static_cast<double>(layout_.layer_nm.size());
    light_layers(x, y, irradiance);
    const double* sums = sums_.data() + at(x, y) * stride_ + kLayers;
    for (std::size_t k = 0; k < layout_.layer_nm.size() && expected > 0.0; ++k) {
        irradiance[k] += sums[k] / expected;
    }
}

void Film::light_layers(int x, int y, std::span<double> irradiance) const {
    std::ranges::fill(irradiance, 0.0);
    const double expected = static_cast<double>(light_paths_) / static_cast<double>(layout_.layer_nm.size());
    if (layout_.has_splats && expected > 0.0) {
        const double* sums = splat_sums_.data() + at(x, y) * splat_stride_ + kLayers;
        std::transform(sums, sums + layout_.layer_nm.size(), irradiance.begin(),
                       [expected](double sum) { return sum / expected; });
    }
}

double Film::coverage(int x, int y) const {
    const std::uint32_t n = counts(x, y).samples;
    return layout_.has_features && n > 0 ? sums_[at(x, y) * stride_ + features_ + 1] / n : 0.0;
}

PixelFeatures Film::features(int x, int y) const {
    const double n = counts(x, y).samples;
    if (!(coverage(x, y) > 0.0)) {
        return {};
    }
    const double* sums = sums_.data() + at(x, y) * stride_ + features_;
    return {.depth_mm = sums[0] / sums[1],
            .albedo_rgb = {sums[2] / n, sums[3] / n, sums[4] / n},
            .normal = {sums[5] / n, sums[6] / n, sums[7] / n}};
}

void Film::set_pixel(int x, int y, const PixelContent& content) {
    const double n = content.counts.samples;
    const auto layers = static_cast<double>(layout_.layer_nm.size());
    double* sums = sums_.data() + at(x, y) * stride_;
    counts_[at(x, y)] = content.counts;
    put_estimate(content.camera, n, content.counts.blocks, sums);
    std::ranges::transform(content.camera_layers, sums + kLayers, [&](double mean) { return mean * n / layers; });
    if (layout_.has_features) {
        const double met = content.coverage * n;
        const auto& [depth_mm, albedo, normal] = content.features;
        const std::array<double, kFeatureSums> features = {met * depth_mm, met,          n * albedo.x, n * albedo.y,
                                                           n * albedo.z,   n * normal.x, n * normal.y, n * normal.z};
        std::ranges::copy(features, sums + features_);
    }
    if (layout_.has_splats) {
        const auto paths = static_cast<double>(light_paths_);
        double* splats = splat_sums_.data() + at(x, y) * splat_stride_;
        put_estimate(content.light, paths, paths, splats);
        std::ranges::transform(content.light_layers, splats + kLayers,
                               [&](double mean) { return mean * paths / layers; });
    }
}

}  // namespace lensproof::render
