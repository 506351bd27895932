#include "calibration/sharpness/siemens_star.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calibration/sharpness/star_modulation.h"
#include "calibration/sharpness/star_phase.h"
#include "calibration/statistics/dense_solvers.h"
#include "calibration/statistics/student.h"

namespace lensproof::calibration {
namespace {

constexpr int kSegments = 8;
constexpr double kMostClippedOfStar = 0.01;
constexpr double kPaperFrom = 1.06;    // of the rim, and
constexpr double kPaperFrom_px = 3.0;  // beyond it: where the paper around the star is looked at, up to
constexpr double kPaperTo = 1.2;       // of the rim, and
constexpr double kPaperTo_px = 6.0;    // beyond it
constexpr int kFewestPaperWedges = 6;
constexpr double kMostOvershoot = 0.05;                 // of an MTF above 1 at the rim
constexpr double kSquareWave = 4.0 / std::numbers::pi;  // its fundamental, of its amplitude
constexpr double kAround = 0.3;  // of the frequency, on either side, that a crossing is fitted over
constexpr int kFewestAround = 5;
constexpr double kLeastStarContrast = 0.1;
constexpr double kNearest_px = 2.0;  // to the centre

/// The pixels of a segment: of the star, and of the paper around it.
struct SegmentPixels {
    std::vector<StarPixel> star;
    std::vector<StarPixel> paper;
};

// A polynomial's value at `at` as weights of its samples: weighted least squares of degree 2 in x.
Eigen::VectorXd quadratic_weights(const std::vector<double>& x, const std::vector<double>& weight, double at,
                                  bool slope) {
    const auto count = static_cast<Eigen::Index>(x.size());
    Eigen::MatrixXd rows(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double t = x[static_cast<std::size_t>(i)] - at;
        rows.row(i) << 1.0, t, t * t;
    }
    const Eigen::VectorXd w = Eigen::Map<const Eigen::VectorXd>(weight.data(), count);
    const Eigen::Matrix3d normal = rows.transpose() * w.asDiagonal() * rows;
    const Eigen::Vector3d unit = slope ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
    return w.asDiagonal() * rows * solve_symmetric(normal, unit);
}

// The paper's light in the middle of its ring, and how far out that is; none where too little of it is in the picture,
// the median over the wedges, as something may be printed there.
struct Paper {
    StarEstimate light;
    double radius_px = 0.0;
};

std::optional<Paper> paper_of(const std::vector<StarPixel>& pixels) {
    StarWedges sum{};
    StarWedges count{};
    Paper paper;
    for (const StarPixel& pixel : pixels) {
        sum[pixel.wedge()] += pixel.light;
        count[pixel.wedge()] += 1.0;
        paper.radius_px += pixel.radius_px / static_cast<double>(pixels.size());
    }
    std::vector<double> means;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        if (count[i] > 0.0) {
            means.push_back(sum[i] / count[i]);
        }
    }
    if (means.size() < kFewestPaperWedges) {
        return std::nullopt;
    }
    std::ranges::sort(means);
    const std::size_t middle = means.size() / 2;
    paper.light.value = means.size() % 2 == 1 ? means[middle] : 0.5 * (means[middle - 1] + means[middle]);
    const double weight = std::sqrt(0.5 * std::numbers::pi) / static_cast<double>(means.size());  // a median's error
    for (std::size_t i = 0; i < sum.size(); ++i) {
        paper.light.of_wedge[i] = count[i] > 0.0 ? weight * (sum[i] / count[i] - paper.light.value) : 0.0;
    }
    return paper;
}

// (white − black) / (white + black) = white / mean − 1 of the sectors, which are of equal width: the mean light, which
// no blur changes, followed outwards to the paper as a straight line in the radius' square.
StarEstimate contrast_of(const std::vector<StarModulation>& bins, const Paper& paper) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    std::vector<Eigen::Vector2d> rows;
    rows.reserve(bins.size());
    for (const StarModulation& bin : bins) {
        const double r = bin.radius_px / paper.radius_px;
        rows.emplace_back(1.0, r * r - 1.0);
        normal += r * r * rows.back() * rows.back().transpose();  // as many pixels
    }
    const Eigen::Vector2d at_paper = solve_symmetric(normal, Eigen::Vector2d::UnitX());
    StarEstimate level;
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const double r = bins[i].radius_px / paper.radius_px;
        const double weight = r * r * at_paper.dot(rows[i]);
        level.value += weight * bins[i].level.value;
        add(level.of_wedge, weight, bins[i].level.of_wedge);
    }
    StarEstimate contrast{.value = paper.light.value / level.value - 1.0, .of_wedge = {}};
    add(contrast.of_wedge, 1.0 / level.value, paper.light.of_wedge);
    add(contrast.of_wedge, -paper.light.value / (level.value * level.value), level.of_wedge);
    return contrast;
}

struct MtfBin {
    double cycles_per_px = 0.0;
    StarEstimate mtf;
};

std::vector<MtfBin> mtf_of(const std::vector<StarModulation>& bins, const StarEstimate& contrast) {
    std::vector<MtfBin> result;
    for (const StarModulation& bin : bins) {
        const double whole = kSquareWave * contrast.value * bin.level.value;
        MtfBin one{.cycles_per_px = bin.cycles_per_px, .mtf = {.value = bin.amplitude.value / whole, .of_wedge = {}}};
        add(one.mtf.of_wedge, 1.0 / whole, bin.amplitude.of_wedge);
        add(one.mtf.of_wedge, -one.mtf.value / contrast.value, contrast.of_wedge);
        add(one.mtf.of_wedge, -one.mtf.value / bin.level.value, bin.level.of_wedge);
        result.push_back(one);
    }
    return result;
}

// Where the curve, `bins` at frequencies above 0, falls to a level: a quadratic through the bins around it.
std::optional<MtfFrequency> falls_to(const std::vector<MtfBin>& bins, double level) {
    std::size_t below = 0;
    while (below < bins.size() && !(bins[below].mtf.value < level)) {
        ++below;
    }
    if (below == 0 || below == bins.size()) {
        return std::nullopt;
    }
    double at = 0.5 * (bins[below - 1].cycles_per_px + bins[below].cycles_per_px);
    Eigen::VectorXd weights;
    std::vector<std::size_t> around;
    double slope = 0.0;
    for (int step = 0; step < 8; ++step) {
        around.clear();
        std::vector<double> x;
        std::vector<double> weight;
        double reach = kAround;
        while (around.size() < kFewestAround && reach < 1.0) {
            around.clear();
            for (std::size_t i = 0; i < bins.size(); ++i) {
                if (std::abs(bins[i].cycles_per_px - at) < reach * at) {
                    around.push_back(i);
                }
            }
            reach += 0.1;
        }
        if (around.size() < kFewestAround) {
            return std::nullopt;
        }
        for (const std::size_t i : around) {
            x.push_back(bins[i].cycles_per_px);
            weight.push_back(1.0);
        }
        weights = quadratic_weights(x, weight, at, false);
        const Eigen::VectorXd slopes = quadratic_weights(x, weight, at, true);
        double value = 0.0;
        slope = 0.0;
        for (std::size_t k = 0; k < around.size(); ++k) {
            value += weights(static_cast<Eigen::Index>(k)) * bins[around[k]].mtf.value;
            slope += slopes(static_cast<Eigen::Index>(k)) * bins[around[k]].mtf.value;
        }
        if (!(slope < 0.0)) {
            return std::nullopt;
        }
        at = std::clamp(at + (level - value) / slope, 0.8 * at, 1.25 * at);
    }
    StarWedges total{};
    for (std::size_t k = 0; k < around.size(); ++k) {
        add(total, weights(static_cast<Eigen::Index>(k)) / slope, bins[around[k]].mtf.of_wedge);
    }
    const double error = std::sqrt(variance(total));
    const double half = student_95(kStarWedges - 1.0) * error;
    return MtfFrequency{
        .cycles_per_px = at, .standard_error = error, .lower_95 = std::max(at - half, 0.0), .upper_95 = at + half};
}

std::variant<StarSegment, StarRefusal> segment_of(SegmentPixels pixels, int segment) {
    const auto paper = paper_of(pixels.paper);
    if (!paper) {
        return StarRefusal{"the white around the star is not in the picture"};
    }
    const std::vector<StarModulation> bins = star_modulations(pixels.star);
    if (bins.size() < kFewestAround) {
        return StarRefusal{"the star is too small, or not in the picture"};
    }
    const StarEstimate contrast = contrast_of(bins, *paper);
    if (!(contrast.value > kLeastStarContrast)) {
        return StarRefusal{"what is around the star is no lighter than its sectors in the mean"};
    }
    const double side = 45.0 * segment;
    StarSegment result{.frequency_deg = std::fmod(side + 90.0, 180.0),
                       .side_deg = side,
                       .contrast = contrast.value,
                       .contrast_standard_error = std::sqrt(variance(contrast.of_wedge))};
    const std::vector<MtfBin> curve = mtf_of(bins, contrast);
    for (const MtfBin& bin : curve) {
        result.cycles_per_px.push_back(bin.cycles_per_px);
        result.mtf.push_back(bin.mtf.value);
        result.mtf_standard_error.push_back(std::sqrt(variance(bin.mtf.of_wedge)));
    }
    if (result.mtf.front() > 1.0 + kMostOvershoot + 3.0 * result.mtf_standard_error.front()) {
        return StarRefusal{"the paper around the star is darker than its white sectors"};
    }
    result.mtf50 = falls_to(curve, 0.5);
    result.mtf10 = falls_to(curve, 0.1);
    return result;
}

/// Every pixel's place in the star; or why it cannot be measured.
std::variant<std::array<SegmentPixels, kSegments>, StarRefusal> gather(const formats::Image& image, int channel,
                                                                       const StarMap& map,
                                                                       const scene::SiemensStar& star) {
    const EllipseOutline rim = outline(map, star.radius_mm);
    const int reach = static_cast<int>(std::ceil(kPaperTo * rim.long_half_axis_px + kPaperTo_px));
    const int x0 = std::max(0, static_cast<int>(rim.centre_px.x) - reach);
    const int x1 = std::min(image.width - 1, static_cast<int>(rim.centre_px.x) + reach);
    const int y0 = std::max(0, static_cast<int>(rim.centre_px.y) - reach);
    const int y1 = std::min(image.height - 1, static_cast<int>(rim.centre_px.y) + reach);
    std::array<SegmentPixels, kSegments> segments;
    double clipped = 0.0;
    double count = 0.0;
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const Vec2d p{static_cast<double>(x), static_cast<double>(y)};
            const Vec2d offset{p.x - map.centre_px.x, p.y - map.centre_px.y};
            const double radius = std::hypot(offset.x, offset.y);
            const double rim_px = map.rim_px(p, star.radius_mm);
            const bool is_paper =
                radius > kPaperFrom * rim_px + kPaperFrom_px && radius < kPaperTo * rim_px + kPaperTo_px;
            if (radius < kNearest_px || !(is_paper || radius < kWithinRim * rim_px)) {
                continue;
            }
            const double turn = std::atan2(offset.y, offset.x) / (2.0 * std::numbers::pi) * kSegments + 0.5 + kSegments;
            StarPixel pixel{
                .turn = turn - std::floor(turn) - 0.5, .radius_px = radius, .light = image.at(x, y, channel)};
            SegmentPixels& segment = segments[static_cast<std::size_t>(turn) % kSegments];
            if (!std::isfinite(pixel.light)) {
                return StarRefusal{"the star has pixels without a value"};
            }
            clipped += pixel.light == 1.0 ? 1.0 : 0.0;  // integer formats end there
            count += 1.0;
            if (is_paper) {
                segment.paper.push_back(pixel);
                continue;
            }
            pixel.cycles_per_px = 0.5 * star.sectors * map.angle_per_px(p) / (2.0 * std::numbers::pi);
            if (pixel.cycles_per_px < kStarHighest) {
                pixel.phase = 0.5 * star.sectors * map.angle(p);
                segment.star.push_back(pixel);
            }
        }
    }
    if (clipped > kMostClippedOfStar * count) {
        return StarRefusal{"the star is clipped at white"};
    }
    return segments;
}

}  // namespace

std::variant<StarMtf, StarRefusal> measure_star(const formats::Image& image, int channel, const StarMap& map,
                                                const scene::SiemensStar& star) {
    auto gathered = gather(image, channel, map, star);
    if (const auto* refusal = std::get_if<StarRefusal>(&gathered)) {
        return *refusal;
    }
    auto& pixels = std::get<std::array<SegmentPixels, kSegments>>(gathered);
    StarMtf result{.centre_px = map.centre_px, .outline = outline(map, star.radius_mm), .segments = {}};
    std::string reason;
    for (int i = 0; i < kSegments; ++i) {
        auto segment = segment_of(std::move(pixels[static_cast<std::size_t>(i)]), i);
        if (const auto* refusal = std::get_if<StarRefusal>(&segment)) {
            reason = refusal->reason;
        } else {
            result.segments.push_back(std::move(std::get<StarSegment>(segment)));
        }
    }
    if (result.segments.empty()) {
        return StarRefusal{reason};
    }
    return result;
}

}  // namespace lensproof::calibration
