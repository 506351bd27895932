#include "experiments/studies/tradeoff/effect_kinds.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "experiments/studies/tradeoff/picture_error.h"

namespace lensproof::studies {

using formats::Image;

namespace {

/// What the pilot's picture loses or gains by a change that is done to each of its seeds.
Measured seen(const Pilot& pilot, const std::function<Image(const Image&)>& change) {
    std::vector<Image> changed;
    std::ranges::transform(pilot.full().rgb, std::back_inserter(changed), change);
    return picture_errors(changed, pilot.full().rgb, pilot.settings().probe.threads).ciede2000.bias;
}

/// The same of a change of so many px, which the pilot's are not: its detail may be all there is, as of a few edges, so
/// that a shift counts for as little as it is in the pilot's pixels; or there may be as much at every scale (Ruderman
/// 1994), so that it counts for as many of them. Anything between is as likely.
Measured seen_at_any_scale(const Pilot& pilot, const std::function<Image(const Image&, double scale)>& change) {
    const auto at = [&](double scale) {
        return seen(pilot, [&](const Image& picture) { return change(picture, scale); });
    };
    const Measured fine = at(1.0);
    const Measured coarse = at(static_cast<double>(pilot.width()) / pilot.setup().camera.sensor.width);
    const double noise = 0.5 * std::hypot(fine.standard_error, coarse.standard_error);
    return {0.5 * (fine.value + coarse.value), std::hypot(noise, (fine.value - coarse.value) / std::sqrt(12.0))};
}

}  // namespace

Measured rms(const std::vector<double>& values) {
    double sum = 0.0;
    double fourth = 0.0;
    for (const double value : values) {
        sum += value * value;
        fourth += value * value * value * value;
    }
    const auto n = static_cast<double>(std::max<std::size_t>(1, values.size()));
    return root({sum / n, std::sqrt(std::max(0.0, fourth / n - std::pow(sum / n, 2)) / n)});
}

Measured rms_over_pixels(const Pilot& pilot, const std::function<double(int x, int y)>& of) {
    std::vector<double> all;
    for (int y = 0; y < pilot.height(); ++y) {
        for (int x = 0; x < pilot.width(); ++x) {
            all.push_back(of(x, y));
        }
    }
    return rms(all);
}

Contribution difference(const Pilot& pilot, const std::vector<Image>& without) {
    const PictureErrors found = picture_errors(without, pilot.full().rgb, pilot.settings().probe.threads);
    return {.px = {},
            .ev = {std::abs(found.exposure_ev.value), found.exposure_ev.standard_error},
            .ciede2000 = found.ciede2000.bias};
}

Effect gain_effect(const Pilot& pilot, const std::string& name, const Vec3d& gain) {
    const auto gained = [&](const Image& picture) { return with_gain(picture, [&](int, int) { return gain; }); };
    return {.name = name,
            .contribution = {.px = {}, .ev = {std::abs(std::log2(gain.y)), 0.0}, .ciede2000 = seen(pilot, gained)}};
}

Effect falloff_effect(const Pilot& pilot, const std::string& name, const RadialMean& light, const Measured& ev) {
    const auto brighter = [&](int x, int y) {
        const double gain = 1.0 / std::max(1e-3, light.at(pilot.image_height(x, y)));
        return Vec3d{gain, gain, gain};
    };
    const auto without = [&](const Image& picture) { return with_gain(picture, brighter); };
    return {.name = name, .contribution = {.px = {}, .ev = ev, .ciede2000 = seen(pilot, without)}};
}

Effect shift_effect(const Pilot& pilot, const std::string& name, const std::array<RadialMean, 3>& shift_px,
                    const Measured& px) {
    const auto shifted = [&](const Image& picture, double scale) {
        return with_shift(picture, [&](int x, int y, int c) {
            const double outwards_px = shift_px[static_cast<std::size_t>(c)].at(pilot.image_height(x, y));
            return scale * outwards_px * pilot.outwards(x, y);
        });
    };
    return {.name = name, .contribution = {.px = px, .ev = {}, .ciede2000 = seen_at_any_scale(pilot, shifted)}};
}

Effect blur_effect(const Pilot& pilot, const std::string& name, const PixelSpread& spread_px, const Measured& px) {
    const auto blurred = [&](const Image& picture, double scale) {
        return with_spread(picture, [&](int x, int y) { return scale * spread_px(x, y); });
    };
    return {.name = name, .contribution = {.px = px, .ev = {}, .ciede2000 = seen_at_any_scale(pilot, blurred)}};
}

}  // namespace lensproof::studies
