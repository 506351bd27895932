#include "engine/optics/unstated_rims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/optics/design_fields.h"
#include "engine/optics/meridional_bundle.h"
#include "engine/optics/paraxial.h"

namespace lensproof::optics {

namespace {

bool has_no_rim(const LensSurface& surface) {
    return std::isinf(surface.semi_diameter);
}

/// The stop's semi-diameter for the aperture, or not finite where it says nothing.
double stop_semi_diameter(const Lens& lens, const Prescription& prescription, const SystemAperture& aperture) {
    Lens unit = lens;
    unit.surfaces[unit.stop_index()].semi_diameter = 1.0;
    const TraceLens<double> traced = at_wavelength<double>(unit, prescription.reference_wavelength_nm());
    const ParaxialData data = paraxial_data(traced);
    switch (aperture.kind) {
        case ApertureKind::entrance_pupil_diameter:
            return aperture.value / data.entrance_pupil_diameter;
        case ApertureKind::f_number:
            return std::abs(data.f_number) / aperture.value;
        case ApertureKind::working_f_number:
            return paraxial_conjugates(traced, prescription.object_distance_mm).working_f_number / aperture.value;
        case ApertureKind::object_numerical_aperture: {
            const double slope = paraxial_conjugates(traced, prescription.object_distance_mm).object_numerical_aperture;
            const double index = traced.surfaces.front().index_before;
            return index * std::tan(std::asin(aperture.value / index)) / slope;
        }
        case ApertureKind::stop:
            break;
    }
    return kInfinity;
}

/// A field whose light is to pass: its angle, and the part of the pupil that it fills.
struct WantedField {
    double angle = 0.0;
    PupilVignetting vignetting;
};

/// Of a field off the axis in x alone, the pupil's y is along x here.
PupilVignetting along_field(const PupilVignetting& vignetting, const Vec2d& point) {
    if (point.x == 0.0) {
        return vignetting;
    }
    const auto swapped = [](const Vec2d& v) { return Vec2d{v.y, v.x}; };
    return point.y == 0.0 ? PupilVignetting{swapped(vignetting.decentre), swapped(vignetting.compression)}
                          : PupilVignetting{};
}

std::vector<WantedField> wanted_fields(const Prescription& prescription, const TraceLens<double>& traced,
                                       const ChiefRays& chief_rays) {
    const DesignFields& fields = prescription.fields;
    const StatedData& stated = prescription.stated;
    std::vector<WantedField> wanted = {{}};
    for (std::size_t i = 0; i < fields.points.size(); ++i) {
        const std::optional<double> angle =
            field_angle(fields.kind, fields.points[i], traced, chief_rays, prescription.object_distance_mm);
        if (angle) {
            const bool is_vignetted = i < fields.vignetting.size();
            wanted.push_back(
                {*angle, is_vignetted ? along_field(fields.vignetting[i], fields.points[i]) : PupilVignetting{}});
        }
    }
    if (fields.points.empty() && (stated.half_field_deg || stated.image_circle_mm)) {
        const double angle = stated.half_field_deg ? *stated.half_field_deg * kDegree
                                                   : field_at_image_height(chief_rays, 0.5 * *stated.image_circle_mm);
        wanted.push_back({std::min(angle, chief_rays.largest_field()), {}});
    }
    return wanted;
}

/// The marginal ray added to the chief ray.
std::vector<double> paraxial_heights(const Prescription& prescription, const TraceLens<double>& traced) {
    const ParaxialData data = paraxial_data(traced);
    const StatedData& stated = prescription.stated;
    double tangent = 0.0;
    if (stated.half_field_deg && *stated.half_field_deg < 80.0) {
        tangent = std::tan(*stated.half_field_deg * kDegree);
    } else if (stated.image_circle_mm) {
        tangent = 0.5 * *stated.image_circle_mm / std::abs(data.front_efl);
    }
    ParaxialRay marginal = paraxial_marginal_ray(traced, prescription.object_distance_mm)
                               .value_or(ParaxialRay{0.5 * data.entrance_pupil_diameter, 0.0});
    ParaxialRay chief{-tangent * data.entrance_pupil_z, tangent};
    std::vector<double> heights;
    for (std::size_t i = 0; i < traced.surfaces.size(); ++i) {
        const int here = static_cast<int>(i);
        if (i > 0) {
            const double gap = traced.surfaces[i].vertex_z - traced.surfaces[i - 1].vertex_z;
            marginal.height += gap * marginal.slope;
            chief.height += gap * chief.slope;
        }
        heights.push_back(std::abs(marginal.height) + std::abs(chief.height));
        marginal = trace_paraxial(traced, marginal, here, here);
        chief = trace_paraxial(traced, chief, here, here);
    }
    return heights;
}

/// Heights at every surface that the wanted fields' light reaches, real rays.
std::vector<double> real_heights(const Lens& open, const Prescription& prescription, const TraceLens<double>& traced) {
    std::vector<double> heights(traced.surfaces.size(), 0.0);
    const ChiefRays chief_rays(open, prescription.reference_wavelength_nm());
    const auto follow = [&](const Ray<double>& ray) {
        std::size_t i = 0;
        trace(traced, ray, [&](const SurfaceEvent<double>& event) {
            if (event.status == RayStatus::ok && i < heights.size()) {
                heights[i] = std::max(heights[i], std::hypot(event.ray.origin.x, event.ray.origin.y));
            }
            ++i;
        });
    };
    for (const auto& [angle, vignetting] : wanted_fields(prescription, traced, chief_rays)) {
        const std::optional<ChiefRay> chief = chief_rays.at_field(angle);
        if (!chief) {
            continue;
        }
        const MeridionalBundle bundle = meridional_bundle(traced, *chief, prescription.object_distance_mm);
        const auto passes = [&](double offset) {
            return trace(traced, bundle.ray({offset, 0.0})).status == RayStatus::ok;
        };
        constexpr int kHalvings = 50;
        const double widest = 3.0 * std::sqrt(traced.surfaces.front().semi_diameter_squared);
        const double side = bisected({0.0, widest}, kHalvings, passes).inside;
        const auto& [decentre, compression] = vignetting;
        const auto meridional = [&](double pupil) {
            return pupil > 0.0 ? pupil * bundle.upper : -pupil * bundle.lower;
        };
        const double middle = meridional(decentre.y);
        follow(bundle.ray({0.0, meridional(decentre.y + 1.0 - compression.y)}));
        follow(bundle.ray({0.0, meridional(decentre.y - 1.0 + compression.y)}));
        follow(bundle.ray({side * (decentre.x + 1.0 - compression.x), middle}));
        follow(bundle.ray({side * (decentre.x - 1.0 + compression.x), middle}));
    }
    return heights;
}

/// How high the widest axial beam stands at the stop that all other surfaces' rims let pass.
double widest_axial_height(const Lens& open, const Prescription& prescription, const TraceLens<double>& traced) {
    double height = 0.0;
    const std::optional<ChiefRay> axis = ChiefRays(open, prescription.reference_wavelength_nm()).at_field(0.0);
    if (axis) {
        const MeridionalBundle bundle = meridional_bundle(traced, *axis, prescription.object_distance_mm);
        trace(traced, bundle.ray({0.0, bundle.upper}), [&](const SurfaceEvent<double>& event) {
            height = event.surface == open.stop_index() ? std::abs(event.ray.origin.y) : height;
        });
    }
    if (height == 0.0) {
        throw InputError(
            fmt::format("{}: neither an aperture nor the stop's size is stated, and the other surfaces "
                        "let no axial beam pass that it could be found from",
                        open.name));
    }
    return height;
}

}  // namespace

void open_stop(Lens& lens, const Prescription& prescription) {
    const SystemAperture aperture = prescription.governing_aperture();
    if (aperture.kind == ApertureKind::stop) {
        return;
    }
    const double needed = stop_semi_diameter(lens, prescription, aperture);
    if (!(needed > 0.0) || !std::isfinite(needed)) {
        throw InputError(
            fmt::format("{}: its aperture, {}, opens no stop of this lens; state the stop's "
                        "semi-diameter",
                        prescription.file.string(), describe(aperture)));
    }
    LensSurface& stop = lens.surfaces[lens.stop_index()];
    stop.semi_diameter = std::min(stop.semi_diameter, needed);
}

void estimate_rims(Lens& lens, const Prescription& prescription) {
    if (std::ranges::none_of(lens.surfaces, has_no_rim)) {
        return;
    }
    const int stop = lens.stop_index();
    const bool is_stop_alone = std::ranges::count_if(lens.surfaces, has_no_rim) == 1;
    if (has_no_rim(lens.surfaces[stop]) && !is_stop_alone) {
        throw InputError(
            fmt::format("{}: no semi-diameter is stated for some surfaces, and no f-number that they could "
                        "be found from; expected semi_diameter_mm, or stated.f_number",
                        lens.name));
    }
    // Wider than any ray that the lens focuses, but finite, so that searches end.
    Lens open = lens;
    const TraceLens<double> infinite = at_wavelength<double>(lens, prescription.reference_wavelength_nm());
    const double efl = paraxial_data(infinite).efl;
    const double wide =
        10.0 * (std::abs(lens.last_vertex_z() - lens.surfaces.front().vertex_z) +
                lens.surfaces[lens.stop_index()].semi_diameter + (std::isfinite(efl) ? std::abs(efl) : 0.0));
    for (LensSurface& surface : open.surfaces) {
        surface.semi_diameter = std::min(surface.semi_diameter, wide);
    }
    const TraceLens<double> traced = at_wavelength<double>(open, prescription.reference_wavelength_nm());
    if (open.image_z == open.last_vertex_z()) {  // the source does not say
        const double image = paraxial_image_distance(traced, prescription.object_distance_mm);
        open.image_z += std::isfinite(image) ? image : 0.0;
    }
    if (is_stop_alone && has_no_rim(lens.surfaces[stop])) {
        const double opening = widest_axial_height(open, prescription, traced);
        lens.surfaces[stop].semi_diameter = opening;
        lens.findings.push_back(
            {"stop-size", Severity::warning, stop + 1,
             fmt::format("neither an aperture nor the stop's size is stated: it opens to {:.4g} mm, "
                         "as far as the other surfaces let an axial beam pass",
                         opening)});
        return;
    }
    const std::vector<double> paraxial = paraxial_heights(prescription, traced);
    const std::vector<double> heights =
        lens.is_rotationally_symmetric ? real_heights(open, prescription, traced) : paraxial;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        if (has_no_rim(lens.surfaces[i])) {
            constexpr double kRounding = 1e-9;  // the outermost ray passes whichever way it is traced
            lens.surfaces[i].semi_diameter = (heights[i] > 0.0 ? heights[i] : paraxial[i]) * (1.0 + kRounding);
        }
    }
}

}  // namespace lensproof::optics
