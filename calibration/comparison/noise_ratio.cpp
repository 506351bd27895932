#include "calibration/comparison/noise_ratio.h"

#include <cmath>

namespace lensproof::calibration {

Estimate rms_difference(const formats::Image& a, const formats::Image& b, const Overlap& overlap) {
    const std::size_t channels = a.channels.size();
    BlockSums sums(a.width, a.height, 2);
    for (int band = 0; band < sums.bands(); ++band) {
        for (int y = sums.first_row(band); y < sums.first_row(band + 1); ++y) {
            for (int x = 0; x < a.width; ++x) {
                const auto pixel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) + static_cast<std::size_t>(x);
                if (overlap[pixel] == 0) {
                    continue;
                }
                double* block = sums.at(x, band);
                for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
                    const double difference = static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]);
                    block[0] += difference * difference;
                    block[1] += 1.0;
                }
            }
        }
    }
    return sums.estimate([](const std::vector<double>& sum) { return std::sqrt(sum[0] / sum[1]); });
}

Estimate peak_signal_to_noise_db(const Estimate& rms) {
    return {.value = -20.0 * std::log10(rms.value),
            .standard_error = rms.value > 0.0 ? 20.0 / std::log(10.0) * rms.standard_error / rms.value : 0.0};
}

}  // namespace lensproof::calibration
