// engine/optics/prescription.h — a lens as its file states it: the table, the source, what the source claims.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/base/vec.h"
#include "engine/optics/finding.h"
#include "engine/optics/glass.h"
#include "engine/optics/projection.h"
#include "engine/optics/thin_element.h"
#include "engine/optics/wall_finish.h"

namespace lensproof::optics {

/// A wavelength in nm and a value there.
struct WavelengthValue {
    double wavelength_nm = 0.0;
    double value = 0.0;
    bool operator==(const WavelengthValue&) const = default;
};

/// Linear between the values, the first and the last one kept beyond them. `values`: at least one, by rising
/// wavelength.
double interpolated(const std::vector<WavelengthValue>& values, double wavelength_nm);

/// What a table states about the medium behind a surface: nothing (air), a glass's name, n_d with or without V_d, or
/// indices at wavelengths.
struct StatedMedium {
    std::string glass;          // catalogue name; may carry a maker: "SCHOTT LAK9"
    std::optional<double> n_d;  // beside a glass: what the source says of it, which the checker compares
    std::optional<double> V_d;  // without it, n_d holds at every wavelength
    std::vector<WavelengthValue> indices;

    [[nodiscard]] bool is_air() const;
    bool operator==(const StatedMedium&) const = default;
};

/// Coefficients of r², r⁴, … r²⁰, or of r, r³, … r¹⁹: an asphere's departure from its conic; that of r^j in mm^(1−j).
inline constexpr int kAsphereTerms = 10;
inline constexpr int kHighestPower = 2 * kAsphereTerms;
using AsphereTerms = std::array<double, kAsphereTerms>;

/// A rotation by `tilt_deg` about x, then about the turned y, then about the twice turned z, each by the right-hand
/// rule, and a shift across the axis before it.
struct Misalignment {
    std::array<double, 2> decentre_mm{};
    std::array<double, 3> tilt_deg{};

    bool operator==(const Misalignment&) const = default;
};

/// What a surface adds to the phase of light, in the order that is looked at (thin_element.h): the lines of a grating,
/// parallel to its x and equally spaced along y, and a kinoform, the path Σ c_i r^(2i) at its design wavelength.
struct PhaseElement {
    double order = 1.0;
    double lines_per_mm = 0.0;
    std::array<double, kPhaseTerms> radial{};  // c_1, …, mm^(1−2i)
    double design_wavelength_nm = 1.0;         // of those

    bool operator==(const PhaseElement&) const = default;
};

/// One row of a prescription. Numbers are as stated, NaN and absurd ones included: the checker names those, and
/// `make_lens` refuses them.
struct PrescribedSurface {
    double radius_mm = kInfinity;  // infinite or 0: flat
    double conic = 0.0;            // 0 a sphere, −1 a paraboloid
    AsphereTerms asphere{};        // of even powers
    AsphereTerms odd_asphere{};
    bool along_normal = false;          // these terms count along the conic's normal (SurfaceShape has the formula)
    std::optional<double> radius_x_mm;  // a toroid: the curve in y–z turned about an axis at this distance; inf: a
                                        // cylinder
    double thickness_mm = 0.0;          // to the next surface; for the last one: to the sensor
    std::optional<double> semi_diameter_mm;  // of the clear aperture
    std::optional<double> rim_mm;            // mechanical semi-diameter of the glass, where it is larger
    std::optional<double> barrel_mm;         // inner radius of the barrel over the space behind the surface
    StatedMedium medium;                     // behind the surface; that in front of it at a mirror
    bool is_mirror = false;                  // what follows lies at the distances −thickness
    bool is_stop = false;
    std::optional<double>
        ideal_focal_length_mm;  // an ideal lens, in air: beside other media n/f is its power all the same
    std::optional<PhaseElement> phase;
    std::string coating;        // a name in Prescription::coatings; empty: bare
    Misalignment misalignment;  // of this surface alone, about its vertex
    std::string where;          // "file:line: surfaces[3]", for messages

    [[nodiscard]] bool is_thin_element() const { return ideal_focal_length_mm || phase; }
    [[nodiscard]] bool is_flat() const { return radius_mm == 0.0 || std::isinf(radius_mm); }
    [[nodiscard]] double curvature() const { return is_flat() ? 0.0 : 1.0 / radius_mm; }  // 1/mm
    /// The coefficient of r^power, 1 to kHighestPower.
    [[nodiscard]] double& term(int power) { return (power % 2 == 0 ? asphere : odd_asphere)[(power - 1) / 2]; }
    [[nodiscard]] double term(int power) const { return (power % 2 == 0 ? asphere : odd_asphere)[(power - 1) / 2]; }
    [[nodiscard]] bool has_odd_terms() const { return odd_asphere != AsphereTerms{}; }
    [[nodiscard]] bool is_asphere() const { return asphere != AsphereTerms{} || has_odd_terms(); }
    /// As it is in coordinates with z the other way, its misalignment left as it is.
    [[nodiscard]] PrescribedSurface turned() const;
    bool operator==(const PrescribedSurface&) const = default;
};

/// Gives each mirror the medium in front of it, which is the one behind it too. `before`: in front of the first.
void set_mirror_media(std::vector<PrescribedSurface>& surfaces, StatedMedium before = {});

/// The thin element of a row or of a lens's surface at one wavelength, for an object at infinity.
template <class Surface>
ThinElement<double> thin_element(const Surface& surface, double wavelength_nm) {
    if (surface.ideal_focal_length_mm) {
        return {.kind = ThinKind::ideal_lens, .power = 1.0 / *surface.ideal_focal_length_mm};
    }
    ThinElement<double> element;
    if (surface.phase) {
        const PhaseElement& phase = *surface.phase;
        element.kind = ThinKind::phase;
        element.linear = phase.order * phase.lines_per_mm * wavelength_nm * 1e-6;
        const double of_design = phase.order * wavelength_nm / phase.design_wavelength_nm;
        std::ranges::transform(phase.radial, element.radial.begin(),
                               [&](double coefficient) { return of_design * coefficient; });
    }
    return element;
}

/// What the source claims about the lens as a whole; each is optional.
struct StatedData {
    std::optional<double> efl_mm;
    std::optional<double> bfl_mm;
    std::optional<double> f_number;
    std::optional<double> half_field_deg;
    std::optional<double> image_circle_mm;             // diameter
    std::optional<double> total_track_mm;              // first vertex to image
    std::optional<double> entrance_pupil_diameter_mm;  // as design programs say the aperture
    std::string source;                                // where these claims stand, if not in the lens's source
    bool operator==(const StatedData&) const = default;
};

/// What sets how far the stop opens: its own semi-diameter, or the system's aperture as design programs state it. The
/// stop is then the smaller of its semi-diameter, where it has one, and of what the paraxial marginal ray needs.
enum class ApertureKind {
    stop,
    entrance_pupil_diameter,    // mm
    f_number,                   // focal length over entrance pupil diameter
    working_f_number,           // 1 / (2 n' |u'|) for the object that the table is set to
    object_numerical_aperture,  // n sin U there
};
struct SystemAperture {
    ApertureKind kind = ApertureKind::stop;
    double value = 0.0;
    bool operator==(const SystemAperture&) const = default;
};

/// "an entrance pupil of 10 mm".
std::string describe(const SystemAperture& aperture);

/// How Zemax shrinks the pupil for a field: from −1 to 1 across it, the rays fill decentre ± (1 − compression).
struct PupilVignetting {
    Vec2d decentre;
    Vec2d compression;
    bool operator==(const PupilVignetting&) const = default;
};

/// What the points of a design's fields say; in Zemax's order.
enum class FieldKind { angle, object_height, paraxial_image_height, image_height };

/// The fields that a lens is designed for, the file's own order; degrees in x and in y, or mm.
struct DesignFields {
    FieldKind kind = FieldKind::angle;
    std::vector<Vec2d> points;
    std::vector<PupilVignetting> vignetting;  // of each point, or empty
    bool operator==(const DesignFields&) const = default;
};

/// A number of StatedData, as files key it.
struct Claim {
    const char* key;
    std::optional<double> StatedData::*value;
    bool is_positive;  // or else may have either sign
};
inline constexpr std::array kClaims = {
    Claim{"efl_mm", &StatedData::efl_mm, false},
    Claim{"bfl_mm", &StatedData::bfl_mm, false},
    Claim{"f_number", &StatedData::f_number, true},
    Claim{"half_field_deg", &StatedData::half_field_deg, true},
    Claim{"image_circle_mm", &StatedData::image_circle_mm, true},
    Claim{"total_track_mm", &StatedData::total_track_mm, true},
    Claim{"entrance_pupil_diameter_mm", &StatedData::entrance_pupil_diameter_mm, true},
};

/// Takes the claims that `other` makes in the place of those here.
void take_claims(StatedData& stated, const StatedData& other);

/// A stop whose blades leave a regular polygon. Its corners lie on the circle of the stop's semi-diameter.
struct PolygonStop {
    int blades = 6;
    double curvature = 0.0;     // of the blades' edges: 0 straight, 1 the circle through the corners
    double rotation_deg = 0.0;  // of a corner from +x towards +y
};

/// Where a point of the square around a circle, which is the unit circle, lies in a texture of it, row by row.
constexpr std::size_t texture_place(double x, double y, int columns, int rows) {
    const auto cell = [](double position, int size) {
        const int at = static_cast<int>(0.5 * (position + 1.0) * size);
        return at < 0 ? 0 : (at < size ? at : size - 1);
    };
    return static_cast<std::size_t>(cell(-y, rows)) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(cell(x, columns));
}

/// A picture's linear brightness over the square around an aperture's circle, 0 to 1; rows from +y downwards, each from
/// −x.
struct ApertureTexture {
    int size_x = 0;
    int size_y = 0;
    std::vector<float> values;

    /// At a point inside the circle, in units of its semi-diameter.
    [[nodiscard]] double at(double x, double y) const { return values[texture_place(x, y, size_x, size_y)]; }
};

/// A stop with a picture's linear brightness as its transmittance.
struct TexturedStop {
    std::string image;                               // relative to the prescription's file
    std::shared_ptr<const ApertureTexture> texture;  // what it shows, once it is read (with_stop_picture)
};

using StopShape = std::variant<std::monostate, PolygonStop, TexturedStop>;  // monostate: the full circle

/// A layer of a thin-film stack, of index n + iκ. One value of n or κ holds at every wavelength; a table of several
/// ends where it ends.
struct CoatingLayer {
    std::vector<WavelengthValue> index;         // n; empty where a material is named
    std::string material{};                     // as the glass catalogues know it
    std::vector<WavelengthValue> extinction{};  // κ; empty: 0
    double thickness_nm = 0.0;                  // or, where that is 0:
    double quarter_wave_nm = 0.0;               // the vacuum wavelength of which it is a quarter's optical thickness
    bool operator==(const CoatingLayer&) const = default;
};

/// Layers from the scene's side to the sensor's; or from the side of the lower index, which is the air's, to the other.
struct LayerStack {
    std::vector<CoatingLayer> layers;
    bool from_air = false;
    bool operator==(const LayerStack&) const = default;
};

/// What lies on a surface: thin films, or the reflectance that a maker states. One value of the latter holds at every
/// wavelength; between values it is interpolated, beyond them kept.
using Coating = std::variant<LayerStack, std::vector<WavelengthValue>>;

/// A range of surfaces that is shifted and tilted as one, about the vertex of its first surface plus `pivot_mm` along
/// the axis. Surfaces are counted from 1.
struct MisalignedGroup {
    int first = 1;
    int last = 1;
    Misalignment misalignment;
    double pivot_mm = 0.0;
};

/// A setting of a zoom lens: the gaps that differ from the table's, by the surface that they follow (from 1).
struct ZoomPosition {
    std::string name;
    std::map<int, double> gaps_mm;
    std::optional<double> stop_semi_diameter_mm;
    SystemAperture aperture;  // or the prescription's, where the kind is `stop`
    StatedData stated;
};

/// Surfaces (from 1) that move along the axis to focus: by `travel` mm towards the scene for each mm of the focusing
/// drive, 1 for the only group.
struct FocusGroup {
    int first = 1;
    int last = 1;
    double travel = 1.0;
};

/// What the glass touches. Catalogue indices are relative to air: in air its index is taken as 1 and theirs as they
/// are; in vacuum they are multiplied by the index of standard air (Ciddor 1996).
enum class Surroundings { air, vacuum };

struct Prescription {
    std::string name;
    std::string source;
    std::string notes;
    std::string design;  // the family it belongs to, for lists: "Tessar", "double Gauss"; may be empty
    Projection projection = Projection::rectilinear;
    StatedData stated;
    std::vector<PrescribedSurface> surfaces;
    StopShape stop_shape;
    BarrelFinish barrel;
    std::map<std::string, Coating> coatings;
    std::vector<MisalignedGroup> groups;
    std::vector<ZoomPosition> zoom;        // empty: a lens of one focal length
    std::vector<FocusGroup> focus_groups;  // empty: the lens focuses as a whole, that is, the sensor moves
    Surroundings surroundings = Surroundings::air;
    double object_distance_mm = kInfinity;  // that the table is set to
    StatedMedium object_medium;             // in front of the first surface: not air where a lens is immersed
    SystemAperture aperture;
    DesignFields fields;                            // may be empty
    std::vector<double> wavelengths_nm;             // that a design program's file names, the
                                                    // reference first; may be empty
    std::vector<std::filesystem::path> catalogues;  // glass files of its own
    std::vector<Glass> enclosed_glasses;            // that stand in the lens's own file
    std::vector<std::string> preferred_makers;      // whose glass a bare name means first
    bool figures_are_spare =
        false;                     // n_d and V_d beside a glass's name are no claim: they count where none has the name
    std::vector<Finding> remarks;  // what its reader could not carry over, and what it took upon itself
    std::filesystem::path file;

    /// The wavelength that the table is to be judged at: the file's reference, or the d line.
    [[nodiscard]] double reference_wavelength_nm() const;
    /// The aperture that governs; where the stop says nothing, the one that is claimed.
    [[nodiscard]] SystemAperture governing_aperture() const;
    [[nodiscard]] bool has_mirrors() const { return std::ranges::any_of(surfaces, &PrescribedSurface::is_mirror); }
    [[nodiscard]] bool has_thin_elements() const {
        return std::ranges::any_of(surfaces, &PrescribedSurface::is_thin_element);
    }
    /// Of the surfaces; the stop may have blades all the same.
    [[nodiscard]] bool is_rotationally_symmetric() const;
};

/// The prescription with its gaps (and stop and claims) at one of its zoom positions, which it then no longer lists.
/// What is stated of the whole lens holds at each position, but for its focal length, back focus and track.
/// Throws InputError naming the positions where there is no such one. A lens without positions has only position 0.
Prescription at_zoom_position(Prescription prescription, std::size_t position);

/// The position called `name`, or with that number (from 1). Throws InputError naming those that there are.
std::size_t find_zoom_position(const Prescription& prescription, const std::string& name);

}  // namespace lensproof::optics
