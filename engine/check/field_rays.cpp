// Real rays at the claimed field: the chief ray, what the rims leave of the beam, and where it lands.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/check/checks.h"
#include "engine/check/rays.h"
#include "engine/check/sag.h"
#include "engine/optics/chief_ray.h"

namespace lensproof::check {

namespace {

// Rule 28: of the axial beam's area. The two Nikkor fisheyes have 0.21 and 0.23 at 90°.
constexpr double kLeastTransmitted = 0.20;
constexpr double kRoundedField = 0.95;       // of the claimed field: up to there at least some light must come
constexpr double kDistortion = 0.05;         // rule 31
constexpr double kFisheyeDistortion = 0.10;  // from the projection that is claimed: this project's
constexpr double kWidestRectilinear = 80.0;  // degrees: f tan grows without bounds
constexpr double kImageCircle = 0.05;        // this project's
constexpr double kSteepIncidence = 60.0;     // degrees, rule 33
constexpr double kGrazingIncidence = 80.0;   // a fisheye of 90° has 76.9° at its front
constexpr double kBackwardsFraction = 0.01;  // of the beam that passes, below which a rim's edge explains it

/// The lens as the field is judged by: its sensor in the paraxial image, its rims as they are or wide open.
optics::Lens lens_in_focus(const CheckedLens& checked, bool with_rims) {
    optics::Lens lens = *checked.lens;
    lens.image_z = lens.last_vertex_z() + checked.focus->image_distance;
    for (optics::LensSurface& surface : lens.surfaces) {
        if (!with_rims) {
            surface.semi_diameter = kInfinity;
        }
    }
    return lens;
}

/// Where rays from the stop's centre, tilted more and more, first fail although no rim cuts them.
RayFate first_failure(const CheckedLens& checked) {
    const optics::TraceLens<double> lens = without_rims(checked, false);
    const int stop = checked.lens->stop_index();
    const optics::TraceLens<double> front{
        {lens.surfaces.begin(), lens.surfaces.begin() + stop}, lens.image_z, lens.specials};
    const optics::TraceLens<double> rear{
        {lens.surfaces.begin() + stop + 1, lens.surfaces.end()}, lens.image_z, lens.specials};
    const double z = lens.surfaces[stop].vertex_z;
    constexpr int kAngles = 900;
    for (int k = 1; k < kAngles; ++k) {
        const double angle = 90.0 * kDegree * k / kAngles;
        const Vec3d direction{0.0, std::sin(angle), std::cos(angle)};
        // Where the stop is a glass surface, the ray bends at its vertex.
        const double sine = lens.surfaces[stop].reverse_ratio * direction.y;
        if (!(sine < 1.0)) {
            return {.status = optics::RayStatus::total_internal_reflection, .surface = stop};
        }
        const Vec3d back{0.0, -sine, -std::sqrt(1.0 - sine * sine)};
        const optics::TracedRay<double> outwards =
            optics::trace<optics::Direction::reverse>(front, Ray<double>{{0.0, 0.0, z}, back});
        const optics::TracedRay<double> inwards =
            optics::trace<optics::Direction::forward>(rear, Ray<double>{{0.0, 0.0, z}, direction});
        if (stop > 0 && outwards.status != optics::RayStatus::ok) {
            return {.status = outwards.status, .surface = outwards.surface};
        }
        if (inwards.status != optics::RayStatus::ok) {
            return {.status = inwards.status, .surface = stop + 1 + inwards.surface};
        }
    }
    return {};
}

/// Rule 26. Returns the chief ray, past the rims where need be.
std::optional<optics::ChiefRay> check_chief_ray(const CheckedLens& checked, double field, Findings& findings) {
    const double wavelength = checked.wavelength_nm;
    const optics::ChiefRays rays(lens_in_focus(checked, true), wavelength);
    if (std::optional<optics::ChiefRay> chief = rays.at_field(field)) {
        return chief;
    }
    const optics::ChiefRays rays_past_rims(lens_in_focus(checked, false), wavelength);
    const std::optional<optics::ChiefRay> past_rims = rays_past_rims.at_field(field);
    if (past_rims) {
        const RayFate fate = follow(*checked.traced, past_rims->front);
        const double reached = rays.largest_field() / kDegree;
        findings.push_back(
            {"chief-ray", warning, fate.surface + 1,
             fmt::format("the chief ray of the stated field of {:.2f}° does not pass: {}; it does up to {:.2f}°",
                         field / kDegree, words(fate), reached),
             reached, field / kDegree, "deg"});
        return past_rims;
    }
    const RayFate fate = first_failure(checked);
    const double reached = std::max(0.0, rays_past_rims.largest_field()) / kDegree;
    findings.push_back(
        {"chief-ray", error, fate.passes() ? 0 : fate.surface + 1,
         fmt::format("no chief ray reaches the stated field of {:.2f}°, even past the rims: beyond {:.2f}°, {}",
                     field / kDegree, reached, fate.passes() ? "none arrives from there" : words(fate)),
         reached, field / kDegree, "deg"});
    return std::nullopt;
}

/// A beam of parallel rays sampled on a grid across it.
struct SampledBeam {
    double area = 0.0;       // mm², across the beam, of what passes
    double backwards = 0.0;  // mm², of what every rim lets through although surfaces stand in the wrong order for it
    int backwards_surface = 0;
    double largest_incidence = 0.0;  // rad, of what passes
    int steepest_surface = 0;
};

SampledBeam sample_beam(const CheckedLens& checked, double field, double centre, double half_width) {
    constexpr int kCells = 120;  // across; the beam is symmetric in x
    const Vec3d direction{0.0, std::sin(field), std::cos(field)};
    const Vec3d across{0.0, std::cos(field), -std::sin(field)};
    const double cell = 2.0 * half_width / kCells;
    SampledBeam beam;
    for (int i = 0; i < kCells / 2; ++i) {
        for (int k = 0; k < kCells; ++k) {
            const double a = (i + 0.5) * cell;
            const double b = centre - half_width + (k + 0.5) * cell;
            const RayFate fate = follow(*checked.traced, {Vec3d{a, 0.0, 0.0} + b * across, direction});
            if (fate.status == optics::RayStatus::ok && fate.is_backwards) {
                beam.backwards += 2.0 * cell * cell;
                beam.backwards_surface = fate.surface;
            }
            if (!fate.passes()) {
                continue;
            }
            beam.area += 2.0 * cell * cell;
            if (fate.largest_incidence > beam.largest_incidence) {
                beam.largest_incidence = fate.largest_incidence;
                beam.steepest_surface = fate.steepest_surface;
            }
        }
    }
    return beam;
}

/// Half the width of a window that holds the beam: of the first surface seen from the field, or some axial beams.
double window(const CheckedLens& checked, double axial_semi_diameter) {
    const double reach = checked.semi_diameters.front();
    const double depth = std::abs(sag_at(checked.row(0), reach));
    constexpr double kPupilGrowth = 3.0;
    return std::min(reach + depth, kPupilGrowth * axial_semi_diameter);
}

/// The beam of the field that the rims let pass.
SampledBeam field_beam(const CheckedLens& checked, double field, const optics::ChiefRay& chief, double axial) {
    const double centre = chief.front.origin.y * std::cos(field) - chief.front.origin.z * std::sin(field);
    return sample_beam(checked, field, centre, window(checked, axial));
}

/// Rule 28. A field that is claimed a little too wide is a warning: light has to end long before it to be an error.
void check_vignetting(const CheckedLens& checked, double field, double axial, double area, Findings& findings) {
    const double transmitted = area / (std::numbers::pi * axial * axial);
    if (transmitted >= kLeastTransmitted) {
        return;
    }
    optics::Severity severity = warning;
    if (!(transmitted > 0.0)) {
        const double within = kRoundedField * field;
        const std::optional<optics::ChiefRay> chief =
            optics::ChiefRays(lens_in_focus(checked, false), checked.wavelength_nm).at_field(within);
        const bool is_dark = !chief || !(field_beam(checked, within, *chief, axial).area > 0.0);
        severity = is_dark ? error : warning;
    }
    findings.push_back(
        {"vignetting", severity, 0,
         fmt::format("the rims leave {} of the axial beam at the stated field of {:.2f}°",
                     transmitted > 0.0 ? fmt::format("{:.1f} %", 100.0 * transmitted) : "nothing", field / kDegree),
         100.0 * transmitted, transmitted > 0.0 ? 100.0 * kLeastTransmitted : 0.0, "%"});
}

/// Rule 33, and the order of surfaces.
void check_beam(const CheckedLens& checked, double field, const std::optional<optics::ChiefRay>& chief,
                Findings& findings) {
    const double axial = axial_beam(checked).height;
    if (!(axial > 0.0) || !chief) {
        return;
    }
    const SampledBeam beam = field_beam(checked, field, *chief, axial);
    check_vignetting(checked, field, axial, beam.area, findings);
    if (beam.backwards > kBackwardsFraction * (beam.area + beam.backwards)) {
        // Rims that were estimated are no claim of the table's.
        const int there = beam.backwards_surface;
        const bool is_estimated = checked.is_estimated[there] || (there > 0 && checked.is_estimated[there - 1]);
        findings.push_back({"order-of-surfaces", is_estimated ? warning : error, there + 1,
                            fmt::format("rays of the stated field of {:.2f}° pass every rim, but would have to run "
                                        "backwards to meet surface {}",
                                        field / kDegree, there + 1),
                            100.0 * beam.backwards / (beam.area + beam.backwards), 100.0 * kBackwardsFraction, "%"});
    }
    const double incidence = beam.largest_incidence / kDegree;
    if (incidence > kSteepIncidence) {
        const bool grazing = incidence > kGrazingIncidence;
        findings.push_back({"incidence-angle", grazing ? warning : info, beam.steepest_surface + 1,
                            fmt::format("rays of the stated field meet it at up to {:.1f}°", incidence), incidence,
                            grazing ? kGrazingIncidence : kSteepIncidence, "deg"});
    }
}

/// Rule 31.
void check_distortion(const CheckedLens& checked, double field, double image_height, Findings& findings) {
    const optics::Projection projection = checked.prescription.projection;
    const bool is_rectilinear = projection == optics::Projection::rectilinear;
    if (is_rectilinear && field > kWidestRectilinear * kDegree) {
        findings.push_back(
            {"distortion", warning, 0,
             fmt::format(
                 "a half field of {:.2f}° is none of a rectilinear lens: is it a fisheye, or is the full field stated?",
                 field / kDegree),
             field / kDegree, kWidestRectilinear, "deg"});
        return;
    }
    const double ideal =
        checked.focus->efl / std::abs(checked.table.index.back()) * optics::projected_radius(projection, field);
    const double off = image_height / ideal - 1.0;
    const double limit = is_rectilinear ? kDistortion : kFisheyeDistortion;
    if (std::abs(off) > limit) {
        findings.push_back(
            {"distortion", warning, 0,
             fmt::format("the chief ray of {:.2f}° lands {:.4g} mm from the axis, {:+.1f} % off the {} projection",
                         field / kDegree, image_height, 100.0 * off, optics::projection_name(projection)),
             100.0 * off, 100.0 * limit, "%"});
    }
}

/// The stated image circle against the stated field's chief ray, or against the last one that passes.
void check_image_circle(const CheckedLens& checked, std::optional<double> image_height, Findings& findings) {
    if (!checked.claims.image_circle_mm) {
        return;
    }
    const double circle = *checked.claims.image_circle_mm;
    bool is_off = false;
    std::string what = "the stated field";
    if (image_height) {
        is_off = std::abs(2.0 * *image_height / circle - 1.0) > kImageCircle;
    } else {
        const optics::ChiefRays rays(lens_in_focus(checked, true), checked.wavelength_nm);
        const std::optional<optics::ChiefRay> last = rays.at_field(rays.largest_field() * (1.0 - 1e-9));
        image_height = last ? last->image_height : 0.0;
        is_off = 2.0 * *image_height < (1.0 - kImageCircle) * circle;
        what = "all that the rims let pass";
    }
    if (is_off) {
        findings.push_back({"image-circle", warning, 0,
                            fmt::format("{} fills an image circle of {:.4g} mm, {:.4g} mm is stated", what,
                                        2.0 * *image_height, circle),
                            2.0 * *image_height, circle, "mm"});
    }
}

}  // namespace

void check_field_rays(const CheckedLens& checked, Findings& findings) {
    const bool is_judged = checked.traced && checked.focus && checked.prescription.is_rotationally_symmetric() &&
                           std::isinf(checked.prescription.object_distance_mm) &&
                           std::isfinite(checked.focus->image_distance);
    if (!is_judged) {
        return;
    }
    std::optional<double> image_height;
    if (checked.claims.half_field_deg && *checked.claims.half_field_deg > 0.0) {
        const double field = *checked.claims.half_field_deg * kDegree;
        const std::optional<optics::ChiefRay> chief = check_chief_ray(checked, field, findings);
        check_beam(checked, field, chief, findings);
        if (chief) {
            image_height = chief->image_height;
            check_distortion(checked, field, *image_height, findings);
        }
    }
    check_image_circle(checked, image_height, findings);
}

}  // namespace lensproof::check
