#include "engine/render/pass_turns.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace lensproof::render {

namespace {

/// Whose turn it is among passes, and in which tiles.
class Turns {
  public:
    Turns(std::span<RenderState> states, std::span<const Render> renders, double noise)
        : states_(states),
          renders_(renders),
          noise_(noise),
          rects_(film_tiles(states.front().film.width(), states.front().film.height())) {}

    /// Sets the targets of the pass that goes on, and returns it; nothing where all are done. One that was interrupted
    /// goes on first.
    std::optional<std::size_t> next() {
        for (std::size_t i = 0; i < states_.size(); ++i) {
            if (std::ranges::any_of(states_[i].tiles,
                                    [](const TileProgress& tile) { return tile.done < tile.target; })) {
                return i;
            }
        }
        judge();
        constexpr double kMost = std::numeric_limits<double>::max();
        std::optional<std::size_t> best;
        double most = -1.0;
        for (std::size_t i = 0; i < states_.size(); ++i) {
            const std::uint32_t taken = taken_of(states_[i]);
            // Those with few samples first, the fewest before others; then what a sample more takes away of V / n.
            const double gain = taken < kFewestSamplesToJudge ? kMost / (1.0 + taken) : variance_of(i) / taken;
            if (has_more(i) && gain > most) {
                most = gain;
                best = i;
            }
        }
        if (best) {
            set_targets(*best);
        }
        return best;
    }

    [[nodiscard]] double fraction_done() const {
        double taken = 0.0;
        double all = 0.0;
        for (const RenderState& state : states_) {
            for (const TileProgress& tile : state.tiles) {
                taken += tile.done - state.range.first;
                all += state.range.end - state.range.first;
            }
        }
        return taken / all;
    }

  private:
    static std::uint32_t taken_of(const RenderState& state) {
        return std::ranges::max(state.tiles, {}, &TileProgress::done).done - state.range.first;
    }

    /// Which tiles are to go on.
    void judge() {
        const Picture picture = picture_of(states_);
        dark_ = kDarkFraction * mean_brightness(picture);
        const bool is_judged = noise_ > 0.0 && std::ranges::all_of(states_, [](const RenderState& state) {
                                   return taken_of(state) >= kFewestSamplesToJudge;
                               });
        is_good_.assign(rects_.size(), false);
        for (std::size_t i = 0; is_judged && i < rects_.size(); ++i) {
            is_good_[i] = tile_error(picture, rects_[i], dark_) <= noise_;
        }
    }

    [[nodiscard]] double variance_of(std::size_t pass) const {
        const Picture picture = picture_of(states_);
        return relative_variance(picture, states_[pass].film, {.width = picture.width(), .height = picture.height()},
                                 dark_);
    }

    [[nodiscard]] bool goes_on(std::size_t pass, std::size_t tile) const {
        const RenderState& state = states_[pass];
        const bool is_wanted =
            renders_[pass].lands_anywhere ? !std::ranges::all_of(is_good_, std::identity()) : !is_good_[tile];
        return is_wanted && state.tiles[tile].done < state.range.end;
    }

    [[nodiscard]] bool has_more(std::size_t pass) const {
        for (std::size_t i = 0; i < rects_.size(); ++i) {
            if (goes_on(pass, i)) {
                return true;
            }
        }
        return false;
    }

    void set_targets(std::size_t pass) {
        RenderState& state = states_[pass];
        for (std::size_t i = 0; i < rects_.size(); ++i) {
            if (goes_on(pass, i)) {
                const std::uint32_t taken = state.tiles[i].done - state.range.first;
                state.tiles[i].target = std::min(state.range.end, state.range.first + round_end(taken, true));
            }
        }
    }

    std::span<RenderState> states_;
    std::span<const Render> renders_;
    double noise_;
    std::vector<PixelRect> rects_;
    double dark_ = 0.0;
    std::vector<bool> is_good_;
};

}  // namespace

RenderEnd render_passes(std::span<RenderState> states, std::span<const Render> renders, const RenderGoal& goal,
                        const RenderControl& control) {
    if (states.size() == 1 && !renders.front().lands_anywhere) {
        return render_progressively(states.front(), renders.front().renderer, goal, control);
    }
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    Turns turns(states, renders, goal.noise);
    const double done_before = turns.fraction_done();
    RenderReport before;  // of the turns so far
    RenderReport turn;
    RenderControl in_turn = control;
    in_turn.on_progress = [&](const RenderReport& now) {
        turn = now;
        if (!control.on_progress) {
            return;
        }
        const double done = turns.fraction_done();
        const double in_this_run = (done - done_before) / (1.0 - done_before);
        const double rest = seconds() * (1.0 - in_this_run) / std::max(1e-9, in_this_run);
        control.on_progress({.done = std::clamp(std::max(done, seconds() / goal.seconds), 0.0, 1.0),
                             .seconds = seconds(),
                             .seconds_left = std::max(0.0, std::min(rest, goal.seconds - seconds())),
                             .samples = before.samples + turn.samples,
                             .rays = before.rays + turn.rays});
    };
    while (const auto pass = turns.next()) {
        turn = {};
        const RenderEnd end =
            render_planned(states[*pass], renders[*pass].renderer, {.seconds = goal.seconds - seconds()}, in_turn);
        if (end != RenderEnd::complete) {
            return end;
        }
        before.samples += turn.samples;
        before.rays += turn.rays;
    }
    return RenderEnd::complete;
}

}  // namespace lensproof::render
