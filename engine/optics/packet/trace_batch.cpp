#include "engine/optics/packet/trace_batch.h"

#include <type_traits>

#include "engine/optics/packet/trace_kernels.h"

namespace lensproof::optics {

namespace {

const LoopsByLevel<LevelKernels>& kernels() {
    static const LoopsByLevel<LevelKernels> found([]<SimdLevel level>() { return trace_kernels_at<level>(); });
    return found;
}

template <class T>
const TraceKernels<T>& kernels_of(std::optional<SimdLevel> level) {
    if constexpr (std::is_same_v<T, float>) {
        return kernels().at(level).in_float;
    } else {
        return kernels().at(level).in_double;
    }
}

}  // namespace

template <class T>
KernelLens<T> kernel_lens(const SpectralLens<T>& lens) {
    const std::vector<TraceSurface<T>>& surfaces = lens.at().front().surfaces;
    return {.surfaces = surfaces.data(),
            .indices = lens.indices().data(),
            .specials = lens.at().front().specials.data(),
            .lens = &lens,
            .count = static_cast<int>(surfaces.size()),
            .wavelengths = lens.wavelengths(),
            .absorbs = lens.absorbs()};
}

template KernelLens<float> kernel_lens(const SpectralLens<float>&);
template KernelLens<double> kernel_lens(const SpectralLens<double>&);

template <class T>
T lane_mask_transmittance(const SpectralLens<T>& lens, int surface, T x, T y) {
    const TraceLens<T>& any = lens.at().front();
    const TraceSurface<T>& stop = any.surfaces[static_cast<std::size_t>(surface)];
    return mask_transmittance(stop, any.specials[static_cast<std::size_t>(stop.special)], x, y);
}

template <class T>
T lane_coated_transmittance(const SpectralLens<T>& lens, int wavelength, int surface, bool forward, T cos_incidence) {
    const TraceLens<T>& at = lens.at(wavelength);
    const TraceSurface<T>& coated = at.surfaces[static_cast<std::size_t>(surface)];
    return coated_transmittance(coated, at.specials[static_cast<std::size_t>(coated.special)], forward, cos_incidence);
}

template <class T>
const ThinElement<T>& lane_thin_element(const SpectralLens<T>& lens, int wavelength, int surface) {
    const TraceLens<T>& at = lens.at(wavelength);
    return at.specials[static_cast<std::size_t>(at.surfaces[static_cast<std::size_t>(surface)].special)].thin;
}

template <class T>
T lane_fading(T optical_depth) {
    return fading(optical_depth);
}

template const ThinElement<float>& lane_thin_element(const SpectralLens<float>&, int, int);
template const ThinElement<double>& lane_thin_element(const SpectralLens<double>&, int, int);
template float lane_fading(float);
template double lane_fading(double);
template float lane_mask_transmittance(const SpectralLens<float>&, int, float, float);
template double lane_mask_transmittance(const SpectralLens<double>&, int, double, double);
template float lane_coated_transmittance(const SpectralLens<float>&, int, int, bool, float);
template double lane_coated_transmittance(const SpectralLens<double>&, int, int, bool, double);

template <Direction direction, class T>
void trace_columns(const SpectralLens<T>& lens, const RayColumns<T>& rays, const BatchSettings& settings) {
    const auto& loops = kernels_of<T>(settings.level)[static_cast<std::size_t>(direction)];
    loops[static_cast<std::size_t>(settings.carry)](kernel_lens(lens), rays, settings.rims == Rims::clip);
}

template <Direction direction, class T>
void trace_batch(const SpectralLens<T>& lens, RayBatch<T>& rays, const BatchSettings& settings) {
    trace_columns<direction>(lens, rays.columns(), settings);
}

template void trace_columns<Direction::forward>(const SpectralLens<float>&, const RayColumns<float>&,
                                                const BatchSettings&);
template void trace_columns<Direction::reverse>(const SpectralLens<float>&, const RayColumns<float>&,
                                                const BatchSettings&);
template void trace_columns<Direction::forward>(const SpectralLens<double>&, const RayColumns<double>&,
                                                const BatchSettings&);
template void trace_columns<Direction::reverse>(const SpectralLens<double>&, const RayColumns<double>&,
                                                const BatchSettings&);

template void trace_batch<Direction::forward>(const SpectralLens<float>&, RayBatch<float>&, const BatchSettings&);
template void trace_batch<Direction::reverse>(const SpectralLens<float>&, RayBatch<float>&, const BatchSettings&);
template void trace_batch<Direction::forward>(const SpectralLens<double>&, RayBatch<double>&, const BatchSettings&);
template void trace_batch<Direction::reverse>(const SpectralLens<double>&, RayBatch<double>&, const BatchSettings&);

}  // namespace lensproof::optics
