// engine/render/film/film.h — the sums that samples leave: what an image, its variance and its layers are made of.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/base/vec.h"
#include "engine/render/sampling/pixel_filter.h"

namespace lensproof::render {

/// Pixels [x, x + width) × [y, y + height).
struct PixelRect {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    [[nodiscard]] int pixels() const { return width * height; }
    friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// Samples [first, end) of each pixel of a part of the film.
struct TileSamples {
    PixelRect rect;
    std::uint32_t first = 0;
    std::uint32_t end = 0;
};

/// Samples whose index has the same quotient by this are a block: a part of the sequence that is well spread in itself.
/// Variances are estimated from the means of blocks, since those of single samples, which differ in wavelength and in
/// place, say little of what a sum of well-spread ones is wrong by.
inline constexpr std::uint32_t kSamplesPerBlock = 16;

/// How large a film is, what it keeps, and what it makes of light.
struct FilmLayout {
    int width = 0;
    int height = 0;
    std::vector<double> layer_nm;  // centres of the spectral layers, of equal width
    std::vector<Vec3d> rgb_weights;  // a wavelength stratum each: linear RGB of 1 W·m⁻²·nm⁻¹ on the film, per nm; as
                                     // many strata as layers, or a multiple
    double band_nm = 0.0;        // what all strata cover
    PixelFilter filter;          // that splats are spread with
    bool has_splats = false;     // sums for light paths are kept
    bool has_features = false;   // depth, albedo, normals are kept
    double kept_fraction = 1.0;  // of what is added to it, that is kept: the rest goes to other films
};

/// Of sums in memory, that all films of a picture may take; a camera's own without features and splats.
inline constexpr double kMostFilmBytes = 16e9;

/// Bytes that a film holds for each of its pixels.
std::size_t film_bytes_per_pixel(const FilmLayout& layout);

/// What a pixel's sums are of.
struct PixelCounts {
    std::uint32_t samples = 0;
    std::uint32_t blocks = 0;  // begun or whole
    friend PixelCounts operator+(const PixelCounts& a, const PixelCounts& b) {
        return {a.samples + b.samples, a.blocks + b.blocks};
    }
};

/// What the first surface on a path is like.
struct PixelFeatures {
    double depth_mm = 0.0;  // along the camera's axis
    Vec3d albedo_rgb;
    Vec3d normal;  // of the surface, in the frame that the renderer says
};

/// The sums of a few pixels, for one thread to add samples to; it takes them from a film and gives them back.
///
/// Sums are of double: n of them differ from what was added by n · 1e-16 at most, relative to the sum of magnitudes.
/// They are added to block by block, in the samples' order, so that it makes no difference to any bit in how many turns
/// samples are taken, where turns end between blocks.
class FilmTile {
  public:
    /// `layout` outlives it.
    explicit FilmTile(const FilmLayout& layout);

    [[nodiscard]] const PixelRect& rect() const { return samples_.rect; }

    /// The number of a pixel within the tile, by its place on the film.
    [[nodiscard]] std::size_t pixel(int x, int y) const {
        const int number = (y - rect().y) * rect().width + (x - rect().x);
        return static_cast<std::size_t>(number);
    }

    /// Adds sample `sample` at one wavelength stratum: its estimate of the film irradiance, W·m⁻²·nm⁻¹, filter weight
    /// included. Once a sample, with all that it met, and a pixel's samples in ascending order; samples that met no
    /// light need not be told. One that is not a finite number is left out, as if it had met no light, and counted.
    void add(std::size_t pixel, std::uint32_t sample, std::size_t stratum, double irradiance) {
        if (!std::isfinite(irradiance)) {
            ++left_out_;
            return;
        }
        const double kept = kept_fraction_ * irradiance;
        const Light& light = lights_[stratum];
        Vec3d& rgb = block_of(pixel, sample).rgb;
        rgb = rgb + rgb_of(light, kept);
        sums_[pixel * stride_ + light.layer] += kept;
    }

    /// The same at the wavelengths of one path, of which each is as likely as any to be at any stratum (hero wavelength
    /// sampling): the sample's value is the mean over them. A path that ends all but its first gives zeros for them and
    /// four times the first's own estimate.
    void add(std::size_t pixel, std::uint32_t sample, std::span<const std::uint16_t, 4> strata,
             std::span<const float, 4> irradiance);

    /// Adds what a sample's first surface is like; samples that met none need not be told. Left out and counted where a
    /// number is not finite.
    void add_features(std::size_t pixel, const PixelFeatures& features);

    /// Says that a light path begins, to be told of those that bring nothing too. Its splats count together for the
    /// variance.
    void begin_light_path() { ++light_paths_; }
    /// The number of the one that began last.
    [[nodiscard]] std::uint64_t light_path() const { return light_paths_; }

    /// Light at any point of the film, of the tile or not: the power that one light path brings there over the area of
    /// a pixel, W·m⁻²·nm⁻¹, the mean over the path's wavelengths as above. Each wavelength has its own point, in pixel
    /// coordinates; points outside the film count too, if the filter of a pixel reaches them. A splat with a number
    /// that is not finite is left out and counted.
    void splat(const std::array<Vec2d, 4>& at_px, std::span<const std::uint16_t, 4> strata,
               std::span<const float, 4> irradiance) {
        splat(at_px, strata, irradiance, light_paths_);
    }
    /// The same of one that began before; of several in their order.
    void splat(const std::array<Vec2d, 4>& at_px, std::span<const std::uint16_t, 4> strata,
               std::span<const float, 4> irradiance, std::uint64_t light_path);

    /// Says that all samples that the tile was loaded for are taken.
    void finish();

    /// Rays that were traced: for whom it may interest.
    void count_rays(std::uint64_t rays) { rays_ += rays; }
    [[nodiscard]] std::uint64_t rays() const { return rays_; }

  private:
    friend class Film;

    struct Light {  // what a stratum makes of irradiance
        Vec3d rgb_weights;
        std::uint32_t layer = 0;  // where its sum stands among a pixel's
    };
    struct Splat {  // a wavelength each
        std::array<Vec2d, 4> at_px;
        std::array<float, 4> irradiance{};  // of which the mean counts
        std::array<std::uint16_t, 4> strata{};
        std::uint64_t path = 0;
    };

    [[nodiscard]] Vec3d rgb_of(const Light& light, double irradiance) const {
        const double over_band = band_nm_ * irradiance;
        return {over_band * light.rgb_weights.x, over_band * light.rgb_weights.y, over_band * light.rgb_weights.z};
    }
    struct Block {
        Vec3d rgb;  // the sum over its samples so far
        std::uint32_t index = kNoBlock;
    };
    static constexpr std::uint32_t kNoBlock = ~0U;

    Block& block_of(std::size_t pixel, std::uint32_t sample) {
        Block& block = blocks_[pixel];
        if (block.index != sample / kSamplesPerBlock) {
            end_block(pixel);
            block.index = sample / kSamplesPerBlock;
        }
        return block;
    }
    void end_block(std::size_t pixel);

    std::vector<Light> lights_;
    double band_nm_ = 0.0;
    double kept_fraction_ = 1.0;
    Vec2d film_px_;  // its size
    double filter_radius_px_ = 0.0;
    std::size_t stride_ = 0;
    std::size_t features_ = 0;  // where they stand among a pixel's sums
    TileSamples samples_;
    std::vector<double> sums_;
    std::vector<Block> blocks_;  // that each pixel is in
    std::vector<PixelCounts> counts_;
    std::vector<Splat> splats_;
    std::uint64_t light_paths_ = 0;
    std::uint64_t left_out_ = 0;
    std::uint64_t rays_ = 0;
};

/// Renders these samples into the tile, which has been loaded for them. What a sample gives depends on the seed, its
/// pixel and its index alone. A renderer may own what it needs for every tile, and so belongs to one thread; a copy is
/// for another.
using TileRenderer = std::function<void(const TileSamples&, FilmTile&)>;

/// A film to be rendered, and by whom.
struct Render {
    FilmLayout film;
    TileRenderer renderer;
    bool lands_anywhere = false;  // all of its light comes as splats: no tile has samples of its own
};

/// What samples say of a pixel, and the variance of that.
///
/// The variance of n samples' mean m is estimated from the means m_b of its M blocks of n_b samples:
/// Σ n_b (m_b − m)² / (n (M − 1)). For independent samples that has the variance's expectation whatever the blocks are;
/// blocks of one sequence lie between each other's points, so their mean does better than independent ones: then it is
/// an upper bound. It is 0 where there is one block alone. Of light paths each is a block of its own, with all that it
/// brings to the pixel: the variance's expectation again if they are independent, an upper bound as they are spread.
struct PixelEstimate {
    Vec3d rgb;       // linear, 1 = saturation
    Vec3d variance;  // of rgb
};

/// All pixels' sums. Two films of one layout that hold different samples add up to the film of all of them.
class Film {
  public:
    explicit Film(FilmLayout layout);

    [[nodiscard]] const FilmLayout& layout() const { return layout_; }
    [[nodiscard]] int width() const { return layout_.width; }
    [[nodiscard]] int height() const { return layout_.height; }

    /// Gives a tile the sums of its pixels, so that these samples may be added.
    void load(const TileSamples& samples, FilmTile& tile) const;

    /// Takes a finished tile's sums in place of the film's, and its splats, in their order.
    void store(const FilmTile& tile);

    /// Adds another film's sums. Throws std::invalid_argument unless it may: where sizes, layers and kinds are the
    /// same.
    [[nodiscard]] bool can_merge(const Film& other) const;
    void merge(const Film& other);

    [[nodiscard]] const PixelCounts& counts(int x, int y) const { return counts_[at(x, y)]; }
    [[nodiscard]] std::uint64_t light_paths() const { return light_paths_; }
    /// Samples and splats that were no finite numbers, and count as if they had met no light.
    [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

    /// What camera paths and light paths make of a pixel together, and each alone. Both are parts of one image: where
    /// both can bring the same light, the renderer has weighed them to add up to it.
    [[nodiscard]] PixelEstimate estimate(int x, int y) const;
    [[nodiscard]] PixelEstimate camera_estimate(int x, int y) const;
    [[nodiscard]] PixelEstimate light_estimate(int x, int y) const;

    /// Mean film irradiance over the band of each spectral layer, W·m⁻²·nm⁻¹; of camera and light paths, or of the
    /// latter alone.
    void layers(int x, int y, std::span<double> irradiance) const;
    void light_layers(int x, int y, std::span<double> irradiance) const;

    /// Means of the features: of albedo and normal over all samples, of depth over those that met a surface, and
    /// which fraction of the samples that is.
    [[nodiscard]] PixelFeatures features(int x, int y) const;
    [[nodiscard]] double coverage(int x, int y) const;

    /// All that a film holds besides its layout, for checkpoints.
    template <class Self, class Visit>
    static void visit_sums(Self& film, const Visit& visit) {
        visit(film.sums_);
        visit(film.counts_);
        visit(film.splat_sums_);
        visit(film.light_paths_);
        visit(film.left_out_);
    }

    /// Puts a pixel's sums together from what was written of it: what `estimate`, … give for it. For shards.
    struct PixelContent {
        PixelCounts counts;
        PixelEstimate camera;
        std::span<const double> camera_layers;
        PixelEstimate light;
        std::span<const double> light_layers;
        PixelFeatures features;
        double coverage = 0.0;
    };
    void set_pixel(int x, int y, const PixelContent& content);
    void set_light_paths(std::uint64_t paths) { light_paths_ = paths; }
    void set_left_out(std::uint64_t samples) { left_out_ = samples; }

  private:
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(layout_.width) + static_cast<std::size_t>(x);
    }
    struct PathLight {  // what a light path brings to a pixel
        std::size_t pixel = 0;
        Vec3d rgb;
    };
    void add_light_path(std::span<const FilmTile::Splat> splats, std::vector<PathLight>& lit);
    void add_splat(const FilmTile::Splat& splat, std::vector<PathLight>& lit);

    FilmLayout layout_;
    std::size_t stride_ = 0;
    std::size_t splat_stride_ = 0;
    std::size_t features_ = 0;
    std::vector<double> sums_;         // a pixel: RGB, Σ n_b m_b² of each, layers, features
    std::vector<PixelCounts> counts_;  // of each pixel
    std::vector<double> splat_sums_;   // a pixel: RGB, their squares, layers
    std::uint64_t light_paths_ = 0;
    std::uint64_t left_out_ = 0;
};

}  // namespace lensproof::render
