#include "engine/optics/prescription.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "engine/base/input_error.h"

namespace lensproof::optics {

std::string projection_name(Projection projection) {
    switch (projection) {
        case Projection::rectilinear:
            return "rectilinear";
        case Projection::equidistant:
            return "equidistant";
        case Projection::equisolid:
            return "equisolid";
        case Projection::stereographic:
            return "stereographic";
        case Projection::orthographic:
            return "orthographic";
    }
    return "unknown";
}

double projected_radius(Projection projection, double field_angle) {
    switch (projection) {
        case Projection::rectilinear:
            return std::tan(field_angle);
        case Projection::equidistant:
            return field_angle;
        case Projection::equisolid:
            return 2.0 * std::sin(0.5 * field_angle);
        case Projection::stereographic:
            return 2.0 * std::tan(0.5 * field_angle);
        case Projection::orthographic:
            return std::sin(field_angle);
    }
    return 0.0;
}

double interpolated(const std::vector<WavelengthValue>& values, double wavelength_nm) {
    const auto above = std::ranges::upper_bound(values, wavelength_nm, {}, &WavelengthValue::wavelength_nm);
    if (above == values.begin() || above == values.end()) {
        return above == values.begin() ? values.front().value : values.back().value;
    }
    const WavelengthValue& low = *(above - 1);
    const double share = (wavelength_nm - low.wavelength_nm) / (above->wavelength_nm - low.wavelength_nm);
    return low.value + share * (above->value - low.value);
}

bool StatedMedium::is_air() const {
    if (glass.empty()) {
        return !n_d && indices.empty();
    }
    return glass == "air" || glass == "AIR" || glass == "Air";
}

bool Prescription::is_rotationally_symmetric() const {
    const bool round_surfaces = std::ranges::all_of(surfaces, [](const PrescribedSurface& surface) {
        return !surface.radius_x_mm && surface.misalignment == Misalignment{};
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
    const auto take = [](std::optional<double>& claim, const std::optional<double>& here) {
        if (here) {
            claim = here;
        }
    };
    StatedData& stated = prescription.stated;
    // What a source says of the whole lens holds at each position that says nothing else, but for lengths that zooming
    // changes.
    stated.efl_mm = chosen.stated.efl_mm;
    stated.bfl_mm = chosen.stated.bfl_mm;
    stated.total_track_mm = chosen.stated.total_track_mm;
    take(stated.half_field_deg, chosen.stated.half_field_deg);
    take(stated.entrance_pupil_diameter_mm, chosen.stated.entrance_pupil_diameter_mm);
    take(stated.f_number, chosen.stated.f_number);
    take(stated.image_circle_mm, chosen.stated.image_circle_mm);
    prescription.zoom.clear();
    return prescription;
}

std::size_t find_zoom_position(const Prescription& prescription, const std::string& name) {
    const auto named = std::ranges::find(prescription.zoom, name, &ZoomPosition::name);
    if (named != prescription.zoom.end()) {
        return static_cast<std::size_t>(named - prescription.zoom.begin());
    }
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    const std::size_t count = std::max<std::size_t>(1, prescription.zoom.size());
    if (error == std::errc() && end == name.data() + name.size() && number >= 1 && number <= count) {
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
