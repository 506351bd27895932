#include "engine/scene/bsdf/mix.h"

#include <algorithm>

namespace lensproof::scene {

spectral::SpectralSample evaluate(const MixBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    spectral::SpectralSample sum;
    for (std::size_t i = 0; i < bsdf.count; ++i) {
        sum += static_cast<float>(bsdf.fraction[i]) *
               std::visit([&](const auto& part) { return evaluate(part, wo, wi, transport); }, bsdf.part[i]);
    }
    return sum;
}

double pdf(const MixBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    double sum = 0.0;
    for (std::size_t i = 0; i < bsdf.count; ++i) {
        sum +=
            bsdf.fraction[i] * std::visit([&](const auto& part) { return pdf(part, wo, wi, transport); }, bsdf.part[i]);
    }
    return sum;
}

std::optional<BsdfSample> sample(const MixBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers,
                                 Transport transport) {
    std::size_t drawn = 0;
    double below = 0.0;
    while (drawn + 1 < bsdf.count && numbers.lobe >= below + bsdf.fraction[drawn]) {
        below += bsdf.fraction[drawn++];
    }
    BsdfNumbers of_part = numbers;
    of_part.lobe = std::clamp((numbers.lobe - below) / bsdf.fraction[drawn], 0.0, 1.0);
    std::optional<BsdfSample> result =
        std::visit([&](const auto& part) { return sample(part, wo, of_part, transport); }, bsdf.part[drawn]);
    // A delta's fraction is as large as its probability.
    if (result && !result->is_delta) {
        result->pdf = pdf(bsdf, wo, result->wi, transport);
        result->weight = static_cast<float>(1.0 / result->pdf) * evaluate(bsdf, wo, result->wi, transport);
    }
    return result;
}

}  // namespace lensproof::scene
