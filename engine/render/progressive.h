// engine/render/progressive.h — a render as it grows: which samples are taken next, until when, and what is done so
// far.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/render/film/picture.h"

namespace lensproof::render {

/// Samples of each pixel that a render may take: [first, end), all of them unless something else ends it.
struct SampleRange {
    std::uint32_t first = 0;
    std::uint32_t end = 0;
    friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

inline constexpr std::uint32_t kMostSamples = 1U << 20U;

/// How far a tile is: its pixels have had the samples before `done`, and are to have those before `target`.
struct TileProgress {
    std::uint32_t done = 0;
    std::uint32_t target = 0;
    friend bool operator==(const TileProgress&, const TileProgress&) = default;
};

/// A render between two of its steps, or one of its passes: all that is needed to go on.
struct RenderState {
    RenderState(FilmLayout layout, SampleRange range, std::string pass = "");

    std::string pass;  // its name, among several

    Film film;
    SampleRange range;
    std::vector<TileProgress> tiles;  // row by row from the top left
};

/// What they make together.
Picture picture_of(std::span<const RenderState> passes);

inline constexpr int kTileSide = 16;  // px

inline constexpr double kDarkFraction = 0.01;  // of the picture's mean: darker pixels are judged as if they had that

/// How many samples the tiles have at the end of the round after `done`.
std::uint32_t round_end(std::uint32_t done, bool in_rounds);

/// The parts of a film that are rendered and, with --noise, judged as one, row by row from the top left.
std::vector<PixelRect> film_tiles(int width, int height);

/// When a render is done: with all of its samples, and earlier when one of these holds.
struct RenderGoal {
    double seconds = std::numeric_limits<double>::infinity();

    /// The relative error wanted of pixels, 0: none. After at least kFewestSamplesToJudge samples a pixel, and then at
    /// the ends of rounds, a tile gets no more samples once its error is down to that. A tile's error is the root mean
    /// square, over its pixels and R, G, B, of the standard error over the pixel's mean of R, G, B; a pixel darker than
    /// a hundredth of the picture's mean counts as that bright.
    ///
    /// A tile is judged by the samples that it keeps, which biases it (Kirk & Arvo, SIGGRAPH 1991), but by all of its
    /// pixels together. Let a pixel's mean have the standard error σ, and the chance of stopping at n1 samples rather
    /// than going on to n2 be q. Then the bias of the pixel from that decision is (1 − n1/n2) cov(mean, stops), and
    /// |cov| ≤ σ |ρ| √(q (1 − q)) ≤ σ |ρ| / 2, ρ being the correlation of the pixel with the tile's error. Of K alike
    /// and independent pixels |ρ| ≤ 1/√K; n2/n1 ≤ 2 and K = 256 bound the bias by σ/64, and that of a tile's mean by a
    /// quarter of its own standard error, which is σ/64 too. (Measured at the worst
    /// place, pixels of σ = 6 %: 1.5e-4 ± 0.6e-4 of the value, bound 3.9e-4;
    /// ProgressiveNoise.IsBiasedByNoMoreThanItSays.)
    double noise = 0.0;
};

inline constexpr std::uint32_t kFewestSamplesToJudge = 64;

/// How far a render is.
struct RenderReport {
    double done = 0.0;  // 0 to 1, by the goal that is nearest
    double seconds = 0.0;
    double seconds_left = 0.0;
    std::uint64_t samples = 0;  // taken in this run
    std::uint64_t rays = 0;     // traced in this run, where the renderer counts them
};

struct RenderControl {
    int threads = 0;  // 0: one a core
    /// The whole picture early, then better and better, in rounds that end at 16, 32, 64 samples and a quarter more
    /// each time; else as few rounds as there can be. It decides when tiles are judged, and the order in which splats
    /// are added, so their last bits; no bit of anything else.
    bool in_rounds = true;
    /// Asked before every tile, by any thread; true ends the render as soon as the tiles in work are done.
    std::function<bool()> is_interrupted;
    /// Called after tiles were stored, one call at a time; states are whole and stand still meanwhile.
    std::function<void(const RenderReport&)> on_progress;
};

enum class RenderEnd { complete, out_of_time, interrupted };

/// Goes on with a render until its goal. The state is whole at its end, too; a render that goes on from it later takes
/// the same samples and adds them in the same order as one that was never interrupted: to the same bits.
RenderEnd render_progressively(RenderState& state, const TileRenderer& renderer, const RenderGoal& goal,
                               const RenderControl& control);

/// No further than to each tile's target.
RenderEnd render_planned(RenderState& state, const TileRenderer& renderer, const RenderGoal& goal,
                         const RenderControl& control);

/// The film after these samples of every pixel; `progress` is told which part of them is done.
Film render_film(const Render& render, const SampleRange& range, int threads = 0,
                 const std::function<void(double done)>& progress = {});

/// The pixels' variances over their squared brightness, the sum; `dark` is the brightness that darker pixels count as.
/// `of`: whose variances, of a part of the picture or of all.
double relative_variance(const Picture& picture, const Picture& of, const PixelRect& rect, double dark);

/// A tile's error as `RenderGoal::noise` has it.
double tile_error(const Picture& picture, const PixelRect& rect, double dark);

/// Mean over the film of the pixels' means of R, G and B.
double mean_brightness(const Picture& picture);

}  // namespace lensproof::render
