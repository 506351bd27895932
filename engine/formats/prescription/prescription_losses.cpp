#include "engine/formats/prescription/prescription_losses.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::formats {

optics::Finding lost(const std::string& code, optics::Severity severity, int surface, const std::string& message) {
    return {code, severity, surface, message};
}

optics::Prescription single_position(const optics::Prescription& prescription,
                                     std::vector<optics::Finding>& lost_here) {
    if (prescription.zoom.empty()) {
        return prescription;
    }
    lost_here.push_back(lost("lost-zoom", optics::Severity::warning, 0,
                             fmt::format("one of {} zoom positions is written, \"{}\"; the others are left out",
                                         prescription.zoom.size(), prescription.zoom.front().name)));
    return optics::at_zoom_position(prescription, 0);
}

std::optional<double> plain_semi_diameter(const optics::Prescription& prescription, std::size_t index) {
    const optics::PrescribedSurface& row = prescription.surfaces[index];
    std::optional<double> narrowest = row.semi_diameter_mm ? row.semi_diameter_mm : row.rim_mm;
    const auto narrow = [&](const std::optional<double>& barrel) {
        if (barrel && !(narrowest && *narrowest <= *barrel)) {
            narrowest = barrel;
        }
    };
    narrow(row.barrel_mm);
    if (index > 0) {
        narrow(prescription.surfaces[index - 1].barrel_mm);
    }
    return narrowest;
}

void state_rims(optics::Prescription& prescription, std::vector<optics::Finding>& lost_here) {
    std::vector<std::size_t> unstated;
    for (std::size_t i = 0; i < prescription.surfaces.size(); ++i) {
        const bool is_set =
            prescription.surfaces[i].is_stop && prescription.aperture.kind != optics::ApertureKind::stop;
        if (is_set || !plain_semi_diameter(prescription, i)) {
            unstated.push_back(i);
        }
    }
    if (unstated.empty()) {
        return;
    }
    const optics::Lens lens =
        optics::make_lens(with_stop_picture(prescription), with_own_catalogues(shipped_glasses(), prescription));
    for (const std::size_t i : unstated) {
        const double needed = lens.surfaces[i].semi_diameter;
        prescription.surfaces[i].semi_diameter_mm = needed;
        lost_here.push_back(lost("aperture-estimated", optics::Severity::info, static_cast<int>(i) + 1,
                                 fmt::format("no clear aperture is stated; written is what the aperture and the fields "
                                             "need, {:.6g} mm across",
                                             2.0 * needed)));
    }
}

namespace {

void add_surface_losses(const optics::PrescribedSurface& row, int surface, std::vector<optics::Finding>& losses) {
    const auto add = [&](const std::string& code, optics::Severity severity, const std::string& message) {
        losses.push_back(lost(code, severity, surface, message));
    };
    if (row.is_mirror) {
        throw InputError(fmt::format(
            "{} is a mirror, which a plain table of radii cannot say; convert to .toml or .zmx", row.where));
    }
    if (row.is_thin_element()) {
        throw InputError(fmt::format(
            "{} is an ideal lens, a grating or a kinoform, which a plain table of radii cannot say; convert to .toml",
            row.where));
    }
    if (row.radius_x_mm) {
        add("lost-toroid", optics::Severity::warning, "a toroid or cylinder, written as a surface of revolution");
    }
    if (row.misalignment != optics::Misalignment{}) {
        add("lost-misalignment", optics::Severity::warning, "its decentre and tilt are left out");
    }
    if (!row.coating.empty()) {
        add("lost-coating", optics::Severity::warning,
            fmt::format("its coating \"{}\" is left out: the rays stay, their transmittance changes", row.coating));
    }
    if ((row.rim_mm && row.semi_diameter_mm) || row.barrel_mm) {
        add("lost-rim", optics::Severity::info, "of rim, barrel and clear aperture, one semi-diameter is written");
    }
}

bool states_anything(const optics::StatedData& stated) {
    return std::ranges::any_of(optics::kClaims,
                               [&](const optics::Claim& claim) { return (stated.*claim.value).has_value(); });
}

}  // namespace

std::pair<double, double> figures_of_table(const optics::StatedMedium& medium) {
    optics::PrescribedSurface row;
    row.medium.indices = medium.indices;
    const optics::DispersionFormula formula = optics::resolved_medium(row, {}, {}).formula;
    const double dispersion =
        optics::refractive_index(formula, spectral::kLineF) - optics::refractive_index(formula, spectral::kLineC);
    const double n_d = optics::refractive_index(formula, spectral::kLineD);
    return {n_d, dispersion > 0.0 ? (n_d - 1.0) / dispersion : 0.0};
}

std::vector<optics::Finding> losses_of_tables(const optics::Prescription& prescription) {
    std::vector<optics::Finding> losses;
    for (std::size_t i = 0; i < prescription.surfaces.size(); ++i) {
        add_surface_losses(prescription.surfaces[i], static_cast<int>(i) + 1, losses);
    }
    const auto add = [&](bool holds, const std::string& code, optics::Severity severity, const std::string& message) {
        if (holds) {
            losses.push_back(lost(code, severity, 0, message));
        }
    };
    const bool moves = std::ranges::any_of(prescription.groups, [](const optics::MisalignedGroup& group) {
        return group.misalignment != optics::Misalignment{};
    });
    add(moves, "lost-misalignment", optics::Severity::warning, "decentred and tilted groups are written as if aligned");
    add(prescription.stop_shape.index() != 0, "lost-stop-shape", optics::Severity::warning,
        "the stop's shape is left out: a full circle is written");
    add(!prescription.barrel.is_black(), "lost-barrel", optics::Severity::info,
        "what its walls scatter is left out: the image stays, its stray light changes");
    add(!prescription.focus_groups.empty(), "lost-focus-groups", optics::Severity::warning,
        "which groups move to focus is left out");
    add(prescription.surroundings == optics::Surroundings::vacuum, "lost-surroundings", optics::Severity::warning,
        "that the lens is in vacuum is left out");
    add(!prescription.catalogues.empty() || !prescription.enclosed_glasses.empty() ||
            !prescription.preferred_makers.empty(),
        "lost-catalogues", optics::Severity::warning,
        "the lens's own glass catalogues and preferred makers are left out");
    add(prescription.projection != optics::Projection::rectilinear, "lost-projection", optics::Severity::info,
        fmt::format("the {} projection that the lens is meant to have is left out",
                    optics::projection_name(prescription.projection)));
    add(states_anything(prescription.stated), "lost-stated", optics::Severity::info,
        "what the source states of the whole lens is left out");
    add(prescription.object_distance_mm != kInfinity, "lost-object-distance", optics::Severity::info,
        fmt::format("the object's distance, {} mm, is left out", prescription.object_distance_mm));
    add(!prescription.fields.points.empty(), "lost-fields", optics::Severity::info, "the design's fields are left out");
    add(!prescription.object_medium.is_air(), "lost-object-medium", optics::Severity::warning,
        "that the object does not lie in air is left out");
    add(!prescription.wavelengths_nm.empty(), "lost-wavelengths", optics::Severity::info,
        "the wavelengths are left out");
    return losses;
}

}  // namespace lensproof::formats
