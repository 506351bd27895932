#include "experiments/draw/line_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/draw/palette.h"
#include "experiments/draw/svg.h"

namespace lensproof::draw {

namespace {

constexpr double kLinePageWidth = 1200.0;  // of the picture
constexpr double kLineMargin = 12.0;
constexpr double kLineTitleHeight = 48.0;
constexpr double kShownResidual = 10.0;  // px of the page, of all but a twentieth of the residuals used

// 1, 2 or 5 times a power of ten, at most `most`.
double round_factor(double most) {
    const double power = std::pow(10.0, std::floor(std::log10(most)));
    const double lead = most / power;
    return power * (lead >= 5.0 ? 5.0 : lead >= 2.0 ? 2.0 : 1.0);
}

double enlargement(const std::vector<MarkedLine>& lines, double scale) {
    std::vector<double> sizes;
    for (const MarkedLine& line : lines) {
        for (std::size_t i = 0; line.used && i < line.residual_px.size(); ++i) {
            sizes.push_back(std::abs(line.residual_px[i]));
        }
    }
    if (sizes.empty()) {
        return 1.0;
    }
    std::ranges::sort(sizes);
    const double large = sizes[static_cast<std::size_t>(0.95 * static_cast<double>(sizes.size() - 1))];
    return large > 0.0 ? std::clamp(round_factor(kShownResidual / (scale * large)), 1.0, 1e4) : 1.0;
}

}  // namespace

std::string marked_lines_svg(const std::string& title, int width_px, int height_px, std::string_view png,
                             const std::vector<MarkedLine>& lines) {
    const double scale = kLinePageWidth / width_px;
    const PageBox box{kLineMargin, kLineTitleHeight, kLinePageWidth, scale * height_px};
    const auto on_page = [&](const Vec2d& px) {
        return SvgPoint{box.x + scale * (px.x + 0.5), box.y + scale * (px.y + 0.5)};
    };
    const double factor = enlargement(lines, scale);
    const auto used = std::ranges::count(lines, true, &MarkedLine::used);
    Svg svg(title);
    svg.text({kLineMargin, 20.0}, shortened(title, 120), {.size = 14.0, .fill = kInk, .bold = true});
    svg.text(
        {kLineMargin, 38.0},
        fmt::format("{} straight lines (blue), {} left out (vermilion, dashed); beside them, thin, their points with "
                    "residuals enlarged {:g} times",
                    used, static_cast<std::ptrdiff_t>(lines.size()) - used, factor),
        {.size = 12.0, .fill = kQuiet});
    svg.picture(box, png, title);
    svg.open_viewport("lines", box);
    for (const MarkedLine& line : lines) {
        std::vector<SvgPoint> points;
        std::vector<SvgPoint> enlarged;
        const Vec2d chord = line.points_px.back() - line.points_px.front();
        const double size = std::hypot(chord.x, chord.y);
        const Vec2d left{chord.y / size, -chord.x / size};
        for (std::size_t i = 0; i < line.points_px.size(); ++i) {
            const double e = i < line.residual_px.size() ? factor * line.residual_px[i] : 0.0;
            points.push_back(on_page(line.points_px[i]));
            enlarged.push_back(on_page(line.points_px[i] + e * left));
        }
        const std::string colour = series_colour(line.used ? 0 : 1);
        svg.path(points, {.stroke = "#fff", .width = 3.4, .opacity = 0.8});
        svg.path(points, {.stroke = colour, .width = 1.8, .dashes = line.used ? "" : "6 3"});
        if (line.used) {
            svg.path(enlarged, {.stroke = "#ffb000", .width = 0.9});
        }
    }
    svg.close_viewport();
    return svg.document(box.x + box.width + kLineMargin, box.y + box.height + kLineMargin);
}

}  // namespace lensproof::draw
