#include "experiments/draw/section_drawing.h"

#include <fmt/format.h>

#include <cmath>

#include "experiments/draw/clipping.h"

namespace lensproof::draw {

namespace {

void draw_axis(Svg& svg, const SectionView& view) {
    constexpr double kOverhang = 14.0;
    SvgPoint from = view.to_page({view.box.z_min, 0.0});
    SvgPoint to = view.to_page({view.box.z_max, 0.0});
    from.x -= kOverhang;
    to.x += kOverhang;
    svg.line(from, to, {.stroke = kQuiet, .width = 0.7, .dashes = "14 3 2 3", .class_name = "axis"});
}

/// The tint's strength rises with the index, from 0.4 at n_d = 1.4 to 1 at 2.
double tint_strength(double n_d) {
    constexpr double kUnknownIndex = 0.3;
    const double fraction = std::isfinite(n_d) ? std::clamp((n_d - 1.4) / 0.6, 0.0, 1.0) : kUnknownIndex;
    return 0.4 + 0.6 * fraction;
}

void draw_glass(Svg& svg, const SectionView& view, const SectionElement& element) {
    const std::string description =
        std::isfinite(element.n_d)
            ? fmt::format("{}: n_d {:.5g}{}", element.name, element.n_d,
                          std::isfinite(element.V_d) ? fmt::format(", V_d {:.4g}", element.V_d) : "")
            : element.name;
    const std::vector<SvgPoint> outline = view.to_page(element.outline);
    svg.path(outline,
             {.fill = glass_colour(glass_kind(element)),
              .opacity = tint_strength(element.n_d),
              .class_name = "glass",
              .description = description},
             true);
    svg.path(outline, {.stroke = kInk, .width = 1.1, .class_name = "outline"}, true);
}

/// The blades: a bar outwards from either end of the opening, thick outside and pointed at its edge.
void draw_stop(Svg& svg, const SectionView& view, const SectionSurface& surface) {
    constexpr double kLength = 22.0;  // px
    constexpr double kHalfWidth = 3.2;
    for (const double side : {-1.0, 1.0}) {
        const SvgPoint tip = view.to_page(side > 0.0 ? surface.curve.back() : surface.curve.front());
        const SvgPoint out{side * surface.across.z, -side * surface.across.y};
        const SvgPoint end{tip.x + kLength * out.x, tip.y + kLength * out.y};
        const SvgPoint wide{-kHalfWidth * out.y, kHalfWidth * out.x};
        svg.path({tip, {end.x + wide.x, end.y + wide.y}, {end.x - wide.x, end.y - wide.y}},
                 {.fill = "#111", .class_name = "stop", .description = "aperture stop"}, true);
    }
}

/// An ideal lens's symbol: a line with arrow heads, which point outwards where it collects light and inwards where it
/// spreads it.
void draw_ideal_lens(Svg& svg, const SectionView& view, const SectionSurface& surface) {
    constexpr double kHead = 7.0;  // px
    const SvgStyle style{.stroke = kInk, .width = 1.6, .class_name = "ideal-lens", .description = "ideal lens"};
    svg.path(view.to_page(surface.curve), style);
    for (const double side : {-1.0, 1.0}) {
        const SvgPoint tip = view.to_page(side > 0.0 ? surface.curve.back() : surface.curve.front());
        const SvgPoint out{side * surface.across.z, -side * surface.across.y};
        const double back = surface.ideal_focal_length_mm > 0.0 ? -kHead : kHead;
        for (const double beside : {-0.6 * kHead, 0.6 * kHead}) {
            svg.line(tip, {tip.x + back * out.x - beside * out.y, tip.y + back * out.y + beside * out.x}, style);
        }
    }
}

void draw_surfaces(Svg& svg, const SectionView& view, const SectionGeometry& geometry) {
    for (const SectionSurface& surface : geometry.surfaces) {
        if (surface.ideal_focal_length_mm != 0.0) {
            draw_ideal_lens(svg, view, surface);
        } else if (surface.is_phase) {
            svg.path(view.to_page(surface.curve),
                     {.stroke = kInk, .width = 2.0, .dashes = "1.5 1.5", .class_name = "grating"});
        }
        if (surface.is_mirror) {
            svg.path(view.to_page(surface.curve), {.stroke = kInk, .width = 2.6, .class_name = "mirror"});
        }
        if (surface.is_stop) {
            draw_stop(svg, view, surface);
        } else if ((!surface.is_glass && !surface.is_mirror && !surface.is_phase &&
                    surface.ideal_focal_length_mm == 0.0) ||
                   !surface.is_exact) {
            svg.path(view.to_page(surface.curve),
                     {.stroke = kQuiet, .width = 0.9, .dashes = "3 3", .class_name = "surface"});
        }
    }
}

void draw_barrels(Svg& svg, const SectionView& view, const SectionGeometry& geometry) {
    for (const std::array<SectionPoint, 2>& barrel : geometry.barrels) {
        for (const double side : {-1.0, 1.0}) {
            const SectionLine wall =
                clipped_to(view.box, {barrel[0].z, side * barrel[0].y}, {barrel[1].z, side * barrel[1].y});
            svg.path(view.to_page(wall), {.stroke = "#8a909b", .width = 2.6, .class_name = "barrel"});
        }
    }
}

void draw_sensor(Svg& svg, const SectionView& view, const SectionGeometry& geometry) {
    if (!(view.sensor_half_height > 0.0)) {
        return;
    }
    constexpr double kTick = 4.0;
    const SvgPoint top = view.to_page({geometry.image_z, view.sensor_half_height});
    const SvgPoint bottom = view.to_page({geometry.image_z, -view.sensor_half_height});
    const SvgStyle style{.stroke = kInk, .width = 2.0, .class_name = "sensor", .description = "sensor"};
    svg.line(top, bottom, style);
    for (const SvgPoint end : {top, bottom}) {
        svg.line({end.x - kTick, end.y}, {end.x + kTick, end.y}, {.stroke = kInk, .width = 1.2});
    }
}

/// A blocked ray ends in a cross.
void draw_block(Svg& svg, SvgPoint at, const char* colour) {
    constexpr double kArm = 4.0;
    const SvgStyle style{.stroke = colour, .width = 1.6, .class_name = "block", .description = "the ray ends here"};
    svg.line({at.x - kArm, at.y - kArm}, {at.x + kArm, at.y + kArm}, style);
    svg.line({at.x - kArm, at.y + kArm}, {at.x + kArm, at.y - kArm}, style);
}

void draw_ray(Svg& svg, const SectionView& view, const SectionRay& ray, const FieldLine& line, bool is_marginal) {
    // Piece by piece where the box cuts it, in one stroke where it does not.
    const SvgStyle style{.stroke = line.colour,
                         .width = is_marginal || ray.is_chief ? 1.1 : 0.7,
                         .dashes = line.dashes,
                         .opacity = is_marginal || ray.is_chief ? 1.0 : 0.6,
                         .class_name = ray.passes ? (ray.is_chief ? "ray chief" : "ray") : "ray blocked"};
    SectionLine run;
    for (std::size_t i = 0; i + 1 < ray.points.size(); ++i) {
        const SectionLine piece = clipped_to(view.box, ray.points[i], ray.points[i + 1]);
        if (piece.empty()) {
            continue;
        }
        if (run.empty()) {
            run.push_back(piece.front());
        }
        run.push_back(piece.back());
    }
    svg.path(view.to_page(run), style);
    if (!ray.passes && !run.empty()) {
        draw_block(svg, view.to_page(run.back()), line.colour);
    }
}

void draw_rays(Svg& svg, const SectionView& view, const SectionRays& rays) {
    for (std::size_t field = 0; field < rays.bundles.size(); ++field) {
        svg.open_group(fmt::format("bundle field-{}", field + 1));
        const std::vector<SectionRay>& bundle = rays.bundles[field].rays;
        for (const SectionRay& ray : bundle) {
            const bool is_marginal =
                &ray == &bundle.front() || (bundle.size() > 1 && &ray == &bundle[bundle.size() - 2]);
            draw_ray(svg, view, ray, field_line(field), is_marginal);
        }
        svg.close_group();
    }
}

void draw_marks(Svg& svg, const SectionView& view, const SectionGeometry& geometry, const SurfaceMarks& marks) {
    for (const auto& [number, severity] : marks) {
        if (number >= 1 && number <= static_cast<int>(geometry.surfaces.size())) {
            svg.path(view.to_page(geometry.surfaces[number - 1].curve),
                     {.stroke = severity_colour(severity),
                      .width = 2.8,
                      .class_name = fmt::format("marked {} surface-{}", optics::severity_name(severity), number)});
        }
    }
}

}  // namespace

const char* severity_colour(optics::Severity severity) {
    switch (severity) {
        case optics::Severity::info:
            return "#4b6a9b";
        case optics::Severity::warning:
            return "#e07b00";
        case optics::Severity::error:
            break;
    }
    return "#d0021b";
}

void SectionBox::hold(SectionPoint point) {
    z_min = std::min(z_min, point.z);
    z_max = std::max(z_max, point.z);
    y_min = std::min(y_min, point.y);
    y_max = std::max(y_max, point.y);
}

void SectionBox::hold(const SectionLine& line) {
    for (const SectionPoint point : line) {
        hold(point);
    }
}

std::vector<SvgPoint> SectionView::to_page(const SectionLine& line) const {
    std::vector<SvgPoint> points;
    std::ranges::transform(line, std::back_inserter(points), [&](SectionPoint point) { return to_page(point); });
    return points;
}

SectionBox glass_box(const SectionGeometry& geometry) {
    SectionBox box;
    for (const SectionSurface& surface : geometry.surfaces) {
        box.hold(surface.curve);
    }
    for (const SectionElement& element : geometry.elements) {
        box.hold(element.outline);
    }
    for (const std::array<SectionPoint, 2>& barrel : geometry.barrels) {
        box.hold({barrel[0].z, barrel[0].y});
        box.hold({barrel[0].z, -barrel[0].y});
    }
    return box;
}

SectionLine clipped_to(const SectionBox& box, SectionPoint a, SectionPoint b) {
    SectionLine inside;
    for (const auto& piece :
         clipped_line({{a.z, a.y}, {b.z, b.y}}, {box.z_min, box.y_min, box.width(), box.height()})) {
        inside = {{piece.front().x, piece.front().y}, {piece.back().x, piece.back().y}};
    }
    return inside;
}

void draw_section(Svg& svg, const SectionView& view, const SectionGeometry& geometry, const SectionRays& rays,
                  const SurfaceMarks& marks) {
    svg.open_group("section");
    for (const SectionElement& element : geometry.elements) {
        draw_glass(svg, view, element);
    }
    draw_axis(svg, view);
    draw_barrels(svg, view, geometry);
    draw_rays(svg, view, rays);
    draw_surfaces(svg, view, geometry);
    draw_sensor(svg, view, geometry);
    draw_marks(svg, view, geometry, marks);
    svg.close_group();
}

GlassKind glass_kind(const SectionElement& element) {
    if (!std::isfinite(element.n_d) || !std::isfinite(element.V_d)) {
        return GlassKind::unknown;
    }
    return element.V_d > (element.n_d < 1.6 ? 55.0 : 50.0) ? GlassKind::crown : GlassKind::flint;
}

const char* glass_colour(GlassKind kind) {
    switch (kind) {
        case GlassKind::crown:
            return "#a9cbee";
        case GlassKind::flint:
            return "#ecd29a";
        case GlassKind::unknown:
            break;
    }
    return "#d3d7dd";
}

}  // namespace lensproof::draw
