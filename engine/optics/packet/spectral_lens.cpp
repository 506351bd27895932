#include "engine/optics/packet/spectral_lens.h"

#include <algorithm>
#include <span>
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

}  // namespace

template <class T>
SpectralLens<T>::SpectralLens(std::vector<TraceLens<T>> at) : at_(std::move(at)) {
    if (at_.empty() || at_.size() > static_cast<std::size_t>(kMostWavelengths)) {
        throw std::invalid_argument("a spectral lens has 1 to 65536 wavelengths");
    }
    for (const TraceLens<T>& lens : at_) {
        if (!differ_in_indices_alone(at_.front(), lens)) {
            throw std::invalid_argument("the lenses of a spectral lens differ in more than indices and coatings");
        }
    }
    const std::size_t count = at_.size();
    const std::size_t surfaces = at_.front().surfaces.size();
    table_.reserve(surfaces * count);
    for (std::size_t i = 0; i < surfaces; ++i) {
        for (const TraceLens<T>& lens : at_) {
            const TraceSurface<T>& surface = lens.surfaces[i];
            table_.push_back({.before = surface.index_before,
                              .after = surface.index_after,
                              .forward_ratio = surface.forward_ratio,
                              .reverse_ratio = surface.reverse_ratio});
        }
    }
    for (std::size_t i = 0; i < surfaces; ++i) {
        const std::span<const SurfaceIndices<T>> of_surface(table_.data() + i * count, count);
        const int special = at_.front().surfaces[i].special;
        indices_.push_back(
            {.at = of_surface.data(),
             .bends = std::ranges::any_of(of_surface, [](const auto& one) { return one.before != one.after; }),
             .is_coated_sphere = special >= 0 && at_.front().specials[static_cast<std::size_t>(special)].is_sphere()});
    }
    add_attenuation();
    add_coatings();
}

template <class T>
void SpectralLens<T>::add_attenuation() {
    if (std::ranges::all_of(at_, [](const TraceLens<T>& lens) { return lens.attenuation.empty(); })) {
        return;
    }
    const std::size_t count = at_.size();
    attenuation_.reserve((indices_.size() + 1) * count);
    for (std::size_t medium = 0; medium <= indices_.size(); ++medium) {
        for (const TraceLens<T>& lens : at_) {
            attenuation_.push_back(lens.attenuation.empty() ? T(0) : lens.attenuation[medium]);
        }
    }
    const auto unless_clear = [&](std::size_t medium) {
        const std::span<const T> of_medium(attenuation_.data() + medium * count, count);
        const bool is_clear = std::ranges::all_of(of_medium, [](T attenuation) { return attenuation == T(0); });
        return is_clear ? nullptr : of_medium.data();
    };
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        indices_[i].attenuation_before = unless_clear(i);
        indices_[i].attenuation_after = unless_clear(i + 1);
    }
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
