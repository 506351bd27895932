#include "experiments/studies/tradeoff/picture_error.h"

#include <algorithm>
#include <cmath>

#include "calibration/comparison/ciede2000.h"
#include "calibration/comparison/colour_planes.h"
#include "calibration/comparison/flip.h"
#include "calibration/comparison/overlap.h"
#include "engine/render/progressive.h"

namespace lensproof::studies {

void fields(JsonArchive& json, SeenDifference& difference) {
    json.field("bias", difference.bias).field("noise", difference.noise);
}

void fields(JsonArchive& json, PictureErrors& errors) {
    json.field("ciede2000", errors.ciede2000).field("flip", errors.flip).field("exposure_ev", errors.exposure_ev);
}

namespace {

using formats::Image;

/// Adds so much of a picture.
void add(Image& sum, const Image& picture, float factor) {
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) {
        sum.pixels[i] += factor * picture.pixels[i];
    }
}

/// Sums of numbers at each pixel, over blocks.
template <class At>
calibration::BlockSums block_sums(const Image& like, int sums, const At& at) {
    calibration::BlockSums blocks(like.width, like.height, sums);
    for (int band = 0; band < blocks.bands(); ++band) {
        for (int y = blocks.first_row(band); y < blocks.first_row(band + 1); ++y) {
            for (int x = 0; x < like.width; ++x) {
                at(x, y, blocks.at(x, band));
            }
        }
    }
    return blocks;
}

SeenDifference seen_difference(const Image& with_bias, const Image& noise_alone) {
    const calibration::BlockSums blocks = block_sums(with_bias, 5, [&](int x, int y, double* sum) {
        const double s = with_bias.at(x, y, 0);
        const double n = noise_alone.at(x, y, 0);
        sum[0] += 1.0;
        sum[1] += s;
        sum[2] += s * s;
        sum[3] += n;
        sum[4] += n * n;
    });
    const calibration::Estimate square = blocks.estimate([](const std::vector<double>& sum) {
        const double mean = sum[1] / sum[0];
        return sum[2] > 0.0 ? mean * mean * (1.0 - sum[4] / sum[2]) : 0.0;
    });
    const calibration::Estimate noise = blocks.estimate([](const std::vector<double>& sum) { return sum[3] / sum[0]; });
    return {root({square.value, square.standard_error}), noise.value};
}

}  // namespace

double relative_noise(const std::vector<Image>& pictures) {
    const std::size_t pixels = pictures.front().pixels.size() / pictures.front().channels.size();
    const auto n = static_cast<double>(pictures.size());
    std::vector<double> mean(pixels);
    std::vector<double> square(pixels);
    double whole = 0.0;
    for (const Image& picture : pictures) {
        for (std::size_t i = 0; i < pixels; ++i) {
            const double y = calibration::luminance(calibration::rgb_at(picture, i));
            mean[i] += y / n;
            square[i] += y * y / n;
            whole += y / (n * static_cast<double>(pixels));
        }
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const double least = std::max(mean[i], render::kDarkFraction * whole);
        sum += least > 0.0 ? std::max(0.0, square[i] - mean[i] * mean[i]) * n / (n - 1.0) / (least * least) : 0.0;
    }
    return std::sqrt(sum / static_cast<double>(pixels));
}

PictureErrors picture_errors(const std::vector<Image>& model, const std::vector<Image>& reference, int threads) {
    const auto n = static_cast<float>(model.size());
    const std::size_t paired = model.size() - model.size() % 2;  // as many even seeds as odd ones
    Image of_model = formats::make_image(reference.front().width, reference.front().height, reference.front().channels);
    Image of_reference = of_model;
    Image quarter = of_model;  // (d1 − d2) / 4
    for (std::size_t i = 0; i < model.size(); ++i) {
        add(of_model, model[i], 1.0F / n);
        add(of_reference, reference[i], 1.0F / n);
        const float weight = i < paired ? (i % 2 == 0 ? 0.5F : -0.5F) / static_cast<float>(paired) : 0.0F;
        add(quarter, model[i], weight);
        add(quarter, reference[i], -weight);
    }
    Image one = formats::make_image(quarter.width, quarter.height, quarter.channels);  // b + (d1 − d2) / 4
    add(one, of_model, 0.5F);
    add(one, of_reference, 0.5F);
    Image other = one;
    add(one, quarter, 1.0F);
    add(other, quarter, -1.0F);
    const calibration::BlockSums light = block_sums(of_model, 2, [&](int x, int y, double* sum) {
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(of_model.width) + static_cast<std::size_t>(x);
        sum[0] += calibration::luminance(calibration::rgb_at(of_model, pixel));
        sum[1] += calibration::luminance(calibration::rgb_at(of_reference, pixel));
    });
    const calibration::Estimate exposure = light.estimate(
        [](const std::vector<double>& sum) { return sum[0] > 0.0 && sum[1] > 0.0 ? std::log2(sum[0] / sum[1]) : 0.0; });
    const auto flip = [&](const Image& a, const Image& b) {
        return calibration::flip_low_range(a, b, calibration::kFlipPixelsPerDegree, threads);
    };
    return {.ciede2000 = seen_difference(calibration::ciede2000_map(of_reference, of_model, threads),
                                         calibration::ciede2000_map(one, other, threads)),
            .flip = seen_difference(flip(of_reference, of_model), flip(one, other)),
            .exposure_ev = {exposure.value, exposure.standard_error}};
}

}  // namespace lensproof::studies
