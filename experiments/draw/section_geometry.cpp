#include "experiments/draw/section_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/base/bisect.h"
#include "engine/base/infinity.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::draw {

namespace {

constexpr double kLargest = 1e7;  // mm, as in make_lens

bool is_length(double value) {
    return value > 0.0 && value <= kLargest;
}

std::optional<double> usable(const std::optional<double>& length) {
    return length && is_length(*length) ? length : std::nullopt;
}

/// A surface in its place: the lens's own, or what the table gives without it.
struct PlacedSurface {
    optics::LensSurface surface;
    bool is_exact = true;
};

/// The table as it stands, without what its misaligned groups do. `fallback`: the semi-diameter where none is stated.
std::vector<PlacedSurface> placed_by_table(const optics::Prescription& prescription, double fallback) {
    std::vector<PlacedSurface> placed;
    double z = 0.0;
    for (const optics::PrescribedSurface& row : prescription.surfaces) {
        PlacedSurface& here = placed.emplace_back();
        optics::LensSurface& surface = here.surface;
        const bool has_radius = row.is_flat() || std::abs(row.radius_mm) <= kLargest * kLargest;
        surface.curvature = has_radius ? row.curvature() : 0.0;
        surface.vertex_z = z;
        surface.semi_diameter = usable(row.semi_diameter_mm).value_or(usable(row.rim_mm).value_or(fallback));
        surface.is_stop = row.is_stop;
        surface.shape = {.curvature = surface.curvature, .conic = std::isfinite(row.conic) ? row.conic : 0.0};
        const auto is_finite = [](double term) { return std::isfinite(term); };
        if (std::ranges::all_of(row.asphere, is_finite) && std::ranges::all_of(row.odd_asphere, is_finite)) {
            surface.shape.asphere = row.asphere;
            surface.shape.terms = row.is_asphere() ? optics::kAsphereTerms : 0;
            surface.shape.odd_asphere = row.odd_asphere;
            surface.shape.odd_terms = row.has_odd_terms() ? optics::kAsphereTerms : 0;
            surface.shape.along_normal = row.along_normal;
        }
        here.is_exact = has_radius && (!row.semi_diameter_mm || usable(row.semi_diameter_mm));
        z += std::abs(row.thickness_mm) <= kLargest ? row.thickness_mm : 0.0;
    }
    return placed;
}

/// The largest usable semi-diameter of the table; a third of its length where it states none.
double fallback_semi_diameter(const optics::Prescription& prescription) {
    double largest = 0.0;
    double length = 0.0;
    for (const optics::PrescribedSurface& row : prescription.surfaces) {
        largest = std::max({largest, usable(row.semi_diameter_mm).value_or(0.0), usable(row.rim_mm).value_or(0.0)});
        length += is_length(row.thickness_mm) ? row.thickness_mm : 0.0;
    }
    return largest > 0.0 ? largest : std::max(length / 3.0, 1.0);
}

/// How a surface's own y and z lie in the section. Its meridian is the one whose direction lies in the section, so that
/// a turned cylinder shows the curve that the section cuts.
class OwnFrame {
  public:
    explicit OwnFrame(const optics::LensSurface& surface) : surface_(surface) {
        const double x = -surface.axes[1].x;
        const double y = surface.axes[0].x;
        const double size = std::hypot(x, y);
        constexpr double kEdgeOn = 1e-6;
        u_ = size > kEdgeOn ? x / size : 0.0;
        v_ = size > kEdgeOn ? y / size : 1.0;
        const Vec3d along = u_ * surface.axes[0] + v_ * surface.axes[1];
        across_ = {along.z, along.y};
        if (across_.y < 0.0) {
            u_ = -u_;
            v_ = -v_;
            across_ = {-across_.z, -across_.y};
        }
    }

    /// The surface at height t of its meridian; not finite where it does not exist.
    [[nodiscard]] SectionPoint at(double t) const {
        optics::SurfaceShape<double> shape = surface_.shape;
        shape.curvature = surface_.curvature;
        const double height = optics::sag(shape, t * u_, t * v_);
        // An asphere whose coefficients run away ends where no glass could be.
        constexpr double kSteepest = 4.0;
        return point(t, std::abs(height) <= kSteepest * surface_.semi_diameter ? height : kNaN);
    }

    [[nodiscard]] SectionPoint across() const { return across_; }

  private:
    [[nodiscard]] SectionPoint point(double t, double height) const {
        return {surface_.vertex_z + t * across_.z + height * surface_.axes[2].z,
                surface_.vertex.y + t * across_.y + height * surface_.axes[2].y};
    }

    const optics::LensSurface& surface_;
    double u_ = 0.0;
    double v_ = 1.0;
    SectionPoint across_;
};

bool is_finite(SectionPoint point) {
    return std::isfinite(point.z) && std::isfinite(point.y);
}

/// The last height at which the surface exists: the semi-diameter, or the equator.
double drawn_height(const OwnFrame& frame, double semi_diameter) {
    constexpr int kHalvings = 40;
    const auto exists = [&](double height) { return is_finite(frame.at(height)) && is_finite(frame.at(-height)); };
    return exists(semi_diameter) ? semi_diameter : bisected({0.0, semi_diameter}, kHalvings, exists).inside;
}

SectionLine profile(const OwnFrame& frame, double reach) {
    // Even in angle, as a hemisphere's end is steep: 64 chords leave its arc by 0.03 % of the radius.
    constexpr int kChords = 64;
    SectionLine curve;
    for (int i = 0; i <= kChords; ++i) {
        const double angle = std::numbers::pi * (static_cast<double>(i) / kChords - 0.5);
        curve.push_back(frame.at(reach * std::sin(angle)));
    }
    return curve;
}

SectionPoint moved(SectionPoint point, double by, SectionPoint along) {
    return {point.z + by * along.z, point.y + by * along.y};
}

/// The element between two surfaces, its edges at `semi_diameter`; `heading`: where light runs in it, along z or (−1)
/// against it.
SectionLine element_outline(const SectionSurface& front, const SectionSurface& back, double semi_diameter,
                            double heading) {
    SectionLine outline;
    const auto step = [&](const SectionSurface& surface, double side) {
        const SectionPoint end = side > 0.0 ? surface.curve.back() : surface.curve.front();
        return moved(end, side * std::max(0.0, semi_diameter - surface.semi_diameter), surface.across);
    };
    const auto has_room = [&](double side) { return heading * (step(back, side).z - step(front, side).z) > 0.0; };
    // Up the front, over the upper edge, down the back, over the lower edge.
    outline = front.curve;
    if (has_room(1.0)) {
        outline.push_back(step(front, 1.0));
        outline.push_back(step(back, 1.0));
    }
    outline.insert(outline.end(), back.curve.rbegin(), back.curve.rend());
    if (has_room(-1.0)) {
        outline.push_back(step(back, -1.0));
        outline.push_back(step(front, -1.0));
    }
    return outline;
}

std::string medium_name(const optics::StatedMedium& medium, double n_d, double V_d) {
    if (!medium.glass.empty()) {
        return medium.glass;
    }
    if (!std::isfinite(n_d)) {
        return "?";
    }
    return std::isfinite(V_d) ? fmt::format("{:.4g}/{:.3g}", n_d, V_d) : fmt::format("{:.4g}", n_d);
}

SectionElement element(const optics::Prescription& prescription, const optics::Lens* lens,
                       const std::vector<SectionSurface>& surfaces, std::size_t i) {
    const optics::PrescribedSurface& row = prescription.surfaces[i];
    SectionElement made;
    made.front = static_cast<int>(i) + 1;
    made.n_d = row.medium.n_d.value_or(kNaN);
    made.V_d = row.medium.V_d.value_or(kNaN);
    if (lens != nullptr) {
        const optics::Glass& glass = lens->surfaces[i].medium;
        made.n_d = optics::refractive_index(glass.formula, spectral::kLineD);
        made.V_d = optics::abbe_number(glass.formula);
    }
    made.name = medium_name(row.medium, made.n_d, made.V_d);
    const auto mechanical = [&](std::size_t k) {
        return std::max(surfaces[k].semi_diameter, usable(prescription.surfaces[k].rim_mm).value_or(0.0));
    };
    const auto end = prescription.surfaces.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    const auto mirrors =
        std::count_if(prescription.surfaces.begin(), end, [](const auto& each) { return each.is_mirror; });
    made.outline = element_outline(surfaces[i], surfaces[i + 1], std::max(mechanical(i), mechanical(i + 1)),
                                   mirrors % 2 == 0 ? 1.0 : -1.0);
    return made;
}

}  // namespace

SectionGeometry section_geometry(const optics::Prescription& prescription, const optics::Lens* lens) {
    std::vector<PlacedSurface> placed = placed_by_table(prescription, fallback_semi_diameter(prescription));
    SectionGeometry geometry;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const optics::PrescribedSurface& row = prescription.surfaces[i];
        if (lens != nullptr) {
            placed[i] = {lens->surfaces[i], is_length(lens->surfaces[i].semi_diameter)};
            optics::LensSurface& surface = placed[i].surface;
            const double clear = usable(row.semi_diameter_mm).value_or(surface.semi_diameter);
            surface.semi_diameter = is_length(clear) ? clear : fallback_semi_diameter(prescription);
        }
        const OwnFrame frame(placed[i].surface);
        const double reach = drawn_height(frame, placed[i].surface.semi_diameter);
        const bool glass_before = i > 0 && !prescription.surfaces[i - 1].medium.is_air();
        geometry.surfaces.push_back({.number = static_cast<int>(i) + 1,
                                     .curve = profile(frame, reach),
                                     .across = frame.across(),
                                     .semi_diameter = reach,
                                     .is_stop = row.is_stop,
                                     .is_mirror = row.is_mirror,
                                     .is_glass = glass_before || !row.medium.is_air(),
                                     .ideal_focal_length_mm = row.ideal_focal_length_mm.value_or(0.0),
                                     .is_phase = row.phase.has_value(),
                                     .is_exact = placed[i].is_exact});
    }
    for (std::size_t i = 0; i + 1 < placed.size(); ++i) {
        if (!prescription.surfaces[i].medium.is_air()) {
            geometry.elements.push_back(element(prescription, lens, geometry.surfaces, i));
        }
    }
    if (!placed.empty()) {
        const double behind = prescription.surfaces.back().thickness_mm;
        geometry.image_z = lens != nullptr
                               ? lens->image_z
                               : placed.back().surface.vertex_z + (std::abs(behind) <= kLargest ? behind : 0.0);
    }
    for (std::size_t i = 0; i < placed.size(); ++i) {
        if (const auto radius = usable(prescription.surfaces[i].barrel_mm)) {
            const double start = geometry.surfaces[i].curve.back().z;
            const double end = i + 1 < placed.size() ? geometry.surfaces[i + 1].curve.back().z : geometry.image_z;
            geometry.barrels.push_back({{{start, *radius}, {std::max(start, end), *radius}}});
        }
    }
    return geometry;
}

}  // namespace lensproof::draw
