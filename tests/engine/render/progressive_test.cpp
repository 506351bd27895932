#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/render/pass_turns.h"
#include "tests/engine/render/film/film_sample.h"

namespace lensproof::render::progressive_test {

/// Every bit of a film's sums.
std::string bits(const Film& film) {
    std::string all;
    Film::visit_sums(film, [&]<class Sums>(const Sums& sums) {
        if constexpr (std::is_arithmetic_v<Sums>) {
            all.append(reinterpret_cast<const char*>(&sums), sizeof sums);
        } else {
            all.append(reinterpret_cast<const char*>(sums.data()), sums.size() * sizeof sums[0]);
        }
    });
    return all;
}

FilmLayout film_with_splats() {
    FilmLayout layout = plain_film(50, 37, 4);
    layout.has_splats = true;
    layout.filter = PixelFilter::named("gaussian");
    return layout;
}

/// Adds splats all over the film to what the tile gets.
TileRenderer splatting_renderer(const FilmLayout& layout) {
    return [camera = exponential_renderer(layout, 1)](const TileSamples& samples, FilmTile& tile) {
        camera(samples, tile);
        const auto place = static_cast<std::uint32_t>(samples.rect.y * 50 + samples.rect.x);
        for (std::uint32_t i = samples.first; i < samples.end; ++i) {
            const float light = static_cast<float>(even_number(2, place, i));
            tile.begin_light_path();
            tile.splat(all_at(50.0 * even_number(3, place, i), 37.0 * even_number(4, place, i)),
                       std::array<std::uint16_t, 4>{0, 1, 2, 3}, std::array<float, 4>{light, light, light, light});
        }
    };
}

RenderState rendered(const FilmLayout& layout, const TileRenderer& renderer, std::uint32_t samples,
                     const RenderControl& control) {
    RenderState state(layout, {.first = 0, .end = samples});
    EXPECT_EQ(render_progressively(state, renderer, {}, control), RenderEnd::complete);
    return state;
}

TEST(Progressive, TakesEverySampleOnce) {
    const FilmLayout layout = plain_film(50, 37);
    for (const bool in_rounds : {false, true}) {
        const RenderState state =
            rendered(layout, exponential_renderer(layout, 1), 150, {.threads = 2, .in_rounds = in_rounds});
        Film expected(layout);
        FilmTile tile(layout);
        const TileSamples all{.rect = {0, 0, 50, 37}, .first = 0, .end = 150};
        expected.load(all, tile);
        exponential_renderer(layout, 1)(all, tile);
        tile.finish();
        expected.store(tile);
        EXPECT_EQ(bits(state.film), bits(expected)) << "rounds " << in_rounds;
    }
}

// Splats too: tiles are stored in their order, whichever thread was first.
TEST(Progressive, GivesTheSameBitsForEveryNumberOfThreads) {
    const FilmLayout layout = film_with_splats();
    const auto with_threads = [&](int threads) {
        return bits(rendered(layout, splatting_renderer(layout), 100, {.threads = threads}).film);
    };
    const std::string alone = with_threads(1);
    EXPECT_EQ(with_threads(2), alone);
    EXPECT_EQ(with_threads(5), alone);
}

// Wherever a render is interrupted, as often as may be, it ends at the same bits. 12 tiles and 4 rounds are 48 places.
TEST(Progressive, GoesOnAsIfNothingHadHappened) {
    const FilmLayout layout = film_with_splats();
    const std::string whole = bits(rendered(layout, splatting_renderer(layout), 100, {.threads = 1}).film);
    for (const int tiles_a_turn : {1, 5, 7, 20}) {
        RenderState state(layout, {.first = 0, .end = 100});
        int turns = 0;
        for (RenderEnd end = RenderEnd::interrupted; end == RenderEnd::interrupted; ++turns) {
            std::atomic<int> asked = 0;
            end = render_progressively(state, splatting_renderer(layout), {},
                                       {.threads = 2, .is_interrupted = [&] { return ++asked > tiles_a_turn; }});
        }
        EXPECT_GT(turns, 48 / (tiles_a_turn + 2)) << "it was interrupted";
        EXPECT_EQ(bits(state.film), whole) << tiles_a_turn;
    }
}

/// An even field by camera paths and light that lands anywhere, noisier by far.
struct TwoPasses {
    FilmLayout plain = plain_film(50, 37, 4);
    FilmLayout splats = film_with_splats();
    std::vector<Render> renders = {{.film = plain, .renderer = exponential_renderer(plain, 1)},
                                   {.film = splats, .renderer = splatting_renderer(splats), .lands_anywhere = true}};

    [[nodiscard]] std::vector<RenderState> begin(std::uint32_t samples) const {
        return {{plain, {.first = 0, .end = samples}, "a"}, {splats, {.first = 0, .end = samples}, "b"}};
    }
};

// Each pass ends at the bits that it has alone, in turns, with any threads and wherever it is interrupted.
TEST(Progressive, PassesInTurnsAreThoseByThemselves) {
    const TwoPasses two;
    const std::string first = bits(rendered(two.plain, two.renders[0].renderer, 100, {.threads = 1}).film);
    const std::string second = bits(rendered(two.splats, two.renders[1].renderer, 100, {.threads = 1}).film);
    for (const int tiles_a_turn : {5, 1000}) {
        std::vector<RenderState> states = two.begin(100);
        for (RenderEnd end = RenderEnd::interrupted; end == RenderEnd::interrupted;) {
            std::atomic<int> asked = 0;
            end = render_passes(states, two.renders, {},
                                {.threads = 2, .is_interrupted = [&] { return ++asked > tiles_a_turn; }});
        }
        EXPECT_EQ(bits(states[0].film), first) << tiles_a_turn;
        EXPECT_EQ(bits(states[1].film), second) << tiles_a_turn;
    }
}

// Samples go where the picture's variance is. That of either pass is σ²/n a sample of each pixel: the best split of a
// budget has n in proportion to σ, within the quarter more that a turn takes at a time (and its square, for both).
TEST(Progressive, NoiseTakesSamplesFromThePassThatMakesIt) {
    const FilmLayout layout = plain_film(32, 32);
    const auto brighter = [&](double factor) {
        return [=, width = layout.width](const TileSamples& samples, FilmTile& tile) {
            for (int y = samples.rect.y; y < samples.rect.y + samples.rect.height; ++y) {
                for (int x = samples.rect.x; x < samples.rect.x + samples.rect.width; ++x) {
                    for (std::uint32_t i = samples.first; i < samples.end; ++i) {
                        const auto pixel = static_cast<std::uint32_t>(y * width + x);
                        tile.add(tile.pixel(x, y), i, 0, factor * exponential_number(7, pixel, i));
                    }
                }
            }
        };
    };
    const std::vector<Render> renders = {{.film = layout, .renderer = brighter(1.0)},
                                         {.film = layout, .renderer = brighter(4.0)}};
    std::vector<RenderState> states = {{layout, {.first = 0, .end = 1U << 16U}, "faint"},
                                       {layout, {.first = 0, .end = 1U << 16U}, "bright"}};
    EXPECT_EQ(render_passes(states, renders, {.noise = 0.02}, {.threads = 2}), RenderEnd::complete);
    const PixelRect all{.width = 32, .height = 32};
    EXPECT_LE(tile_error(picture_of(states), all, 0.0), 0.02);
    const double ratio = static_cast<double>(states[1].film.counts(0, 0).samples) / states[0].film.counts(0, 0).samples;
    EXPECT_GT(ratio, 4.0 / (1.25 * 1.25));
    EXPECT_LT(ratio, 4.0 * 1.25 * 1.25);
}

TEST(Progressive, EndsInTimeWithWholeTiles) {
    const FilmLayout layout = plain_film(40, 40);
    RenderState state(layout, {.first = 0, .end = kMostSamples});
    const RenderEnd end =
        render_progressively(state, exponential_renderer(layout, 1), {.seconds = 0.02}, {.threads = 2});
    EXPECT_EQ(end, RenderEnd::out_of_time);
    for (std::size_t i = 0; i < state.tiles.size(); ++i) {
        const PixelRect rect = film_tiles(40, 40)[i];
        EXPECT_EQ(state.film.counts(rect.x, rect.y).samples, state.tiles[i].done);
    }
}

TEST(Progressive, PassesFailuresOn) {
    const FilmLayout layout = plain_film(160, 160);
    RenderState state(layout, {.first = 0, .end = 64});
    std::atomic<int> tiles = 0;
    const auto fails = [&](const TileSamples&, FilmTile&) {
        if (++tiles == 30) {
            throw std::runtime_error("out of light");
        }
    };
    EXPECT_THROW(render_progressively(state, fails, {}, {.threads = 4}), std::runtime_error);
}

TEST(Progressive, ReportsGoForward) {
    const FilmLayout layout = plain_film(40, 40);
    double before = 0.0;
    std::uint64_t samples = 0;
    rendered(layout, exponential_renderer(layout, 1), 64,
             {.threads = 2, .in_rounds = true, .is_interrupted = {}, .on_progress = [&](const auto& report) {
                  EXPECT_GE(report.done, before);
                  before = report.done;
                  samples = report.samples;
              }});
    EXPECT_EQ(before, 1.0);
    EXPECT_EQ(samples, 40U * 40U * 64U);
}

/// What --noise makes of an even field: its error over the picture, its mean, and what it cost.
struct Judged {
    double error = 0.0;  // root mean square of pixels
    double mean = 0.0;
    double samples = 0.0;  // a pixel
};

Judged judged(double noise, int side, std::uint64_t seed) {
    const FilmLayout layout = plain_film(side, side);
    RenderState state(layout, {.first = 0, .end = 4096});
    EXPECT_EQ(render_progressively(state, exponential_renderer(layout, seed), {.noise = noise}, {.threads = 2}),
              RenderEnd::complete);
    Judged result;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const double value = state.film.estimate(x, y).rgb.x;
            result.error += (value - 1.0) * (value - 1.0) / (side * side);
            result.mean += value / (side * side);
            result.samples += static_cast<double>(state.film.counts(x, y).samples) / (side * side);
        }
    }
    result.error = std::sqrt(result.error);
    return result;
}

// Samples of mean 1 and variance 1: n of them have the error 1/√n. In R, G and B it is worth 1, 2, 3 of a mean
// brightness of 2, so √(14/12) = 1.08 of the pixel's own relative error, and a target of 0.08 wants 182 samples: the
// pass that ends at 192 has them; that at 128, with an error of 0.095, has not. A tile's estimate scatters by about √(2
// · 14²/9)/√(256 · 11 · …) < 5 %, so hardly a tile decides otherwise.
TEST(ProgressiveNoise, ReachesItsTargetAndNotMuchMore) {
    const Judged at_8_percent = judged(0.08, 64, 1);
    EXPECT_LT(1.08 * at_8_percent.error, 0.08);
    EXPECT_GT(1.08 * at_8_percent.error, 0.08 * std::sqrt(128.0 / 192.0));
    EXPECT_NEAR(at_8_percent.samples, 192.0, 10.0);
}

// The rule's bias is at most a quarter of the standard error of a tile's mean (progressive.h). The target of 0.0675 is
// the error that the tiles have at 256 samples, so that about half of them stop there: the worst case. Over 20 pictures
// of 64 tiles the mean's standard error is 1/√(256 · 1280 · n): 1.1e-4 for n = 256; a quarter of a tile's error of
// 1/√(256 · 256) is 9.8e-4 at n2/n1 = 2, and (1 − 256/320)/(1/2) of that, 3.9e-4, at the step that is next here. Four
// errors and that bound.
TEST(ProgressiveNoise, IsBiasedByNoMoreThanItSays) {
    double mean = 0.0;
    double samples = 0.0;
    const int pictures = 8;
    for (int i = 0; i < pictures; ++i) {
        const Judged one = judged(0.0675, 128, 100 + static_cast<std::uint64_t>(i));
        mean += one.mean / pictures;
        samples += one.samples / pictures;
    }
    EXPECT_GT(samples, 256.0 * 1.02) << "some tiles go on";
    EXPECT_LT(samples, 320.0 * 0.98) << "some stop";
    EXPECT_NEAR(mean, 1.0, 4 * 1.7e-4 + 3.9e-4);
}

// A dark half of the picture counts as a hundredth as bright as the picture, and does not keep it for ever.
TEST(ProgressiveNoise, StopsInTheDark) {
    const FilmLayout layout = plain_film(32, 16);
    const auto half_dark = [&](const TileSamples& samples, FilmTile& tile) {
        if (samples.rect.x == 0) {
            exponential_renderer(layout, 5)(samples, tile);
        } else {
            tile.add(0, samples.first, 0, 1e-12);  // a single spark
        }
    };
    RenderState state(layout, {.first = 0, .end = kMostSamples});
    EXPECT_EQ(render_progressively(state, half_dark, {.noise = 0.05}, {.threads = 1}), RenderEnd::complete);
    EXPECT_EQ(state.film.counts(20, 0).samples, kFewestSamplesToJudge);
    EXPECT_GT(state.film.counts(0, 0).samples, kFewestSamplesToJudge);
}

}  // namespace lensproof::render::progressive_test
