#include "calibration/sharpness/edge_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace lensproof::calibration {
namespace {

constexpr double kShortestHalfLength_px = 8.0;
constexpr double kNarrowestHalfWidth_px = 3.0;
constexpr double kLeastAlignedContrast = 0.1;  // (bright − dark) / (bright + dark)
constexpr double kClippedEdgeFraction = 0.01;
constexpr double kCutNoise = 0.02;  // zeros among this fraction and its complement: noise cut at black
constexpr double kAlignmentBin_px = 0.5;
constexpr int kIterations = 20;
constexpr double kSettled_px = 1e-4;
constexpr int kTerms = 3;  // beside the constant: slope, bow and S-shape

std::array<double, kTerms> legendre_terms(double t) {
    return {t, 0.5 * (3.0 * t * t - 1.0), 0.5 * t * (5.0 * t * t - 3.0)};
}
std::array<double, kTerms> legendre_derivative(double t) {
    return {1.0, 3.0 * t, 0.5 * (15.0 * t * t - 3.0)};
}

double mean_of(const std::vector<EdgePixel>& pixels, double from, double to) {
    double sum = 0.0;
    int count = 0;
    for (const EdgePixel& p : pixels) {
        if (p.distance >= from && p.distance <= to) {
            sum += p.value;
            ++count;
        }
    }
    return count > 0 ? sum / count : 0.0;
}

std::vector<EdgePixel> gather(const formats::Image& image, int channel, const EdgeRegion& region, const Vec2d& normal) {
    const double reach_x = std::abs(region.along.x) * region.half_length_px + std::abs(normal.x) * region.half_width_px;
    const double reach_y = std::abs(region.along.y) * region.half_length_px + std::abs(normal.y) * region.half_width_px;
    const auto first = [](double at) { return std::max(0, static_cast<int>(std::ceil(at))); };
    const auto last = [](double at, int size) { return std::min(size - 1, static_cast<int>(std::floor(at))); };
    std::vector<EdgePixel> pixels;
    for (int y = first(region.centre_px.y - reach_y); y <= last(region.centre_px.y + reach_y, image.height); ++y) {
        for (int x = first(region.centre_px.x - reach_x); x <= last(region.centre_px.x + reach_x, image.width); ++x) {
            const double dx = x - region.centre_px.x;
            const double dy = y - region.centre_px.y;
            const double u = dx * region.along.x + dy * region.along.y;
            const double v = dx * normal.x + dy * normal.y;
            if (std::abs(u) <= region.half_length_px && std::abs(v) <= region.half_width_px) {
                pixels.push_back({u, v, image.at(x, y, channel), v});
            }
        }
    }
    return pixels;
}

// What makes a region unusable whatever its edge; empty when nothing does.
std::string unusable(const std::vector<EdgePixel>& pixels, const EdgeRegion& region) {
    const double area = 4.0 * region.half_length_px * region.half_width_px;
    if (static_cast<double>(pixels.size()) < 0.9 * area) {
        return "reaches beyond the picture";
    }
    double full = 0.0;
    double dark = 0.0;
    double zeros = 0.0;
    for (const EdgePixel& p : pixels) {
        if (!std::isfinite(p.value)) {
            return "has pixels without a value";
        }
        full += p.value == 1.0 ? 1.0 : 0.0;  // integer formats end there
        dark += p.across < 0.0 ? 1.0 : 0.0;
        zeros += p.across < 0.0 && p.value == 0.0 ? 1.0 : 0.0;
    }
    if (full > kClippedEdgeFraction * static_cast<double>(pixels.size())) {
        return "is clipped at white";
    }
    return zeros > kCutNoise * dark && zeros < (1.0 - kCutNoise) * dark ? "is clipped at black" : "";
}

struct Curve3 {
    double offset = 0.0;
    std::array<double, kTerms> theta{};
};

void set_distances(std::vector<EdgePixel>& pixels, const Curve3& edge, double half_length) {
    for (EdgePixel& p : pixels) {
        const auto basis = legendre_terms(p.along / half_length);
        const auto derivative = legendre_derivative(p.along / half_length);
        double at = edge.offset;
        double slope = 0.0;
        for (std::size_t j = 0; j < kTerms; ++j) {
            at += edge.theta[j] * basis[j];
            slope += edge.theta[j] * derivative[j] / half_length;
        }
        p.distance = (p.across - at) / std::sqrt(1.0 + slope * slope);
    }
}

// Where the profile, followed from the dark end, last rises through `level`; none if it does not.
std::optional<double> crossing(const EdgeProfile& profile, double level, bool last) {
    std::optional<double> at;
    for (std::size_t k = 0; k + 1 < profile.mean.size(); ++k) {
        const double a = profile.mean[k];
        const double b = profile.mean[k + 1];
        if (a < level && b >= level && (last || !at)) {
            at = profile.middle(k) + profile.width * (level - a) / (b - a);
        }
    }
    return at;
}

// One Gauss-Newton step of θ against the profile that the present θ gives; the largest change, px.
double improve(const std::vector<EdgePixel>& pixels, const EdgeProfile& profile, double half_length, Curve3& edge) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const EdgePixel& p : pixels) {
        const int bin = profile.bin(p.distance);
        if (bin < 0) {
            continue;
        }
        const auto k = static_cast<std::size_t>(bin);
        const double slope = profile.slope(k);
        const double residual = p.value - (profile.mean[k] + slope * (p.distance - profile.middle(k)));
        const auto basis = legendre_terms(p.along / half_length);
        const Eigen::Vector3d row = -slope * Eigen::Vector3d(basis[0], basis[1], basis[2]);
        normal += row * row.transpose();
        right += residual * row;
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) {
        return 0.0;
    }
    const Eigen::Vector3d step = solver.solve(right);
    double largest = 0.0;
    for (int j = 0; j < kTerms; ++j) {
        const double limited = std::clamp(step(j), -1.0, 1.0);
        edge.theta[static_cast<std::size_t>(j)] += limited;
        largest = std::max(largest, std::abs(limited));
    }
    return largest;
}

double bend(const Curve3& edge) {
    double largest = 0.0;
    for (double t = -1.0; t <= 1.0; t += 0.05) {
        const auto basis = legendre_terms(t);
        largest = std::max(largest, std::abs(edge.theta[1] * basis[1] + edge.theta[2] * basis[2]));
    }
    return largest;
}

}  // namespace

int EdgeProfile::bin(double distance) const {
    const double k = std::floor(distance / width + 0.5 * static_cast<double>(mean.size()));
    return k >= 0.0 && k < static_cast<double>(mean.size()) ? static_cast<int>(k) : -1;
}

double EdgeProfile::slope(std::size_t k) const {
    const std::size_t below = k > 0 ? k - 1 : k;
    const std::size_t above = std::min(k + 1, mean.size() - 1);
    return (mean[above] - mean[below]) / (static_cast<double>(above - below) * width);
}

EdgeProfile edge_profile(const std::vector<EdgePixel>& pixels, double half_width, double bin_width) {
    const auto bins = 2 * static_cast<std::size_t>(std::max(2.0, std::ceil(half_width / bin_width)));
    EdgeProfile profile{.width = bin_width, .mean = std::vector<double>(bins, 0.0), .count = std::vector<int>(bins, 0)};
    std::vector<double> place(bins, 0.0);
    for (const EdgePixel& p : pixels) {
        if (const int k = profile.bin(p.distance); k >= 0) {
            profile.mean[static_cast<std::size_t>(k)] += p.value;
            place[static_cast<std::size_t>(k)] += p.distance;
            ++profile.count[static_cast<std::size_t>(k)];
        }
    }
    std::optional<std::size_t> before;  // the nearest filled bin on this side
    for (std::size_t k = 0; k < bins; ++k) {
        if (profile.count[k] == 0) {
            continue;
        }
        profile.mean[k] /= profile.count[k];
        place[k] /= profile.count[k];
        for (std::size_t i = before ? *before + 1 : 0; i < k; ++i) {
            const std::size_t from = before.value_or(k);
            const double fraction = before ? static_cast<double>(i - from) / static_cast<double>(k - from) : 0.0;
            profile.mean[i] = std::lerp(profile.mean[from], profile.mean[k], fraction);
        }
        before = k;
    }
    for (std::size_t i = before ? *before + 1 : bins; i < bins; ++i) {
        profile.mean[i] = profile.mean[*before];
    }
    const EdgeProfile raw = profile;
    for (std::size_t k = 0; k < bins; ++k) {
        if (profile.count[k] > 0) {
            profile.mean[k] += raw.slope(k) * (profile.middle(k) - place[k]);
        }
    }
    return profile;
}

std::variant<AlignedEdge, EdgeRefusal> align_edge(const formats::Image& image, int channel, const EdgeRegion& region) {
    if (!(region.half_length_px >= kShortestHalfLength_px) || !(region.half_width_px >= kNarrowestHalfWidth_px)) {
        return EdgeRefusal{"is too small"};
    }
    Vec2d normal{-region.along.y, region.along.x};
    std::vector<EdgePixel> pixels = gather(image, channel, region, normal);
    const double h = region.half_length_px;
    const double w = region.half_width_px;
    if (mean_of(pixels, 0.3 * w, w) < mean_of(pixels, -w, -0.3 * w)) {
        normal = {-normal.x, -normal.y};
        for (EdgePixel& p : pixels) {
            p.across = p.distance = -p.across;
        }
    }
    if (std::string reason = unusable(pixels, region); !reason.empty()) {
        return EdgeRefusal{std::move(reason)};
    }
    const double dark = mean_of(pixels, -w, -0.7 * w);
    const double bright = mean_of(pixels, 0.7 * w, w);
    if (!(bright - dark > kLeastAlignedContrast * (bright + dark)) || !(bright + dark > 0.0)) {
        return EdgeRefusal{"has too little contrast"};
    }
    Curve3 edge;
    EdgeProfile profile;
    for (int i = 0; i < kIterations; ++i) {
        set_distances(pixels, edge, h);
        profile = edge_profile(pixels, w, kAlignmentBin_px);
        const auto middle = crossing(profile, 0.5 * (dark + bright), false);
        if (!middle) {
            return EdgeRefusal{"has no edge"};
        }
        edge.offset += *middle;
        set_distances(pixels, edge, h);
        profile = edge_profile(pixels, w, kAlignmentBin_px);
        if (improve(pixels, profile, h, edge) < kSettled_px && std::abs(*middle) < kSettled_px * 10.0) {
            break;
        }
    }
    set_distances(pixels, edge, h);
    profile = edge_profile(pixels, w, kAlignmentBin_px);
    const auto low = crossing(profile, std::lerp(dark, bright, 0.1), true);
    const auto high = crossing(profile, std::lerp(dark, bright, 0.9), false);
    if (!low || !high || *high - *low > w || std::abs(edge.offset) + bend(edge) > 0.5 * w) {
        return EdgeRefusal{"has no single edge in its middle"};
    }
    const double turn = edge.theta[0] / h;  // across per along, once θ_1 is small
    const double scale = 1.0 / std::sqrt(1.0 + turn * turn);
    const Vec2d turned{(normal.x - turn * region.along.x) * scale, (normal.y - turn * region.along.y) * scale};
    return AlignedEdge{.pixels = std::move(pixels),
                       .centre_px = {region.centre_px.x + edge.offset * normal.x - 0.5 * edge.theta[1] * normal.x,
                                     region.centre_px.y + edge.offset * normal.y - 0.5 * edge.theta[1] * normal.y},
                       .normal = turned,
                       .half_length_px = h,
                       .half_width_px = w - std::abs(edge.offset) - std::abs(edge.theta[0]) - bend(edge),
                       .rise_px = std::max(*high - *low, 0.5),
                       .bend_px = bend(edge)};
}

}  // namespace lensproof::calibration
