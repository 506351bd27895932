#include "engine/analysis/lens_analysis.h"

#include <algorithm>

#include "engine/analysis/beam_outline.h"
#include "engine/analysis/wavefront.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/illumination.h"

namespace lensproof {

namespace {

/// The direction cosines under which the sensor sees the chief ray come.
Vec2d seen_from_sensor(const ChiefRay& chief) {
    return {-chief.rear.direction.x, -chief.rear.direction.y};
}

/// A lens at one wavelength, with what every field is compared to.
class AtWavelength {
  public:
    AtWavelength(const Lens& lens, double wavelength_nm, const AnalysisSettings& settings)
        : settings_(settings),
          wavelength_nm_(wavelength_nm),
          lens_(at_wavelength<double>(lens, wavelength_nm)),
          chief_rays_(lens, wavelength_nm, Rims::follow) {
        if (const std::optional<ChiefRay> axial = chief_rays_.at_field(0.0)) {
            axial_beam_area_ = beam_outline(lens_, bundle(*axial)).area;
            axial_solid_angle_ = image_outline(lens_, axial->image_point, seen_from_sensor(*axial)).area;
        }
    }

    [[nodiscard]] const TraceLens<double>& lens() const { return lens_; }
    [[nodiscard]] std::optional<ChiefRay> chief_ray(double field) const { return chief_rays_.at_field(field); }
    [[nodiscard]] FieldAnalysis analyze(double field, const std::optional<ChiefRay>& reference_chief) const;

  private:
    [[nodiscard]] FieldBundle bundle(const ChiefRay& chief) const {
        return {.chief = chief, .object_distance = settings_.object_distance};
    }

    const AnalysisSettings& settings_;
    double wavelength_nm_;
    TraceLens<double> lens_;
    ChiefRays chief_rays_;
    double axial_beam_area_ = 0.0;
    double axial_solid_angle_ = 0.0;
};

FieldAnalysis AtWavelength::analyze(double field, const std::optional<ChiefRay>& reference_chief) const {
    FieldAnalysis row{.field_angle = field, .wavelength_nm = wavelength_nm_};
    const std::optional<ChiefRay> chief = chief_ray(field);
    if (!chief) {
        row.status = RayStatus::missed;
        return row;
    }
    row.status = chief->status;
    row.surface = chief->surface;
    row.chief_ray_height = chief->image_height;
    const FieldBundle rays = bundle(*chief);
    const RegionOutline outline = beam_outline(lens_, rays);
    if (axial_beam_area_ > 0.0) {
        row.vignetting = outline.area / axial_beam_area_;
    }
    if (!outline.is_empty()) {
        const std::vector<BeamNode> nodes = beam_quadrature(outline, settings_.rings);
        if (const std::optional<ReferenceSphere> sphere = reference_sphere(lens_, rays)) {
            const Wavefront waves = wavefront(lens_, wavelength_nm_, rays, *sphere, nodes);
            row.wavefront_rms_waves = wavefront_errors(waves).rms;
        }
    }
    if (reference_chief) {
        row.lateral_colour = chief->image_height - reference_chief->image_height;
        if (axial_solid_angle_ > 0.0) {
            row.relative_illumination =
                image_outline(lens_, reference_chief->image_point, seen_from_sensor(*chief)).area / axial_solid_angle_;
        }
    }
    return row;
}

}  // namespace

LensAnalysis analyze_lens(const Lens& lens, const AnalysisSettings& settings) {
    LensAnalysis analysis;
    const AtWavelength reference(lens, settings.reference_wavelength_nm, settings);
    std::vector<AtWavelength> wavelengths;
    for (const double wavelength_nm : settings.wavelengths_nm) {
        wavelengths.emplace_back(lens, wavelength_nm, settings);
        analysis.paraxial.push_back(paraxial_data(wavelengths.back().lens()));
    }
    analysis.reference_paraxial = paraxial_data(reference.lens());
    analysis.conjugates = paraxial_conjugates(reference.lens(), settings.object_distance);

    const double largest_field = std::ranges::max(settings.fields);
    const auto [shortest, longest] = std::ranges::minmax_element(settings.wavelengths_nm);
    analysis.seidel = seidel_sums(reference.lens(), at_wavelength<double>(lens, *shortest),
                                  at_wavelength<double>(lens, *longest), largest_field, settings.object_distance);
    analysis.lagrange_invariant = lagrange_invariant(reference.lens(), largest_field);
    for (const double field : settings.fields) {
        const std::optional<ChiefRay> reference_chief = reference.chief_ray(field);
        for (const AtWavelength& wavelength : wavelengths) {
            analysis.fields.push_back(wavelength.analyze(field, reference_chief));
        }
    }
    return analysis;
}

}  // namespace lensproof
