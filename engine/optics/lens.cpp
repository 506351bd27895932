#include "engine/optics/lens.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/optics/air.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/frame.h"
#include "engine/optics/paraxial.h"
#include "engine/optics/unstated_rims.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

namespace {

// Far beyond any lens, far below what a square would overflow at.
constexpr double kLargestLength = 1e7;
constexpr double kLargestThickness = 1e10;
constexpr double kSmallestRadius = 1e-3;

void require(bool holds, const PrescribedSurface& row, const char* key, double found, const char* expected) {
    if (!holds) {
        throw InputError(fmt::format("{}.{} is {}, expected {}", row.where, key, found, expected));
    }
}

/// An ideal lens is flat, and nothing else bends there; a phase is that of one order at a time.
void require_thin_element(const PrescribedSurface& row) {
    const double focal = row.ideal_focal_length_mm.value_or(kInfinity);
    require(std::abs(focal) >= kSmallestRadius, row, "ideal_focal_length_mm", focal,
            "a focal length of at least 0.001 mm");
    if (row.ideal_focal_length_mm &&
        (!row.is_flat() || row.conic != 0.0 || row.is_asphere() || row.radius_x_mm || row.is_mirror || row.phase)) {
        throw InputError(
            fmt::format("{} is an ideal lens, expected a flat surface that is no mirror and no grating", row.where));
    }
    if (!row.phase) {
        return;
    }
    require(std::isfinite(row.phase->order), row, "diffraction_order", row.phase->order, "a number");
    require(std::isfinite(row.phase->lines_per_mm) && std::abs(row.phase->lines_per_mm) <= 1e6, row,
            "grating_lines_per_mm", row.phase->lines_per_mm, "lines a mm, up to 1e6");
    require(row.phase->design_wavelength_nm > 0.0 && std::isfinite(row.phase->design_wavelength_nm), row, "kinoform_nm",
            row.phase->design_wavelength_nm, "a wavelength in nm");
    for (const double coefficient : row.phase->radial) {
        require(std::isfinite(coefficient), row, "kinoform", coefficient, "a coefficient");
    }
}

/// Refuses what cannot be traced; `check` says more about it.
void require_traceable(const Prescription& prescription) {
    const auto misread = std::ranges::find(prescription.remarks, Severity::error, &Finding::severity);
    if (misread != prescription.remarks.end()) {
        throw InputError(
            fmt::format("{}: surface {}: {}", prescription.file.string(), misread->surface, misread->message));
    }
    for (const PrescribedSurface& row : prescription.surfaces) {
        require(row.is_flat() || (std::isfinite(row.radius_mm) && std::abs(row.radius_mm) >= kSmallestRadius), row,
                "radius_mm", row.radius_mm, "a radius of at least 0.001 mm; a flat surface has inf, or no radius_mm");
        require(std::isfinite(row.conic), row, "conic", row.conic, "a conic constant");
        for (int power = 1; power <= kHighestPower; ++power) {
            require(std::isfinite(row.term(power)), row, fmt::format("A{}", power).c_str(), row.term(power),
                    "an aspheric coefficient");
        }
        require(!row.radius_x_mm || (!std::isnan(*row.radius_x_mm) && *row.radius_x_mm != 0.0), row, "radius_x_mm",
                row.radius_x_mm.value_or(0.0), "a radius in mm, or inf for a cylinder");
        require(std::abs(row.thickness_mm) <= kLargestThickness, row, "thickness_mm", row.thickness_mm,
                "a length up to 1e10 mm");
        for (const auto& [key, length] : {std::pair{"semi_diameter_mm", row.semi_diameter_mm},
                                          {"rim_mm", row.rim_mm},
                                          {"barrel_mm", row.barrel_mm}}) {
            require(!length || (*length > 0.0 && *length <= kLargestLength), row, key, length.value_or(0.0),
                    "a length above 0, up to 1e7 mm");
        }
        require_thin_element(row);
        require(!row.medium.n_d || (*row.medium.n_d >= 1.0 && *row.medium.n_d <= 5.0), row, "n_d",
                row.medium.n_d.value_or(0.0), "a refractive index from 1 to 5");
        require(!row.medium.V_d || (*row.medium.V_d >= 1.0 && *row.medium.V_d <= 1000.0), row, "V_d",
                row.medium.V_d.value_or(0.0), "an Abbe number from 1 to 1000");
    }
    const double in_front = prescription.object_medium.n_d.value_or(1.0);
    if (!(in_front >= 1.0 && in_front <= 5.0)) {
        throw InputError(fmt::format("{}: object_medium.n_d is {}, expected a refractive index from 1 to 5",
                                     prescription.file.string(), in_front));
    }
    const auto stops = std::ranges::count_if(prescription.surfaces, &PrescribedSurface::is_stop);
    if (stops != 1) {
        throw InputError(fmt::format("{}: the prescription has {} aperture stops, expected exactly one",
                                     prescription.file.string(), stops));
    }
}

/// Light runs forwards, and back behind each mirror. Only a dummy, with one medium on both sides, may stand behind the
/// surface that follows it, or in front of the one before it: there the step back is only in the table. The image plane
/// may stand anywhere: a diverging lens's image is virtual.
void require_forwards(const Prescription& prescription, const Lens& lens) {
    const std::vector<LensSurface>& surfaces = lens.surfaces;
    const auto is_dummy = [&](std::size_t i) {
        return i < surfaces.size() && !surfaces[i].is_mirror && !surfaces[i].is_thin_element() &&
               surfaces[i].medium.formula == lens.medium_before(i).formula;
    };
    for (std::size_t i = 0; i + 1 < surfaces.size(); ++i) {
        const PrescribedSurface& row = prescription.surfaces[i];
        const double heading = lens.heading_behind(i);
        require(heading * row.thickness_mm >= -kGapRounding || is_dummy(i) || is_dummy(i + 1), row, "thickness_mm",
                row.thickness_mm,
                heading > 0.0 ? "a length that is not negative, but beside a dummy surface"
                              : "a length that is not positive behind a mirror, but beside a dummy surface");
    }
}

LensSurface placed_surface(const PrescribedSurface& row, const Frame& frame) {
    LensSurface surface;
    surface.curvature = row.curvature();
    surface.vertex_z = frame.origin.z;
    surface.vertex = {frame.origin.x, frame.origin.y};
    surface.axes = frame.axes;
    surface.semi_diameter = row.semi_diameter_mm.value_or(row.rim_mm.value_or(kInfinity));
    surface.rim = row.rim_mm.value_or(0.0);
    surface.tube_behind = row.barrel_mm.value_or(0.0);
    surface.is_mirror = row.is_mirror;
    surface.is_stop = row.is_stop;
    surface.ideal_focal_length_mm = row.ideal_focal_length_mm;
    surface.phase = row.phase;
    surface.has_shape = row.conic != 0.0 || row.is_asphere() || row.radius_x_mm.has_value();
    surface.shape = prescribed_shape(row);
    return surface;
}

}  // namespace

Glass resolved_medium(const PrescribedSurface& surface, const GlassCatalogue& glasses,
                      const std::vector<std::string>& preferred_makers) {
    return resolved_medium(surface.medium, surface.where, glasses, preferred_makers);
}

Glass resolved_medium(const StatedMedium& medium, const std::string& where, const GlassCatalogue& glasses,
                      const std::vector<std::string>& preferred_makers) {
    if (medium.is_air()) {
        return constant_glass("air", 1.0);
    }
    if (!medium.indices.empty()) {
        return tabulated_glass(fmt::format("a table of {} indices", medium.indices.size()), medium.indices);
    }
    GlassMatch match;
    if (!medium.glass.empty()) {
        match = glasses.resolve(medium.glass, preferred_makers);
        if (match.glass) {
            return std::move(*match.glass);
        }
    }
    if (medium.n_d && !medium.V_d) {
        return constant_glass(fmt::format("n={}", *medium.n_d), *medium.n_d);
    }
    if (medium.n_d) {
        Glass glass;
        glass.name = fmt::format("n_d={} V_d={}", *medium.n_d, *medium.V_d);
        glass.formula = normal_line(*medium.n_d, *medium.V_d);
        glass.min_wavelength_nm = kNormalLineMinNm;
        glass.max_wavelength_nm = kNormalLineMaxNm;
        return glass;
    }
    throw InputError(fmt::format("{}.glass is \"{}\", which no catalogue has; {}. Or state n_d and V_d.", where,
                                 printable(medium.glass), suggestion_text(match.suggestions)));
}

Finding unknown_glass(const StatedMedium& medium, const GlassMatch& match, int surface) {
    std::string message =
        fmt::format("no catalogue has the glass {}; {}", medium.glass, suggestion_text(match.suggestions));
    if (medium.n_d) {
        message += fmt::format("; traced with the n_d = {}{} beside it", *medium.n_d,
                               medium.V_d ? fmt::format(" and V_d = {}", *medium.V_d) : "");
    }
    return {"glass-unknown", medium.n_d ? Severity::warning : Severity::error, surface, message};
}

SurfaceShape<double> prescribed_shape(const PrescribedSurface& row) {
    SurfaceShape<double> shape{.curvature = row.curvature(),
                               .conic = row.conic,
                               .asphere = row.asphere,
                               .odd_asphere = row.odd_asphere,
                               .along_normal = row.along_normal,
                               .is_toroid = row.radius_x_mm.has_value(),
                               .curvature_x = row.radius_x_mm ? 1.0 / *row.radius_x_mm : 0.0};
    for (int power = 1; power <= kHighestPower; ++power) {
        if (row.term(power) != 0.0) {
            (power % 2 == 0 ? shape.terms : shape.odd_terms) = (power + 1) / 2;
        }
    }
    return shape;
}

int Lens::stop_index() const {
    return static_cast<int>(std::ranges::find_if(surfaces, &LensSurface::is_stop) - surfaces.begin());
}

double Lens::heading_behind(std::size_t i) const {
    const auto end = surfaces.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    return std::count_if(surfaces.begin(), end, [](const LensSurface& each) { return each.is_mirror; }) % 2 == 0 ? 1.0
                                                                                                                 : -1.0;
}

void require_refraction_alone(const Lens& lens, std::string_view what) {
    if (lens.has_mirrors()) {
        throw InputError(fmt::format("{}: {} is not simulated in lenses with mirrors", lens.name, what));
    }
    require_air_in_front(lens, what);
    require_no_thin_elements(lens, what);
}

void require_air_in_front(const Lens& lens, std::string_view what) {
    if (lens.object_medium.formula != DispersionFormula(ConstantIndex{1.0})) {
        throw InputError(fmt::format("{}: {} takes light from air, and the object lies in {}", lens.name, what,
                                     lens.object_medium.name));
    }
}

void require_no_thin_elements(const Lens& lens, std::string_view what) {
    if (lens.has_thin_elements()) {
        throw InputError(
            fmt::format("{}: {} is not simulated in lenses with ideal lenses, gratings or kinoforms", lens.name, what));
    }
}

void require_no_gratings(const Lens& lens, std::string_view what) {
    if (lens.has_gratings()) {
        throw InputError(
            fmt::format("{}: {} counts along the axis, which a grating turns; `trace` follows rays through "
                        "it",
                        lens.name, what));
    }
}

Lens make_lens(const Prescription& prescription, const GlassCatalogue& glasses, const IndexOverrides& overrides) {
    require_traceable(prescription);
    Lens lens;
    lens.name = prescription.name;
    lens.id = prescription.file.stem().string();
    lens.source = prescription.source;
    lens.projection = prescription.projection;
    lens.stated = prescription.stated;
    lens.stop_mask = StopMask(prescription.stop_shape);
    lens.barrel = prescription.barrel;
    lens.focus_groups = prescription.focus_groups;
    lens.surroundings = prescription.surroundings;
    lens.reference_wavelength_nm = prescription.reference_wavelength_nm();
    lens.object_distance_mm = prescription.object_distance_mm;
    lens.is_rotationally_symmetric = prescription.is_rotationally_symmetric();
    const StatedMedium& in_front = prescription.object_medium;
    lens.object_medium = overrides.contains(in_front.glass)
                             ? constant_glass(in_front.glass, overrides.at(in_front.glass))
                             : resolved_medium(in_front, prescription.file.string() + ": object_medium", glasses,
                                               prescription.preferred_makers);
    std::set<std::string> used{in_front.glass};
    const std::vector<Frame> frames = surface_frames(prescription);
    double barrel_before = kInfinity;
    for (const PrescribedSurface& row : prescription.surfaces) {
        const auto override_index = overrides.find(row.medium.glass);
        Glass medium = override_index != overrides.end() ? constant_glass(row.medium.glass, override_index->second)
                                                         : resolved_medium(row, glasses, prescription.preferred_makers);
        used.insert(row.medium.glass);
        if (override_index == overrides.end() && row.medium.indices.empty() && !row.medium.is_air() &&
            !row.medium.glass.empty()) {
            const GlassMatch match = glasses.resolve(row.medium.glass, prescription.preferred_makers);
            if (!match.glass) {
                lens.findings.push_back(unknown_glass(row.medium, match, static_cast<int>(lens.surfaces.size()) + 1));
            }
        }
        LensSurface surface = placed_surface(row, frames[lens.surfaces.size()]);
        const Glass before = lens.medium_before(lens.surfaces.size());
        // A barrel is convex, so a path runs inside it where it does so at both ends.
        surface.semi_diameter = std::min({surface.semi_diameter, barrel_before, row.barrel_mm.value_or(kInfinity)});
        surface.medium = std::move(medium);
        if (row.is_mirror && !(surface.medium.formula == before.formula)) {
            throw InputError(fmt::format("{} is a mirror, behind which is {}; expected what is in front of it, {}",
                                         row.where, surface.medium.name, before.name));
        }
        if (!row.coating.empty()) {
            const auto coating = prescription.coatings.find(row.coating);
            if (coating == prescription.coatings.end()) {
                throw InputError(fmt::format("{}.coating is \"{}\", which the prescription does not hold", row.where,
                                             printable(row.coating)));
            }
            if ((row.is_mirror || surface.is_thin_element()) && std::holds_alternative<LayerStack>(coating->second)) {
                throw InputError(
                    fmt::format("{}: the coating {} of a mirror or a thin element has layers, expected a "
                                "reflectance",
                                row.where, printable(row.coating)));
            }
            surface.coating = resolved_coating(coating->second, glasses, before, surface.medium,
                                               fmt::format("{}: coating {}", prescription.file.string(), row.coating));
        }
        lens.surfaces.push_back(std::move(surface));
        barrel_before = row.barrel_mm.value_or(kInfinity);
        lens.image_z += row.thickness_mm;
    }
    require_forwards(prescription, lens);
    for (const auto& [name, index] : overrides) {
        if (!used.contains(name)) {
            used.erase("");
            throw InputError(fmt::format("--index {}={}: {} has no glass of that name; it has: {}", name, index,
                                         prescription.file.string(), fmt::join(used, ", ")));
        }
    }
    open_stop(lens, prescription);
    estimate_rims(lens, prescription);
    return lens;
}

WavelengthRange wavelength_range(const Lens& lens) {
    WavelengthRange range{lens.object_medium.min_wavelength_nm, lens.object_medium.max_wavelength_nm};
    for (const LensSurface& surface : lens.surfaces) {
        range.min_nm = std::max(range.min_nm, surface.medium.min_wavelength_nm);
        range.max_nm = std::min(range.max_nm, surface.medium.max_wavelength_nm);
        if (const auto* films = std::get_if<std::vector<ThinFilm>>(&surface.coating)) {
            for (const ThinFilm& film : *films) {
                range.min_nm = std::max(range.min_nm, film.medium.min_wavelength_nm);
                range.max_nm = std::min(range.max_nm, film.medium.max_wavelength_nm);
            }
        }
    }
    return range;
}

namespace {

/// The index of a medium against what the lens stands in, which itself has 1.
double index_in(Surroundings surroundings, const Glass& medium, double wavelength_nm) {
    if (surroundings == Surroundings::air || medium.name == "air") {
        return refractive_index(medium.formula, wavelength_nm);
    }
    const double in_air_nm = air_wavelength_nm(wavelength_nm);
    return absolute_index(refractive_index(medium.formula, in_air_nm), in_air_nm);
}

/// By which light fades in glass of known internal transmittance, 1/mm: as far as a table's zeros may say.
double attenuation_of(const Glass& medium, double wavelength_nm) {
    constexpr double kOpaque = 100.0;
    const std::optional<double> through = internal_transmittance(medium, wavelength_nm, 1.0);
    return through ? std::min(-std::log(*through), kOpaque) : 0.0;
}

TraceLens<double> traced_lens(const Lens& lens, double wavelength_nm) {
    TraceLens<double> traced{.surfaces = {}, .image_z = lens.image_z};
    if (!covers(lens.object_medium, wavelength_nm)) {
        throw InputError(fmt::format("{}: {} nm is outside the range of {}, in which the object lies", lens.name,
                                     wavelength_nm, lens.object_medium.name));
    }
    double index_before = index_in(lens.surroundings, lens.object_medium, wavelength_nm);
    double sign = 1.0;  // of indices and distances: the other one behind each mirror
    traced.attenuation = {0.0};
    for (const LensSurface& surface : lens.surfaces) {
        if (!covers(surface.medium, wavelength_nm)) {
            throw InputError(fmt::format("{}: {} nm is outside the range of {}, {} to {} nm", lens.name, wavelength_nm,
                                         surface.medium.name, surface.medium.min_wavelength_nm,
                                         surface.medium.max_wavelength_nm));
        }
        sign = surface.is_mirror ? -sign : sign;
        const double index_after = sign * index_in(lens.surroundings, surface.medium, wavelength_nm);
        // At the vertex an r² term bends like the curvature: A2 r² = c r² / 2.
        const double vertex_curvature = surface.curvature + 2.0 * surface.shape.asphere[0];
        traced.surfaces.push_back(make_trace_surface(vertex_curvature, surface.vertex_z, surface.semi_diameter,
                                                     index_before, index_after, surface.is_stop));
        const bool is_masked = surface.is_stop && !lens.stop_mask.is_full_circle();
        SpecialSurface<double> special{.has_shape = surface.has_shape,
                                       .shape = surface.shape,
                                       .vertex = surface.vertex,
                                       .axes = surface.axes,
                                       .coating = coating_at(surface.coating, wavelength_nm, lens.name)};
        special.coating.is_mirror = surface.is_mirror;
        if (is_masked) {
            special.mask = lens.stop_mask;
        }
        special.thin = thin_element(surface, wavelength_nm);
        if (special.has_shape || special.thin.kind != ThinKind::none || surface.is_misaligned() ||
            !special.coating.is_bare() || is_masked) {
            traced.surfaces.back().special = static_cast<int>(traced.specials.size());
            traced.specials.push_back(std::move(special));
        }
        traced.attenuation.push_back(sign * attenuation_of(surface.medium, wavelength_nm));
        index_before = index_after;
    }
    if (std::ranges::all_of(traced.attenuation, [](double per_mm) { return per_mm == 0.0; })) {
        traced.attenuation.clear();
    }
    note_near_gaps(traced.surfaces, traced.specials);
    return traced;
}

/// Where ideal lenses have their object: the paraxial image of the lens's own in front of each, at the reference
/// wavelength, so that all wavelengths have one lens.
void set_object_vergences(const Lens& lens, TraceLens<double>& traced) {
    if (std::ranges::all_of(lens.surfaces, [](const LensSurface& each) { return !each.ideal_focal_length_mm; })) {
        return;
    }
    constexpr double kNearest = 1e-9;  // mm, to a lens in which the object's image stands: there no path is one
    const TraceLens<double> reference = traced_lens(lens, lens.reference_wavelength_nm);
    ParaxialRay ray = paraxial_detail::ray_from_axis(lens.object_distance_mm);
    double z = reference.surfaces.front().vertex_z;
    for (std::size_t i = 0; i < traced.surfaces.size(); ++i) {
        ray.height += ray.slope * (reference.surfaces[i].vertex_z - z);
        z = reference.surfaces[i].vertex_z;
        if (lens.surfaces[i].ideal_focal_length_mm && ray.slope != 0.0) {
            const double object_z = -ray.height / ray.slope;
            traced.specials[traced.surfaces[i].special].thin.object_vergence =
                1.0 / (std::abs(object_z) < kNearest ? kNearest : object_z);
        }
        ray = paraxial_detail::refracted(reference, ray, reference.surfaces[i]);
    }
}

}  // namespace

template <class T>
TraceLens<T> at_wavelength(const Lens& lens, double wavelength_nm) {
    TraceLens<double> traced = traced_lens(lens, wavelength_nm);
    set_object_vergences(lens, traced);
    return convert_lens<T>(traced);
}

template TraceLens<float> at_wavelength(const Lens&, double);
template TraceLens<double> at_wavelength(const Lens&, double);
template TraceLens<long double> at_wavelength(const Lens&, double);

}  // namespace lensproof::optics
