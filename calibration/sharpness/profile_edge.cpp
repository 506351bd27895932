#include "calibration/sharpness/profile_edge.h"

namespace lensproof::calibration {

void mtf_fields(JsonArchive& json, const std::string& name, std::optional<MtfFrequency>& frequency,
                const std::optional<double>& pixel_pitch_um) {
    if (!json.present(name + "_cycles_per_px", frequency)) {
        return;
    }
    json.field(name + "_cycles_per_px", frequency->cycles_per_px)
        .field(name + "_standard_error", frequency->standard_error)
        .field(name + "_lower_95", frequency->lower_95)
        .field(name + "_upper_95", frequency->upper_95);
    if (pixel_pitch_um) {
        json.derived(name + "_cycles_per_mm", frequency->cycles_per_px * 1e3 / *pixel_pitch_um);
    }
}

void fields(JsonArchive& json, ProfileEdge& edge, const std::optional<double>& pixel_pitch_um) {
    EdgeMtf& e = edge.edge;
    json.field("image", edge.image)
        .field("centre_px", e.centre_px)
        .field("normal_deg", e.normal_deg)
        .field("rise_px", e.rise_px)
        .field("bend_px", e.bend_px)
        .added("length_px", e.length_px)
        .added("width_px", e.width_px);
    mtf_fields(json, "mtf50", e.mtf50, pixel_pitch_um);
    mtf_fields(json, "mtf10", e.mtf10, pixel_pitch_um);
    json.optional_group("curve", !e.mtf.empty(), [&](JsonArchive& curve) {
        curve.constant("step_cycles_per_px", kMtfStep, "0.02").field("mtf", e.mtf);
        curve.numbers("standard_error", e.mtf_standard_error, e.mtf.size());
    });
}

}  // namespace lensproof::calibration
