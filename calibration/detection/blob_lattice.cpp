#include "calibration/detection/blob_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <queue>
#include <utility>

namespace lensproof::calibration {
namespace {

constexpr int kSmallestSpot_px = 5;
constexpr double kLeastCompact = 0.80;  // area over that of the ellipse with its moments: disc 1, square 0.955
constexpr double kMostCompact = 1.15;
constexpr double kReach = 0.25;       // of a step, around where the next spot should be
constexpr double kMostGrowth = 1.9;   // of the area, from one spot to the next
constexpr double kLeastFilled = 0.4;  // of the places between the first and last columns and rows
constexpr std::size_t kMostSeeds = 40;
constexpr double kWallDarkness = 0.92;  // grey level of a cell's walls at most, of its own
constexpr double kWallMargin_px = 4.0;
constexpr int kRays = 16;
constexpr int kThresholdOffset = 8;  // grey levels that a spot differs from its surroundings

using Place = std::pair<int, int>;  // column and row

struct Blob {
    cv::Point2f middle;
    double area = 0.0;
};

std::vector<Blob> blobs_of(const cv::Mat& picture, bool dark, int block) {
    cv::Mat mask;
    cv::adaptiveThreshold(picture, mask, 255, cv::ADAPTIVE_THRESH_MEAN_C,
                          dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY, block,
                          dark ? kThresholdOffset : -kThresholdOffset);
    cv::Mat labels;
    cv::Mat stats;
    cv::Mat centres;
    const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8, CV_32S);
    std::vector<Blob> blobs;
    std::vector<cv::Vec3d> moments(static_cast<std::size_t>(count));  // of x², xy and y² about the middles
    for (int y = 0; y < labels.rows; ++y) {
        for (int x = 0; x < labels.cols; ++x) {
            const int label = labels.at<int>(y, x);
            const double dx = x - centres.at<double>(label, 0);
            const double dy = y - centres.at<double>(label, 1);
            moments[static_cast<std::size_t>(label)] += cv::Vec3d(dx * dx, dx * dy, dy * dy);
        }
    }
    for (int label = 1; label < count; ++label) {
        const int x = stats.at<int>(label, cv::CC_STAT_LEFT);
        const int y = stats.at<int>(label, cv::CC_STAT_TOP);
        const double area = stats.at<int>(label, cv::CC_STAT_AREA);
        const bool is_cut = x == 0 || y == 0 || x + stats.at<int>(label, cv::CC_STAT_WIDTH) == picture.cols ||
                            y + stats.at<int>(label, cv::CC_STAT_HEIGHT) == picture.rows;
        if (is_cut || area < kSmallestSpot_px) {
            continue;
        }
        const cv::Vec3d m = moments[static_cast<std::size_t>(label)] / area;
        constexpr double kPixel = 1.0 / 12.0;  // of a pixel's own extent
        const double ellipse =
            4.0 * std::numbers::pi * std::sqrt(std::max(0.0, (m[0] + kPixel) * (m[2] + kPixel) - m[1] * m[1]));
        if (area > kLeastCompact * ellipse && area < kMostCompact * ellipse) {
            blobs.push_back({cv::Point2f(static_cast<float>(centres.at<double>(label, 0)),
                                         static_cast<float>(centres.at<double>(label, 1))),
                             area});
        }
    }
    return blobs;
}

/// Whether something dark ends a bright cell on every side. Beside a chart's outermost lines stand half cells between
/// the lines' ends, open to the paper, which would lead a lattice astray.
bool is_walled(const cv::Mat& picture, const Blob& cell) {
    const double side = std::sqrt(cell.area);
    const double wall = kWallDarkness * picture.at<uchar>(cvRound(cell.middle.y), cvRound(cell.middle.x));
    for (int i = 0; i < kRays; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kRays;
        bool is_ended = false;
        for (double t = 0.3 * side; t < side + kWallMargin_px && !is_ended; t += 1.0) {
            const int x = cvRound(cell.middle.x + t * std::cos(angle));
            const int y = cvRound(cell.middle.y + t * std::sin(angle));
            is_ended = x >= 0 && y >= 0 && x < picture.cols && y < picture.rows && picture.at<uchar>(y, x) < wall;
        }
        if (!is_ended) {
            return false;
        }
    }
    return true;
}

/// The blob nearest to `place` within `reach`, of about the size `area`.
std::optional<std::size_t> blob_at(const std::vector<Blob>& blobs, cv::Point2f place, double reach, double area) {
    std::optional<std::size_t> best;
    double best_distance = reach;
    for (std::size_t i = 0; i < blobs.size(); ++i) {
        const double distance = cv::norm(blobs[i].middle - place);
        const double growth = blobs[i].area / area;
        if (distance < best_distance && growth < kMostGrowth && growth > 1.0 / kMostGrowth) {
            best_distance = distance;
            best = i;
        }
    }
    return best;
}

struct Steps {
    cv::Point2f column;
    cv::Point2f row;
};

/// Steps to the neighbours of a blob that has one on each of its four sides.
std::optional<Steps> steps_at(const std::vector<Blob>& blobs, std::size_t seed) {
    const Blob& own = blobs[seed];
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t i = 0; i < blobs.size(); ++i) {
        if (i != seed) {
            near.emplace_back(cv::norm(blobs[i].middle - own.middle), i);
        }
    }
    const std::size_t count = std::min<std::size_t>(near.size(), 8);
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    std::vector<cv::Point2f> steps;
    for (std::size_t k = 0; k < count; ++k) {
        const cv::Point2f step = blobs[near[k].second].middle - own.middle;
        const double length = near[k].first;
        const bool is_new = std::all_of(steps.begin(), steps.end(), [&](const cv::Point2f& other) {
            return std::abs(step.cross(other)) > 0.5 * length * cv::norm(other);
        });
        if (is_new && blob_at(blobs, own.middle - step, kReach * length, own.area) &&
            blob_at(blobs, own.middle + step, kReach * length, own.area)) {
            steps.push_back(step);
        }
        if (steps.size() == 2) {
            return steps[0].cross(steps[1]) > 0.0F ? Steps{steps[0], steps[1]} : Steps{steps[1], steps[0]};
        }
    }
    return std::nullopt;
}

std::map<Place, std::size_t> grow(const std::vector<Blob>& blobs, std::size_t seed, const Steps& first) {
    std::map<Place, std::size_t> lattice{{{0, 0}, seed}};
    std::map<Place, Steps> steps{{{0, 0}, first}};
    std::vector<bool> taken(blobs.size(), false);
    taken[seed] = true;
    std::queue<Place> open({Place{0, 0}});
    while (!open.empty()) {
        const Place place = open.front();
        open.pop();
        const Blob& own = blobs[lattice.at(place)];
        const Steps own_steps = steps.at(place);
        for (const auto& [dc, dr] : {Place{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            const Place next{place.first + dc, place.second + dr};
            const cv::Point2f step = static_cast<float>(dc) * own_steps.column + static_cast<float>(dr) * own_steps.row;
            const auto found = lattice.count(next) != 0
                                   ? std::nullopt
                                   : blob_at(blobs, own.middle + step, kReach * cv::norm(step), own.area);
            if (!found || taken[*found]) {
                continue;
            }
            taken[*found] = true;
            lattice[next] = *found;
            Steps next_steps = own_steps;
            const cv::Point2f made = blobs[*found].middle - own.middle;
            if (dc != 0) {
                next_steps.column = static_cast<float>(dc) * made;
            } else {
                next_steps.row = static_cast<float>(dr) * made;
            }
            steps[next] = next_steps;
            open.push(next);
        }
    }
    return lattice;
}

std::map<Place, std::size_t> largest_lattice(const std::vector<Blob>& blobs) {
    std::map<Place, std::size_t> best;
    const std::size_t stride = std::max<std::size_t>(1, blobs.size() / kMostSeeds);
    for (std::size_t seed = 0; seed < blobs.size() && 2 * best.size() < blobs.size(); seed += stride) {
        if (const auto steps = steps_at(blobs, seed)) {
            auto lattice = grow(blobs, seed, *steps);
            if (lattice.size() > best.size()) {
                best = std::move(lattice);
            }
        }
    }
    return best;
}

bool is_filled(const std::map<Place, std::size_t>& lattice) {
    Place least = lattice.begin()->first;
    Place most = least;
    for (const auto& [place, blob] : lattice) {
        least = {std::min(least.first, place.first), std::min(least.second, place.second)};
        most = {std::max(most.first, place.first), std::max(most.second, place.second)};
    }
    const double places = (most.first - least.first + 1.0) * (most.second - least.second + 1.0);
    return static_cast<double>(lattice.size()) > kLeastFilled * places;
}

/// Turned by quarter turns until its rows run to the right, and counted from 0.
std::vector<LatticeSpot> upright(const std::vector<Blob>& blobs, const std::map<Place, std::size_t>& lattice) {
    cv::Point2f along_rows;
    for (const auto& [place, blob] : lattice) {
        const auto next = lattice.find({place.first + 1, place.second});
        if (next != lattice.end()) {
            along_rows += blobs[next->second].middle - blobs[blob].middle;
        }
    }
    const bool is_steep = std::abs(along_rows.y) > std::abs(along_rows.x);
    const int sign = (is_steep ? along_rows.y : along_rows.x) >= 0.0F ? 1 : -1;
    std::vector<LatticeSpot> spots;
    Place least{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
    for (const auto& [place, blob] : lattice) {
        // Columns that run down are rows of the upright lattice; its rows then run against the other step.
        const int column = sign * (is_steep ? -place.second : place.first);
        const int row = sign * (is_steep ? place.first : place.second);
        spots.push_back({column, row, blobs[blob].middle});
        least = {std::min(least.first, column), std::min(least.second, row)};
    }
    for (LatticeSpot& spot : spots) {
        spot.column -= least.first;
        spot.row -= least.second;
    }
    std::sort(spots.begin(), spots.end(), [](const LatticeSpot& a, const LatticeSpot& b) {
        return std::pair(a.row, a.column) < std::pair(b.row, b.column);
    });
    return spots;
}

}  // namespace

std::vector<LatticeSpot> find_blob_lattice(const cv::Mat& picture, bool dark, bool is_fine) {
    std::vector<LatticeSpot> best;
    cv::Mat smooth;
    cv::GaussianBlur(picture, smooth, {}, 1.0);              // noise makes spots too
    for (const double fraction : {0.3, 0.15, 0.06, 0.02}) {  // blocks of these fractions of the picture's side
        if (!is_fine && fraction < 0.1) {
            break;
        }
        const int block = std::max(7, 2 * static_cast<int>(0.5 * fraction * std::max(picture.cols, picture.rows)) + 1);
        std::vector<Blob> blobs = blobs_of(smooth, dark, block);
        if (!is_fine) {
            std::erase_if(blobs, [&](const Blob& blob) { return !is_walled(smooth, blob); });
        }
        const auto lattice = largest_lattice(blobs);
        if (lattice.size() >= kFewestSpots && lattice.size() > best.size() && is_filled(lattice)) {
            best = upright(blobs, lattice);
        }
    }
    return best;
}

}  // namespace lensproof::calibration
