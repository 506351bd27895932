#include "experiments/cli/analysis_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/angle.h"
#include "engine/base/json.h"
#include "engine/base/visible.h"
#include "experiments/cli/command.h"
#include "experiments/cli/findings_text.h"

namespace lensproof::cli {

namespace {
constexpr double kMicrometre = 1e-3;  // in mm

Json optional_json(const std::optional<double>& value, double unit = 1.0) {
    return value ? *value / unit + 0.0 : Json(nullptr);
}

Json paraxial_json(const optics::ParaxialData& data) {
    return {{"efl_mm", data.efl},
            {"bfl_mm", data.bfl},
            {"ffl_mm", data.ffl},
            {"entrance_pupil_z_mm", data.entrance_pupil_z},
            {"entrance_pupil_diameter_mm", data.entrance_pupil_diameter},
            {"exit_pupil_z_mm", data.exit_pupil_z},
            {"exit_pupil_diameter_mm", data.exit_pupil_diameter},
            {"f_number", data.f_number},
            {"front_principal_z_mm", data.front_principal_z},
            {"rear_principal_z_mm", data.rear_principal_z},
            {"front_nodal_z_mm", data.front_nodal_z},
            {"rear_nodal_z_mm", data.rear_nodal_z},
            {"petzval_radius_mm", data.petzval_radius}};
}

Json ray_surfaces_json(const optics::Lens& lens, const analysis::LensAnalysis& analysis) {
    Json surfaces = Json::list();
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        Json row{{"surface", i + 1}};
        for (const auto& [name, ray] :
             {std::pair{"marginal_ray_", &analysis.marginal_ray}, {"chief_ray_", &analysis.chief_ray}}) {
            const auto value = [&, rays = ray](double analysis::RayAtSurface::*member) {
                return rays->empty() ? Json(nullptr) : Json((*rays)[i].*member + 0.0);
            };
            row[std::string(name) + "height_mm"] = value(&analysis::RayAtSurface::height);
            row[std::string(name) + "slope"] = value(&analysis::RayAtSurface::slope);
            row[std::string(name) + "incidence"] = value(&analysis::RayAtSurface::incidence);
        }
        surfaces.push_back(std::move(row));
    }
    return surfaces;
}

Json reference_json(const optics::Lens& lens, const analysis::LensAnalysis& analysis) {
    Json json = paraxial_json(analysis.reference_paraxial);
    json["total_track_mm"] = lens.image_z - lens.surfaces.front().vertex_z;
    json["lagrange_invariant_mm"] = optional_json(analysis.lagrange_invariant);
    json["image_plane_mm"] = lens.image_z - lens.last_vertex_z();
    json["image_distance_mm"] = analysis.conjugates.image_distance;
    json["magnification"] = analysis.conjugates.magnification;
    json["working_f_number"] = analysis.conjugates.working_f_number;
    json["real_working_f_number"] = analysis.real_working_f_number;
    json["surfaces"] = ray_surfaces_json(lens, analysis);
    return json;
}

Json terms_json(const analysis::SeidelTerms<double>& terms) {
    return {{"s1", terms.s1}, {"s2", terms.s2}, {"s3", terms.s3}, {"s4", terms.s4},
            {"s5", terms.s5}, {"c1", terms.c1}, {"c2", terms.c2}};
}

/// Third-order theory has no place for an odd power of r.
bool has_odd_terms(const optics::Lens& lens) {
    return std::ranges::any_of(lens.surfaces, [](const auto& surface) { return surface.shape.odd_terms > 0; });
}

/// Those of the lens, what its gratings leave open, and where light does not come to its image plane.
std::vector<optics::Finding> findings_of(const optics::Lens& lens) {
    std::vector<optics::Finding> findings = lens.findings;
    const double behind = lens.final_heading() * (lens.image_z - lens.last_vertex_z());
    if (behind < -optics::kGapRounding) {
        findings.push_back({"virtual-image", optics::Severity::warning, static_cast<int>(lens.surfaces.size()),
                            fmt::format("the image plane lies {:.7g} mm in front of the last surface: rays are "
                                        "prolonged backwards to it",
                                        -behind)});
    }
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        if (lens.surfaces[i].is_grating()) {
            findings.push_back({"grating", optics::Severity::info, static_cast<int>(i) + 1,
                                "a grating turns the axis, each colour's by another angle: first-order data leave that "
                                "turn out, fields count from the axis in front of the lens, heights from the first "
                                "surface's, and there are no Seidel sums and no distortion"});
        }
    }
    return findings;
}

Json seidel_json(const optics::Lens& lens, const std::optional<analysis::SeidelSums<double>>& sums) {
    if (!sums) {
        return nullptr;
    }
    Json surfaces = Json::list();
    for (std::size_t i = 0; i < sums->surfaces.size(); ++i) {
        Json row{{"surface", i + 1}};
        const Json terms = terms_json(sums->surfaces[i]);
        for (const auto& [key, value] : terms.members()) {
            row[key] = value;
        }
        surfaces.push_back(std::move(row));
    }
    Json json{{"surfaces", std::move(surfaces)}, {"total", terms_json(sums->total)}};
    if (has_odd_terms(lens)) {
        json["without_odd_terms"] = true;
    }
    return json;
}

Json field_json(const analysis::FieldAnalysis& row) {
    return {
        {"field_deg", row.field_deg},
        {"wavelength_nm", row.wavelength_nm},
        {"status", optics::status_name(row.status)},
        {"surface", row.surface >= 0 && row.status != optics::RayStatus::ok ? Json(row.surface + 1) : Json(nullptr)},
        {"chief_ray_height_mm", row.chief_ray_point ? row.chief_ray_point->y + 0.0 : Json(nullptr)},
        {"chief_ray_x_mm", row.chief_ray_point ? row.chief_ray_point->x + 0.0 : Json(nullptr)},
        {"distortion_percent", optional_json(row.distortion_percent)},
        {"distortion_plane", "paraxial"},
        {"tangential_focus_mm", optional_json(row.tangential_focus)},
        {"sagittal_focus_mm", optional_json(row.sagittal_focus)},
        {"relative_illumination", optional_json(row.relative_illumination)},
        {"vignetting", optional_json(row.vignetting)},
        {"transmittance", optional_json(row.transmittance)},
        {"spot_rms_um", optional_json(row.spot_rms, kMicrometre)},
        {"spot_centroid_mm", row.spot_centroid ? Json{row.spot_centroid->x, row.spot_centroid->y} : Json(nullptr)},
        {"wavefront_rms_waves", optional_json(row.wavefront_rms_waves)},
        {"lateral_colour_um", optional_json(row.lateral_colour, kMicrometre)}};
}

/// A cell of a table, a dash where there is nothing.
std::string cell(const std::optional<double>& value, int width, int digits) {
    // Adding 0 makes a 0 of −0.
    if (!value || !std::isfinite(*value)) {
        return fmt::format("{:>{}}", "-", width);
    }
    const std::string text = fmt::format(" {:.{}f}", *value + 0.0, digits);
    return fmt::format("{:>{}}", static_cast<int>(text.size()) > width ? fmt::format(" {:.3g}", *value) : text, width);
}

std::string paraxial_text(const optics::Lens& lens, const analysis::LensAnalysis& analysis) {
    const optics::ParaxialData& data = analysis.reference_paraxial;
    std::string text;
    const auto line = [&](const char* name, const std::optional<double>& value, const char* unit) {
        text += fmt::format("  {:<26}{} {}\n", name, cell(value, 14, 5), unit);
    };
    line("focal length", data.efl, "mm");
    line("back focus", data.bfl, "mm");
    line("front focus", data.ffl, "mm");
    line("front principal point", data.front_principal_z, "mm");
    line("rear principal point", data.rear_principal_z, "mm");
    line("entrance pupil", data.entrance_pupil_z, "mm");
    line("  diameter", data.entrance_pupil_diameter, "mm");
    line("exit pupil", data.exit_pupil_z, "mm");
    line("  diameter", data.exit_pupil_diameter, "mm");
    line("f-number", data.f_number, "");
    line("working f-number", analysis.conjugates.working_f_number, "");
    line("  of real rays", analysis.real_working_f_number, "");
    line("magnification", analysis.conjugates.magnification, "");
    line("image plane", lens.image_z - lens.last_vertex_z(), "mm");
    line("  paraxial image", analysis.conjugates.image_distance, "mm");
    line("total track", lens.image_z - lens.surfaces.front().vertex_z, "mm");
    line("Petzval radius", data.petzval_radius, "mm");
    line("Lagrange invariant", analysis.lagrange_invariant, "mm");
    return text;
}

std::string ray_surfaces_text(const optics::Lens& lens, const analysis::LensAnalysis& analysis) {
    std::string text = fmt::format("  {:>7}{:>36}{:>36}\n  {:>7}", "", "marginal ray", "chief ray", "surface");
    for (int ray = 0; ray < 2; ++ray) {
        text += fmt::format("{:>12}{:>12}{:>12}", "height mm", "slope", "incidence");
    }
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        text += fmt::format("\n  {:>7}", i + 1);
        for (const std::vector<analysis::RayAtSurface>* ray : {&analysis.marginal_ray, &analysis.chief_ray}) {
            const auto column = [&](double analysis::RayAtSurface::*member) {
                return cell(ray->empty() ? std::nullopt : std::optional((*ray)[i].*member), 12, 6);
            };
            text += column(&analysis::RayAtSurface::height) + column(&analysis::RayAtSurface::slope) +
                    column(&analysis::RayAtSurface::incidence);
        }
    }
    return text + "\n";
}

std::string seidel_text(const analysis::SeidelSums<double>& sums) {
    std::string text = fmt::format("  {:>7}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "surface", "S1", "S2", "S3",
                                   "S4", "S5", "C1", "C2");
    const auto row = [&](const std::string& name, const analysis::SeidelTerms<double>& t) {
        text += fmt::format("  {:>7}{}{}{}{}{}{}{}\n", name, cell(t.s1, 12, 6), cell(t.s2, 12, 6), cell(t.s3, 12, 6),
                            cell(t.s4, 12, 6), cell(t.s5, 12, 6), cell(t.c1, 12, 6), cell(t.c2, 12, 6));
    };
    for (std::size_t i = 0; i < sums.surfaces.size(); ++i) {
        row(std::to_string(i + 1), sums.surfaces[i]);
    }
    row("sum", sums.total);
    return text;
}

std::string fields_text(const std::vector<analysis::FieldAnalysis>& fields) {
    std::string text = fmt::format("  {:>8}{:>10}{:>11}{:>10}{:>10}{:>10}{:>8}{:>8}{:>10}{:>10}{:>10}  {}\n", "field",
                                   "nm", "height", "distort.", "T focus", "S focus", "illum.", "vign.", "spot rms",
                                   "wave rms", "lat. col.", "chief ray");
    text += fmt::format("  {:>8}{:>10}{:>11}{:>10}{:>10}{:>10}{:>8}{:>8}{:>10}{:>10}{:>10}\n", "deg", "", "mm", "%",
                        "mm", "mm", "", "", "um", "waves", "um");
    for (const analysis::FieldAnalysis& row : fields) {
        const auto in_um = [](const std::optional<double>& mm) {
            return mm ? std::optional(*mm / kMicrometre) : std::nullopt;
        };
        text += fmt::format("  {:8.3f}{:10.4f}", row.field_deg, row.wavelength_nm);
        text += cell(row.chief_ray_point ? std::optional(row.chief_ray_point->y) : std::nullopt, 11, 5) +
                cell(row.distortion_percent, 10, 4) + cell(row.tangential_focus, 10, 4) +
                cell(row.sagittal_focus, 10, 4) + cell(row.relative_illumination, 8, 4) + cell(row.vignetting, 8, 4) +
                cell(in_um(row.spot_rms), 10, 3) + cell(row.wavefront_rms_waves, 10, 4) +
                cell(in_um(row.lateral_colour), 10, 3);
        text += row.status == optics::RayStatus::ok ? "  ok\n"
                : row.surface >= 0
                    ? fmt::format("  {} at surface {}\n", optics::status_name(row.status), row.surface + 1)
                    : fmt::format("  {}\n", optics::status_name(row.status));
    }
    return text;
}

}  // namespace

Json analysis_json(const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                   const analysis::LensAnalysis& analysis) {
    Json json{{"lens", lens.id},
              {"name", lens.name},
              {"reference_wavelength_nm", settings.reference_wavelength_nm},
              {"object_distance_mm", settings.object_distance},
              {"projection", optics::projection_name(lens.projection)},
              {"findings", findings_json(findings_of(lens))},
              {"paraxial", reference_json(lens, analysis)},
              {"seidel", seidel_json(lens, analysis.seidel)},
              {"fields", Json::list()},
              {"wavelengths", Json::list()}};
    for (const analysis::FieldAnalysis& row : analysis.fields) {
        json["fields"].push_back(field_json(row));
    }
    for (std::size_t i = 0; i < settings.wavelengths_nm.size(); ++i) {
        json["wavelengths"].push_back(
            {{"wavelength_nm", settings.wavelengths_nm[i]}, {"paraxial", paraxial_json(analysis.paraxial[i])}});
    }
    return json;
}

std::string analysis_text(const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                          const analysis::LensAnalysis& analysis) {
    std::string text = visible_in_line(lens.name) + "\n";
    text += findings_text(findings_of(lens));
    text += fmt::format(
        "At {:.7g} nm, object at {}:\n", settings.reference_wavelength_nm,
        std::isinf(settings.object_distance) ? "infinity" : fmt::format("{:.7g} mm", settings.object_distance));
    text += paraxial_text(lens, analysis);
    const double largest = analysis::largest_field_deg(settings);
    text += fmt::format("Paraxial rays, the chief ray for {:.4g} deg, slopes behind the surfaces:\n", largest) +
            ray_surfaces_text(lens, analysis);
    if (analysis.seidel) {
        text += fmt::format("Seidel sums for {:.4g} deg, mm{}:\n", largest,
                            has_odd_terms(lens) ? ", without the odd aspheric terms" : "") +
                seidel_text(*analysis.seidel);
    } else {
        text +=
            lens.has_kinoforms()
                ? fmt::format("No Seidel sums: none are known of {}\n", lens.has_gratings() ? "gratings" : "kinoforms")
                : fmt::format("No Seidel sums: paraxial rays have no field of {:.4g} deg\n", largest);
    }
    text += "Fields:\n" + fields_text(analysis.fields);
    return text;
}

Json veiling_glare_json(const analysis::VeilingGlare& glare) {
    constexpr double kPercent = 0.01;
    Json json{{"index_percent", glare.index.fraction / kPercent},
              {"standard_error_percent", glare.index.standard_error / kPercent},
              {"ghosts_percent", glare.ghosts.fraction / kPercent},
              {"barrel_percent", glare.barrel.fraction / kPercent},
              {"blur_percent", glare.blur.fraction / kPercent},
              {"spot_diameter_deg", 2.0 * glare.spot_angle / kDegree}};
    if (const auto& polarised = glare.polarised) {
        json["polarised"] = {{"index_percent", polarised->index.fraction / kPercent},
                             {"standard_error_percent", polarised->index.standard_error / kPercent},
                             {"ghosts_percent", polarised->ghosts.fraction / kPercent},
                             {"barrel_percent", polarised->barrel.fraction / kPercent},
                             {"blur_percent", polarised->blur.fraction / kPercent},
                             {"difference_percent", polarised->difference.fraction / kPercent},
                             {"difference_standard_error_percent", polarised->difference.standard_error / kPercent}};
    }
    return json;
}

std::string veiling_glare_text(const analysis::VeilingGlare& glare) {
    std::string text = fmt::format(
        "Veiling glare index: {:.3f} +- {:.3f} % (ghosts {:.3f}, barrel {:.3f}, blur {:.3f}), of a black "
        "spot of {:.2f} deg at the middle of an even half space\n",
        100.0 * glare.index.fraction, 100.0 * glare.index.standard_error, 100.0 * glare.ghosts.fraction,
        100.0 * glare.barrel.fraction, 100.0 * glare.blur.fraction, 2.0 * glare.spot_angle / kDegree);
    if (const auto& polarised = glare.polarised) {
        text += fmt::format(
            "With polarisation carried along its paths: {:.3f} %, that is {:+.4f} +- {:.4f} % (ghosts {:.3f}, barrel "
            "{:.3f}, blur {:.3f})\n",
            100.0 * polarised->index.fraction, 100.0 * polarised->difference.fraction,
            100.0 * polarised->difference.standard_error, 100.0 * polarised->ghosts.fraction,
            100.0 * polarised->barrel.fraction, 100.0 * polarised->blur.fraction);
    }
    return text;
}

}  // namespace lensproof::cli
