// experiments/cli/measure_plots.cpp — what `lensproof measure --plots` writes of the edges that were measured.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/detection/working_copy.h"
#include "calibration/sharpness/sharpness_map.h"
#include "engine/base/csv.h"
#include "experiments/cli/measure_parts.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/analysis_plots.h"
#include "experiments/draw/sharpness_plots.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::cli {

namespace {

constexpr int kMarkedWidth = 1600;  // px, of a picture that edges are marked on
constexpr const char* kEdgesHeader =
    "image,channel,x_px,y_px,image_height,normal_deg,normal_from_radius_deg,length_px,width_px,rise_px,"
    "mtf50_cycles_per_px,mtf50_standard_error,mtf50_lower_95,mtf50_upper_95,mtf10_cycles_per_px\n";

std::vector<draw::MarkedEdge> marked(const std::vector<calibration::ProfileEdge>& edges, const std::string& image) {
    std::vector<draw::MarkedEdge> result;
    for (const calibration::ProfileEdge& listed : edges) {
        const calibration::EdgeMtf& edge = listed.edge;
        if (edge.mtf50 && (image.empty() || listed.image == image)) {
            result.push_back(
                {edge.centre_px, edge.normal_deg, edge.length_px, edge.width_px, edge.mtf50->cycles_per_px});
        }
    }
    return result;
}

draw::FrameMap map_of(const calibration::Profile& profile, const std::string& channel,
                      const std::vector<calibration::ProfileEdge>& listed) {
    std::vector<calibration::EdgeMtf> edges;
    edges.reserve(listed.size());
    for (const calibration::ProfileEdge& edge : listed) {
        edges.push_back(edge.edge);
    }
    calibration::SharpnessMap map = calibration::sharpness_map(edges, profile.width_px, profile.height_px);
    return {.title = fmt::format("MTF50 of {}, channel {}", profile.name, channel),
            .label = "MTF50",
            .unit = "cycles/px",
            .width_px = profile.width_px,
            .height_px = profile.height_px,
            .columns = map.columns,
            .rows = map.rows,
            .values = std::move(map.mtf50_cycles_per_px)};
}

std::string edges_csv(const calibration::Profile& profile) {
    const Vec2d middle{0.5 * (profile.width_px - 1), 0.5 * (profile.height_px - 1)};
    const Vec2d centre = profile.geometry ? calibration::centre_px(profile.geometry->model) : middle;
    std::string text = kEdgesHeader;
    for (const auto& [channel, edges] : profile.sharpness) {
        for (const auto& [image, edge] : edges) {
            const Vec2d q = edge.centre_px - centre;
            const double radius_deg = degrees(std::atan2(q.y, q.x));
            text += fmt::format("{},{},{:.3f},{:.3f},{:.4f},{:.2f},{:.2f},{:.1f},{:.1f},{:.3f}", csv_cell(image),
                                channel, edge.centre_px.x, edge.centre_px.y, length(q) / half_diagonal_px(profile),
                                edge.normal_deg, std::abs(std::remainder(edge.normal_deg - radius_deg, 180.0)),
                                edge.length_px, edge.width_px, edge.rise_px);
            if (const auto& f = edge.mtf50) {
                text += fmt::format(",{:.5f},{:.5f},{:.5f},{:.5f},", f->cycles_per_px, f->standard_error, f->lower_95,
                                    f->upper_95);
            } else {
                text += ",,,,,";
            }
            text += (edge.mtf10 ? fmt::format("{:.5f}", edge.mtf10->cycles_per_px) : "") + "\n";
        }
    }
    return text;
}

// The channel whose edges stand for the picture's: the one that geometry is measured in.
const std::string& shown_channel(const calibration::Profile& profile) {
    const auto green = profile.sharpness.find("G");
    return green != profile.sharpness.end() ? green->first : profile.sharpness.begin()->first;
}

}  // namespace

void write_measure_plots(const std::filesystem::path& folder, const calibration::Profile& profile,
                         const calibration::MeasureInput& input) {
    if (!profile.scene_lines.empty()) {
        write_line_plots(folder, profile, input);
        return;
    }
    if (std::ranges::all_of(profile.sharpness, [](const auto& channel) { return channel.second.empty(); })) {
        print_message("lensproof: --plots: {} has no edges to draw: {}\n", profile.name,
                      why_not_measured(profile, calibration::part::kSharpness, "none was measured"));
        return;
    }
    std::map<std::string, std::string> files;
    files["edges.csv"] = edges_csv(profile);
    for (const auto& [channel, edges] : profile.sharpness) {
        const std::vector<draw::MarkedEdge> all = marked(edges, "");
        files[fmt::format("sharpness_{}.svg", channel)] =
            sharpness_map_svg(map_of(profile, channel, edges), all, draw::sharpness_range(all));
    }
    const std::vector<calibration::ProfileEdge>& shown = profile.sharpness.at(shown_channel(profile));
    const draw::AxisRange range = draw::sharpness_range(marked(shown, ""));
    for (const calibration::Picture& picture : input.pictures) {
        const std::vector<draw::MarkedEdge> own = marked(shown, picture.name);
        if (!own.empty()) {
            const formats::Image image = picture.load();
            const findings::Picture copy = findings::shown_picture(picture.name, "", image, kMarkedWidth);
            files[fmt::format("edges_{}.svg", std::filesystem::path(picture.name).filename().string())] =
                draw::marked_edges_svg(picture.name, image.width, image.height, copy.bytes, own, range);
        }
    }
    draw::write_plots(folder, files);
}

}  // namespace lensproof::cli
