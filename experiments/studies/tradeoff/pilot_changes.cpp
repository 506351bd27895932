#include "experiments/studies/tradeoff/pilot_changes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace lensproof::studies {

using formats::Image;

RadialMean::RadialMean(std::vector<Sample> samples, int rings) {
    std::ranges::sort(samples, {}, &Sample::image_height);
    const std::size_t count = samples.size();
    const std::size_t parts = std::min(count, static_cast<std::size_t>(rings));
    for (std::size_t ring = 0; ring < parts; ++ring) {
        Sample mean;
        const std::size_t first = ring * count / parts;
        const std::size_t end = (ring + 1) * count / parts;
        for (std::size_t i = first; i < end; ++i) {
            mean.image_height += samples[i].image_height / static_cast<double>(end - first);
            mean.value += samples[i].value / static_cast<double>(end - first);
        }
        rings_.push_back(mean);
    }
}

double RadialMean::at(double image_height) const {
    if (rings_.empty()) {
        return 0.0;
    }
    const auto beyond = std::ranges::upper_bound(rings_, image_height, {}, &Sample::image_height);
    if (beyond == rings_.begin() || beyond == rings_.end()) {
        return beyond == rings_.end() ? rings_.back().value : rings_.front().value;
    }
    const Sample& below = *(beyond - 1);
    const double part = (image_height - below.image_height) / (beyond->image_height - below.image_height);
    return below.value + part * (beyond->value - below.value);
}

Image with_gain(const Image& picture, const PixelGain& gain) {
    Image changed = picture;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const Vec3d factor = gain(x, y);
            changed.at(x, y, 0) *= static_cast<float>(factor.x);
            changed.at(x, y, 1) *= static_cast<float>(factor.y);
            changed.at(x, y, 2) *= static_cast<float>(factor.z);
        }
    }
    return changed;
}

Vec3d mean_rgb(const Image& picture) {
    Vec3d sum;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            sum = sum + Vec3d{picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2)};
        }
    }
    return (1.0 / (static_cast<double>(picture.width) * picture.height)) * sum;
}

Image with_veil(const Image& picture, double fraction) {
    const Vec3d veil = fraction * mean_rgb(picture);
    Image changed = picture;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            changed.at(x, y, 0) += static_cast<float>(veil.x);
            changed.at(x, y, 1) += static_cast<float>(veil.y);
            changed.at(x, y, 2) += static_cast<float>(veil.z);
        }
    }
    return changed;
}

Image with_shift(const Image& picture, const PixelShift& shift) {
    Image changed = picture;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const Vec2d by = shift(x, y, c);
                const double u = std::clamp(x + by.x, 0.0, picture.width - 1.0);
                const double v = std::clamp(y + by.y, 0.0, picture.height - 1.0);
                const int left = std::min(static_cast<int>(u), std::max(0, picture.width - 2));
                const int top = std::min(static_cast<int>(v), std::max(0, picture.height - 2));
                const int right = std::min(left + 1, picture.width - 1);
                const int bottom = std::min(top + 1, picture.height - 1);
                const double s = u - left;
                const double t = v - top;
                const auto value = [&](int px, int py) { return static_cast<double>(picture.at(px, py, c)); };
                changed.at(x, y, c) =
                    static_cast<float>((1.0 - t) * ((1.0 - s) * value(left, top) + s * value(right, top)) +
                                       t * ((1.0 - s) * value(left, bottom) + s * value(right, bottom)));
            }
        }
    }
    return changed;
}

namespace {

/// e⁻ᵗ Iₙ(t), n from 0 to `reach`, Iₙ being the modified Bessel functions: the Gaussian of a lattice, whose variance is
/// t however narrow it is, and whose sum over all n, negative ones too, is 1 (Lindeberg, "Scale-space for discrete
/// signals", IEEE PAMI 12, 1990, §IV). By their recurrence downwards, in which any other solution dies (Miller; Olver
/// et al., NIST Handbook, §10.74(iv)): all n at once, for each pixel.
std::vector<double> lattice_gaussian(double t, int reach) {
    const int beyond = reach + 10 + static_cast<int>(6.0 * std::sqrt(t));
    std::vector<double> weights(static_cast<std::size_t>(beyond) + 2);
    weights[static_cast<std::size_t>(beyond)] = 1e-290;
    double sum = 0.0;
    for (int n = beyond; n > 0; --n) {
        const auto i = static_cast<std::size_t>(n);
        weights[i - 1] = weights[i + 1] + 2.0 * n / t * weights[i];
        sum += 2.0 * weights[i];
        if (weights[i - 1] > 1e250) {  // narrow ones fall faster than a double's exponent goes
            for (double& weight : weights) {
                weight *= 1e-250;
            }
            sum *= 1e-250;
        }
    }
    sum += weights[0];
    weights.resize(static_cast<std::size_t>(reach) + 1);
    for (double& weight : weights) {
        weight /= sum;
    }
    return weights;
}

}  // namespace

Image with_spread(const Image& picture, const PixelSpread& spread) {
    constexpr double kLeast = 0.005;  // px: below, neighbours get less than 2e-5
    constexpr int kMost = 24;
    Image changed = formats::make_image(picture.width, picture.height, picture.channels);
    std::vector<double> weights;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const double sigma = std::max(0.0, spread(x, y)) / std::numbers::sqrt2;
            const int reach = sigma < kLeast ? 0 : std::min(kMost, 1 + static_cast<int>(std::ceil(3.0 * sigma)));
            weights.assign(1, 1.0);
            if (reach > 0) {
                const std::vector<double> half = lattice_gaussian(sigma * sigma, reach);
                weights.assign(half.rbegin(), half.rend());
                weights.insert(weights.end(), half.begin() + 1, half.end());
            }
            const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
            int to_y = y - reach;
            for (const double down : weights) {
                int to_x = x - reach;
                for (const double across : weights) {
                    const double weight = down * across / (sum * sum);
                    for (int c = 0; c < 3; ++c) {
                        changed.at(std::clamp(to_x, 0, picture.width - 1), std::clamp(to_y, 0, picture.height - 1),
                                   c) += static_cast<float>(weight * static_cast<double>(picture.at(x, y, c)));
                    }
                    ++to_x;
                }
                ++to_y;
            }
        }
    }
    return changed;
}

}  // namespace lensproof::studies
