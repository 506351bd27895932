#include "calibration/detection/detect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/detection/detect_charuco.h"
#include "calibration/detection/detect_lattice.h"
#include "calibration/detection/working_copy.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/base/overloaded.h"

namespace lensproof::calibration {
namespace {

using Points = std::vector<cv::Point2f>;
using Finder = std::function<bool(const cv::Mat&, Points&)>;

constexpr int kSmallestPicture_px = 16;
constexpr double kSearchSide_px = 1600.0;  // larger pictures are searched at this size: corners lie well within a pixel

std::string size_in_words(cv::Size size) {
    return std::to_string(size.width) + " × " + std::to_string(size.height);
}

bool find_classic(const cv::Mat& picture, cv::Size grid, Points& points) {
    return cv::findChessboardCorners(picture, grid, points,
                                     cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
}

bool find_sector_based(const cv::Mat& picture, cv::Size grid, Points& points, int flags) {
    return cv::findChessboardCornersSB(picture, grid, points, cv::CALIB_CB_NORMALIZE_IMAGE | flags);
}

// A copy as a rectilinear lens would have taken it, if the picture came from an equidistant fisheye whose half-diagonal
// is `corner_angle`. Straight lines in the scene become nearly straight again, which is all a detector needs.
struct Unbent {
    cv::Mat picture;
    cv::Point2d source_centre;
    cv::Point2d centre;
    double source_focal = 0.0;
    double focal = 0.0;

    Unbent(const cv::Mat& source, double corner_angle) {
        source_centre = {(source.cols - 1) / 2.0, (source.rows - 1) / 2.0};
        source_focal = 0.5 * std::hypot(source.cols, source.rows) / corner_angle;
        // Magnification at the frame's edge grows as 1 / cos²; shrink the middle and enlarge the frame to hold it.
        const double enlarged = std::min(2.0, std::tan(corner_angle) / corner_angle);
        const cv::Size size(static_cast<int>(source.cols * enlarged), static_cast<int>(source.rows * enlarged));
        focal = std::max(0.35 * source_focal, 0.5 * std::hypot(size.width, size.height) / std::tan(corner_angle));
        centre = {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
        cv::Mat map(size, CV_32FC2);
        for (int y = 0; y < size.height; ++y) {
            for (int x = 0; x < size.width; ++x) {
                map.at<cv::Point2f>(y, x) = to_source({static_cast<float>(x), static_cast<float>(y)});
            }
        }
        cv::remap(source, picture, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    }

    [[nodiscard]] cv::Point2f to_source(cv::Point2f point) const {
        const cv::Point2d offset = cv::Point2d(point) - centre;
        const double radius = std::hypot(offset.x, offset.y);
        const double scale = radius > 0.0 ? source_focal * std::atan(radius / focal) / radius : source_focal / focal;
        return source_centre + scale * offset;
    }
};

bool inside(const Points& points, const cv::Mat& picture) {
    return std::all_of(points.begin(), points.end(), [&](const cv::Point2f& p) {
        return p.x >= 0.0F && p.y >= 0.0F && p.x <= static_cast<float>(picture.cols - 1) &&
               p.y <= static_cast<float>(picture.rows - 1);
    });
}

bool find_bent(const cv::Mat& picture, const std::vector<Finder>& finders, Points& points) {
    for (const double corner_angle_deg : {50.0, 70.0, 85.0}) {
        const Unbent unbent(picture, radians(corner_angle_deg));
        for (const Finder& find : finders) {
            if (find(unbent.picture, points)) {
                for (cv::Point2f& point : points) {
                    point = unbent.to_source(point);
                }
                if (inside(points, picture)) {
                    return true;
                }
            }
        }
    }
    return false;
}

/// The inner corners of the largest checkerboard in the picture, counted as nearly as `grid` as they can be; none where
/// there is none of at least 4 × 3.
std::optional<cv::Size> board_seen(const cv::Mat& picture, cv::Size grid) {
    constexpr int kFewest = 12;
    Points points;
    cv::Mat squares;
    const int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER;
    if (!cv::findChessboardCornersSB(picture, {3, 3}, points, flags, squares) || squares.size().area() < kFewest) {
        return std::nullopt;
    }
    const cv::Size seen = squares.size();
    const cv::Size turned(seen.height, seen.width);
    const auto off = [&](cv::Size size) {
        return std::abs(size.width - grid.width) + std::abs(size.height - grid.height);
    };
    return off(turned) < off(seen) ? turned : seen;
}

/// "9 × 6 inner corners (squares = [10, 7])", as a chart's file counts.
std::string corners_in_words(cv::Size grid) {
    return size_in_words(grid) + " inner corners (squares = [" + std::to_string(grid.width + 1) + ", " +
           std::to_string(grid.height + 1) + "])";
}

bool is_larger(cv::Size board, cv::Size grid) {
    return board.width >= grid.width && board.height >= grid.height && board != grid;
}

/// That the picture shows a board of another count than the chart's.
std::string other_board(cv::Size seen, cv::Size grid) {
    const std::string of_chart = corners_in_words(grid) + " of the chart";
    return is_larger(seen, grid) ? "a checkerboard of " + corners_in_words(seen) + " found, more than the " + of_chart
                                 : "a checkerboard of " + corners_in_words(seen) + " found, not the " + of_chart +
                                       ": is its count another, or a part of it hidden?";
}

/// Finds the board, or says why not. All of OpenCV's detectors but the first take a part of a larger board for the
/// whole at times, so that one is looked for before them.
std::string find_board(const cv::Mat& picture, cv::Size grid, Points& points) {
    const Finder sector_based = [grid](const cv::Mat& p, Points& found) {
        return find_sector_based(p, grid, found, 0);
    };
    const Finder classic = [grid](const cv::Mat& p, Points& found) { return find_classic(p, grid, found); };
    if (sector_based(picture, points) && points.size() == static_cast<std::size_t>(grid.area())) {
        return "";
    }
    const std::optional<cv::Size> seen = board_seen(picture, grid);
    if (seen && is_larger(*seen, grid)) {
        return other_board(*seen, grid);
    }
    const bool is_found = classic(picture, points) ||
                          find_sector_based(picture, grid, points, cv::CALIB_CB_EXHAUSTIVE) ||
                          find_bent(picture, {sector_based, classic}, points);
    if (is_found && points.size() == static_cast<std::size_t>(grid.area())) {
        return "";
    }
    return seen && *seen != grid ? other_board(*seen, grid)
                                 : "no checkerboard of " + size_in_words(grid) + " inner corners found";
}

// One of the eight ways to number a grid: where the first point is, and whether rows and columns are swapped.
struct Renumbering {
    bool flip_columns = false;
    bool flip_rows = false;
    bool transpose = false;

    [[nodiscard]] Points apply(const Points& points, cv::Size grid) const {
        Points result;
        result.reserve(points.size());
        for (int row = 0; row < grid.height; ++row) {
            for (int column = 0; column < grid.width; ++column) {
                const int c = flip_columns ? grid.width - 1 - column : column;
                const int r = flip_rows ? grid.height - 1 - row : row;
                result.push_back(transpose ? points[static_cast<std::size_t>(c) * grid.width + r]
                                           : points[static_cast<std::size_t>(r) * grid.width + c]);
            }
        }
        return result;
    }
};

// Directions of rows and columns through the whole grid.
cv::Point2f along_row(const Points& p, cv::Size grid) {
    return p[grid.width - 1] - p[0] + p[p.size() - 1] - p[p.size() - grid.width];
}
cv::Point2f along_column(const Points& p, cv::Size grid) {
    return p[p.size() - grid.width] - p[0] + p[p.size() - 1] - p[grid.width - 1];
}

// How much darker the squares are that should be black than those that should be white (grey levels, may be negative).
double darkness_of_black(const cv::Mat& picture, const Points& points, cv::Size grid) {
    double sum[2] = {0.0, 0.0};
    int count[2] = {0, 0};
    for (int row = 0; row + 1 < grid.height; ++row) {
        for (int column = 0; column + 1 < grid.width; ++column) {
            const int i = row * grid.width + column;
            const cv::Point2f centre =
                0.25F * (points[i] + points[i + 1] + points[i + grid.width] + points[i + grid.width + 1]);
            const int parity = (row + column) % 2;
            sum[parity] += picture.at<uchar>(std::clamp(cvRound(centre.y), 0, picture.rows - 1),
                                             std::clamp(cvRound(centre.x), 0, picture.cols - 1));
            ++count[parity];
        }
    }
    return sum[1] / count[1] - sum[0] / count[0];
}

// The numbering that the chart asks for; none when no numbering fits (a mirror image, or not this chart).
std::optional<Points> numbered_as_chart(const cv::Mat& picture, const Points& points, cv::Size grid,
                                        Numbering& numbering) {
    std::optional<Points> best;
    int fitting = 0;
    double best_uprightness = -2.0;
    for (const bool transpose : {false, true}) {
        if (transpose && grid.width != grid.height) {
            continue;
        }
        for (const int flips : {0, 1, 2, 3}) {
            const Points candidate = Renumbering{(flips & 1) != 0, (flips & 2) != 0, transpose}.apply(points, grid);
            const cv::Point2f row = along_row(candidate, grid);
            if (row.cross(along_column(candidate, grid)) <= 0.0F) {
                continue;  // mirrored
            }
            if (darkness_of_black(picture, candidate, grid) <= 0.0) {
                continue;
            }
            ++fitting;
            const double uprightness = row.x / std::hypot(row.x, row.y);
            if (uprightness > best_uprightness) {
                best_uprightness = uprightness;
                best = candidate;
            }
        }
    }
    numbering = fitting > 2 ? Numbering::quarter_turn : fitting > 1 ? Numbering::half_turn : Numbering::certain;
    return best;
}

// A checkerboard, which is seen as a whole or not at all.
ChartSearch find_checkerboard(const cv::Mat& picture, cv::Size grid) {
    Points points;
    if (std::string reason = find_board(picture, grid, points); !reason.empty()) {
        return {.reason = std::move(reason)};
    }
    Numbering numbering = Numbering::certain;
    const auto numbered = numbered_as_chart(picture, points, grid, numbering);
    if (!numbered) {
        return {.reason = "a checkerboard of " + size_in_words(grid) +
                          " inner corners found, but mirrored or with other colours than the chart"};
    }
    return {.points = *numbered, .found = std::vector<bool>(points.size(), true), .reason = {}, .numbering = numbering};
}

ChartSearch search(const cv::Mat& picture, const scene::Chart& chart) {
    const scene::ChartTraits known = scene::traits(chart);
    const Overloaded find{
        [&](const scene::SquareCorners&) {
            return find_checkerboard(picture, {known.points.columns, known.points.rows});
        },
        [&](const scene::MarkedCorners&) {
            return find_charuco(picture, std::get<scene::CharucoBoard>(chart.pattern));
        },
        [&](const scene::Spots& spots) { return find_lattice(picture, known.points, spots); },
        [&](const scene::LineCrossings& lines) { return find_lattice(picture, known.points, lines); },
        [](const scene::Unsearched&) { return ChartSearch{.reason = "not searched for"}; },
    };
    try {
        return std::visit(find, known.look);
    } catch (const cv::Exception&) {
        // OpenCV's detectors assert on some pictures that merely do not show the chart.
        return {.reason = "no " + scene::kind_name(chart) + " found"};
    }
}

bool is_searched_for(const scene::PointLook& look) {
    return std::visit([]<class Look>(const Look&) { return !std::derived_from<Look, scene::Unsearched>; }, look);
}

Detection not_found(std::string reason) {
    return {.points = {}, .reason = std::move(reason)};
}

}  // namespace

bool can_detect(const scene::Chart& chart) {
    return is_searched_for(scene::traits(chart).look);
}

std::string detectable_kinds() {
    std::string names;
    for (const scene::ChartKind& kind : scene::chart_kinds()) {
        if (is_searched_for(kind.look)) {
            names += (names.empty() ? "" : ", ") + kind.name;
        }
    }
    return names;
}

Detection detect(const formats::Image& image, const scene::Chart& chart) {
    if (!can_detect(chart)) {
        throw InputError("a chart of kind " + scene::kind_name(chart) + " cannot be searched for: expected one of " +
                         detectable_kinds());
    }
    const scene::GridSize grid = scene::feature_grid(chart);
    if (grid.columns < 3 || grid.rows < 3) {
        throw InputError("a " + scene::kind_name(chart) + " with " + size_in_words({grid.columns, grid.rows}) +
                         " points cannot be searched for: expected at least 3 × 3");
    }
    if (image.width < kSmallestPicture_px || image.height < kSmallestPicture_px || image.channel_count() == 0) {
        return not_found("the picture is too small: " + size_in_words({image.width, image.height}) + " pixels");
    }
    const cv::Mat full = detector_copy(image);
    if (full.empty()) {
        return not_found("the picture is black or of one tone: no contrast to find a chart by");
    }
    const double shrink = std::min(1.0, kSearchSide_px / std::max(image.width, image.height));
    cv::Mat picture = full;
    if (shrink < 1.0) {
        cv::resize(full, picture, {}, shrink, shrink, cv::INTER_AREA);
    }
    ChartSearch found = search(picture, chart);
    if (!found.reason.empty()) {
        return not_found(std::move(found.reason));
    }
    // Pixel centres are whole numbers in both sizes, so the scale acts on coordinates measured from the outer edge.
    const double scale_x = static_cast<double>(image.width) / picture.cols;
    const double scale_y = static_cast<double>(image.height) / picture.rows;
    Detection result;
    for (const cv::Point2f& point : found.points) {
        result.points.image_px.push_back({(point.x + 0.5) * scale_x - 0.5, (point.y + 0.5) * scale_y - 0.5});
    }
    result.points.found = std::move(found.found);
    result.numbering = found.numbering;
    return result;
}

}  // namespace lensproof::calibration
