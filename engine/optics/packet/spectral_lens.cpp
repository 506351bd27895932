#include "engine/optics/packet/spectral_lens.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <stdexcept>
#include <utility>

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

template <class T>
bool is_coated_sphere(const TraceLens<T>& lens, std::size_t surface) {
    const int index = lens.surfaces[surface].special;
    if (index < 0) {
        return false;
    }
    const SpecialSurface<T>& special = lens.specials[static_cast<std::size_t>(index)];
    return special.is_sphere() && !special.coating.is_bare();
}

/// Of coatings of one surface; none where they are not made of layers that all absorb nothing.
template <class T>
std::size_t clear_layers_of(const std::vector<const TraceCoating<T>*>& coatings) {
    const std::size_t count = coatings.front()->layers.size();
    const bool are_clear = std::ranges::all_of(coatings, [&](const TraceCoating<T>* coating) {
        return !coating->is_stated() && coating->layers.size() == count &&
               std::ranges::all_of(coating->layers,
                                   [](const TraceLayer<T>& layer) { return layer.extinction == T(0); });
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
    ratios_.reserve(2 * table_.size());
    for (std::size_t i = 0; i < surfaces; ++i) {
        const std::span<const SurfaceIndices<T>> of_surface(table_.data() + i * count, count);
        std::ranges::transform(of_surface, std::back_inserter(ratios_), &SurfaceIndices<T>::forward_ratio);
        std::ranges::transform(of_surface, std::back_inserter(ratios_), &SurfaceIndices<T>::reverse_ratio);
        indices_.push_back(
            {.at = of_surface.data(),
             .forward_ratios = ratios_.data() + 2 * i * count,
             .reverse_ratios = ratios_.data() + (2 * i + 1) * count,
             .bends = std::ranges::any_of(of_surface, [](const auto& one) { return one.before != one.after; }),
             .is_coated_sphere = is_coated_sphere(at_.front(), i)});
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
    std::vector<std::size_t> first_layers;  // of each surface
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        first_layers.push_back(clear_layers_.size());
        if (at_.front().surfaces[i].special >= 0) {
            add_coatings_of(i);
        }
    }
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        indices_[i].coatings.clear_layers = clear_layers_.data() + first_layers[i];
    }
}

template <class T>
void SpectralLens<T>::add_coatings_of(std::size_t surface) {
    std::vector<const TraceCoating<T>*> by_wavelength;
    for (const TraceLens<T>& lens : at_) {
        by_wavelength.push_back(&lens.specials[static_cast<std::size_t>(lens.surfaces[surface].special)].coating);
    }
    const auto column = [&](const auto& of, const auto& number) {
        std::vector<T>& numbers = of_coated_surfaces_.emplace_back();
        std::ranges::transform(of, std::back_inserter(numbers), number);
        return std::as_const(numbers).data();
    };
    SurfaceCoatings<T>& coatings = indices_[surface].coatings;
    coatings.wavelengths = wavelengths();
    coatings.is_mirror = by_wavelength.front()->is_mirror;
    if (std::ranges::all_of(by_wavelength, [&](const TraceCoating<T>* coating) {
            return coating->is_stated() && coating->is_mirror == coatings.is_mirror;
        })) {
        coatings.stated =
            column(by_wavelength, [](const TraceCoating<T>* coating) { return coating->reflectance.value_or(T(1)); });
        return;
    }
    const std::size_t layers = clear_layers_of(by_wavelength);
    if (layers == 0) {
        return;
    }
    coatings.clear_layer_count = static_cast<int>(layers);
    for (std::size_t layer = 0; layer < layers; ++layer) {
        std::ranges::transform(by_wavelength, std::back_inserter(clear_layers_),
                               [&](const TraceCoating<T>* coating) { return clear_layer(coating->layers[layer]); });
    }
    const auto per_squared = [&](T TraceSurface<T>::*index) {
        return column(at_, [&](const TraceLens<T>& lens) {
            const T& n = lens.surfaces[surface].*index;
            return T(1) / (n * n);
        });
    };
    coatings.per_squared_before = per_squared(&TraceSurface<T>::index_before);
    coatings.per_squared_after = per_squared(&TraceSurface<T>::index_after);
}

template class SpectralLens<float>;
template class SpectralLens<double>;

}  // namespace lensproof::optics
