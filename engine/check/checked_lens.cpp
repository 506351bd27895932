#include "engine/check/checked_lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/check/rays.h"

namespace lensproof::check {

namespace {

double index_behind(const optics::PrescribedSurface& row, const std::optional<optics::Glass>& medium,
                    const optics::IndexOverrides& indices, double wavelength_nm) {
    const auto override_index = indices.find(row.medium.glass);
    if (!row.medium.glass.empty() && override_index != indices.end()) {
        return override_index->second;
    }
    const bool is_known = medium && optics::covers(*medium, wavelength_nm);
    return is_known ? optics::refractive_index(medium->formula, wavelength_nm) : kNaN;
}

/// Where a stop is missing or doubled, rays are judged as though the narrowest of the surfaces that may be meant were
/// it.
std::optional<int> assume_stop(optics::Prescription& prescription) {
    const auto stops = std::ranges::count_if(prescription.surfaces, &optics::PrescribedSurface::is_stop);
    if (stops == 1) {
        return std::nullopt;
    }
    const auto narrowness = [&](const optics::PrescribedSurface& row) {
        return stops > 1 && !row.is_stop ? kInfinity : row.semi_diameter_mm.value_or(kInfinity);
    };
    const auto narrowest = std::ranges::min_element(prescription.surfaces, {}, narrowness);
    for (optics::PrescribedSurface& row : prescription.surfaces) {
        row.is_stop = false;
    }
    narrowest->is_stop = true;
    return static_cast<int>(narrowest - prescription.surfaces.begin());
}

void trace_if_possible(CheckedLens& checked) {
    optics::Prescription traceable = checked.prescription;
    traceable.stop_shape = {};
    traceable.stated = checked.claims;
    checked.assumed_stop = assume_stop(traceable);
    try {
        checked.lens = optics::make_lens(traceable, *checked.known_glasses, checked.settings.indices);
        for (const optics::LensSurface& surface : checked.lens->surfaces) {
            if (!optics::covers(surface.medium, checked.wavelength_nm)) {
                throw InputError(
                    fmt::format("the index of {} is not known at {} nm", surface.medium.name, checked.wavelength_nm));
            }
        }
        checked.traced = optics::at_wavelength<double>(*checked.lens, checked.wavelength_nm);
        checked.paraxial = optics::paraxial_data(*checked.traced);
    } catch (const InputError& error) {
        checked.why_not_traced = error.what();
        checked.lens.reset();
        checked.traced.reset();
    }
}

}  // namespace

std::optional<optics::Glass> stated_glass(const optics::PrescribedSurface& row, const optics::GlassCatalogue& glasses,
                                          const std::vector<std::string>& preferred_makers) {
    optics::PrescribedSurface sound = row;
    if (!(row.medium.V_d.value_or(1.0) > 0.0)) {
        sound.medium.V_d.reset();  // no dispersion can be made of it, but the index stands
    }
    try {
        return optics::resolved_medium(sound, glasses, preferred_makers);
    } catch (const InputError&) {
        return std::nullopt;
    }
}

optics::TraceLens<double> paraxial_lens(const ParaxialTable& table) {
    optics::TraceLens<double> lens{.surfaces = {}, .image_z = 0.0};
    lens.surfaces.reserve(table.curvature.size());
    double index_before = table.index_in_front;
    double z = 0.0;
    for (std::size_t i = 0; i < table.curvature.size(); ++i) {
        lens.surfaces.push_back(
            optics::make_trace_surface(table.curvature[i], z, kInfinity, index_before, table.index[i], false));
        if (table.thin_power[i] != 0.0) {
            lens.surfaces.back().special = static_cast<int>(lens.specials.size());
            lens.specials.push_back({.thin = {.kind = optics::ThinKind::ideal_lens, .power = table.thin_power[i]}});
        }
        index_before = table.index[i];
        z += table.gap[i];
    }
    lens.image_z = z;
    return lens;
}

Focus paraxial_focus(const ParaxialTable& table, double object_distance_mm) {
    const optics::TraceLens<double> lens = paraxial_lens(table);
    const optics::ParaxialRay rear =
        optics::trace_paraxial(lens, {1.0, 0.0}, 0, static_cast<int>(lens.surfaces.size()) - 1);
    return {.efl = -std::copysign(1.0, table.index.back()) / rear.slope,
            .bfl = -rear.height / rear.slope,
            .image_distance = optics::paraxial_image_distance(lens, object_distance_mm)};
}

bool CheckedLens::is_dummy(int i) const {
    return table.index[i] == index_before(i) && !row(i).is_thin_element();
}

bool CheckedLens::has_virtual_image() const {
    constexpr double kSamePlace = 0.005;  // of the focal length, as a back focus may be off without a warning
    if (!focus || !std::isfinite(focus->efl)) {
        return false;
    }
    const double stated = stated_image_distance();
    const double image = headings.back() * focus->image_distance;
    return stated < 0.0 && image < 0.0 &&
           (is_at_best_focus || std::abs(stated - image) < kSamePlace * std::abs(focus->efl));
}

bool CheckedLens::collimates() const {
    constexpr double kFar = 1e3;  // focal lengths
    return focus && std::isfinite(prescription.object_distance_mm) &&
           !(std::abs(focus->image_distance) < kFar * std::abs(focus->efl));
}

bool CheckedLens::is_single_element() const {
    int elements = 0;
    for (int i = 0; i < size(); ++i) {
        const bool has_power = !row(i).is_flat() || (i + 1 < size() && !row(i + 1).is_flat());
        elements += row(i).is_mirror || (is_glass_behind(i) && has_power) ? 1 : 0;
    }
    return elements == 1 && !prescription.has_thin_elements();
}

int CheckedLens::leading_dummies() const {
    int count = 0;
    while (count + 1 < size() && is_dummy(count) && !row(count).is_stop) {
        ++count;
    }
    return count;
}

CheckedLens make_checked_lens(const optics::Prescription& at_one_position, const optics::StatedData& claims,
                              const optics::GlassCatalogue& glasses, const CheckSettings& settings) {
    CheckedLens checked;
    checked.prescription = at_one_position;
    checked.claims = at_one_position.stated;
    optics::take_claims(checked.claims, claims);  // from outside: before what the file says
    checked.settings = settings;
    checked.wavelength_nm = settings.wavelength_nm.value_or(at_one_position.reference_wavelength_nm());
    checked.known_glasses = &glasses;
    trace_if_possible(checked);
    checked.table.index_in_front = checked.traced ? checked.traced->surfaces.front().index_before : 1.0;
    bool is_known = checked.traced || at_one_position.object_medium.is_air();
    double heading = 1.0;
    for (int i = 0; i < checked.size(); ++i) {
        const optics::PrescribedSurface& row = checked.row(i);
        checked.media.push_back(stated_glass(row, glasses, at_one_position.preferred_makers));
        checked.table.curvature.push_back(row.curvature() + 2.0 * row.asphere[0]);
        checked.table.gap.push_back(row.thickness_mm);
        checked.table.thin_power.push_back(optics::thin_element(row, checked.wavelength_nm).first_order_power());
        heading = row.is_mirror ? -heading : heading;
        checked.headings.push_back(heading);
        // The traced lens knows of its surroundings, too.
        checked.table.index.push_back(checked.traced ? checked.traced->surfaces[i].index_after
                                                     : heading * index_behind(row, checked.media.back(),
                                                                              settings.indices, checked.wavelength_nm));
        const bool is_last = i + 1 == checked.size();
        is_known = is_known && std::isfinite(checked.table.curvature.back() + checked.table.thin_power.back()) &&
                   std::isfinite(checked.table.index.back()) && heading * checked.table.index.back() > 0.0 &&
                   (std::isfinite(row.thickness_mm) || is_last);
    }
    const bool has_grating = std::ranges::any_of(at_one_position.surfaces, [](const optics::PrescribedSurface& row) {
        return row.phase && row.phase->lines_per_mm != 0.0;
    });
    if (is_known && !has_grating) {  // which turns the axis
        checked.focus = paraxial_focus(checked.table, at_one_position.object_distance_mm);
    }
    for (int i = 0; i < checked.size(); ++i) {
        const optics::PrescribedSurface& row = checked.row(i);
        const bool is_stated = row.semi_diameter_mm || row.rim_mm;
        const double estimate = checked.lens ? checked.lens->surfaces[i].semi_diameter : kNaN;
        checked.semi_diameters.push_back(row.semi_diameter_mm.value_or(row.rim_mm.value_or(estimate)));
        checked.is_estimated.push_back(!is_stated);
    }
    checked.is_at_best_focus = stands_at_best_focus(checked);
    return checked;
}

}  // namespace lensproof::check
