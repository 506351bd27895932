#include "engine/analysis/polychromatic_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "engine/base/input_error.h"
#include "engine/optics/rim_margin.h"

namespace lensproof::analysis {

namespace {

constexpr double kTurn = 2.0 * kPi;

/// From the plane in which the outline's radii are straight to offsets (RegionOutline::bend).
Vec2d bent(const optics::RegionOutline& outline, Vec2d straight) {
    const double x = straight.x - outline.centre.x;
    return {straight.x, straight.y + outline.bend * x * x};
}

/// The beam's outline in polar coordinates that are stretched to its height and width, so that a slim one is seen
/// evenly.
class Outline {
  public:
    Outline(const PolychromaticField::Part& part, const optics::FieldBundle& bundle)
        : region_([&](Vec2d straight) {
              return optics::rim_margin(part.lens, bundle.ray(bent(part.outline, straight)),
                                        optics::Direction::forward);
          }),
          centre_(part.outline.centre) {
        for (const optics::OutlinePoint& point : part.outline.points) {
            stretch_ = {std::max(stretch_.x, std::abs(point.edge.x)), std::max(stretch_.y, std::abs(point.edge.y))};
        }
    }

    /// From the centre to the rim.
    [[nodiscard]] Vec2d edge_at(double azimuth) const {
        const Vec2d along = along_at(azimuth);
        return optics::region_edge(region_, centre_, along).distance * along;
    }

    /// d area = factor · t dt d azimuth, t running from 0 to 1 along an edge.
    [[nodiscard]] double area_factor(double azimuth, Vec2d edge) const {
        const Vec2d along = along_at(azimuth);
        const double stretched = dot(edge, along) / dot(along, along);
        return stretch_.x * stretch_.y * stretched * stretched;
    }

    /// The azimuths, ascending, where one rim takes over from another; those between which no even azimuth lies are not
    /// seen.
    [[nodiscard]] std::vector<double> corners(int azimuths) const {
        std::vector<double> found;
        int last = limit_at(0.0);
        for (int i = 1; i <= azimuths; ++i) {
            const int here = limit_at(kTurn * i / azimuths);
            if (here != last) {
                const Bracket corner{kTurn * (i - 1) / azimuths, kTurn * i / azimuths};
                found.push_back(bisected(corner, 30, [&](double at) { return limit_at(at) == last; }).inside);
            }
            last = here;
        }
        return found;
    }

  private:
    [[nodiscard]] Vec2d along_at(double azimuth) const {
        return {stretch_.x * std::cos(azimuth), stretch_.y * std::sin(azimuth)};
    }
    [[nodiscard]] int limit_at(double azimuth) const {
        return optics::region_edge(region_, centre_, along_at(azimuth)).limit;
    }

    optics::Region region_;
    Vec2d centre_;
    Vec2d stretch_;
};

}  // namespace

PolychromaticField polychromatic_field(const optics::Lens& lens, const optics::FieldBundle& bundle, double reference_nm,
                                       std::span<const WeightedWavelength> wavelengths) {
    PolychromaticField field{.bundle = bundle};
    const optics::TraceLens<double> reference = optics::at_wavelength<double>(lens, reference_nm);
    const std::optional<ReferenceSphere> sphere = reference_sphere(reference, bundle);
    if (!sphere) {
        return field;
    }
    field.sphere = *sphere;
    field.chief_direction =
        reference.surfaces.back().index_after * optics::trace_past_rims(reference, bundle.ray({})).ray.direction;
    double total = 0.0;
    for (const WeightedWavelength& of : wavelengths) {
        if (!(of.weight >= 0.0) || !std::isfinite(of.weight)) {
            throw InputError(
                fmt::format("the weight of {} nm is {}: expected 0 or a positive number", of.wavelength_nm, of.weight));
        }
        optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, of.wavelength_nm);
        optics::RegionOutline outline = beam_outline(traced, bundle);
        if (of.weight > 0.0 && outline.area > 0.0) {
            const double weight = of.weight * outline.area;
            total += weight;
            field.parts.push_back({of.wavelength_nm, weight, std::move(traced), std::move(outline)});
        }
    }
    for (PolychromaticField::Part& part : field.parts) {
        part.weight /= total;
    }
    return field;
}

std::vector<optics::RegionNode> polar_nodes(const PolychromaticField::Part& part, const optics::FieldBundle& bundle,
                                            int azimuths, int rings) {
    if (part.outline.is_empty()) {
        return {};
    }
    const Outline outline(part, bundle);
    std::vector<optics::RegionNode> nodes;
    const optics::GaussRule radial = optics::gauss_legendre(rings);
    const auto add = [&](double azimuth, double width) {
        const Vec2d edge = outline.edge_at(azimuth);
        const double wedge = width * outline.area_factor(azimuth, edge);
        for (std::size_t k = 0; k < radial.nodes.size(); ++k) {
            const double t = radial.nodes[k];
            nodes.push_back({bent(part.outline, part.outline.centre + t * edge), wedge * radial.weights[k] * t});
        }
    };
    const std::vector<double> corners = outline.corners(azimuths);
    if (corners.empty()) {
        for (int i = 0; i < azimuths; ++i) {
            add(kTurn * (i + 0.5) / azimuths, kTurn / azimuths);
        }
        return nodes;
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const double from = corners[i];
        const double arc = (i + 1 < corners.size() ? corners[i + 1] : corners.front() + kTurn) - from;
        const optics::GaussRule along = optics::gauss_legendre(static_cast<int>(std::ceil(azimuths * arc / kTurn)) + 2);
        for (std::size_t k = 0; k < along.nodes.size(); ++k) {
            add(from + arc * along.nodes[k], arc * along.weights[k]);
        }
    }
    return nodes;
}

std::optional<ImageRay> image_ray(const PolychromaticField::Part& part, const PolychromaticField& field, Vec2d offset) {
    const optics::TracedRay<double> traced = optics::trace_past_rims(part.lens, field.bundle.ray(offset));
    const ReferenceSphere plane{.centre = field.sphere.centre, .curvature = 0.0};
    const std::optional<SphereMeeting> meeting = meet_sphere(part.lens, plane, traced);
    if (!meeting || !(traced.ray.direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d at = optics::meet_plane(traced.ray, plane.centre.z).point - plane.centre;
    return ImageRay{.direction = part.lens.surfaces.back().index_after * traced.ray.direction,
                    .aberration = {at.x, at.y},
                    .path = meeting->optical_path,
                    .passes = traced.status == optics::RayStatus::ok};
}

}  // namespace lensproof::analysis
