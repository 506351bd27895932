// engine/optics/lens.h — a lens as it was meant: glasses looked up, stop and focus set, ready to be traced.
#pragma once
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/optics/front_dust.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/optics/prescription.h"
#include "engine/optics/thin_film.h"
#include "engine/optics/trace.h"
#include "engine/optics/wall_finish.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

/// What rounding and optimizers leave of surfaces that touch: a gap below that is none, mm.
inline constexpr double kGapRounding = 1e-6;

/// A surface of a `Lens`. Lens space, mm.
struct LensSurface {
    double curvature = 0.0;
    double vertex_z = 0.0;
    double semi_diameter = 0.0;  // of what passes: the clear aperture, or the barrel where that is narrower
    double rim = 0.0;            // of the glass, mechanically, and
    double tube_behind = 0.0;    // the barrel's inner radius over the space behind; 0 where they are not stated
    Glass medium;                // behind the surface
    bool is_mirror = false;
    bool is_stop = false;
    std::optional<double> ideal_focal_length_mm;  // of an ideal lens there
    std::optional<PhaseElement> phase;            // of a grating or a kinoform there
    SurfaceShape<double> shape{};                 // of a surface that is no sphere; its curvature is the one above
    bool has_shape = false;
    Vec2d vertex{};                                                                  // x, y of a displaced vertex
    std::array<Vec3d, 3> axes{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};  // of its frame, in lens space
    LensCoating coating{};

    [[nodiscard]] bool is_misaligned() const {
        return axes[2] != Vec3d{0.0, 0.0, 1.0} || axes[0] != Vec3d{1.0, 0.0, 0.0} || vertex != Vec2d{};
    }
    [[nodiscard]] bool is_thin_element() const { return ideal_focal_length_mm || phase; }
    [[nodiscard]] bool is_grating() const { return phase && phase->lines_per_mm != 0.0; }
};

/// A traceable lens. The scene lies in `object_medium` in front of the first surface, the sensor at `image_z` behind
/// the last, in that one's medium. What light loses in front of the first surface is not counted.
struct Lens {
    std::string name;
    std::string id;  // the file's stem
    std::string source;
    Projection projection = Projection::rectilinear;
    StatedData stated;
    Glass object_medium = constant_glass("air", 1.0);
    std::vector<LensSurface> surfaces;
    StopMask stop_mask;
    BarrelFinish barrel;
    std::optional<FrontDust> dust;
    std::vector<FocusGroup> focus_groups;
    Surroundings surroundings = Surroundings::air;
    double reference_wavelength_nm = spectral::kLineD;
    double object_distance_mm = kInfinity;  // from the first vertex, that it is focused at
    bool is_rotationally_symmetric = true;
    double image_z = 0.0;
    std::vector<Finding> findings;  // names of glasses that no catalogue has, which the figures beside them stand for

    [[nodiscard]] int stop_index() const;
    [[nodiscard]] const Glass& medium_before(std::size_t i) const {
        return i == 0 ? object_medium : surfaces[i - 1].medium;
    }
    [[nodiscard]] double last_vertex_z() const { return surfaces.back().vertex_z; }
    [[nodiscard]] bool has_mirrors() const { return std::ranges::any_of(surfaces, &LensSurface::is_mirror); }
    [[nodiscard]] bool has_thin_elements() const {
        return std::ranges::any_of(surfaces, &LensSurface::is_thin_element);
    }
    [[nodiscard]] bool has_kinoforms() const {
        return std::ranges::any_of(surfaces, [](const LensSurface& each) { return each.phase.has_value(); });
    }
    [[nodiscard]] bool has_gratings() const { return std::ranges::any_of(surfaces, &LensSurface::is_grating); }
    /// Where light runs behind surface `i`, from 0, and behind the last one: along z (1), or against it (−1) after an
    /// odd number of mirrors.
    [[nodiscard]] double heading_behind(std::size_t i) const;
    [[nodiscard]] double final_heading() const { return heading_behind(surfaces.size() - 1); }
};

/// Throws InputError naming what is known of refracting surfaces alone, where `lens` has mirrors, ideal lenses,
/// gratings or kinoforms.
void require_refraction_alone(const Lens& lens, std::string_view what);

/// Throws InputError naming what is known of light from air alone, where `lens` is immersed.
void require_air_in_front(const Lens& lens, std::string_view what);

/// The same for lenses with thin elements alone.
void require_no_thin_elements(const Lens& lens, std::string_view what);

/// Throws InputError naming what counts along the axis, where `lens` has a grating, which turns it.
void require_no_gratings(const Lens& lens, std::string_view what);

/// Constant indices that stand for glasses, by catalogue name: `--index LAK9=1.691`.
using IndexOverrides = std::map<std::string, double>;

/// The surface's shape, centred: its tilt and decentre are left out.
SurfaceShape<double> prescribed_shape(const PrescribedSurface& row);

/// What is behind a surface: its table of indices, the glass it names, or what its n_d and V_d stand for; those too
/// where the name is not known. Throws InputError with suggestions for an unknown name alone.
Glass resolved_medium(const PrescribedSurface& surface, const GlassCatalogue& glasses,
                      const std::vector<std::string>& preferred_makers);

Glass resolved_medium(const StatedMedium& medium, const std::string& where, const GlassCatalogue& glasses,
                      const std::vector<std::string>& preferred_makers);

/// That no catalogue has the name of the glass behind surface `surface` (from 1): an error, or a warning where figures
/// beside it are traced.
Finding unknown_glass(const StatedMedium& medium, const GlassMatch& match, int surface);

/// Looks the prescription's glasses up. Throws InputError naming the file, the line and the name of an unknown glass,
/// for an override of a glass that the lens does not have, for a coating that it does not have or that
/// `resolved_coating` refuses, for a mirror with layers or with two media, and for a stop's picture that was not read.
Lens make_lens(const Prescription& prescription, const GlassCatalogue& glasses, const IndexOverrides& overrides = {});

/// The range of wavelengths that every glass's formula and every coating covers, nm.
struct WavelengthRange {
    double min_nm = 0.0;
    double max_nm = 0.0;
};
WavelengthRange wavelength_range(const Lens& lens);

/// The lens at one wavelength in precision T. Throws InputError naming the glass whose formula does not cover it.
template <class T>
TraceLens<T> at_wavelength(const Lens& lens, double wavelength_nm);

/// Which precisions exist: `double` is the reference, `float` the fast path, `long double` judges both.
extern template TraceLens<float> at_wavelength(const Lens&, double);
extern template TraceLens<double> at_wavelength(const Lens&, double);
extern template TraceLens<long double> at_wavelength(const Lens&, double);

}  // namespace lensproof::optics
