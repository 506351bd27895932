// engine/optics/device/lens_view.h — a lens at several wavelengths as plain arrays, for the one tracer on a GPU.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/optics/stop_mask.h"
#include "engine/optics/trace.h"

namespace lensproof::optics {

/// A SpectralLens laid out in memory that a device reaches (DeviceLens). What depends on the wavelength lies side by
/// side for all of them, so that neighbours of different wavelengths read from one line of memory.
template <class T>
struct LensView {
    using Special = SpecialSurface<T, std::span<const TraceLayer<T>>, StopOpening>;
    enum Column { kBefore, kAfter, kForwardRatio, kReverseRatio, kColumns };

    const TraceSurface<T>* surfaces = nullptr;  // of the first wavelength
    const T* indices = nullptr;                 // [surface][Column][wavelength]
    const Special* specials = nullptr;          // [wavelength][special]
    const T* attenuation = nullptr;             // [medium, that in front of the first surface too][wavelength]; or null
    int surface_count = 0;
    int special_count = 0;
    int wavelengths = 0;
    T image_z = T(0);

    /// Whether `trace_through` needs its `has_specials`.
    [[nodiscard]] constexpr bool has_more_than_spheres() const { return special_count > 0 || attenuation != nullptr; }

    /// What a TraceLens is to the tracer, of one wavelength.
    struct AtWavelength {
        using Special = LensView::Special;

        struct Surfaces {
            const LensView& lens;
            int wavelength;

            [[nodiscard]] constexpr std::size_t size() const { return static_cast<std::size_t>(lens.surface_count); }
            constexpr TraceSurface<T> operator[](std::size_t i) const {
                TraceSurface<T> surface = lens.surfaces[i];
                const auto stride = static_cast<std::size_t>(lens.wavelengths);
                const T* at = lens.indices + i * kColumns * stride + static_cast<std::size_t>(wavelength);
                surface.index_before = at[kBefore * stride];
                surface.index_after = at[kAfter * stride];
                surface.forward_ratio = at[kForwardRatio * stride];
                surface.reverse_ratio = at[kReverseRatio * stride];
                return surface;
            }
        };
        struct Attenuation {
            const T* of_wavelength;

            [[nodiscard]] constexpr bool empty() const { return of_wavelength == nullptr; }
        };

        Surfaces surfaces;
        std::span<const Special> specials;
        Attenuation attenuation;
        T image_z;

        [[nodiscard]] constexpr const T& attenuation_towards(int surface, bool forward) const {
            return attenuation.of_wavelength[static_cast<std::size_t>(forward ? surface : surface + 1) *
                                             static_cast<std::size_t>(surfaces.lens.wavelengths)];
        }
    };

    /// This outlives it.
    [[nodiscard]] constexpr AtWavelength at(int wavelength) const {
        return {.surfaces = {*this, wavelength},
                .specials = {specials + static_cast<std::ptrdiff_t>(wavelength) * special_count,
                             static_cast<std::size_t>(special_count)},
                .attenuation = {attenuation != nullptr ? attenuation + wavelength : nullptr},
                .image_z = image_z};
    }
};

}  // namespace lensproof::optics
