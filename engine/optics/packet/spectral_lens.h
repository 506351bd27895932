// engine/optics/packet/spectral_lens.h — a lens at several wavelengths at once, for packets whose rays differ in
// theirs.
#pragma once
#include <vector>

#include "engine/optics/lens.h"
#include "engine/optics/surface_indices.h"

namespace lensproof::optics {

/// A surface's coating at each wavelength, where packets know how to take it; else nothing.
template <class T>
struct SurfaceCoatings {
    int wavelengths = 0;
    const T* stated = nullptr;  // reflectance by wavelength, in the place of layers; of a mirror what goes on
    bool is_mirror = false;
    /// Of layers from the scene's side, none of which absorbs: [layer][wavelength].
    const ClearLayer<T>* clear_layers = nullptr;
    int clear_layer_count = 0;
    const T* per_squared_before = nullptr;  // 1 / the squares of the media's indices, by wavelength
    const T* per_squared_after = nullptr;
};

/// One lens at up to 65,536 wavelengths in one precision. The surfaces are the same in all of them but for indices and
/// coatings; the indices and what absorbs lie in a table a surface, so that a packet can look its lanes' up.
template <class T>
class SpectralLens {
  public:
    static constexpr int kMostWavelengths = 65536;

    /// Throws std::invalid_argument for lenses that differ in more than indices and coatings, and for none.
    explicit SpectralLens(std::vector<TraceLens<T>> at);
    SpectralLens(SpectralLens&&) noexcept = default;  // `indices` point into the table
    SpectralLens& operator=(SpectralLens&&) noexcept = default;
    SpectralLens(const SpectralLens&) = delete;
    SpectralLens& operator=(const SpectralLens&) = delete;
    ~SpectralLens() = default;

    [[nodiscard]] const std::vector<TraceLens<T>>& at() const { return at_; }
    [[nodiscard]] const TraceLens<T>& at(int wavelength) const { return at_[static_cast<std::size_t>(wavelength)]; }
    [[nodiscard]] int wavelengths() const { return static_cast<int>(at_.size()); }
    [[nodiscard]] int surfaces() const { return static_cast<int>(at_.front().surfaces.size()); }

    /// One surface's numbers, each by wavelength.
    struct Indices {
        const SurfaceIndices<T>* at = nullptr;
        const T* forward_ratios = nullptr;  // what `at` has, for who needs nothing else
        const T* reverse_ratios = nullptr;
        bool bends = true;                      // at some of the wavelengths: its media differ
        bool is_coated_sphere = false;          // centred, of a round aperture, and coated
        const T* attenuation_before = nullptr;  // null: clear at all of them
        const T* attenuation_after = nullptr;
        SurfaceCoatings<T> coatings;
    };
    [[nodiscard]] const std::vector<Indices>& indices() const { return indices_; }
    /// What they have at `at`, surface after surface.
    [[nodiscard]] const std::vector<SurfaceIndices<T>>& table() const { return table_; }
    /// Of each medium, from the one in front of the first surface on, by wavelength: /mm. Empty where none absorbs.
    [[nodiscard]] const std::vector<T>& attenuation() const { return attenuation_; }
    [[nodiscard]] bool absorbs() const { return !attenuation_.empty(); }

  private:
    void add_attenuation();
    void add_coatings();
    void add_coatings_of(std::size_t surface);

    std::vector<TraceLens<T>> at_;
    std::vector<SurfaceIndices<T>> table_;            // [surface][wavelength]
    std::vector<T> ratios_;                           // [surface][forward, reverse][wavelength]
    std::vector<T> attenuation_;                      // [medium][wavelength]
    std::vector<ClearLayer<T>> clear_layers_;         // [coating][layer][wavelength]
    std::vector<std::vector<T>> of_coated_surfaces_;  // what their SurfaceCoatings point to
    std::vector<Indices> indices_;
};

extern template class SpectralLens<float>;
extern template class SpectralLens<double>;

/// The lens at each of the wavelengths. Throws as `at_wavelength` does.
template <class T>
SpectralLens<T> at_wavelengths(const Lens& lens, const std::vector<double>& wavelengths_nm) {
    std::vector<TraceLens<T>> at;
    at.reserve(wavelengths_nm.size());
    for (const double nm : wavelengths_nm) {
        at.push_back(at_wavelength<T>(lens, nm));
    }
    return SpectralLens<T>(std::move(at));
}

}  // namespace lensproof::optics
