#include "engine/optics/prescription.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

double interpolated(const std::vector<WavelengthValue>& values, double wavelength_nm) {
    const auto above = std::ranges::upper_bound(values, wavelength_nm, {}, &WavelengthValue::wavelength_nm);
    if (above == values.begin() || above == values.end()) {
        return above == values.begin() ? values.front().value : values.back().value;
    }
    const WavelengthValue& low = *(above - 1);
    const double fraction = (wavelength_nm - low.wavelength_nm) / (above->wavelength_nm - low.wavelength_nm);
    return low.value + fraction * (above->value - low.value);
}

void take_claims(StatedData& stated, const StatedData& other) {
    for (const Claim& claim : kClaims) {
        if (other.*claim.value) {
            stated.*claim.value = other.*claim.value;
        }
    }
}

bool StatedMedium::is_air() const {
    if (glass.empty()) {
        return !n_d && indices.empty();
    }
    return glass == "air" || glass == "AIR" || glass == "Air";
}

PrescribedSurface PrescribedSurface::turned() const {
    PrescribedSurface row = *this;
    row.radius_mm = is_flat() ? row.radius_mm : -row.radius_mm;
    if (row.radius_x_mm) {
        row.radius_x_mm = std::isinf(*row.radius_x_mm) ? row.radius_x_mm : std::optional(-*row.radius_x_mm);
    }
    for (int power = 1; power <= kHighestPower; ++power) {
        row.term(power) = -row.term(power);
    }
    row.thickness_mm = -row.thickness_mm;
    return row;
}

void set_mirror_media(std::vector<PrescribedSurface>& surfaces, StatedMedium before) {
    for (PrescribedSurface& row : surfaces) {
        row.medium = row.is_mirror ? before : row.medium;
        before = row.medium;
    }
}

std::string describe(const SystemAperture& aperture) {
    switch (aperture.kind) {
        case ApertureKind::entrance_pupil_diameter:
            return fmt::format("an entrance pupil of {} mm", aperture.value);
        case ApertureKind::f_number:
            return fmt::format("f/{}", aperture.value);
        case ApertureKind::working_f_number:
            return fmt::format("a working f-number of {}", aperture.value);
        case ApertureKind::object_numerical_aperture:
            return fmt::format("a numerical aperture of {} towards the object", aperture.value);
        case ApertureKind::stop:
            break;
    }
    return "the stop's semi-diameter";
}

double Prescription::reference_wavelength_nm() const {
    return wavelengths_nm.empty() ? spectral::kLineD : wavelengths_nm.front();
}

SystemAperture Prescription::governing_aperture() const {
    const auto stop = std::ranges::find_if(surfaces, &PrescribedSurface::is_stop);
    if (aperture.kind != ApertureKind::stop || stop == surfaces.end() || stop->semi_diameter_mm || stop->rim_mm) {
        return aperture;
    }
    if (stated.entrance_pupil_diameter_mm) {
        return {ApertureKind::entrance_pupil_diameter, *stated.entrance_pupil_diameter_mm};
    }
    return stated.f_number ? SystemAperture{ApertureKind::f_number, *stated.f_number} : aperture;
}

bool Prescription::is_rotationally_symmetric() const {
    const bool round_surfaces = std::ranges::all_of(surfaces, [](const PrescribedSurface& surface) {
        const bool has_lines = surface.phase && surface.phase->lines_per_mm != 0.0;
        return !surface.radius_x_mm && !has_lines && surface.misalignment == Misalignment{};
    });
    const bool aligned_groups =
        std::ranges::all_of(groups, [](const MisalignedGroup& group) { return group.misalignment == Misalignment{}; });
    return round_surfaces && aligned_groups;
}

Prescription at_zoom_position(Prescription prescription, std::size_t position) {
    if (prescription.zoom.empty() && position == 0) {
        return prescription;
    }
    if (position >= prescription.zoom.size()) {
        throw InputError(fmt::format("{}: zoom position {}, expected one of its {}", prescription.file.string(),
                                     position + 1, prescription.zoom.size()));
    }
    const ZoomPosition chosen = prescription.zoom[position];
    for (const auto& [surface, gap] : chosen.gaps_mm) {
        prescription.surfaces[surface - 1].thickness_mm = gap;
    }
    if (chosen.stop_semi_diameter_mm) {
        const auto stop = std::ranges::find_if(prescription.surfaces, &PrescribedSurface::is_stop);
        if (stop != prescription.surfaces.end()) {
            stop->semi_diameter_mm = chosen.stop_semi_diameter_mm;
        }
    }
    if (chosen.aperture.kind != ApertureKind::stop) {
        prescription.aperture = chosen.aperture;
    }
    StatedData& stated = prescription.stated;
    // What a source says of the whole lens holds at each position that says nothing else, but for lengths that zooming
    // changes.
    stated.efl_mm = stated.bfl_mm = stated.total_track_mm = std::nullopt;
    take_claims(stated, chosen.stated);
    prescription.zoom.clear();
    return prescription;
}

std::size_t find_zoom_position(const Prescription& prescription, const std::string& name) {
    const auto named = std::ranges::find(prescription.zoom, name, &ZoomPosition::name);
    if (named != prescription.zoom.end()) {
        return static_cast<std::size_t>(named - prescription.zoom.begin());
    }
    const std::size_t number = parse_exact<std::size_t>(name).value_or(0);
    const std::size_t count = std::max<std::size_t>(1, prescription.zoom.size());
    if (number >= 1 && number <= count) {
        return number - 1;
    }
    std::vector<std::string> names;
    std::ranges::transform(prescription.zoom, std::back_inserter(names), &ZoomPosition::name);
    throw InputError(prescription.zoom.empty()
                         ? fmt::format("{} has no zoom positions, found \"{}\"", prescription.file.string(), name)
                         : fmt::format("{} has no zoom position \"{}\", expected 1 to {}, or one of: {}",
                                       prescription.file.string(), name, count, fmt::join(names, ", ")));
}

}  // namespace lensproof::optics
