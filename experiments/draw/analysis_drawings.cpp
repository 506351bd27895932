#include "experiments/draw/analysis_drawings.h"

#include <fmt/format.h>

namespace lensproof::draw {

double pixel_um(const analysis::PsfMap& psf) {
    return 2.0 * psf.intensity.half_width / static_cast<double>(psf.intensity.size);
}

std::string psf_file_name(const analysis::PsfMap& psf) {
    return fmt::format("psf_{:.6g}deg.exr", psf.field_deg);
}

std::optional<formats::Image> psf_image(const analysis::PsfMap& psf) {
    const auto size = static_cast<int>(psf.intensity.size);
    if (size == 0) {
        return std::nullopt;
    }
    formats::Image image = formats::make_image(size, size, {"Y"});
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
            const std::size_t cell = static_cast<std::size_t>(row) * psf.intensity.size + column;
            image.at(column, size - 1 - row, 0) = static_cast<float>(psf.intensity.values[cell]);
        }
    }
    image.metadata = {{"pixel_um", fmt::format("{}", pixel_um(psf))},
                      {"field_deg", fmt::format("{}", psf.field_deg)},
                      {"strehl", fmt::format("{}", psf.strehl)}};
    return image;
}

std::map<std::string, std::string> analysis_drawings(const PlotHeading& heading, optics::Projection projection,
                                                     const analysis::RayCurves& curves,
                                                     const analysis::WaveCurves& waves) {
    return {
        {"ray_fans.svg", ray_fans_svg(heading, curves.fans)},
        {"field_curves.svg", field_curves_svg(heading, curves.field_curves, optics::projection_formula(projection))},
        {"longitudinal_aberration.svg", longitudinal_aberration_svg(heading, curves.longitudinal)},
        {"lateral_colour.svg", lateral_colour_svg(heading, curves.lateral_colour, curves.airy_radius)},
        {"spots.svg", spots_svg(heading, curves.defocus_mm, curves.spots)},
        {"illumination.svg", illumination_svg(heading, curves.illumination)},
        {"wavefront.svg", wavefront_svg(heading, waves.wavefronts)},
        {"psf.svg", psf_svg(heading, waves.psfs)},
        {"mtf.svg", mtf_svg(heading, waves.mtf, waves.diffraction_limit)},
        {"mtf_geometric.svg", mtf_svg(heading, waves.geometric_mtf, waves.diffraction_limit, "geometric")},
        {"mtf_over_field.svg", mtf_field_svg(heading, waves.mtf_over_field)}};
}

}  // namespace lensproof::draw
