// Real rays of the axial beam: whether they pass, what limits them, and whether they meet.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/check/checks.h"
#include "engine/check/rays.h"

namespace lensproof::check {

namespace {

constexpr double kRimLimits = 0.999;  // of the stop's beam: a rim that cuts less than this is the stop's equal
// A rim that cuts more of the beam's height than that: one of 49 products, whose semi-diameters are a transcriber's,
// and one of the 42 tables beside them.
constexpr double kNarrowRim = 0.88;
constexpr double kShortBeam = 0.95;  // of the paraxial beam: what fails beyond it is the beam's edge
// The blur of the axial beam at its best focus, rms, over the focal length: this project's bound. Of 49 products'
// patents 48 stay below 0.033 %, of the 28 lenses that ship 27 below 0.07 %, and the last, a fisheye, has 0.21 %: for a
// fisheye, the bound is of the picture of a half space, which is as large as a normal lens's focal length.
constexpr double kBlur = 8e-4;
constexpr double kAsphericBlur = 5e-4;  // where there are aspheres: of 27 such patents none exceeds 0.033 %
// The distance between the foci at F and C over the focal length, this project's bound: the same tables stay
// below 1.2 %, a single element of V = 60 has 1/60.
constexpr double kAxialColour = 0.015;

/// Rules 23 and 27.
void check_beam(const CheckedLens& checked, const AxialBeam& beam, Findings& findings) {
    const double paraxial = paraxial_beam(checked).height;
    if (beam.height <= 0.0) {
        findings.push_back({"marginal-ray", error, beam.limit.surface + 1,
                            fmt::format("not even a ray near the axis passes: {}", words(beam.limit)), 0.0, paraxial,
                            "mm"});
        return;
    }
    const bool is_broken = beam.limit.status == optics::RayStatus::missed ||
                           beam.limit.status == optics::RayStatus::total_internal_reflection || beam.limit.is_backwards;
    if (is_broken) {
        findings.push_back(
            {"marginal-ray", beam.height < kShortBeam * paraxial ? error : warning, beam.limit.surface + 1,
             fmt::format("the axial beam ends {:.4g} mm from the axis, where the stop would let {:.4g} mm pass: {}",
                         beam.height, paraxial, words(beam.limit)),
             beam.height, paraxial, "mm"});
        return;
    }
    if (beam.limit.status != optics::RayStatus::clipped) {
        return;
    }
    const double of_stop = stop_limited_beam(checked).height;
    const double real_f_number = 0.5 / std::max(1e-12, beam.exit_sine);
    if (beam.height < kRimLimits * of_stop) {
        findings.push_back({"stop-not-limiting", beam.height < kNarrowRim * of_stop ? warning : info,
                            beam.limit.surface + 1,
                            fmt::format("its rim cuts the axial beam to {:.4g} mm, where the stop lets {:.4g} mm pass: "
                                        "f/{:.2f} by real rays, f/{:.2f} by the stop",
                                        beam.height, of_stop, real_f_number, paraxial_beam(checked).f_number),
                            beam.height, of_stop, "mm"});
    }
}

/// Beside rule 22: where pupil aberration parts the real f-number from the paraxial one, both of the object that the
/// table is set to.
void report_real_f_number(const CheckedLens& checked, const AxialBeam& beam, Findings& findings) {
    const double real = 0.5 / beam.exit_sine;
    const double paraxial = paraxial_beam(checked).f_number;
    constexpr double kWorthSaying = 0.02;
    if (beam.height > 0.0 && !checked.collimates() && std::isfinite(real) &&
        std::abs(real / paraxial - 1.0) > kWorthSaying) {
        findings.push_back(
            {"real-f-number", info, 0,
             fmt::format("the axial beam's real f-number is {:.3f}, the paraxial one {:.3f}", real, paraxial), real,
             paraxial});
    }
}

bool is_spherical(const CheckedLens& checked) {
    return std::ranges::none_of(checked.prescription.surfaces, [](const optics::PrescribedSurface& row) {
        return row.is_asphere() || row.conic != 0.0;
    });
}

/// A number that is wrong mostly shows in the image before anything else: rays that should meet do not.
void check_blur(const CheckedLens& checked, const AxialBeam& beam, Findings& findings) {
    if (beam.height <= 0.0 || checked.collimates()) {
        return;
    }
    const AxialSpread spread = axial_spread(checked, beam.height);
    const double blur = spread.at(spread.best_z()) / std::abs(checked.focus->efl);
    const optics::Projection projection = checked.prescription.projection;
    const bool is_aspheric = std::ranges::any_of(checked.prescription.surfaces, &optics::PrescribedSurface::is_asphere);
    const double bound = is_aspheric ? kAsphericBlur : kBlur;
    const double limit = projection == optics::Projection::rectilinear
                             ? bound
                             : 2.0 * optics::projected_radius(projection, 90.0 * kDegree) * bound;
    if (blur > limit) {
        const bool is_natural = checked.is_single_element() && is_spherical(checked);
        findings.push_back({"blur", is_natural ? info : warning, 0,
                            fmt::format("the axial beam does not come to a focus: at its best its rays lie {:.2g} % of "
                                        "the focal length apart (rms){}",
                                        100.0 * blur, is_natural ? ", as those of a single spherical element do" : ""),
                            100.0 * blur, 100.0 * limit, "%"});
    }
}

void check_axial_colour(const CheckedLens& checked, Findings& findings) {
    const bool is_chromatic = std::ranges::all_of(checked.media, [](const std::optional<optics::Glass>& glass) {
        return glass && optics::covers(*glass, spectral::kLineF) && optics::covers(*glass, spectral::kLineC);
    });
    const bool has_constant = std::ranges::any_of(checked.media, [](const std::optional<optics::Glass>& glass) {
        return glass && glass->name != "air" && std::holds_alternative<optics::ConstantIndex>(glass->formula);
    });
    if (!is_chromatic || has_constant || !checked.settings.indices.empty()) {
        return;
    }
    const auto focus_at = [&](double wavelength) {
        ParaxialTable table = checked.table;
        for (int i = 0; i < checked.size(); ++i) {
            table.index[i] = optics::refractive_index(checked.media[i]->formula, wavelength);
        }
        return paraxial_focus(table, kInfinity).bfl;
    };
    const double apart = (focus_at(spectral::kLineF) - focus_at(spectral::kLineC)) / checked.focus->efl;
    if (std::abs(apart) > kAxialColour) {
        const bool is_natural = checked.is_single_element();
        findings.push_back(
            {"axial-colour", is_natural ? info : warning, 0,
             fmt::format("blue (F) and red (C) focus {:.2g} % of the focal length apart: {}", 100.0 * apart,
                         is_natural ? "a single element's colour" : "not a colour-corrected lens, or a glass is wrong"),
             100.0 * apart, 100.0 * kAxialColour, "%"});
    }
}

}  // namespace

void check_axial_rays(const CheckedLens& checked, Findings& findings) {
    if (!checked.traced || !checked.focus || !checked.prescription.is_rotationally_symmetric()) {
        return;
    }
    const AxialBeam beam = axial_beam(checked);
    check_beam(checked, beam, findings);
    report_real_f_number(checked, beam, findings);
    check_blur(checked, beam, findings);
    check_axial_colour(checked, findings);
}

}  // namespace lensproof::check
