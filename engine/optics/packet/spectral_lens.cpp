#include "engine/optics/packet/spectral_lens.h"

#include <algorithm>
#include <stdexcept>

namespace lensproof::optics {

namespace {

template <class T>
bool differ_in_indices_alone(const TraceLens<T>& a, const TraceLens<T>& b) {
    if (a.surfaces.size() != b.surfaces.size() || a.specials.size() != b.specials.size()) {
        return false;
    }
    for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
        const TraceSurface<T>& of_a = a.surfaces[i];
        const TraceSurface<T>& of_b = b.surfaces[i];
        if (of_a.curvature != of_b.curvature || of_a.vertex_z != of_b.vertex_z ||
            of_a.semi_diameter_squared != of_b.semi_diameter_squared || of_a.is_stop != of_b.is_stop ||
            of_a.special != of_b.special) {
            return false;
        }
    }
    return true;
}

/// Of the surface's coating at each wavelength; none where it is not made of layers that all absorb nothing.
template <class T>
std::size_t clear_layers_of(const std::vector<TraceLens<T>>& at, std::size_t surface) {
    const int special = at.front().surfaces[surface].special;
    if (special < 0) {
        return 0;
    }
    const auto coating_of = [&](const TraceLens<T>& lens) -> const auto& {
        return lens.specials[static_cast<std::size_t>(special)].coating;
    };
    const std::size_t count = coating_of(at.front()).layers.size();
    const bool are_clear = std::ranges::all_of(at, [&](const TraceLens<T>& lens) {
        const auto& coating = coating_of(lens);
        return !coating.is_mirror && !coating.reflectance && coating.layers.size() == count &&
               std::ranges::all_of(coating.layers, [](const TraceLayer<T>& layer) { return layer.extinction == T(0); });
    });
    return are_clear ? count : 0;
}

enum Column { kBefore, kAfter, kForwardRatio, kReverseRatio, kColumns };

}  // namespace

template <class T>
SpectralLens<T>::SpectralLens(std::vector<TraceLens<T>> at) : at_(std::move(at)) {
    if (at_.empty() || at_.size() > static_cast<std::size_t>(kMostWavelengths)) {
        throw std::invalid_argument("a spectral lens has 1 to 65536 wavelengths");
    }
    const std::size_t count = at_.size();
    const std::size_t surfaces = at_.front().surfaces.size();
    absorbs_ = std::ranges::any_of(at_, [](const TraceLens<T>& lens) { return !lens.attenuation.empty(); });
    // What absorbs lies behind the rest, so that a lens of clear glass has no wider a table.
    const std::size_t attenuations = surfaces * kColumns * count;
    table_.resize(attenuations + (absorbs_ ? surfaces * 2 * count : 0));
    for (std::size_t k = 0; k < count; ++k) {
        if (!differ_in_indices_alone(at_.front(), at_[k])) {
            throw std::invalid_argument("the lenses of a spectral lens differ in more than indices and coatings");
        }
        T* entry = table_.data() + k;
        for (const TraceSurface<T>& surface : at_[k].surfaces) {
            entry[kBefore * count] = surface.index_before;
            entry[kAfter * count] = surface.index_after;
            entry[kForwardRatio * count] = surface.forward_ratio;
            entry[kReverseRatio * count] = surface.reverse_ratio;
            entry += kColumns * count;
        }
        for (std::size_t i = 0; i < surfaces && !at_[k].attenuation.empty(); ++i) {
            T* of_surface = table_.data() + attenuations + i * 2 * count + k;
            of_surface[0] = at_[k].attenuation[i];
            of_surface[count] = at_[k].attenuation[i + 1];
        }
    }
    for (std::size_t i = 0; i < surfaces; ++i) {
        const T* columns = table_.data() + i * kColumns * count;
        const T* absorbing = absorbs_ ? table_.data() + attenuations + i * 2 * count : nullptr;
        indices_.push_back({.before = columns + kBefore * count,
                            .after = columns + kAfter * count,
                            .forward_ratio = columns + kForwardRatio * count,
                            .reverse_ratio = columns + kReverseRatio * count,
                            .attenuation_before = absorbing,
                            .attenuation_after = absorbs_ ? absorbing + count : nullptr});
    }
    add_coatings();
}

template <class T>
void SpectralLens<T>::add_coatings() {
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        begins.push_back(clear_layers_.size());
        const std::size_t count = clear_layers_of(at_, i);
        indices_[i].clear_layer_count = static_cast<int>(count);
        for (std::size_t layer = 0; layer < count; ++layer) {
            const auto add = [&](T TraceLayer<T>::*number) {
                for (const TraceLens<T>& lens : at_) {
                    const auto special = static_cast<std::size_t>(lens.surfaces[i].special);
                    clear_layers_.push_back(lens.specials[special].coating.layers[layer].*number);
                }
            };
            add(&TraceLayer<T>::index);
            add(&TraceLayer<T>::thickness);
        }
    }
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        indices_[i].clear_layers = clear_layers_.data() + begins[i];
    }
}

template class SpectralLens<float>;
template class SpectralLens<double>;

}  // namespace lensproof::optics
