// experiments/cli/measure_each.cpp — `lensproof measure --each`: many pictures, each by itself.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "engine/base/csv.h"
#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"
#include "experiments/cli/measure_parts.h"
#include "experiments/cli/progress.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

namespace fs = std::filesystem;
using calibration::kQuantities;

struct OwnResult {
    std::string image;
    std::string reason;  // why it was not measured; empty where it was
    std::optional<calibration::Profile> profile;
};

// What the summary has of a profile, a pair of columns each: where it has been measured furthest out.
struct SummarisedCurve {
    std::string key;
    const char* column;  // without the picture's main channel, which differs from picture to picture
};

std::vector<SummarisedCurve> summarised_curves(const std::string& channel) {
    return {{kQuantities.distortion.key(), "distortion_percent"},
            {kQuantities.vignetting_ev.key(channel), "vignetting_ev"},
            {kQuantities.chromatic_shift.key("R"), "chromatic_shift_R_px"},
            {kQuantities.chromatic_shift.key("B"), "chromatic_shift_B_px"},
            {kQuantities.tangential_mtf50.key(channel), "mtf50_tangential_cycles_per_px"},
            {kQuantities.sagittal_mtf50.key(channel), "mtf50_sagittal_cycles_per_px"}};
}

std::string summary_header() {
    std::string header = "image,measured,reason,edges,mtf50_median_cycles_per_px";
    for (const SummarisedCurve& curve : summarised_curves("")) {
        header += fmt::format(",{0},{0}_at_image_height", curve.column);
    }
    return header + "\n";
}

// The channel that stands for the picture.
std::string main_channel(const calibration::Profile& profile) {
    return std::ranges::find(profile.channels, "G") != profile.channels.end() || profile.channels.empty()
               ? "G"
               : profile.channels.front();
}

struct MedianSharpness {
    std::size_t edges = 0;
    std::optional<double> mtf50_cycles_per_px;
};

MedianSharpness median_sharpness(const calibration::Profile& profile) {
    const auto listed = profile.sharpness.find(main_channel(profile));
    std::vector<double> values;
    if (listed != profile.sharpness.end()) {
        for (const calibration::ProfileEdge& edge : listed->second) {
            if (edge.edge.mtf50) {
                values.push_back(edge.edge.mtf50->cycles_per_px);
            }
        }
    }
    return {values.size(), values.empty() ? std::nullopt : std::optional(median(values))};
}

std::string summary_row(const OwnResult& own) {
    std::string row = fmt::format("{},{},{}", csv_cell(own.image), own.profile ? "yes" : "no", csv_cell(own.reason));
    if (!own.profile) {
        return row + std::string(2 + 2 * summarised_curves("").size(), ',') + "\n";
    }
    const auto [edges, mtf50] = median_sharpness(*own.profile);
    row += fmt::format(",{},{}", edges, mtf50 ? fmt::format("{:.5f}", *mtf50) : "");
    for (const SummarisedCurve& summarised : summarised_curves(main_channel(*own.profile))) {
        const calibration::Curve* curve = find_curve(*own.profile, summarised.key);
        const bool is_there = curve != nullptr && !curve->image_height.empty();
        const double height = is_there ? std::min(curve->covered_image_height, curve->image_height.back()) : 0.0;
        const auto value = is_there ? calibration::sample(*curve, height) : std::nullopt;
        row += value ? fmt::format(",{:.5f},{:.3f}", value->value, height) : ",,";
    }
    return row + "\n";
}

void print_line(const OwnResult& own) {
    if (!own.profile) {
        print("{}: left out: {}\n", own.image, own.reason);
        return;
    }
    if (!own.profile->scene_lines.empty()) {
        print("{}: {} straight lines\n", own.image,
              std::ranges::count(own.profile->scene_lines, true, &calibration::SceneLine::used));
        return;
    }
    const auto [edges, mtf50] = median_sharpness(*own.profile);
    print("{}: {}\n", own.image,
          mtf50 ? fmt::format("MTF50 {:.4f} cycles/px (median of {} edges)", *mtf50, edges) : "no edge was measured");
}

OwnResult measure_one(const MeasureOptions& options, const calibration::ProfileSource& source,
                      const scene::Chart& chart, const fs::path& picture, const std::string& name) {
    OwnResult own{.image = picture.string(), .reason = {}, .profile = {}};
    try {
        const calibration::MeasureInput input = measure_input(options, source, chart, own.image, {picture});
        own.profile = measure_pictures(options, input);
        if (!options.output.empty()) {
            fs::create_directories(options.output);
            calibration::write_profile(*own.profile, fs::path(options.output) / (name + ".json"));
        }
        if (!options.plots_folder.empty()) {
            write_measure_plots(fs::path(options.plots_folder) / name, *own.profile, input);
        }
    } catch (const InputError& e) {
        const std::string message = e.what();  // which ends in what is wrong with this one picture
        const std::size_t named = message.rfind(own.image + ": ");
        own.reason = named == std::string::npos ? message : message.substr(named + own.image.size() + 2);
    }
    return own;
}

// The picture's own name, with a number where another picture has it already.
std::string free_name(const fs::path& picture, std::set<std::string>& taken) {
    const std::string base = picture.filename().string();
    std::string name = base;
    for (int i = 2; !taken.insert(name).second; ++i) {
        name = fmt::format("{}-{}", base, i);
    }
    return name;
}

void check_folder(const std::string& option, const std::string& folder) {
    if (fs::exists(folder) && !fs::is_directory(folder)) {
        throw InputError(fmt::format("{}: {} is a file: expected a folder, which --each writes into", option, folder));
    }
    if (!folder.empty()) {
        check_output_name(fs::is_directory(folder) ? fs::path(folder) / "summary.csv" : fs::path(folder));
    }
}

}  // namespace

int measure_each(const MeasureOptions& options, const calibration::ProfileSource& source, const scene::Chart& chart,
                 const std::vector<fs::path>& pictures) {
    if (!options.focus_positions_mm.empty()) {
        throw InputError("--each: a focus series is measured together: expected no --focus-positions");
    }
    check_folder("-o", options.output);
    ProgressBar progress("measuring", options.common.quiet);
    std::set<std::string> taken;
    std::vector<OwnResult> results;
    for (const fs::path& picture : pictures) {
        progress.update(static_cast<double>(results.size()) / static_cast<double>(pictures.size()));
        results.push_back(measure_one(options, source, chart, picture, free_name(picture, taken)));
    }
    if (std::ranges::none_of(results, [](const OwnResult& own) { return own.profile.has_value(); })) {
        throw InputError(
            fmt::format("none of {} pictures can be measured: {}", results.size(), results.front().reason));
    }
    std::string summary = summary_header();
    Json list = Json::list();
    for (const OwnResult& own : results) {
        if (prints_text(options.common)) {
            print_line(own);
        }
        summary += summary_row(own);
        list.push_back(own.profile ? Json{{"image", own.image}, {"profile", lensproof::to_json(*own.profile)}}
                                   : Json{{"image", own.image}, {"reason", own.reason}});
    }
    if (!options.output.empty()) {
        write_file(fs::path(options.output) / "summary.csv", summary);
    }
    write_json_result(options.common, Json{{"pictures", list}});
    return kDone;
}

}  // namespace lensproof::cli
