#include "engine/optics/region_outline.h"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "engine/base/angle.h"

namespace lensproof::optics {

namespace {

constexpr double kAreaTolerance = 1e-11;
// A corner that is off by δ costs δ² / 2 times the change of slope.
constexpr double kCornerTolerance = 1e-6;
constexpr int kMostHalvings = 24;
/// A smooth piece's error falls by 2^-14 and more with each halving. Where an outline jumps, that of one half stays in
/// proportion to its width, the other's falls: no more than kMostHalvings stay before as many fall. Of rounding, both
/// halves' stay.
constexpr double kFalls = 0.05;
constexpr int kMostStays = kMostHalvings + 8;
/// With twice as many in the pieces that were halved, some 60 looks an edge and 17 centres: two million looks.
constexpr std::size_t kMostPoints = 1000;
constexpr int kPoints = 15;

/// Gauss-Kronrod's nodes on [−1, 1], ascending; `gauss` is 0 at those that the 7 Gauss nodes do not have. The
/// `barycentric` weights give the polynomial through values at the nodes (Berrut and Trefethen, SIAM Review 46, 2004).
struct Kronrod {
    std::array<double, kPoints> node{};
    std::array<double, kPoints> weight{};
    std::array<double, kPoints> gauss{};
    std::array<double, kPoints> barycentric{};
};

const Kronrod& kronrod() {
    static const Kronrod rule = [] {
        using boost::math::quadrature::gauss;
        using boost::math::quadrature::gauss_kronrod;
        Kronrod made;
        constexpr int kMiddle = kPoints / 2;
        for (int i = 0; i <= kMiddle; ++i) {
            for (const int k : {kMiddle - i, kMiddle + i}) {
                made.node[k] = (k < kMiddle ? -1.0 : 1.0) * gauss_kronrod<double, kPoints>::abscissa()[i];
                made.weight[k] = gauss_kronrod<double, kPoints>::weights()[i];
                made.gauss[k] = i % 2 == 0 ? gauss<double, kMiddle>::weights()[i / 2] : 0.0;
            }
        }
        for (int i = 0; i < kPoints; ++i) {
            made.barycentric[i] = 1.0;
            for (int k = 0; k < kPoints; ++k) {
                made.barycentric[i] /= k == i ? 1.0 : made.node[i] - made.node[k];
            }
        }
        return made;
    }();
    return rule;
}

/// Polar coordinates about a point inside the region, with axes stretched so that the region is about as wide as high.
class PolarFrame {
  public:
    PolarFrame(const Region& region, Vec2d centre, Vec2d scale) : region_(&region), centre_(centre), scale_(scale) {}

    [[nodiscard]] Vec2d from_centre(double azimuth, double distance) const {
        return {distance * scale_.x * std::cos(azimuth), distance * scale_.y * std::sin(azimuth)};
    }

    [[nodiscard]] RegionSample sample(double azimuth, double distance) const {
        return (*region_)(centre_ + from_centre(azimuth, distance));
    }

    /// The edge at `azimuth`, which is expected at about `hint`.
    [[nodiscard]] RegionEdge edge(double azimuth, double hint) const {
        return region_edge(*region_, centre_, from_centre(azimuth, 1.0), hint);
    }

    [[nodiscard]] bool holds_between(double azimuth, double distance) const {
        return sample(azimuth, distance / 3.0).margin <= 0.0 && sample(azimuth, distance / 1.5).margin <= 0.0;
    }

    [[nodiscard]] double scale_area() const { return scale_.x * scale_.y; }
    [[nodiscard]] Vec2d scale() const { return scale_; }
    [[nodiscard]] Vec2d centre() const { return centre_; }
    [[nodiscard]] const Region& region() const { return *region_; }

  private:
    const Region* region_;
    Vec2d centre_;
    Vec2d scale_;
};

/// The frame moved towards the region's centroid and stretched to its extent, both seen at 16 azimuths.
PolarFrame centred(PolarFrame frame, bool is_mirror) {
    constexpr int kAzimuths = 16;
    constexpr int kMostRounds = 12;
    for (int round = 0; round < kMostRounds; ++round) {
        double area = 0.0;
        Vec2d moment{};
        Vec2d lower{};
        Vec2d upper{};
        double hint = 1.0;
        for (int i = 0; i < kAzimuths; ++i) {
            const double azimuth = 2.0 * kPi * (i + 0.5) / kAzimuths - 0.5 * kPi;
            if (is_mirror && i >= kAzimuths / 2) {
                break;
            }
            hint = frame.edge(azimuth, hint).distance;
            const Vec2d at = frame.from_centre(azimuth, hint);
            area += hint * hint;
            moment = moment + hint * hint * at;
            lower = {std::min(lower.x, at.x), std::min(lower.y, at.y)};
            upper = {std::max(upper.x, at.x), std::max(upper.y, at.y)};
        }
        if (is_mirror) {
            moment.x = 0.0;
            lower.x = -upper.x;
        }
        if (!(area > 0.0)) {
            return frame;
        }
        const Vec2d shift = 2.0 / 3.0 * moment / area;
        const Vec2d scale = 0.5 * (upper - lower);
        const Vec2d centre = frame.centre() + shift;
        const bool is_inside = frame.region()(centre).margin < 0.0;
        const Vec2d stretch{scale.x / frame.scale().x, scale.y / frame.scale().y};
        frame = PolarFrame(frame.region(), is_inside ? centre : frame.centre(), scale);
        const auto is_near = [](double ratio, double one) { return ratio < 1.0 + one && ratio > 1.0 / (1.0 + one); };
        constexpr double kShift = 0.05;
        constexpr double kStretch = 0.3;
        if (!is_inside ||
            (std::hypot(shift.x / scale.x, shift.y / scale.y) < kShift && is_near(stretch.x / stretch.y, kStretch))) {
            break;
        }
    }
    return frame;
}

class Outliner {
  public:
    explicit Outliner(const PolarFrame& frame) : frame_(frame) {}

    /// Appends the outline's points between two azimuths, of a piece with that error.
    void append(double from, double to, int halvings = kMostHalvings,
                double whole_error = std::numeric_limits<double>::infinity()) {
        const Kronrod& rule = kronrod();
        std::array<double, kPoints> azimuth{};
        std::array<RegionEdge, kPoints> edges{};
        for (std::size_t i = 0; i < kPoints; ++i) {
            azimuth[i] = 0.5 * (from + to) + 0.5 * (to - from) * rule.node[i];
            edges[i] = frame_.edge(azimuth[i], hint_);
            hint_ = std::max(edges[i].distance, std::numeric_limits<double>::min());
        }
        double area = 0.0;
        double gauss_area = 0.0;
        for (std::size_t i = 0; i < kPoints; ++i) {
            const double square = edges[i].distance * edges[i].distance;
            area += rule.weight[i] * square;
            gauss_area += rule.gauss[i] * square;
        }
        const double half_width = 0.5 * (to - from);
        const PieceEnds ends = look_at_ends(from, to, edges);
        const double error = estimated_error(half_width, area, gauss_area, edges) + half_width * ends.error;
        stays_ = error < kFalls * whole_error ? std::max(0, stays_ - 1) : stays_ + 1;
        is_rounding = is_rounding || stays_ > kMostStays;
        if (halvings > 0 && is_star_shaped && !is_rounding && points.size() < kMostPoints &&
            error > kAreaTolerance * 2.0 * kPi) {
            const double split = split_point(from, to, azimuth, edges, ends);
            append(from, split, halvings - 1, error);
            append(split, to, halvings - 1, error);
            return;
        }
        error_ += error;
        for (std::size_t i = 0; i < kPoints; ++i) {
            const double square = edges[i].distance * edges[i].distance;
            points.push_back({.edge = frame_.from_centre(azimuth[i], edges[i].distance),
                              .wedge_area = 0.5 * frame_.scale_area() * half_width * rule.weight[i] * square,
                              .limit = edges[i].limit});
            is_star_shaped = is_star_shaped && frame_.holds_between(azimuth[i], edges[i].distance);
        }
    }

    [[nodiscard]] double error() const { return 0.5 * frame_.scale_area() * error_; }

    std::vector<OutlinePoint> points;
    bool is_star_shaped = true;
    bool is_rounding = false;  // halving finds but the rounding of the region's own numbers

  private:
    static bool has_corner(const std::array<RegionEdge, kPoints>& edges) {
        return std::ranges::adjacent_find(edges, std::ranges::not_equal_to{}, &RegionEdge::limit) != edges.end();
    }

    /// QUADPACK's: what the rules differ by, sharpened, where the outline is smooth, by how far that is below the
    /// integrand's own variation. Two limits may also coincide all along; then the difference is small as it is.
    static double estimated_error(double half_width, double area, double gauss_area,
                                  const std::array<RegionEdge, kPoints>& edges) {
        const double mean = 0.5 * area;
        double variation = 0.0;
        for (std::size_t i = 0; i < kPoints; ++i) {
            variation += kronrod().weight[i] * std::abs(edges[i].distance * edges[i].distance - mean);
        }
        const double difference = std::abs(area - gauss_area);
        if (!(variation > 0.0) || has_corner(edges)) {
            return half_width * difference;
        }
        return half_width * variation * std::min(1.0, std::pow(200.0 * difference / variation, 1.5));
    }

    /// The outline just inside a piece's ends, where no node of the rule is.
    struct PieceEnds {
        RegionEdge first;
        RegionEdge last;
        double error = 0.0;  // of the area over half the piece's width: what a corner between an end and its node costs
    };

    [[nodiscard]] PieceEnds look_at_ends(double from, double to, const std::array<RegionEdge, kPoints>& edges) const {
        const double margin = end_margin(from, to);
        PieceEnds ends{.first = frame_.edge(from + margin, edges.front().distance),
                       .last = frame_.edge(to - margin, edges.back().distance)};
        const double end = 1.0 - 2.0 * margin / (to - from);
        const double gap = 1.0 - kronrod().node.back();
        ends.error = 0.5 * gap *
                     (std::abs(squared_distance(edges, -end) - ends.first.distance * ends.first.distance) +
                      std::abs(squared_distance(edges, end) - ends.last.distance * ends.last.distance));
        return ends;
    }

    /// What the nodes' polynomial expects at `place` in [−1, 1], where no node is.
    static double squared_distance(const std::array<RegionEdge, kPoints>& edges, double place) {
        const Kronrod& rule = kronrod();
        double sum = 0.0;
        double weights = 0.0;
        for (std::size_t i = 0; i < kPoints; ++i) {
            const double weight = rule.barycentric[i] / (place - rule.node[i]);
            sum += weight * edges[i].distance * edges[i].distance;
            weights += weight;
        }
        return sum / weights;
    }

    /// A corner that the piece was cut at is known to this; it does not count as one inside.
    static double end_margin(double from, double to) { return std::min(2.0 * kCornerTolerance, 1e-3 * (to - from)); }

    /// The first corner, or the middle where there is none.
    [[nodiscard]] double split_point(double from, double to, const std::array<double, kPoints>& azimuth,
                                     const std::array<RegionEdge, kPoints>& edges, const PieceEnds& ends) {
        if (ends.first.limit != edges.front().limit) {
            return corner(from + end_margin(from, to), azimuth.front(), ends.first);
        }
        if (ends.last.limit != edges.back().limit) {
            return corner(azimuth.back(), to - end_margin(from, to), edges.back());
        }
        const auto last = std::ranges::adjacent_find(edges, std::ranges::not_equal_to{}, &RegionEdge::limit);
        if (last == edges.end()) {
            return azimuth[kPoints / 2];
        }
        const auto i = static_cast<std::size_t>(last - edges.begin());
        return corner(azimuth[i], azimuth[i + 1], *last);
    }

    /// Where the limit changes between two azimuths, the first of which has `edge`. An outline that jumps there is seen
    /// along its tangent.
    [[nodiscard]] double corner(double from, double to, RegionEdge edge) {
        RegionEdge before = edge;
        RegionEdge after = edge;
        while (to - from > kCornerTolerance) {
            const double middle = 0.5 * (from + to);
            const RegionEdge here = frame_.edge(middle, before.distance);
            const bool is_before = here.limit == edge.limit;
            (is_before ? from : to) = middle;
            (is_before ? before : after) = here;
        }
        constexpr double kJump = 1e3 * kCornerTolerance;
        is_star_shaped = is_star_shaped && std::abs(after.distance - before.distance) <= kJump * before.distance;
        return 0.5 * (from + to);
    }

    const PolarFrame& frame_;
    double hint_ = 1.0;
    double error_ = 0.0;
    int stays_ = 0;
};

RegionOutline outline_in(const PolarFrame& frame, bool is_mirror) {
    Outliner outliner(frame);
    const int quarters = is_mirror ? 2 : 4;
    for (int i = 0; i < quarters; ++i) {
        outliner.append(0.5 * kPi * (i - 1), 0.5 * kPi * i);
    }
    RegionOutline outline{.centre = frame.centre(), .is_half = is_mirror, .points = std::move(outliner.points)};
    for (const OutlinePoint& point : outline.points) {
        outline.area += point.wedge_area;
    }
    outline.relative_error = outliner.error() / outline.area;
    // A smooth outline with corners converges; one that jumps, where a ray from the centre touches the edge, does not.
    constexpr double kConverged = 1e-9;
    outline.is_star_shaped = outliner.is_star_shaped && (outline.relative_error < kConverged || outliner.is_rounding);
    if (is_mirror) {
        outline.area *= 2.0;
    }
    return outline;
}

/// The outline about another centre, if the region is star-shaped about one of a few between the frame's centre and the
/// edge; else that about the frame's.
RegionOutline outline_about_another(const PolarFrame& frame, bool is_mirror, RegionOutline outline) {
    const int azimuths = is_mirror ? 2 : 8;
    for (const double t : {0.5, 0.8}) {
        for (int i = 0; i < azimuths; ++i) {
            const double azimuth = 2.0 * kPi * i / azimuths + 0.5 * kPi;
            Vec2d at = frame.from_centre(azimuth, t * frame.edge(azimuth, 1.0).distance);
            at = {is_mirror ? frame.centre().x : frame.centre().x + at.x, frame.centre().y + at.y};
            RegionOutline other = outline_in(PolarFrame(frame.region(), at, frame.scale()), is_mirror);
            if (other.is_star_shaped) {
                return other;
            }
        }
    }
    return outline;
}

/// The outline of a region that is its own mirror image, in a plane sheared so that the middle of the region's height
/// is as high at 0.8 of its half width as on x = 0.
RegionOutline straightened_outline(const PolarFrame& frame) {
    double bend = 0.0;
    const Vec2d centre = frame.centre();
    const Vec2d scale = frame.scale();
    const Region straight = [&](Vec2d at) { return frame.region()({at.x, at.y + bend * at.x * at.x}); };
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
        constexpr double kOut = 0.8;
        const double x = kOut * scale.x * region_edge(straight, centre, {scale.x, 0.0}).distance;
        const auto middle = [&](double at_x) {
            const double above = region_edge(straight, {at_x, centre.y}, {0.0, scale.y}).distance;
            const double below = region_edge(straight, {at_x, centre.y}, {0.0, -scale.y}).distance;
            return 0.5 * scale.y * (above - below);
        };
        bend += (middle(x) - middle(0.0)) / (x * x);
    }
    RegionOutline outline = outline_in(centred(PolarFrame(straight, centre, scale), true), true);
    outline.bend = bend;
    return outline;
}

}  // namespace

RegionOutline region_outline(const Region& region, const RegionSearch& search) {
    const std::optional<Vec2d> inside = find_inside(region, search);
    if (!inside) {
        return {.centre = search.start, .is_half = search.is_mirror, .points = {}};
    }
    const Vec2d scale{search.reach, search.reach};
    const PolarFrame frame = centred(PolarFrame(region, *inside, scale), search.is_mirror);
    RegionOutline outline = outline_in(frame, search.is_mirror);
    if (!outline.is_star_shaped) {
        outline = outline_about_another(frame, search.is_mirror, std::move(outline));
    }
    if (!outline.is_star_shaped && search.is_mirror) {
        RegionOutline straightened = straightened_outline(frame);
        return straightened.is_star_shaped ? straightened : outline;
    }
    return outline;
}

GaussRule gauss_legendre(int count) {
    GaussRule rule;
    for (const double x : boost::math::legendre_p_zeros<double>(count)) {
        const double slope = boost::math::legendre_p_prime(count, x);
        const double weight = 1.0 / ((1.0 - x * x) * slope * slope);  // half of that on [−1, 1]
        rule.nodes.push_back(0.5 * (1.0 + x));
        rule.weights.push_back(weight);
        if (x > 0.0) {
            rule.nodes.insert(rule.nodes.begin(), 0.5 * (1.0 - x));
            rule.weights.insert(rule.weights.begin(), weight);
        }
    }
    return rule;
}

std::vector<RegionNode> region_quadrature(const RegionOutline& outline, int rings) {
    const GaussRule rule = gauss_legendre(rings);
    std::vector<RegionNode> nodes;
    for (const OutlinePoint& point : outline.points) {
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double t = rule.nodes[i];
            const double weight = 2.0 * t * rule.weights[i] * point.wedge_area;
            const Vec2d at = outline.at(point, t);
            nodes.push_back({at, weight});
            if (outline.is_half) {
                nodes.push_back({{-at.x, at.y}, weight});
            }
        }
    }
    return nodes;
}

}  // namespace lensproof::optics
