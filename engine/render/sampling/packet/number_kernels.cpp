#include "engine/render/sampling/packet/number_kernels.h"

namespace lensproof::render {

void NumberColumns::add(const PathSampler& sampler) {
    const auto i = static_cast<std::size_t>(size++);
    const PathSampler::Place place = sampler.place();
    seed[i] = place.seed;
    set[i] = place.set;
    pixel[i] = place.pixel;
    sample[i] = place.sample;
}

const NumberKernels& number_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<NumberKernels> found([]<SimdLevel level>() { return number_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::render
