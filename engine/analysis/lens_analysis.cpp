#include "engine/analysis/lens_analysis.h"

#include <algorithm>
#include <cmath>

#include "engine/analysis/field_curves.h"
#include "engine/analysis/spot.h"
#include "engine/analysis/wavefront.h"
#include "engine/base/angle.h"
#include "engine/base/parallel.h"

namespace lensproof::analysis {

namespace {

/// A lens at one wavelength, with the axis's light that every field's is compared to.
struct AnalysedColour {
    ColourOfLens colour;
    FieldLight axis{};

    AnalysedColour(const optics::Lens& lens, double wavelength_nm, const AnalysisSettings& settings)
        : colour(lens, wavelength_nm) {
        if (const auto axial = optics::field_bundle(colour.chief_rays, 0.0, settings.object_distance)) {
            axis = field_light(colour.lens, *axial, axial->chief.image_point);
        }
    }
};

/// What the passing beam makes at the image.
void add_image(FieldAnalysis& row, const ColourOfLens& colour, const optics::FieldBundle& bundle,
               const optics::RegionOutline& beam, int rings) {
    const SpotSize spot = spot_size(spot_rays(colour.lens, bundle, beam, rings));
    row.spot_rms = spot.rms;
    row.spot_centroid = spot.centroid;
    if (const auto sphere = reference_sphere(colour.lens, bundle)) {
        const Wavefront waves =
            wavefront(colour.lens, colour.wavelength_nm, bundle, *sphere, optics::region_quadrature(beam, rings));
        row.wavefront_rms_waves = wavefront_errors(waves).rms;
    }
}

/// `reference`: the field's bundle at the reference wavelength, which says where the object is.
FieldAnalysis analyze_field(double field_deg, const AnalysedColour& analysed,
                            const std::optional<optics::FieldBundle>& reference, optics::Projection projection,
                            double distortion_z, int rings) {
    const ColourOfLens& colour = analysed.colour;
    FieldAnalysis row{.field_deg = field_deg, .wavelength_nm = colour.wavelength_nm};
    const auto bundle = reference ? optics::same_object(*reference, colour.chief_rays) : std::nullopt;
    if (!bundle) {
        row.status = optics::RayStatus::missed;
        return row;
    }
    row.status = bundle->chief.status;
    row.surface = bundle->chief.surface;
    row.chief_ray_point = bundle->chief.image_point;
    row.lateral_colour = bundle->chief.image_height - reference->chief.image_height;
    const Ray<double>& chief = bundle->chief.front;
    row.transmittance =
        optics::trace_past_rims(colour.lens, Ray<double>{chief.origin - chief.direction, chief.direction})
            .transmittance;
    row.distortion_percent = distortion_percent(colour.lens, projection, *bundle, distortion_z);
    if (const auto pencil = ray_pencil(colour.lens, *bundle)) {
        const AstigmaticFoci foci = astigmatic_foci(*pencil, colour.lens.image_z);
        row.tangential_focus = foci.tangential;
        row.sagittal_focus = foci.sagittal;
    }
    const FieldLight light = field_light(colour.lens, *bundle, reference->chief.image_point);
    if (!analysed.axis.beam.is_empty()) {
        const FieldLightRatio ratio = light_ratio(light, analysed.axis);
        row.vignetting = ratio.vignetting;
        row.relative_illumination = ratio.relative_illumination;
    }
    if (!light.beam.is_empty()) {
        add_image(row, colour, *bundle, light.beam, rings);
    }
    return row;
}

}  // namespace

double largest_field_deg(const AnalysisSettings& settings) {
    return std::abs(std::ranges::max(settings.fields_deg, {}, [](double field) { return std::abs(field); }));
}

double distance_from_front(const optics::Lens& lens, double object_distance) {
    return object_distance + lens.surfaces.front().vertex_z;
}

optics::Lens with_image_plane(optics::Lens lens, double object_distance, double reference_wavelength_nm) {
    if (lens.image_z == lens.last_vertex_z()) {
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, reference_wavelength_nm);
        const double image = optics::paraxial_image_distance(traced, distance_from_front(lens, object_distance));
        if (std::isfinite(image)) {
            lens.image_z += image;
        }
    }
    return lens;
}

LensAnalysis analyze_lens(const optics::Lens& lens, const AnalysisSettings& settings, int threads) {
    const ColourOfLens reference(lens, settings.reference_wavelength_nm);
    const double from_front = distance_from_front(lens, settings.object_distance);
    std::vector<AnalysedColour> colours;
    colours.reserve(settings.wavelengths_nm.size());
    LensAnalysis analysis;
    for (const double wavelength_nm : settings.wavelengths_nm) {
        colours.emplace_back(lens, wavelength_nm, settings);
        analysis.paraxial.push_back(optics::paraxial_data(colours.back().colour.lens));
    }
    analysis.reference_paraxial = optics::paraxial_data(reference.lens);
    analysis.conjugates = optics::paraxial_conjugates(reference.lens, from_front);
    analysis.real_working_f_number = real_working_f_number(reference.lens, from_front);

    const double largest_field = largest_field_deg(settings) * kDegree;
    const auto [shortest, longest] = std::ranges::minmax_element(settings.wavelengths_nm);
    analysis.seidel = seidel_sums(reference.lens, optics::at_wavelength<double>(lens, *shortest),
                                  optics::at_wavelength<double>(lens, *longest), largest_field, from_front);
    analysis.lagrange_invariant = optics::lagrange_invariant(reference.lens, largest_field);
    if (const auto marginal = optics::paraxial_marginal_ray(reference.lens, from_front)) {
        analysis.marginal_ray = ray_at_surfaces(reference.lens, *marginal);
    }
    if (const auto chief = optics::paraxial_chief_ray(reference.lens, largest_field)) {
        analysis.chief_ray = ray_at_surfaces(reference.lens, *chief);
    }
    const double distortion_z = distortion_plane(reference.lens, settings.object_distance);
    analysis.fields.resize(settings.fields_deg.size() * colours.size());
    parallel_for(static_cast<int>(settings.fields_deg.size()), threads, [&](int i) {
        const double field = settings.fields_deg[static_cast<std::size_t>(i)];
        const auto bundle = optics::field_bundle(reference.chief_rays, field * kDegree, settings.object_distance);
        FieldAnalysis* row = &analysis.fields[static_cast<std::size_t>(i) * colours.size()];
        for (const AnalysedColour& colour : colours) {
            *row++ = analyze_field(field, colour, bundle, lens.projection, distortion_z, settings.rings);
        }
    });
    return analysis;
}

std::vector<std::optional<PolychromaticField>> polychromatic_fields(const optics::Lens& lens,
                                                                    const AnalysisSettings& settings) {
    std::vector<WeightedWavelength> wavelengths;
    wavelengths.reserve(settings.wavelengths_nm.size());
    for (const double wavelength_nm : settings.wavelengths_nm) {
        wavelengths.push_back({.wavelength_nm = wavelength_nm});
    }
    const optics::ChiefRays chief_rays(lens, settings.reference_wavelength_nm, optics::Rims::follow);
    std::vector<std::optional<PolychromaticField>> fields;
    fields.reserve(settings.fields_deg.size());
    for (const double field : settings.fields_deg) {
        const auto bundle = optics::field_bundle(chief_rays, field * kDegree, settings.object_distance);
        fields.push_back(
            bundle ? std::optional(polychromatic_field(lens, *bundle, settings.reference_wavelength_nm, wavelengths))
                   : std::nullopt);
        if (fields.back() && fields.back()->parts.empty()) {
            fields.back().reset();
        }
    }
    return fields;
}

}  // namespace lensproof::analysis
