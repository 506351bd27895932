#include "engine/scene/spectra/texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/formats/image/srgb.h"
#include "engine/spectral/colour_checker.h"

namespace lensproof::scene {

namespace {

/// `at` in [0, 1] across `count` pixels.
TexelPlace::Pair neighbours(double at, int count, Wrap wrap) {
    if (!std::isfinite(at)) {
        return {};
    }
    const double inside = at >= 0.0 && at < 1.0  ? at
                          : wrap == Wrap::repeat ? at - std::floor(at)
                          : wrap == Wrap::mirror ? std::abs(at - 2.0 * std::round(0.5 * at))
                                                 : std::clamp(at, 0.0, 1.0);
    const double pixel = inside * count - 0.5;
    const int first = pixel < 0.0 ? -1 : static_cast<int>(pixel);
    const auto wrapped = [&](int index) {
        const int below = wrap == Wrap::repeat ? count - 1 : 0;
        const int beyond = wrap == Wrap::repeat ? 0 : count - 1;
        return static_cast<std::uint32_t>(index < 0 ? below : index >= count ? beyond : index);
    };
    return {.first = wrapped(first), .second = wrapped(first + 1), .fraction = static_cast<float>(pixel - first)};
}

TexelPlace place_in(const TexelGrid& grid, const Vec2d& uv) {
    return {.column = neighbours(uv.x, grid.width, grid.wrap_u),
            .row = neighbours(1.0 - uv.y, grid.height, grid.wrap_v)};
}

std::size_t row_start(const TexelGrid& grid, std::uint32_t row) {
    return std::size_t{row} * static_cast<std::size_t>(grid.width);
}

/// The mean of `value(texel index)` over the four nearest pixels, weighed bilinearly.
template <class Value>
auto bilinear(const TexelGrid& grid, const TexelPlace& place, const Value& value) {
    const auto row = [&](std::uint32_t j) {
        const std::size_t start = row_start(grid, j);
        const auto& [first, second, fraction] = place.column;
        return (1.0F - fraction) * value(start + first) + fraction * value(start + second);
    };
    return (1.0F - place.row.fraction) * row(place.row.first) + place.row.fraction * row(place.row.second);
}

/// But for the picture's white.
[[gnu::always_inline]] inline spectral::SpectralSample value_of(const ImageTexture::Texel& texel,
                                                                const spectral::SpectralSample& abscissa) {
    return texel.scale * spectral::for_each_wavelength([&](float t) { return texel.shape.at(t); }, abscissa);
}

spectral::SpectralSample value_at(const spectral::GridSpectrum& spectrum, const Vec2d&,
                                  const spectral::PathWavelengths& path) {
    return spectrum(path);
}

spectral::SpectralSample value_at(const ChartTexture& texture, const Vec2d& uv, const spectral::PathWavelengths& path) {
    const Vec2d at{(uv.x - 0.5) * texture.width_mm, (0.5 - uv.y) * texture.height_mm};
    if (!texture.patches.empty()) {
        const std::optional<int> patch = patch_at(std::get<ColourChecker>(texture.chart.pattern), at.x, at.y);
        return patch ? texture.patches[static_cast<std::size_t>(*patch)](path) : texture.black(path);
    }
    const auto white = static_cast<float>(reflectance(texture.chart, at.x, at.y));
    return white * texture.white(path) + (1.0F - white) * texture.black(path);
}

/// The channels that give red, green and blue.
std::array<int, 3> rgb_channels(const formats::Image& image, const std::filesystem::path& file) {
    const std::array<int, 3> rgb{formats::find_channel(image, "R"), formats::find_channel(image, "G"),
                                 formats::find_channel(image, "B")};
    const int grey = formats::find_channel(image, "Y");
    const bool has_rgb = std::all_of(rgb.begin(), rgb.end(), [](int channel) { return channel >= 0; });
    if (image.width < 1 || image.height < 1 || (!has_rgb && grey < 0)) {
        throw InputError(fmt::format("{}: a picture of {} × {} pixels with channels {}, expected R, G and B, or Y",
                                     file.string(), image.width, image.height, fmt::join(image.channels, ", ")));
    }
    return has_rgb ? rgb : std::array<int, 3>{grey, grey, grey};
}

/// The texture whose texels are `texel_of(rgb)`.
template <class TexelOf>
ImageTexture image_texture(const formats::Image& image, const std::filesystem::path& file, const TexelGrid& texels,
                           const Vec3d& factor, const spectral::SpectralGrid& grid, const TexelOf& texel_of) {
    const auto [r, g, b] = rgb_channels(image, file);
    ImageTexture texture{.grid = texels,
                         .texel = {},
                         .abscissa = spectral::tabulated(grid, spectral::sigmoid_abscissa),
                         .white = spectral::constant_spectrum(1.0, grid)};
    texture.texel.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            texture.texel.push_back(texel_of(
                Vec3d{factor.x * image.at(x, y, r), factor.y * image.at(x, y, g), factor.z * image.at(x, y, b)}));
        }
    }
    return texture;
}

}  // namespace

TexelPlace place_at(const ImageTexture& image, const Vec2d& uv) {
    return place_in(image.grid, {image.repeats.x * uv.x, image.repeats.y * uv.y});
}

void fetch(const ImageTexture& image, const TexelPlace& place) {
    for (const std::uint32_t row : {place.row.first, place.row.second}) {
        const ImageTexture::Texel* start = image.texel.data() + row_start(image.grid, row);
        __builtin_prefetch(start + place.column.first);
        __builtin_prefetch(start + place.column.second);
    }
}

spectral::SpectralSample value_at(const ImageTexture& image, const TexelPlace& place,
                                  const spectral::PathWavelengths& path) {
    const spectral::SpectralSample abscissa = image.abscissa(path);
    const spectral::SpectralSample value =
        bilinear(image.grid, place, [&](std::size_t index) { return value_of(image.texel[index], abscissa); });
    return value * image.white(path);
}

spectral::SpectralSample value_at(const ImageTexture& image, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return value_at(image, place_at(image, uv), path);
}

std::size_t nearest_texel(const ImageTexture& image, const Vec2d& uv) {
    const auto nearer = [](const TexelPlace::Pair& pair) { return pair.fraction < 0.5F ? pair.first : pair.second; };
    const TexelPlace place = place_at(image, uv);
    return row_start(image.grid, nearer(place.row)) + nearer(place.column);
}

std::vector<float> mean_over_grid(const ImageTexture& image) {
    const std::size_t count = image.white.value.size();
    std::vector<float> means;
    means.reserve(image.texel.size());
    for (const ImageTexture::Texel& texel : image.texel) {
        spectral::SpectralSample sum;
        for (std::size_t i = 0; i < count; i += spectral::kWavelengthsPerPath) {
            const auto four = [i](const spectral::GridSpectrum& s) {
                return spectral::SpectralSample({s.value[i], s.value[i + 1], s.value[i + 2], s.value[i + 3]});
            };
            sum += value_of(texel, four(image.abscissa)) * four(image.white);
        }
        means.push_back(spectral::kWavelengthsPerPath * mean(sum) / static_cast<float>(count));
    }
    return means;
}

spectral::SpectralSample value_at(const Texture& texture, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return std::visit([&](const auto& kind) { return value_at(kind, uv, path); }, texture.kind_);
}

float value_at(const NumberTexture& numbers, const Vec2d& uv) {
    return bilinear(numbers.grid, place_in(numbers.grid, uv), [&](std::size_t index) { return numbers.value[index]; });
}

ImageTexture reflectance_texture(const formats::Image& image, const std::filesystem::path& file,
                                 const TexelGrid& texels, const Vec3d& factor, const spectral::SpectralGrid& grid,
                                 const spectral::RgbUplift& uplift) {
    return image_texture(image, file, texels, factor, grid,
                         [&](const Vec3d& rgb) { return ImageTexture::Texel{.shape = uplift.reflectance(rgb)}; });
}

ImageTexture reflectance_texture(const std::filesystem::path& file, Wrap wrap, const spectral::SpectralGrid& grid,
                                 const spectral::RgbUplift& uplift) {
    const formats::Image image = formats::read_image(file);
    return reflectance_texture(image, file, {image.width, image.height, wrap, wrap}, kAsItIs, grid, uplift);
}

NumberTexture number_texture(const formats::Image& image, const std::filesystem::path& file, const TexelGrid& texels,
                             std::size_t channel) {
    const int from = rgb_channels(image, file)[channel];
    NumberTexture numbers{.grid = texels, .value = {}};
    numbers.value.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            // What was stored in 8 or 16 bits, to the bit.
            constexpr float kSteps = 65535.0F;
            numbers.value.push_back(std::round(kSteps * formats::linear_to_srgb(image.at(x, y, from))) / kSteps);
        }
    }
    return numbers;
}

ImageTexture emission_texture(const formats::Image& image, const std::filesystem::path& file, const TexelGrid& texels,
                              const Vec3d& factor, const spectral::Spectrum& white, const spectral::SpectralGrid& grid,
                              const spectral::RgbUplift& uplift) {
    ImageTexture texture = image_texture(image, file, texels, factor, grid, [&](const Vec3d& rgb) {
        const spectral::UpliftedLight light = spectral::uplifted_light(uplift, rgb);
        return ImageTexture::Texel{.shape = light.shape, .scale = static_cast<float>(light.scale)};
    });
    texture.white = spectral::stratum_means(white, grid);
    return texture;
}

spectral::GridSpectrum rgb_reflectance(const Vec3d& rgb, const spectral::SpectralGrid& grid,
                                       const spectral::RgbUplift& uplift) {
    return spectral::tabulated(grid, spectral::fitted_reflectance(uplift, spectral::rgb_of_reflectance(), rgb));
}

ChartTexture chart_texture(const Chart& chart, double width_mm, double height_mm, const spectral::SpectralGrid& grid) {
    ChartTexture texture{.chart = chart,
                         .width_mm = width_mm,
                         .height_mm = height_mm,
                         .white = spectral::constant_spectrum(chart.white_reflectance, grid),
                         .black = spectral::constant_spectrum(chart.black_reflectance, grid),
                         .patches = {}};
    if (std::holds_alternative<ColourChecker>(chart.pattern)) {
        for (const spectral::ColourPatch& patch : spectral::colour_checker()) {
            texture.patches.push_back(spectral::at_midpoints(patch.reflectance, grid));
        }
    }
    texture.chart.white_reflectance = 1.0;
    texture.chart.black_reflectance = 0.0;
    return texture;
}

}  // namespace lensproof::scene
