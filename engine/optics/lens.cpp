#include "engine/optics/lens.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof {

namespace {

Glass everywhere(std::string name, DispersionFormula formula) {
    Glass glass;
    glass.name = std::move(name);
    glass.formula = formula;
    glass.max_wavelength_nm = std::numeric_limits<double>::infinity();
    return glass;
}

bool is_air(const StatedMedium& medium) {
    return (medium.glass.empty() && !medium.n_d) || medium.glass == "air" || medium.glass == "AIR";
}

Glass resolve_medium(const PrescribedSurface& surface, const std::vector<Glass>& glasses) {
    const StatedMedium& medium = surface.medium;
    if (is_air(medium)) {
        return everywhere("air", ConstantIndex{1.0});
    }
    if (medium.n_d && !medium.V_d) {
        return everywhere(fmt::format("n={}", *medium.n_d), ConstantIndex{*medium.n_d});
    }
    if (medium.n_d) {
        Glass glass;
        glass.name = fmt::format("n_d={} V_d={}", *medium.n_d, *medium.V_d);
        glass.formula = buchdahl_normal_line(*medium.n_d, *medium.V_d);
        // Where Robb & Mercado fitted the form.
        glass.min_wavelength_nm = 365.0;
        glass.max_wavelength_nm = 1014.0;
        return glass;
    }
    if (const std::optional<Glass> found = find_glass(glasses, medium.glass)) {
        return *found;
    }
    std::vector<std::string> names;
    std::ranges::transform(glasses, std::back_inserter(names), &Glass::name);
    throw InputError(
        fmt::format("{}.glass is \"{}\", which is not in the catalogue lenses/glasses.toml; it has: {}. "
                    "Or state n_d and V_d.",
                    surface.where, medium.glass, fmt::join(names, ", ")));
}

}  // namespace

int Lens::stop_index() const {
    return static_cast<int>(std::ranges::find_if(surfaces, &LensSurface::is_stop) - surfaces.begin());
}

Lens make_lens(const Prescription& prescription, const std::vector<Glass>& glasses, const IndexOverrides& overrides) {
    Lens lens;
    lens.name = prescription.name;
    lens.id = prescription.file.stem().string();
    lens.source = prescription.source;
    lens.projection = prescription.projection;
    lens.stated = prescription.stated;
    std::set<std::string> used;
    double z = 0.0;
    for (const PrescribedSurface& row : prescription.surfaces) {
        const auto override_index = overrides.find(row.medium.glass);
        Glass medium = override_index != overrides.end()
                           ? everywhere(row.medium.glass, ConstantIndex{override_index->second})
                           : resolve_medium(row, glasses);
        used.insert(row.medium.glass);
        lens.surfaces.push_back({.curvature = row.curvature,
                                 .vertex_z = z,
                                 .semi_diameter = row.semi_diameter_mm,
                                 .medium = std::move(medium),
                                 .is_stop = row.is_stop});
        z += row.thickness_mm;
    }
    lens.image_z = z;
    for (const auto& [name, index] : overrides) {
        if (!used.contains(name)) {
            used.erase("");
            throw InputError(fmt::format("--index {}={}: {} has no glass of that name; it has: {}", name, index,
                                         prescription.file.string(), fmt::join(used, ", ")));
        }
    }
    const LensSurface& last = lens.surfaces.back();
    if (refractive_index(last.medium.formula, kLineD) != 1.0) {
        throw InputError(fmt::format("{}: the last surface is followed by {}, expected air", prescription.file.string(),
                                     last.medium.name));
    }
    return lens;
}

Lens load_lens(const std::string& lens, const IndexOverrides& overrides) {
    const Prescription prescription = read_prescription(find_lens_file(lens));
    return make_lens(prescription, shipped_glasses(), overrides);
}

Lens with_f_number(Lens lens, double f_number) {
    const double widest = paraxial_data(at_wavelength<double>(lens, kLineD)).f_number;
    LensSurface& stop = lens.surfaces[lens.stop_index()];
    // Published f-numbers are rounded: f/2.8 is asked of a lens that opens to f/2.83.
    constexpr double kRounding = 0.02;
    if (!(f_number >= widest * (1.0 - kRounding))) {
        throw InputError(fmt::format("f/{} is wider than {} opens: f/{:.2f}", f_number, lens.name, widest));
    }
    stop.semi_diameter *= std::min(1.0, widest / f_number);
    return lens;
}

Lens focused_at(Lens lens, double object_distance_mm) {
    const TraceLens<double> at_d = at_wavelength<double>(lens, kLineD);
    const double image_distance = paraxial_image_distance(at_d, object_distance_mm);
    const double front_focus = -paraxial_data(at_d).ffl;
    if (!(object_distance_mm > front_focus) || !std::isfinite(image_distance)) {
        throw InputError(
            fmt::format("{} cannot be focused at {} mm: its front focal point lies {:.2f} mm in front of it", lens.name,
                        object_distance_mm, front_focus));
    }
    if (!(image_distance > 0.0)) {
        throw InputError(
            fmt::format("{} focused at {} mm has its image {:.2f} mm behind the last vertex, where no sensor "
                        "can stand",
                        lens.name, object_distance_mm, image_distance));
    }
    lens.image_z = lens.last_vertex_z() + image_distance;
    return lens;
}

WavelengthRange wavelength_range(const Lens& lens) {
    WavelengthRange range{0.0, std::numeric_limits<double>::infinity()};
    for (const LensSurface& surface : lens.surfaces) {
        range.min_nm = std::max(range.min_nm, surface.medium.min_wavelength_nm);
        range.max_nm = std::min(range.max_nm, surface.medium.max_wavelength_nm);
    }
    return range;
}

template <class T>
TraceLens<T> at_wavelength(const Lens& lens, double wavelength_nm) {
    TraceLens<T> traced{.surfaces = {}, .image_z = static_cast<T>(lens.image_z)};
    double index_before = 1.0;
    for (const LensSurface& surface : lens.surfaces) {
        if (!covers(surface.medium, wavelength_nm)) {
            throw InputError(fmt::format("{}: {} nm is outside the range of {}, {} to {} nm", lens.name, wavelength_nm,
                                         surface.medium.name, surface.medium.min_wavelength_nm,
                                         surface.medium.max_wavelength_nm));
        }
        const double index_after = refractive_index(surface.medium.formula, wavelength_nm);
        traced.surfaces.push_back(make_trace_surface<T>(
            static_cast<T>(surface.curvature), static_cast<T>(surface.vertex_z), static_cast<T>(surface.semi_diameter),
            static_cast<T>(index_before), static_cast<T>(index_after), surface.is_stop));
        index_before = index_after;
    }
    return traced;
}

template TraceLens<float> at_wavelength(const Lens&, double);
template TraceLens<double> at_wavelength(const Lens&, double);
template TraceLens<long double> at_wavelength(const Lens&, double);

}  // namespace lensproof
