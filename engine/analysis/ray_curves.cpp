#include "engine/analysis/ray_curves.h"

#include <algorithm>
#include <cmath>

#include "engine/analysis/axial_curves.h"
#include "engine/analysis/field_curves.h"
#include "engine/analysis/ray_fan.h"
#include "engine/analysis/spot.h"
#include "engine/base/angle.h"
#include "engine/base/infinity.h"

namespace lensproof::analysis {

namespace {

constexpr double kMicrometresPerMm = 1000.0;

constexpr int kCurveFields = 61;  // of a curve over the field
constexpr int kFanRays = 41;
constexpr int kZones = 41;
constexpr int kSpotCells = 20;  // dots across a beam

Vec2d in_um(Vec2d mm) {
    return {mm.x * kMicrometresPerMm, mm.y * kMicrometresPerMm};
}

/// The lens at the settings' wavelengths and at the reference one.
struct Colours {
    std::vector<ColourOfLens> all;
    ColourOfLens reference;

    Colours(const optics::Lens& lens, const AnalysisSettings& settings)
        : reference(lens, settings.reference_wavelength_nm) {
        for (const double wavelength_nm : settings.wavelengths_nm) {
            all.emplace_back(lens, wavelength_nm);
        }
    }
};

/// One field's beam at one wavelength.
struct Beam {
    const ColourOfLens* colour;
    optics::FieldBundle bundle;
    optics::RegionOutline outline;
};

/// The beams of a field that carry light, and the image point that they are judged at.
struct FieldBeams {
    std::optional<optics::FieldBundle> reference;
    std::vector<Beam> beams;
};

FieldBeams field_beams(const Colours& colours, double field, double object_distance) {
    FieldBeams result{.reference = optics::field_bundle(colours.reference.chief_rays, field, object_distance),
                      .beams = {}};
    for (const ColourOfLens& colour : colours.all) {
        const auto bundle = result.reference ? optics::same_object(*result.reference, colour.chief_rays) : std::nullopt;
        if (!bundle) {
            continue;
        }
        optics::RegionOutline outline = beam_outline(colour.lens, *bundle);
        if (!outline.is_empty()) {
            result.beams.push_back({.colour = &colour, .bundle = *bundle, .outline = std::move(outline)});
        }
    }
    return result;
}

WavelengthCurve fan_curve(const Beam& beam, FanPlane plane, Vec2d reference) {
    WavelengthCurve curve{.wavelength_nm = beam.colour->wavelength_nm, .points = {}};
    for (const FanPoint& point : ray_fan(beam.colour->lens, beam.bundle, beam.outline, plane, reference, kFanRays)) {
        const double error = plane == FanPlane::tangential ? point.error.y : point.error.x;
        curve.points.push_back({point.pupil, error * kMicrometresPerMm});
    }
    return curve;
}

FieldFans fans_of(const FieldBeams& field, double field_deg) {
    FieldFans fans{.field_deg = field_deg};
    for (const Beam& beam : field.beams) {
        const Vec2d reference = field.reference->chief.image_point;
        fans.tangential.push_back(fan_curve(beam, FanPlane::tangential, reference));
        fans.sagittal.push_back(fan_curve(beam, FanPlane::sagittal, reference));
    }
    return fans;
}

FieldCurve field_curve(const ColourOfLens& colour, const ColourOfLens& reference, optics::Projection projection,
                       std::span<const double> fields, double object_distance) {
    FieldCurve curve{.wavelength_nm = colour.wavelength_nm, .points = {}};
    for (const FieldCurvePoint& point : field_curves(colour, reference, projection, fields, object_distance)) {
        curve.points.push_back(
            {.field_deg = point.field_angle / kDegree,
             .tangential_mm = point.foci.tangential,
             .sagittal_mm = point.foci.sagittal,
             .distortion_percent = point.field_angle > 0.0 ? point.distortion_percent.value_or(kNaN) : kNaN});
    }
    return curve;
}

std::vector<WavelengthCurve> longitudinal_curves(const Colours& colours, double object_distance) {
    std::vector<WavelengthCurve> curves;
    const FieldBeams axis = field_beams(colours, 0.0, object_distance);
    if (!axis.reference) {
        return curves;
    }
    const double semi_diameter = axial_semi_diameter(colours.reference.lens, *axis.reference);
    for (const Beam& beam : axis.beams) {
        WavelengthCurve curve{.wavelength_nm = beam.colour->wavelength_nm, .points = {}};
        for (const AxialPoint& point : longitudinal_aberration(beam.colour->lens, beam.bundle, semi_diameter, kZones)) {
            curve.points.push_back({point.zone, point.focus});
        }
        curves.push_back(std::move(curve));
    }
    return curves;
}

std::vector<WavelengthCurve> lateral_curves(const Colours& colours, std::span<const double> fields,
                                            double object_distance) {
    std::vector<WavelengthCurve> curves;
    curves.reserve(colours.all.size());
    for (const ColourOfLens& colour : colours.all) {
        curves.push_back({.wavelength_nm = colour.wavelength_nm, .points = {}});
    }
    for (const LateralColourPoint& point : lateral_colour(colours.all, colours.reference, fields, object_distance)) {
        for (std::size_t i = 0; i < curves.size(); ++i) {
            curves[i].points.push_back({point.field_angle / kDegree, point.shift[i] * kMicrometresPerMm});
        }
    }
    return curves;
}

/// A round number (1, 2 or 5 times a power of ten) next above.
double rounded_up(double value) {
    const double decade = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * decade >= value) {
            return step * decade;
        }
    }
    return 10.0 * decade;
}

/// How far apart the planes of a through-focus diagram stand: where a perfect lens would lose a quarter wave, or where
/// defocus widens the axial spot by its own size, whichever is more.
double defocus_step(const Colours& colours, const FieldBeams& axis, double working_f_number, int rings) {
    double step = 2.0 * colours.reference.wavelength_nm * 1e-6 * working_f_number * working_f_number;
    for (const Beam& beam : axis.beams) {
        const auto rays = spot_rays(beam.colour->lens, beam.bundle, beam.outline, rings);
        step = std::max(step, spot_size(rays).rms * working_f_number);
    }
    return rounded_up(step);
}

/// The dots of a beam: on a grid, or, where it is too slim to be met by many, at the nodes of its quadrature.
std::vector<SpotRay> dots(const Beam& beam, const std::vector<SpotRay>& nodes) {
    double half_width = 0.0;
    for (const optics::OutlinePoint& point : beam.outline.points) {
        const Vec2d at = beam.outline.at(point, 1.0);
        half_width = std::max({half_width, std::abs(at.x), std::abs(at.y)});
    }
    std::vector<SpotRay> grid = spot_grid(beam.colour->lens, beam.bundle, half_width, kSpotCells);
    constexpr std::size_t kFewest = 40;
    return grid.size() >= kFewest ? grid : nodes;
}

FieldSpots spots_of(const FieldBeams& field, double field_deg, const std::vector<double>& defocus_mm,
                    double airy_radius_um, int rings) {
    FieldSpots spots{.field_deg = field_deg, .airy_radius_um = airy_radius_um};
    std::vector<std::vector<SpotRay>> nodes;
    std::vector<std::vector<SpotRay>> shown;
    nodes.reserve(field.beams.size());
    shown.reserve(field.beams.size());
    for (const Beam& beam : field.beams) {
        nodes.push_back(spot_rays(beam.colour->lens, beam.bundle, beam.outline, rings));
        shown.push_back(dots(beam, nodes.back()));
    }
    const std::vector<double> equal(nodes.size(), 1.0);
    const std::vector<SpotRay> all = pooled(nodes, equal);
    for (const double defocus : defocus_mm) {
        if (field.beams.empty()) {
            spots.spots.emplace_back();
            continue;
        }
        const Ray<double>& chief = field.reference->chief.rear;
        const Vec2d& centre = field.reference->chief.image_point;
        const Vec2d origin{centre.x + defocus * chief.direction.x / chief.direction.z,
                           centre.y + defocus * chief.direction.y / chief.direction.z};
        Spot spot{.rms_um = spot_size(all, defocus).rms * kMicrometresPerMm};
        for (std::size_t i = 0; i < shown.size(); ++i) {
            WavelengthCurve dots_at{.wavelength_nm = field.beams[i].colour->wavelength_nm, .points = {}};
            for (const SpotRay& ray : shown[i]) {
                const Vec2d at = ray.at(defocus);
                dots_at.points.push_back(in_um({at.x - origin.x, at.y - origin.y}));
            }
            spot.rays.push_back(std::move(dots_at));
        }
        spots.spots.push_back(std::move(spot));
    }
    return spots;
}

}  // namespace

RayCurves ray_curves(const optics::Lens& lens, const AnalysisSettings& settings) {
    RayCurves curves;
    const Colours colours(lens, settings);
    const double distance = settings.object_distance;
    const double largest = largest_field_deg(settings) * kDegree;
    const std::vector<double> dense = even_fields(largest, kCurveFields);
    for (const ColourOfLens& colour : colours.all) {
        curves.field_curves.push_back(field_curve(colour, colours.reference, lens.projection, dense, distance));
    }
    curves.longitudinal = longitudinal_curves(colours, distance);
    curves.lateral_colour = lateral_curves(colours, dense, distance);
    for (const IlluminationPoint& point : illumination_curve(colours.reference, colours.reference, dense, distance)) {
        curves.illumination.push_back({.field_deg = point.field_angle / kDegree,
                                       .relative_illumination = point.light.relative_illumination,
                                       .vignetting = point.light.vignetting});
    }

    const double f_number =
        optics::paraxial_conjugates(colours.reference.lens, distance_from_front(lens, distance)).working_f_number;
    const double airy_radius_um =
        1.219669891 * colours.reference.wavelength_nm * 1e-3 * f_number;  // J₁'s first zero / π
    curves.airy_radius = {{0.0, airy_radius_um}, {largest / kDegree, airy_radius_um}};
    const double step = defocus_step(colours, field_beams(colours, 0.0, distance), f_number, settings.rings);
    curves.defocus_mm = {-2.0 * step, -step, 0.0, step, 2.0 * step};
    for (const double field : settings.fields_deg) {
        const FieldBeams beams = field_beams(colours, field * kDegree, distance);
        curves.fans.push_back(fans_of(beams, field));
        curves.spots.push_back(spots_of(beams, field, curves.defocus_mm, airy_radius_um, settings.rings));
    }
    return curves;
}

}  // namespace lensproof::analysis
