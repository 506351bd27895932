// engine/optics/device/lens_view.h — a lens at several wavelengths as plain arrays, for the one tracer on a GPU.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/optics/stop_mask.h"
#include "engine/optics/surface_indices.h"
#include "engine/optics/trace.h"

namespace lensproof::optics {

/// A SpectralLens laid out in memory that a device reaches (DeviceLens): what a ray reads at a surface lies together,
/// in the words that a GPU's memory is read in.
template <class T>
struct LensView {
    using Special = SpecialSurface<T, std::span<const TraceLayer<T>>, StopOpening>;

    struct alignas(4 * sizeof(T)) Surface {  // at every wavelength
        T curvature;
        T vertex_z;
        T semi_diameter_squared;
        std::int32_t special_and_notes;  // 8 · special and, of these, what holds

        static constexpr std::int32_t kIsStop = 1;
        static constexpr std::int32_t kFromFarForward = 2;
        static constexpr std::int32_t kFromFarReverse = 4;
    };

    const Surface* surfaces = nullptr;
    const SurfaceIndices<T>* indices = nullptr;  // [surface][wavelength]
    const Special* specials = nullptr;           // [wavelength][special]
    const T* attenuation = nullptr;  // [medium, that in front of the first surface too][wavelength]; or null
    int surface_count = 0;
    int special_count = 0;
    int wavelengths = 0;
    T image_z = T(0);

    /// What `trace_through` has to look for.
    [[nodiscard]] constexpr LensMakeup makeup() const {
        return special_count > 0        ? LensMakeup::any
               : attenuation != nullptr ? LensMakeup::spheres
                                        : LensMakeup::clear_spheres;
    }

    /// What a TraceLens is to the tracer, of one wavelength.
    struct AtWavelength {
        using Special = LensView::Special;

        struct Surfaces {
            const LensView& lens;
            int wavelength;

            [[nodiscard]] constexpr std::size_t size() const { return static_cast<std::size_t>(lens.surface_count); }
            constexpr TraceSurface<T> operator[](int i) const {
                const Surface surface = lens.surfaces[i];
                const SurfaceIndices<T>& index = lens.indices[i * lens.wavelengths + wavelength];
                return {.curvature = surface.curvature,
                        .vertex_z = surface.vertex_z,
                        .semi_diameter_squared = surface.semi_diameter_squared,
                        .index_before = index.before,
                        .index_after = index.after,
                        .forward_ratio = index.forward_ratio,
                        .reverse_ratio = index.reverse_ratio,
                        .is_stop = (surface.special_and_notes & Surface::kIsStop) != 0,
                        .special = surface.special_and_notes >> 3,
                        .from_far_forward = (surface.special_and_notes & Surface::kFromFarForward) != 0,
                        .from_far_reverse = (surface.special_and_notes & Surface::kFromFarReverse) != 0};
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
            return attenuation.of_wavelength[(forward ? surface : surface + 1) * surfaces.lens.wavelengths];
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
