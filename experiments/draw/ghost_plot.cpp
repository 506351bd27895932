#include "experiments/draw/ghost_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/draw/heat_map.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/section_drawing.h"

namespace lensproof::draw {

namespace {

constexpr double kGhostEdge = 40.0;  // px, as what follows
constexpr double kGhostWidth = 1100.0;
constexpr double kLargestSection = 420.0;
constexpr double kFootprintSide = 230.0;
constexpr double kFootprintGap = 24.0;
constexpr double kFootprintTitle = 24.0;
constexpr std::size_t kFootprintColumns = 4;
constexpr double kGhostTextSize = 12.5;
constexpr const char* kMirrorColour = "#c8420a";

/// Rays of a ghost in the plane x = 0 that land, and where they are reflected.
struct DrawnPath {
    SectionBundle bundle;
    SectionLine reflections;
};

SectionRay drawn_ray(const analysis::GhostScene& scene, const optics::GhostPath& path, const Ray<double>& ray,
                     SectionLine& reflections) {
    SectionRay drawn;
    auto next = path.begin();
    const auto out = optics::trace_ghost(scene.lens, path, ray, scene.mirrors, [&](const auto& event) {
        const SectionPoint at{event.ray.origin.z, event.ray.origin.y};
        if (drawn.points.empty()) {  // from a little in front
            const double lead = 0.5 * scene.beam.side() / ray.direction.z;
            drawn.points.push_back({at.z - lead * ray.direction.z, at.y - lead * ray.direction.y});
        }
        drawn.points.push_back(at);
        if (next != path.end() && *next == event.surface) {
            reflections.push_back(at);
            ++next;
        }
    });
    const Vec3d image = optics::meet_plane(out.ray, scene.lens.image_z).point;
    drawn.points.push_back({image.z, image.y});
    return drawn;
}

/// Some of the rays that land, evenly over them.
DrawnPath drawn_path(const analysis::GhostScene& scene, const optics::GhostPath& path) {
    constexpr int kTried = 2000;
    constexpr std::size_t kDrawn = 9;
    std::vector<Vec2d> landing;
    for (int i = 0; i < kTried; ++i) {
        const Vec2d offset{0.0, scene.beam.corner().y + (i + 0.5) / kTried * scene.beam.side()};
        if (analysis::landing(scene, path, offset)) {
            landing.push_back(offset);
        }
    }
    DrawnPath drawn;
    for (std::size_t i = 0; i < std::min(kDrawn, landing.size()); ++i) {
        const std::size_t ray = landing.size() <= kDrawn ? i : i * (landing.size() - 1) / (kDrawn - 1);
        drawn.bundle.rays.push_back(drawn_ray(scene, path, scene.beam.ray(landing[ray]), drawn.reflections));
    }
    return drawn;
}

/// Draws the section with the ghost's rays; returns where the page is free below.
double draw_ghost_section(Svg& svg, const SectionGeometry& geometry, const analysis::GhostScene& scene,
                          const DrawnGhost& ghost, double top) {
    const DrawnPath drawn = drawn_path(scene, ghost.path);
    SectionView view;
    view.box = glass_box(geometry);
    view.sensor_half_height = scene.image_radius;
    view.box.hold({geometry.image_z, scene.image_radius});
    view.box.hold({geometry.image_z, -scene.image_radius});
    for (const SectionRay& ray : drawn.bundle.rays) {
        view.box.hold(ray.points.front());
    }
    view.scale = std::min((kGhostWidth - 2.0 * kGhostEdge) / std::max(view.box.width(), 1e-6),
                          kLargestSection / std::max(view.box.height(), 1e-6));
    view.corner = {0.5 * (kGhostWidth - view.scale * view.box.width()), top + 24.0};
    const std::string remark = drawn.bundle.rays.empty() ? "; none of its rays in the plane of the drawing lands" : "";
    svg.text(
        {kGhostEdge, top + 8.0},
        fmt::format("The strongest, reflected at {} (marked): {:.3g} of the light{}", ghost.name, ghost.energy, remark),
        {.size = kGhostTextSize, .fill = kInk, .bold = true, .class_name = "strongest"});
    draw_section(svg, view, geometry, {.bundles = {drawn.bundle}, .remark = {}}, {});
    for (const SectionPoint& at : drawn.reflections) {
        svg.circle(view.to_page(at), 3.0, {.fill = kMirrorColour, .class_name = "reflection"});
    }
    return view.corner.y + view.scale * view.box.height() + kGhostEdge;
}

HeatMap footprint_map(const analysis::Footprint& footprint, double radius, const AxisRange& range) {
    constexpr int kBinned = 2;
    constexpr std::size_t kColumns = analysis::Footprint::kPixels / kBinned;
    HeatMap map{.columns = kColumns,
                .rows = kColumns,
                .values = std::vector<double>(kColumns * kColumns),
                .x = {-radius, radius},
                .y = {-radius, radius},
                .scale = AxisScale::logarithmic,
                .range = range,
                .label = "energy",
                .unit = "1/mm²"};
    const double side = 2.0 * radius / kColumns;
    for (std::size_t i = 0; i < footprint.pixels().size(); ++i) {
        const std::size_t x = i % analysis::Footprint::kPixels / kBinned;
        const std::size_t y = i / analysis::Footprint::kPixels / kBinned;
        map.values[y * kColumns + x] += footprint.pixels()[i] / (side * side);
    }
    return map;
}

/// The brightest of all footprints down to four decades below.
AxisRange footprint_range(const std::vector<DrawnGhost>& ghosts) {
    double brightest = 0.0;
    for (const DrawnGhost& ghost : ghosts) {
        brightest = std::max(brightest, ghost.footprint.peak());
    }
    return {1e-4 * brightest, brightest};
}

double draw_footprints(Svg& svg, const std::vector<DrawnGhost>& ghosts, double radius, double top) {
    svg.text({kGhostEdge, top + 8.0}, "On the sensor, inside the image circle",
             {.size = kGhostTextSize, .fill = kInk, .bold = true});
    top += 20.0;
    const AxisRange range = footprint_range(ghosts);
    for (std::size_t i = 0; i < ghosts.size(); ++i) {
        const DrawnGhost& ghost = ghosts[i];
        const std::size_t column = i % kFootprintColumns;
        const std::size_t row = i / kFootprintColumns;
        const PageBox box{kGhostEdge + static_cast<double>(column) * (kFootprintSide + kFootprintGap),
                          top + static_cast<double>(row) * (kFootprintSide + kFootprintTitle) + kFootprintTitle,
                          kFootprintSide, kFootprintSide};
        svg.text({box.x, box.y - 6.0}, fmt::format("{}   {:.3g}", ghost.name, ghost.energy),
                 {.size = kGhostTextSize, .fill = kInk, .class_name = "footprint"});
        const HeatMap map = footprint_map(ghost.footprint, radius, range);
        draw_heat_map(svg, map, box);
        svg.circle({box.x + 0.5 * kFootprintSide, box.y + 0.5 * kFootprintSide}, 0.5 * kFootprintSide,
                   {.stroke = kFaint});
        if (i == std::min(ghosts.size(), kFootprintColumns) - 1) {
            draw_colour_bar(svg, map, box);
        }
    }
    const double rows = std::ceil(static_cast<double>(ghosts.size()) / kFootprintColumns);
    return top + rows * (kFootprintSide + kFootprintTitle) + 0.5 * kGhostEdge;
}

}  // namespace

std::string ghosts_svg(const optics::Prescription& prescription, const optics::Lens& lens,
                       const analysis::GhostScene& scene, const std::string& conditions,
                       const std::vector<DrawnGhost>& ghosts) {
    Svg svg("Ghosts of " + prescription.name);
    svg.text({kGhostEdge, 34.0}, shortened("Ghosts of " + prescription.name, 100),
             {.size = 17.0, .fill = kInk, .bold = true, .class_name = "title"});
    svg.text({kGhostEdge, 54.0}, conditions, {.size = kGhostTextSize, .fill = kQuiet, .class_name = "conditions"});
    double y = 78.0;
    if (ghosts.empty()) {
        svg.text({kGhostEdge, y}, "No ghost reaches the image circle.", {.size = kGhostTextSize, .fill = kInk});
        return svg.document(kGhostWidth, y + kGhostEdge);
    }
    y = draw_ghost_section(svg, section_geometry(prescription, &lens), scene, ghosts.front(), y);
    y = draw_footprints(svg, ghosts, scene.image_radius, y);
    return svg.document(kGhostWidth + 60.0, y);
}

}  // namespace lensproof::draw
