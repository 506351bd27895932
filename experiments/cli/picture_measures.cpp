#include "experiments/cli/picture_measures.h"

#include <cmath>

namespace lensproof::cli {

using calibration::Estimate;

findings::Check Measure::check() const {
    return {
        .id = key, .label = fault_title, .value = fault.value, .sigma = fault.standard_error, .limit = largest_fault};
}

std::vector<Measure> measures(const calibration::PictureComparison& found, const PictureOptions& options) {
    const Estimate unlike{.value = 1.0 - found.ssim.value, .standard_error = found.ssim.standard_error};
    const auto plain = [](const char* key, const char* title, const Estimate& estimate, double limit) {
        return Measure{.key = key,
                       .title = title,
                       .estimate = estimate,
                       .limit = limit,
                       .fault = estimate,
                       .largest_fault = limit,
                       .fault_title = title};
    };
    return {{.key = "psnr_db",
             .title = "PSNR, dB",
             .estimate = found.psnr_db,
             .limit = options.psnr_limit_db,
             .fault = found.rms,
             .largest_fault = std::pow(10.0, -options.psnr_limit_db / 20.0),
             .fault_title = "rms difference, of which PSNR is made"},
            {.key = "ssim",
             .title = "SSIM",
             .estimate = found.ssim,
             .limit = options.ssim_limit,
             .fault = unlike,
             .largest_fault = 1.0 - options.ssim_limit,
             .fault_title = "1 − SSIM"},
            plain("flip", found.flip_exposures ? "FLIP, high range" : "FLIP", found.flip, options.flip_limit),
            plain("ciede2000_mean", "CIEDE2000, mean", found.ciede2000_mean, options.ciede2000_limit),
            plain("ciede2000_p99", "CIEDE2000, 99 %", found.ciede2000_p99, options.ciede2000_p99_limit)};
}

}  // namespace lensproof::cli
