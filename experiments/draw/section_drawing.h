// experiments/draw/section_drawing.h — a lens section put on the page: glass, stop, barrels, sensor and rays.
#pragma once
#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "experiments/draw/palette.h"
#include "experiments/draw/section_rays.h"
#include "experiments/draw/svg.h"

namespace lensproof::draw {

const char* severity_colour(optics::Severity severity);

/// A rectangle of lens space, mm.
struct SectionBox {
    double z_min = 0.0;
    double z_max = 0.0;
    double y_min = 0.0;
    double y_max = 0.0;

    void hold(SectionPoint point);
    void hold(const SectionLine& line);
    [[nodiscard]] double width() const { return z_max - z_min; }
    [[nodiscard]] double height() const { return y_max - y_min; }
};

/// Which part of lens space is shown, and where on the page: one scale along and across the axis.
struct SectionView {
    SectionBox box;
    double scale = 1.0;               // px per mm
    SvgPoint corner;                  // of the box, top left
    double sensor_half_height = 0.0;  // mm; 0: the sensor is not shown

    [[nodiscard]] SvgPoint to_page(SectionPoint point) const {
        return {corner.x + scale * (point.z - box.z_min), corner.y + scale * (box.y_max - point.y)};
    }
    [[nodiscard]] std::vector<SvgPoint> to_page(const SectionLine& line) const;
};

/// The worst finding of each marked surface (from 1): an error or a warning.
using SurfaceMarks = std::map<int, optics::Severity>;

/// The box around the glass, with nothing of the sensor or the rays.
SectionBox glass_box(const SectionGeometry& geometry);

/// The part of the segment from a to b inside the box; empty where there is none.
SectionLine clipped_to(const SectionBox& box, SectionPoint a, SectionPoint b);

/// Draws the section, from the axis up to the marked surfaces.
void draw_section(Svg& svg, const SectionView& view, const SectionGeometry& geometry, const SectionRays& rays,
                  const SurfaceMarks& marks);

/// Crowns are the glasses with V_d above 50, or above 55 where n_d is below 1.6, as catalogues divide them.
enum class GlassKind { crown, flint, unknown };
GlassKind glass_kind(const SectionElement& element);
const char* glass_colour(GlassKind kind);

}  // namespace lensproof::draw
