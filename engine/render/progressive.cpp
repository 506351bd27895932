#include "engine/render/progressive.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "engine/base/parallel.h"

namespace lensproof::render {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kLongestRound = 1024;

/// One round over the tiles that are to have more samples. Tiles are stored in their order, whoever was first, so that
/// splats are always added in the same one. After an interruption the tiles before some place are stored and none
/// after.
class Round {
  public:
    Round(RenderState& state, std::vector<std::size_t> todo, const std::vector<PixelRect>& rects)
        : state_(&state), rects_(&rects), todo_(std::move(todo)) {}

    [[nodiscard]] int size() const { return static_cast<int>(todo_.size()); }

    [[nodiscard]] TileSamples samples_of(int i) const {
        const std::size_t tile = todo_[static_cast<std::size_t>(i)];
        return {.rect = (*rects_)[tile], .first = state_->tiles[tile].done, .end = state_->tiles[tile].target};
    }

    /// A tile to render `i` with, loaded. No other thread writes to these pixels.
    FilmTile take(int i) {
        FilmTile tile = take_spare();
        state_->film.load(samples_of(i), tile);
        return tile;
    }

    /// Hands in tile `i`, or says that it was left out (nothing); waits where it is far ahead of others. After each
    /// tile that is stored calls `stored(tile, its progress before)`, and `done()` after the last of them, under a
    /// lock.
    template <class Stored, class Done>
    void give(int i, std::optional<FilmTile> tile, const Stored& stored, const Done& done) {
        std::unique_lock lock(mutex_);
        has_moved_.wait(lock, [&] { return i < next_ + kMostAhead; });
        waiting_.emplace(i, std::move(tile));
        bool any = false;
        for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_;
             first = waiting_.erase(first), ++next_) {
            has_gap_ = has_gap_ || !first->second;
            if (!has_gap_) {
                TileProgress& progress = state_->tiles[todo_[static_cast<std::size_t>(next_)]];
                state_->film.store(*first->second);
                stored(*first->second, progress);
                progress.done = progress.target;
                spare_.push_back(*std::move(first->second));
                any = true;
            }
        }
        if (any) {
            done();
        }
        has_moved_.notify_all();
    }

  private:
    static constexpr int kMostAhead = 256;

    FilmTile take_spare() {
        const std::scoped_lock lock(mutex_);
        if (spare_.empty()) {
            return FilmTile(state_->film.layout());
        }
        FilmTile tile = std::move(spare_.back());
        spare_.pop_back();
        return tile;
    }

    RenderState* state_;
    const std::vector<PixelRect>* rects_;
    std::vector<std::size_t> todo_;
    std::mutex mutex_;
    std::condition_variable has_moved_;
    std::map<int, std::optional<FilmTile>> waiting_;
    std::vector<FilmTile> spare_;
    int next_ = 0;
    bool has_gap_ = false;
};

/// Plans rounds, carries them out, and tells how far they are.
class ProgressiveRender {
  public:
    ProgressiveRender(RenderState& state, const TileRenderer& renderer, const RenderGoal& goal,
                      const RenderControl& control)
        : state_(state),
          renderer_(renderer),
          goal_(goal),
          control_(control),
          rects_(film_tiles(state.film.width(), state.film.height())) {}

    /// Only what is planned already.
    RenderEnd run_planned() {
        std::vector<std::size_t> todo = plan();
        done_before_ = fraction_done();
        render_round(std::move(todo));
        return end_;
    }

    RenderEnd run() {
        for (std::vector<std::size_t> todo = plan(); !todo.empty(); todo = plan()) {
            if (!has_begun_) {
                done_before_ = fraction_done();
                has_begun_ = true;
            }
            render_round(std::move(todo));
            if (end_ != RenderEnd::complete) {
                return end_;
            }
        }
        return RenderEnd::complete;
    }

  private:
    [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    [[nodiscard]] static bool is_unfinished(const TileProgress& tile) { return tile.done < tile.target; }

    /// The tiles of the next round; those of the last one first, if it was not carried out to its end.
    std::vector<std::size_t> plan() {
        if (expected_.empty() || std::ranges::none_of(state_.tiles, is_unfinished)) {
            set_targets();
        }
        std::vector<std::size_t> todo;
        for (std::size_t i = 0; i < state_.tiles.size(); ++i) {
            if (is_unfinished(state_.tiles[i])) {
                todo.push_back(i);
            }
        }
        return todo;
    }

    void set_targets() {
        const bool resumes = std::ranges::any_of(state_.tiles, is_unfinished);
        const double dark = goal_.noise > 0.0 ? kDarkFraction * mean_brightness(state_.film) : 0.0;
        expected_.assign(state_.tiles.size(), static_cast<double>(state_.range.end - state_.range.first));
        for (std::size_t i = 0; i < state_.tiles.size(); ++i) {
            TileProgress& tile = state_.tiles[i];
            const std::uint32_t taken = tile.done - state_.range.first;
            bool is_good = false;
            if (goal_.noise > 0.0 && taken >= kFewestSamplesToJudge) {
                const double excess = tile_error(state_.film, rects_[i], dark) / goal_.noise;
                is_good = excess <= 1.0;
                expected_[i] = std::clamp(taken * excess * excess, static_cast<double>(taken), expected_[i]);
            }
            if (!resumes && !is_good && tile.done < state_.range.end) {
                tile.target = std::min(state_.range.end, state_.range.first + round_end(taken, in_rounds()));
            }
        }
    }

    [[nodiscard]] bool in_rounds() const { return control_.in_rounds || goal_.noise > 0.0; }

    /// Whether the render has to end now; once it has, it always has.
    bool has_to_end() {
        if (control_.is_interrupted && control_.is_interrupted()) {
            end_ = RenderEnd::interrupted;
        } else if (end_ == RenderEnd::complete && seconds() >= goal_.seconds) {
            end_ = RenderEnd::out_of_time;
        }
        return end_ != RenderEnd::complete;
    }

    void render_round(std::vector<std::size_t> todo) {
        Round round(state_, std::move(todo), rects_);
        const auto stored = [this](const FilmTile& tile, const TileProgress& before) {
            samples_ += static_cast<std::uint64_t>(tile.rect().pixels()) * (before.target - before.done);
            rays_ += tile.rays();
        };
        const auto done = [this] {
            if (control_.on_progress) {
                control_.on_progress(report());
            }
        };
        const auto make_worker = [&] {
            return [&, render = renderer_](int i) {
                std::optional<FilmTile> tile;
                try {
                    if (!has_to_end()) {
                        tile = round.take(i);
                        render(round.samples_of(i), *tile);
                        tile->finish();
                    }
                } catch (...) {
                    round.give(i, std::nullopt, stored, done);  // or others would wait for it
                    throw;
                }
                round.give(i, std::move(tile), stored, done);
            };
        };
        parallel_for_workers(round.size(), control_.threads, make_worker, [](int) {});
    }

    /// The fraction of the samples that are expected to be needed which have been taken.
    [[nodiscard]] double fraction_done() const {
        double taken = 0.0;
        double needed = 0.0;
        for (std::size_t i = 0; i < state_.tiles.size(); ++i) {
            const double of_tile = state_.tiles[i].done - state_.range.first;
            taken += of_tile;
            needed += std::max(of_tile, expected_[i]);
        }
        return needed > 0.0 ? taken / needed : 1.0;
    }

    [[nodiscard]] RenderReport report() const {
        const double now = seconds();
        const double done = fraction_done();
        const double in_this_run = done_before_ < 1.0 ? (done - done_before_) / (1.0 - done_before_) : 1.0;
        const double rest = in_this_run > 0.0 ? now * (1.0 - in_this_run) / in_this_run : goal_.seconds;
        return {.done = std::clamp(std::max(done, now / goal_.seconds), 0.0, 1.0),
                .seconds = now,
                .seconds_left = std::max(0.0, std::min(rest, goal_.seconds - now)),
                .samples = samples_,
                .rays = rays_};
    }

    RenderState& state_;
    const TileRenderer& renderer_;
    const RenderGoal& goal_;
    const RenderControl& control_;
    std::vector<PixelRect> rects_;
    std::vector<double> expected_;  // samples a pixel, by tile
    Clock::time_point start_ = Clock::now();
    double done_before_ = 0.0;
    bool has_begun_ = false;
    std::atomic<RenderEnd> end_ = RenderEnd::complete;
    std::uint64_t samples_ = 0;
    std::uint64_t rays_ = 0;
};

}  // namespace

std::uint32_t round_end(std::uint32_t done, bool in_rounds) {
    if (!in_rounds) {
        return done + kLongestRound;
    }
    if (done < 64) {
        return std::bit_floor(std::max<std::uint32_t>(kSamplesPerBlock / 2, done)) * 2;
    }
    return done + std::max<std::uint32_t>(64, done / 256 * 64);
}

std::vector<PixelRect> film_tiles(int width, int height) {
    std::vector<PixelRect> tiles;
    for (int y = 0; y < height; y += kTileSide) {
        for (int x = 0; x < width; x += kTileSide) {
            tiles.push_back({x, y, std::min(kTileSide, width - x), std::min(kTileSide, height - y)});
        }
    }
    return tiles;
}

RenderState::RenderState(FilmLayout layout, SampleRange samples, std::string name)
    : pass(std::move(name)),
      film(std::move(layout)),
      range(samples),
      tiles(film_tiles(film.width(), film.height()).size(), {samples.first, samples.first}) {}

Picture picture_of(std::span<const RenderState> passes) {
    std::vector<Picture::Part> parts;
    std::ranges::transform(passes, std::back_inserter(parts), [](const RenderState& state) {
        return Picture::Part{state.pass, &state.film};
    });
    return Picture(std::move(parts));
}

double relative_variance(const Picture& picture, const Picture& of, const PixelRect& rect, double dark) {
    double sum = 0.0;
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
            const Vec3d rgb = picture.estimate(x, y).rgb;
            const Vec3d variance = of.estimate(x, y).variance;
            const double variances = (variance.x + variance.y + variance.z) / 3.0;
            const double brightness = std::max(std::abs(rgb.x + rgb.y + rgb.z) / 3.0, dark);
            sum += variances > 0.0 ? variances / (brightness * brightness) : 0.0;
        }
    }
    return sum;
}

double tile_error(const Picture& picture, const PixelRect& rect, double dark) {
    return std::sqrt(relative_variance(picture, picture, rect, dark) / rect.pixels());
}

double mean_brightness(const Picture& picture) {
    double sum = 0.0;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            const Vec3d rgb = picture.estimate(x, y).rgb;
            sum += std::abs(rgb.x + rgb.y + rgb.z) / 3.0;
        }
    }
    return sum / (static_cast<double>(picture.width()) * picture.height());
}

RenderEnd render_progressively(RenderState& state, const TileRenderer& renderer, const RenderGoal& goal,
                               const RenderControl& control) {
    return ProgressiveRender(state, renderer, goal, control).run();
}

RenderEnd render_planned(RenderState& state, const TileRenderer& renderer, const RenderGoal& goal,
                         const RenderControl& control) {
    return ProgressiveRender(state, renderer, goal, control).run_planned();
}

Film render_film(const Render& render, const SampleRange& range, int threads,
                 const std::function<void(double done)>& progress) {
    RenderState state(render.film, range);
    RenderControl control{.threads = threads, .in_rounds = false, .is_interrupted = {}, .on_progress = {}};
    if (progress) {
        control.on_progress = [&](const RenderReport& report) { progress(report.done); };
    }
    render_progressively(state, render.renderer, {}, control);
    return std::move(state.film);
}

}  // namespace lensproof::render
