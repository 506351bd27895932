#include "calibration/sharpness/profile_edge.h"

#include <string>

#include "engine/base/json.h"

namespace lensproof::calibration {
void add_mtf_frequency(Json& json, const std::string& name, const std::optional<MtfFrequency>& frequency,
                       std::optional<double> pixel_pitch_um) {
    if (!frequency) {
        return;
    }
    json[name + "_cycles_per_px"] = frequency->cycles_per_px;
    json[name + "_standard_error"] = frequency->standard_error;
    json[name + "_lower_95"] = frequency->lower_95;
    json[name + "_upper_95"] = frequency->upper_95;
    if (pixel_pitch_um) {
        json[name + "_cycles_per_mm"] = frequency->cycles_per_px * 1e3 / *pixel_pitch_um;
    }
}

std::optional<MtfFrequency> parse_mtf_frequency(const JsonNode& node, const std::string& name) {
    if (!node.has(name + "_cycles_per_px")) {
        return std::nullopt;
    }
    return MtfFrequency{.cycles_per_px = node.at(name + "_cycles_per_px").number(),
                        .standard_error = node.at(name + "_standard_error").number(),
                        .lower_95 = node.at(name + "_lower_95").number(),
                        .upper_95 = node.at(name + "_upper_95").number()};
}

Json to_json(const ProfileEdge& edge, std::optional<double> pixel_pitch_um) {
    const EdgeMtf& e = edge.edge;
    Json json = {{"image", edge.image},
                 {"centre_px", {e.centre_px.x, e.centre_px.y}},
                 {"normal_deg", e.normal_deg},
                 {"rise_px", e.rise_px},
                 {"bend_px", e.bend_px}};
    add_mtf_frequency(json, "mtf50", e.mtf50, pixel_pitch_um);
    add_mtf_frequency(json, "mtf10", e.mtf10, pixel_pitch_um);
    if (!e.mtf.empty()) {
        json["curve"] = {{"step_cycles_per_px", kMtfStep}, {"mtf", e.mtf}, {"standard_error", e.mtf_standard_error}};
    }
    return json;
}

ProfileEdge parse_edge(const JsonNode& node) {
    ProfileEdge result{.image = node.at("image").text(), .edge = {}};
    EdgeMtf& edge = result.edge;
    edge.centre_px = node.at("centre_px").pair();
    edge.normal_deg = node.at("normal_deg").number();
    edge.rise_px = node.at("rise_px").number();
    edge.bend_px = node.at("bend_px").number();
    edge.mtf50 = parse_mtf_frequency(node, "mtf50");
    edge.mtf10 = parse_mtf_frequency(node, "mtf10");
    if (node.has("curve")) {
        const JsonNode curve = node.at("curve");
        if (curve.at("step_cycles_per_px").number() != kMtfStep) {
            throw curve.at("step_cycles_per_px").error("0.02");
        }
        edge.mtf = curve.at("mtf").numbers();
        edge.mtf_standard_error = curve.at("standard_error").numbers(edge.mtf.size());
    }
    return result;
}

}  // namespace lensproof::calibration
