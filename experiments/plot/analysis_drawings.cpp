#include <fmt/format.h>

#include <cmath>

#include "experiments/plot/analysis_curves.h"

namespace lensproof {

namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json points_json(const std::vector<Vec2d>& points) {
    Json json = Json::array();
    for (const Vec2d& point : points) {
        json.push_back({number(point.x), number(point.y)});
    }
    return json;
}

Json curves_array(const std::vector<WavelengthCurve>& curves) {
    Json json = Json::array();
    for (const WavelengthCurve& curve : curves) {
        json.push_back({{"wavelength_nm", curve.wavelength_nm}, {"points", points_json(curve.points)}});
    }
    return json;
}

Json fans_json(const std::vector<FieldFans>& fields) {
    Json json = Json::array();
    for (const FieldFans& field : fields) {
        json.push_back({{"field_deg", field.field_deg},
                        {"tangential_pupil_um", curves_array(field.tangential)},
                        {"sagittal_pupil_um", curves_array(field.sagittal)}});
    }
    return json;
}

Json field_curves_json(const std::vector<FieldCurve>& curves) {
    Json json = Json::array();
    for (const FieldCurve& curve : curves) {
        Json points = Json::array();
        for (const FieldCurve::Point& point : curve.points) {
            points.push_back({{"field_deg", point.field_deg},
                              {"tangential_focus_mm", number(point.tangential_mm)},
                              {"sagittal_focus_mm", number(point.sagittal_mm)},
                              {"distortion_percent", number(point.distortion_percent)}});
        }
        json.push_back({{"wavelength_nm", curve.wavelength_nm}, {"points", std::move(points)}});
    }
    return json;
}

Json spots_json(const AnalysisCurves& curves) {
    Json json = Json::array();
    for (const FieldSpots& field : curves.spots) {
        Json planes = Json::array();
        for (std::size_t i = 0; i < field.spots.size(); ++i) {
            planes.push_back({{"defocus_mm", curves.defocus_mm[i]},
                              {"spot_rms_um", number(field.spots[i].rms_um)},
                              {"rays_um", curves_array(field.spots[i].rays)}});
        }
        json.push_back({{"field_deg", field.field_deg},
                        {"airy_radius_um", number(field.airy_radius_um)},
                        {"planes", std::move(planes)}});
    }
    return json;
}

Json illumination_json(const std::vector<FieldBrightness>& points) {
    Json json = Json::array();
    for (const FieldBrightness& point : points) {
        json.push_back({{"field_deg", point.field_deg},
                        {"relative_illumination", number(point.relative_illumination)},
                        {"vignetting", number(point.vignetting)}});
    }
    return json;
}

Json map_json(const SquareMap& map) {
    Json values = Json::array();
    for (const double value : map.values) {
        values.push_back(number(value));
    }
    return {{"size", map.size}, {"half_width", number(map.half_width)}, {"values", std::move(values)}};
}

Json wavefronts_json(const std::vector<FieldWavefront>& maps) {
    Json json = Json::array();
    for (const FieldWavefront& map : maps) {
        json.push_back({{"field_deg", map.field_deg},
                        {"wavelength_nm", map.wavelength_nm},
                        {"wavefront_rms_waves", number(map.rms_waves)},
                        {"peak_to_valley_waves", number(map.peak_to_valley_waves)},
                        {"zernike_noll_waves", map.zernike_waves},
                        {"opd_waves", map_json(map.opd_waves)}});
    }
    return json;
}

double pixel_um(const PsfMap& psf) {
    return 2.0 * psf.intensity.half_width / static_cast<double>(psf.intensity.size);
}

Json psfs_json(const std::vector<PsfMap>& maps) {
    Json json = Json::array();
    for (const PsfMap& map : maps) {
        json.push_back({{"field_deg", map.field_deg},
                        {"strehl", number(map.strehl)},
                        {"pixel_um", map.intensity.size > 0 ? number(pixel_um(map)) : Json(nullptr)},
                        {"file", map.intensity.size > 0 ? Json(psf_file_name(map)) : Json(nullptr)}});
    }
    return json;
}

Json mtf_json(const std::vector<FieldMtf>& fields) {
    Json json = Json::array();
    for (const FieldMtf& field : fields) {
        json.push_back({{"field_deg", field.field_deg},
                        {"remark", field.remark},
                        {"tangential", points_json(field.tangential)},
                        {"sagittal", points_json(field.sagittal)}});
    }
    return json;
}

/// What the lens's distortion refers to.
std::string projection_formula(Projection projection) {
    switch (projection) {
        case Projection::rectilinear:
            return "f tan θ";
        case Projection::equidistant:
            return "f θ";
        case Projection::equisolid:
            return "2 f sin(θ/2)";
        case Projection::stereographic:
            return "2 f tan(θ/2)";
        case Projection::orthographic:
            return "f sin θ";
    }
    return "";
}

}  // namespace

Json curves_json(const AnalysisCurves& curves, const WaveCurves& waves) {
    Json over_field = Json::array();
    for (const FrequencyMtf& curve : waves.mtf_over_field) {
        over_field.push_back({{"cycles_per_mm", curve.cycles_per_mm},
                              {"tangential", points_json(curve.tangential)},
                              {"sagittal", points_json(curve.sagittal)}});
    }
    return {{"ray_fans", fans_json(curves.fans)},
            {"field_curves", field_curves_json(curves.field_curves)},
            {"longitudinal_zone_mm", curves_array(curves.longitudinal)},
            {"lateral_colour_deg_um", curves_array(curves.lateral_colour)},
            {"airy_radius_deg_um", points_json(curves.airy_radius)},
            {"spots", spots_json(curves)},
            {"illumination", illumination_json(curves.illumination)},
            {"wavefronts", wavefronts_json(waves.wavefronts)},
            {"psfs", psfs_json(waves.psfs)},
            {"mtf", mtf_json(waves.mtf)},
            {"geometric_mtf", mtf_json(waves.geometric_mtf)},
            {"diffraction_limit", points_json(waves.diffraction_limit)},
            {"mtf_over_field", std::move(over_field)}};
}

std::string psf_file_name(const PsfMap& psf) {
    return fmt::format("psf_{}deg.exr", psf.field_deg);
}

std::optional<Image> psf_image(const PsfMap& psf) {
    const auto size = static_cast<int>(psf.intensity.size);
    if (size == 0) {
        return std::nullopt;
    }
    Image image = make_image(size, size, {"Y"});
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

std::map<std::string, std::string> analysis_drawings(const PlotHeading& heading, Projection projection,
                                                     const AnalysisCurves& curves, const WaveCurves& waves) {
    return {{"ray_fans.svg", ray_fans_svg(heading, curves.fans)},
            {"field_curves.svg", field_curves_svg(heading, curves.field_curves, projection_formula(projection))},
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

}  // namespace lensproof
