#include "engine/check/checker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/check/checks.h"

namespace lensproof::check {

namespace {

bool is_error(const optics::Finding& finding) {
    return finding.severity == error;
}

/// What could not be judged for want of a lens that rays can be traced through.
void report_untraced(const CheckedLens& checked, Findings& findings) {
    if (checked.lens) {
        return;
    }
    const bool is_explained = std::ranges::any_of(findings, is_error);
    findings.push_back(
        {is_explained ? "not-judged" : "not-traceable", is_explained ? info : error, 0,
         (is_explained ? "no ray was traced, so nothing is said about rays: " : "the lens cannot be traced: ") +
             checked.why_not_traced});
}

/// What rays could be traced for and are not: the axial beam and the field are followed in lenses of revolution only,
/// the field from infinity only.
void report_rays_not_asked(const CheckedLens& checked, Findings& findings) {
    if (!checked.traced) {
        return;
    }
    const double object = checked.prescription.object_distance_mm;
    const bool claims_field = checked.claims.half_field_deg || checked.claims.image_circle_mm;
    if (!checked.prescription.is_rotationally_symmetric()) {
        findings.push_back(
            {"not-judged", info, 0,
             "a surface is tilted, shifted, toroidal or ruled, so no ray was traced: nothing is said about the "
             "axial beam, its focus and colour, nor about the field"});
    } else if (std::isfinite(object) && claims_field) {
        findings.push_back({"not-judged", info, 0,
                            fmt::format("the table is set to an object {} mm away, and the field is judged from "
                                        "infinity only: nothing is said about the stated field and image circle",
                                        object)});
    }
}

Findings check_position(const CheckedLens& checked) {
    Findings findings;
    check_table(checked, findings);
    check_geometry(checked, findings);
    check_glasses(checked, findings);
    check_first_order(checked, findings);
    const bool refracts_alone = !checked.prescription.has_mirrors() && !checked.prescription.has_thin_elements() &&
                                checked.prescription.object_medium.is_air();
    if (refracts_alone) {
        check_conventions(checked, findings);
    }
    check_axial_rays(checked, findings);
    check_field_rays(checked, findings);
    if (refracts_alone) {
        suggest_changes(checked, findings);
    }
    report_untraced(checked, findings);
    report_rays_not_asked(checked, findings);
    std::ranges::stable_sort(
        findings, [](const optics::Finding& a, const optics::Finding& b) { return a.severity > b.severity; });
    return findings;
}

bool is_same(const optics::Finding& a, const optics::Finding& b) {
    return a.code == b.code && a.severity == b.severity && a.surface == b.surface && a.message == b.message;
}

bool holds(const Findings& findings, const optics::Finding& wanted) {
    return std::ranges::any_of(findings, [&](const optics::Finding& finding) { return is_same(finding, wanted); });
}

std::optional<ComputedData> computed_data(const CheckedLens& checked, std::string position) {
    if (!checked.focus) {
        return std::nullopt;
    }
    optics::ParaxialData paraxial = checked.paraxial.value_or(optics::ParaxialData{});
    if (!checked.paraxial || checked.assumed_stop) {
        // What a stop is needed for is not known.
        paraxial.entrance_pupil_z = paraxial.entrance_pupil_diameter = kNaN;
        paraxial.exit_pupil_z = paraxial.exit_pupil_diameter = paraxial.f_number = kNaN;
    }
    if (!checked.paraxial) {
        paraxial.ffl = kNaN;
    }
    paraxial.efl = checked.focus->efl;
    paraxial.bfl = checked.focus->bfl;
    return ComputedData{
        .zoom_position = std::move(position), .paraxial = paraxial, .wavelength_nm = checked.wavelength_nm};
}

}  // namespace

bool CheckReport::ok() const {
    return std::ranges::none_of(findings, is_error);
}

ReportSection CheckReport::section(std::size_t i) const {
    if (i < remarks) {
        return ReportSection::file;
    }
    return is_custom_of_manufacture(findings[i]) ? ReportSection::manufacture : ReportSection::lens;
}

CheckReport check_prescription(const optics::Prescription& prescription, const optics::StatedData& claims,
                               const optics::GlassCatalogue& glasses, const CheckSettings& settings) {
    CheckReport report{.findings = prescription.remarks, .computed = {}, .remarks = prescription.remarks.size()};
    if (prescription.surfaces.empty()) {
        report.findings.push_back({"no-surface", error, 0, "the prescription holds no surface"});
        return report;
    }
    if (std::ranges::any_of(report.findings, is_error)) {
        // Numbers of another lens than the file's would only mislead.
        report.findings.push_back(
            {"not-judged", info, 0, "the file holds surfaces that are not traced here, so the rest is not judged"});
        return report;
    }
    const std::size_t count = std::max<std::size_t>(1, prescription.zoom.size());
    std::vector<std::pair<std::string, Findings>> positions;
    for (std::size_t position = 0; position < count; ++position) {
        if (settings.zoom_position && *settings.zoom_position != position) {
            continue;
        }
        const CheckedLens checked =
            make_checked_lens(optics::at_zoom_position(prescription, position), claims, glasses, settings);
        const std::string name = prescription.zoom.empty() ? "" : prescription.zoom[position].name;
        positions.emplace_back(name, check_position(checked));
        if (std::optional<ComputedData> computed = computed_data(checked, name)) {
            report.computed.push_back(*computed);
        }
    }
    for (const auto& [name, findings] : positions) {
        for (const optics::Finding& finding : findings) {
            // What holds at every position is said once.
            const bool everywhere =
                std::ranges::all_of(positions, [&](const auto& other) { return holds(other.second, finding); });
            if (everywhere && holds(report.findings, finding)) {
                continue;
            }
            report.findings.push_back(finding);
            if (!everywhere && !name.empty()) {
                report.findings.back().message = fmt::format("at {}: {}", name, finding.message);
            }
        }
    }
    return report;
}

}  // namespace lensproof::check
