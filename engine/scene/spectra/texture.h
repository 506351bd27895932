// engine/scene/spectra/texture.h — what varies over a surface.
//
// (u, v) covers a texture once from 0 to 1: u runs to the right and v up, so that (0, 1) is a picture's top left
// corner.
#pragma once
#include <cstdint>
#include <filesystem>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/large_pages.h"
#include "engine/base/vec.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"
#include "engine/spectral/rgb_uplift.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::scene {

/// What lies beyond a picture's edge: the picture again, its edge's pixels for ever, or its mirror image.
enum class Wrap { repeat, clamp, mirror };

/// A picture's size and how it goes on, to look up between its pixels' centres.
struct TexelGrid {
    int width = 0;
    int height = 0;
    Wrap wrap_u = Wrap::repeat;
    Wrap wrap_v = Wrap::repeat;
};

/// Where a look-up falls between pixels' centres: the nearest columns and rows, counted from the top left.
struct TexelPlace {
    struct Pair {
        std::uint32_t first = 0;
        std::uint32_t second = 0;
        float fraction = 0.0F;  // of the way from the first to the second
        friend bool operator==(const Pair&, const Pair&) = default;
    };
    Pair column;
    Pair row;
    friend bool operator==(const TexelPlace&, const TexelPlace&) = default;
};

/// A picture whose pixels are spectra: `scale` · `shape` · `white`; between pixels bilinear, wavelength by wavelength.
struct ImageTexture {
    struct Texel {
        spectral::SigmoidSpectrum shape;
        float scale = 1.0F;
    };
    TexelGrid grid;
    Vec2d repeats{1.0, 1.0};                      // how often the picture covers the surface along u and v
    std::vector<Texel, LargePages<Texel>> texel;  // rows from the top
    spectral::GridSpectrum abscissa;              // sigmoid_abscissa of the wavelengths
    spectral::GridSpectrum white;                 // 1 for reflectances
};

/// A picture of numbers, as they are stored; between pixels bilinear.
struct NumberTexture {
    TexelGrid grid;
    std::vector<float> value;  // rows from the top
};
float value_at(const NumberTexture& numbers, const Vec2d& uv);

/// A chart on a surface of width_mm × height_mm, its centre in the middle: `black`, `white`, or what the chart says
/// between them; a colour checker's patches as they were measured.
struct ChartTexture {
    Chart chart;  // of white_reflectance 1 and black_reflectance 0: its reflectance is the fraction of white
    double width_mm = 0.0;
    double height_mm = 0.0;
    spectral::GridSpectrum white;
    spectral::GridSpectrum black;
    std::vector<spectral::GridSpectrum> patches;  // of a colour checker, row by row from the top left; else none
};

/// A spectrum over a surface; a GridSpectrum is the same everywhere. What it is made of is moved into it: a picture
/// that is looked up by itself must not be copied into a Texture on the way.
class Texture {
  public:
    Texture() = default;
    Texture(spectral::GridSpectrum&& even) : kind_(std::move(even)) {}
    Texture(ImageTexture&& picture) : kind_(std::move(picture)) {}
    Texture(ChartTexture&& chart) : kind_(std::move(chart)) {}

    friend spectral::SpectralSample value_at(const Texture& texture, const Vec2d& uv,
                                             const spectral::PathWavelengths& path);
    friend bool varies(const Texture& texture) {
        return !std::holds_alternative<spectral::GridSpectrum>(texture.kind_);
    }

  private:
    std::variant<spectral::GridSpectrum, ImageTexture, ChartTexture> kind_;
};

spectral::SpectralSample value_at(const Texture& texture, const Vec2d& uv, const spectral::PathWavelengths& path);
spectral::SpectralSample value_at(const ImageTexture& image, const Vec2d& uv, const spectral::PathWavelengths& path);

/// The same in two steps, of which the first only finds what the second reads, and may ask memory for it.
TexelPlace place_at(const ImageTexture& image, const Vec2d& uv);
void fetch(const ImageTexture& image, const TexelPlace& place);
spectral::SpectralSample value_at(const ImageTexture& image, const TexelPlace& place,
                                  const spectral::PathWavelengths& path);

/// The index of the pixel that is nearest.
std::size_t nearest_texel(const ImageTexture& image, const Vec2d& uv);

/// The mean over the grid's wavelengths of each pixel, row after row.
std::vector<float> mean_over_grid(const ImageTexture& image);

inline constexpr Vec3d kAsItIs{1.0, 1.0, 1.0};  // no factor

/// A picture's channels R, G, B, or Y, times `factor`, as reflectances of these colours under D65. Throws InputError
/// naming `file` where there are no such channels.
ImageTexture reflectance_texture(const formats::Image& image, const std::filesystem::path& file,
                                 const TexelGrid& texels, const Vec3d& factor, const spectral::SpectralGrid& grid,
                                 const spectral::RgbUplift& uplift);

/// The same of a picture file. Throws InputError for a file that is missing, or as read_image says.
ImageTexture reflectance_texture(const std::filesystem::path& file, Wrap wrap, const spectral::SpectralGrid& grid,
                                 const spectral::RgbUplift& uplift);

/// The picture's channel 0 (R), 1 (G) or 2 (B), or Y, as sRGB would store it: pictures of numbers that are no light.
/// Throws as above.
NumberTexture number_texture(const formats::Image& image, const std::filesystem::path& file, const TexelGrid& texels,
                             std::size_t channel);

/// A picture, times `factor`, as light: where that is (1, 1, 1) it is `white`, a spectral radiance or whatever the
/// owner means, and otherwise as bright and of the colour that its RGB say. Brightness has no limit.
ImageTexture emission_texture(const formats::Image& image, const std::filesystem::path& file, const TexelGrid& texels,
                              const Vec3d& factor, const spectral::Spectrum& white, const spectral::SpectralGrid& grid,
                              const spectral::RgbUplift& uplift);

/// The smooth reflectance of colour `rgb` (linear sRGB, under D65), exactly: a fit of its own. Out of [0, 1]: the
/// nearest inside.
spectral::GridSpectrum rgb_reflectance(const Vec3d& rgb, const spectral::SpectralGrid& grid,
                                       const spectral::RgbUplift& uplift);

/// `chart` with its own two reflectances, alike at all wavelengths, and its patches, if it has such, by
/// engine/spectral/colour_checker.h.
ChartTexture chart_texture(const Chart& chart, double width_mm, double height_mm, const spectral::SpectralGrid& grid);

}  // namespace lensproof::scene
