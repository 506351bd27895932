#include "experiments/draw/curves_json.h"

#include "engine/base/json.h"
#include "experiments/draw/analysis_drawings.h"

namespace lensproof::draw {

namespace {
Json points_json(const std::vector<Vec2d>& points) {
    Json json = Json::list();
    for (const Vec2d& point : points) {
        json.push_back({point.x, point.y});
    }
    return json;
}

Json curves_array(const std::vector<analysis::WavelengthCurve>& curves) {
    Json json = Json::list();
    for (const analysis::WavelengthCurve& curve : curves) {
        json.push_back({{"wavelength_nm", curve.wavelength_nm}, {"points", points_json(curve.points)}});
    }
    return json;
}

Json fans_json(const std::vector<analysis::FieldFans>& fields) {
    Json json = Json::list();
    for (const analysis::FieldFans& field : fields) {
        json.push_back({{"field_deg", field.field_deg},
                        {"tangential_pupil_um", curves_array(field.tangential)},
                        {"sagittal_pupil_um", curves_array(field.sagittal)}});
    }
    return json;
}

Json field_curves_json(const std::vector<analysis::FieldCurve>& curves) {
    Json json = Json::list();
    for (const analysis::FieldCurve& curve : curves) {
        Json points = Json::list();
        for (const analysis::FieldCurve::Point& point : curve.points) {
            points.push_back({{"field_deg", point.field_deg},
                              {"tangential_focus_mm", point.tangential_mm},
                              {"sagittal_focus_mm", point.sagittal_mm},
                              {"distortion_percent", point.distortion_percent}});
        }
        json.push_back({{"wavelength_nm", curve.wavelength_nm}, {"points", std::move(points)}});
    }
    return json;
}

Json spots_json(const analysis::RayCurves& curves) {
    Json json = Json::list();
    for (const analysis::FieldSpots& field : curves.spots) {
        Json planes = Json::list();
        for (std::size_t i = 0; i < field.spots.size(); ++i) {
            planes.push_back({{"defocus_mm", curves.defocus_mm[i]},
                              {"spot_rms_um", field.spots[i].rms_um},
                              {"rays_um", curves_array(field.spots[i].rays)}});
        }
        json.push_back(
            {{"field_deg", field.field_deg}, {"airy_radius_um", field.airy_radius_um}, {"planes", std::move(planes)}});
    }
    return json;
}

Json illumination_json(const std::vector<analysis::FieldBrightness>& points) {
    Json json = Json::list();
    for (const analysis::FieldBrightness& point : points) {
        json.push_back({{"field_deg", point.field_deg},
                        {"relative_illumination", point.relative_illumination},
                        {"vignetting", point.vignetting}});
    }
    return json;
}

Json map_json(const analysis::SquareMap& map) {
    Json values = Json::list();
    for (const double value : map.values) {
        values.push_back(value);
    }
    return {{"size", map.size}, {"half_width", map.half_width}, {"values", std::move(values)}};
}

Json wavefronts_json(const std::vector<analysis::FieldWavefront>& maps) {
    Json json = Json::list();
    for (const analysis::FieldWavefront& map : maps) {
        json.push_back({{"field_deg", map.field_deg},
                        {"wavelength_nm", map.wavelength_nm},
                        {"wavefront_rms_waves", map.rms_waves},
                        {"peak_to_valley_waves", map.peak_to_valley_waves},
                        {"zernike_noll_waves", map.zernike_waves},
                        {"opd_waves", map_json(map.opd_waves)}});
    }
    return json;
}

Json psfs_json(const std::vector<analysis::PsfMap>& maps) {
    Json json = Json::list();
    for (const analysis::PsfMap& map : maps) {
        json.push_back({{"field_deg", map.field_deg},
                        {"strehl", map.strehl},
                        {"pixel_um", map.intensity.size > 0 ? pixel_um(map) : Json(nullptr)},
                        {"file", map.intensity.size > 0 ? Json(psf_file_name(map)) : Json(nullptr)}});
    }
    return json;
}

Json mtf_json(const std::vector<analysis::FieldMtf>& fields) {
    Json json = Json::list();
    for (const analysis::FieldMtf& field : fields) {
        json.push_back({{"field_deg", field.field_deg},
                        {"remark", field.remark},
                        {"tangential", points_json(field.tangential)},
                        {"sagittal", points_json(field.sagittal)}});
    }
    return json;
}

}  // namespace

Json curves_json(const analysis::RayCurves& curves, const analysis::WaveCurves& waves) {
    Json over_field = Json::list();
    for (const analysis::FrequencyMtf& curve : waves.mtf_over_field) {
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

}  // namespace lensproof::draw
