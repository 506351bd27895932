// experiments/cli/measure_lines.cpp — what `lensproof measure --lines` prints and draws.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/cli/measure_parts.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/analysis_plots.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/line_plots.h"
#include "experiments/draw/palette.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::cli {

namespace {

using calibration::SceneLine;

constexpr int kLinesWidth = 1600;  // px, of a picture that lines are marked on

// Over all lines used, every point alike.
double rms_px(const std::vector<SceneLine>& lines) {
    double squares = 0.0;
    double count = 0.0;
    for (const SceneLine& line : lines) {
        const double own = line.used ? static_cast<double>(line.points_px.size()) : 0.0;
        squares += own * line.rms_px * line.rms_px;
        count += own;
    }
    return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

std::string in_words(const std::vector<SceneLine>& lines) {
    const auto used = std::ranges::count(lines, true, &SceneLine::used);
    return fmt::format("{} straight lines, rms {:.3f} px; {} long edges left out, which this lens does not straighten",
                       used, rms_px(lines), static_cast<std::ptrdiff_t>(lines.size()) - used);
}

std::string distortion_chart(const calibration::Profile& profile) {
    const calibration::Quantity& quantity = calibration::kQuantities.distortion;
    const calibration::Curve& curve = *find_curve(profile, quantity.key());
    draw::PlotChart chart{.title = fmt::format("{} of {}", quantity.title(), profile.name),
                          .caption = in_words(profile.scene_lines)};
    chart.x = {.label = "Image height, of the half-diagonal", .low = 0.0, .high = 1.0};
    chart.y = {.label = "Distortion", .unit = quantity.unit.symbol, .least_span = 0.2, .holds_zero = true};
    draw::ChartArea band{.label = "95 %", .colour = draw::series_colour(0)};
    draw::ChartCurve measured{.label = "measured", .colour = draw::series_colour(0)};
    draw::ChartCurve beyond{.label = "beyond the lines", .colour = draw::series_colour(0)};
    beyond.line = draw::CurveLine::dotted;
    for (std::size_t i = 0; i < curve.value.size(); ++i) {
        band.outline.push_back({curve.image_height[i], curve.upper_95[i]});
        const Vec2d point{curve.image_height[i], curve.value[i]};
        const bool is_covered = point.x <= curve.covered_image_height;
        if (is_covered || beyond.points.empty()) {
            measured.points.push_back(point);
        }
        if (!is_covered) {
            beyond.points.push_back(beyond.points.empty() ? measured.points.back() : point);
        }
    }
    for (std::size_t i = curve.value.size(); i-- > 0;) {
        band.outline.push_back({curve.image_height[i], curve.lower_95[i]});
    }
    chart.areas = {band};
    chart.curves = {measured, beyond};
    return draw::chart_svg(chart);
}

std::vector<draw::MarkedLine> lines_in(const calibration::Profile& profile, const std::string& image) {
    std::vector<draw::MarkedLine> marked;
    for (const SceneLine& line : profile.scene_lines) {
        if (line.image == image) {
            marked.push_back({line.points_px, line.residual_px, line.used});
        }
    }
    return marked;
}

}  // namespace

void print_lines(const calibration::Profile& profile) {
    const auto terms = profile.terms.find(calibration::kLineDistortionTerms());
    if (profile.scene_lines.empty() || terms == profile.terms.end()) {
        return;
    }
    print("{}\n", in_words(profile.scene_lines));
    const calibration::FittedTerms& fitted = terms->second;
    for (std::size_t i = 0; i < fitted.names.size(); ++i) {
        print("{:22} {:.6g} ± {:.2g}\n", fitted.names[i], fitted.values[i],
              std::sqrt(fitted.covariance[i * (fitted.names.size() + 1)]));
    }
}

void write_line_plots(const std::filesystem::path& folder, const calibration::Profile& profile,
                      const calibration::MeasureInput& input) {
    std::map<std::string, std::string> files;
    files["distortion.svg"] = distortion_chart(profile);
    for (const calibration::Picture& picture : input.pictures) {
        const std::vector<draw::MarkedLine> own = lines_in(profile, picture.name);
        if (!own.empty()) {
            const formats::Image image = picture.load();
            const findings::Picture copy = findings::shown_picture(picture.name, "", image, kLinesWidth);
            files[fmt::format("lines_{}.svg", std::filesystem::path(picture.name).filename().string())] =
                draw::marked_lines_svg(picture.name, image.width, image.height, copy.bytes, own);
        }
    }
    draw::write_plots(folder, files);
}

}  // namespace lensproof::cli
