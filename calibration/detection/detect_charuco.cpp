#include "calibration/detection/detect_charuco.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

namespace lensproof::calibration {
namespace {

constexpr std::size_t kNeighbours = 4;  // markers that place a corner
constexpr double kNear_squares = 2.0;   // and from how far away
constexpr double kFewMarkers = 0.9;     // of the board's; with fewer a sharpened copy is searched too
constexpr double kFine_px = 0.8;        // what sharpening takes for noise,
constexpr double kCoarse_px = 2.0;      // and for blur
constexpr double kSharpening = 4.0;
constexpr double kMostAgree = 0.8;            // of the markers seen; where fewer do, the board may have another count
constexpr double kDisagreement_sides = 0.35;  // a marker farther from where its neighbours put it is a false one

struct Marker {
    cv::Point2d centre;  // on the board, in squares from its top left
    std::vector<cv::Point2f> corners;
};

/// A marker's pattern, turned by quarter turns, as OpenCV's dictionaries hold it.
cv::Mat bits_of(std::uint64_t marker, int cells) {
    cv::Mat bits(cells, cells, CV_8U);
    for (int i = 0; i < cells * cells; ++i) {
        bits.at<uchar>(i / cells, i % cells) = static_cast<uchar>(marker >> (cells * cells - 1 - i) & 1U);
    }
    return bits;
}

std::uint64_t turned_marker(std::uint64_t marker, int cells) {
    std::uint64_t result = 0;
    for (int row = 0; row < cells; ++row) {
        for (int column = 0; column < cells; ++column) {
            const int from = cells * cells - 1 - ((cells - 1 - column) * cells + row);
            result = result << 1U | (marker >> from & 1U);
        }
    }
    return result;
}

/// Fewest bits in which two of the markers, or one and itself turned, differ.
int least_distance(const std::vector<std::uint64_t>& markers, int cells) {
    int least = cells * cells;
    for (std::size_t i = 0; i < markers.size(); ++i) {
        std::uint64_t turn = markers[i];
        for (int quarter = 1; quarter < 4; ++quarter) {
            turn = turned_marker(turn, cells);
            least = std::min(least, std::popcount(turn ^ markers[i]));
        }
        for (int quarter = 0; quarter < 4; ++quarter) {
            turn = turned_marker(turn, cells);
            for (std::size_t j = i + 1; j < markers.size(); ++j) {
                least = std::min(least, std::popcount(turn ^ markers[j]));
            }
        }
    }
    return least;
}

/// The board's white squares in the order of their markers: middles, in squares.
std::vector<cv::Point2d> marker_centres(const scene::CharucoBoard& board) {
    std::vector<cv::Point2d> centres;
    for (int row = 0; row < board.rows; ++row) {
        for (int column = 0; column < board.columns; ++column) {
            if ((row + column) % 2 == 1) {
                centres.emplace_back(column + 0.5, row + 0.5);
            }
        }
    }
    return centres;
}

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const scene::CharucoBoard& board, std::size_t count) {
    const std::vector<std::uint64_t> markers(board.markers.begin(),
                                             board.markers.begin() + static_cast<std::ptrdiff_t>(count));
    cv::Mat bytes;
    for (const std::uint64_t marker : markers) {
        bytes.push_back(cv::aruco::Dictionary::getByteListFromBits(bits_of(marker, board.cells)));
    }
    const int correctable = std::max(0, (least_distance(markers, board.cells) - 1) / 2);
    return cv::makePtr<cv::aruco::Dictionary>(bytes, board.cells, correctable);
}

struct SeenMarker {
    int number;
    std::vector<cv::Point2f> corners;
};

std::vector<SeenMarker> seen_markers(const cv::Mat& picture, const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
    auto tuning = cv::makePtr<cv::aruco::DetectorParameters>();
    tuning->minMarkerPerimeterRate = 0.02;
    tuning->adaptiveThreshWinSizeMax = 53;
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    cv::aruco::detectMarkers(picture, dictionary, corners, ids, tuning);
    std::vector<SeenMarker> markers;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        // A number seen twice says nothing.
        if (std::count(ids.begin(), ids.end(), ids[i]) == 1) {
            markers.push_back({ids[i], corners[i]});
        }
    }
    return markers;
}

/// Where the markers nearest to `place` (on the board) put it; none without a marker near by. `leave_out` has no say.
std::optional<cv::Point2d> place_in_picture(const std::vector<Marker>& markers, double side_squares, cv::Point2d place,
                                            const Marker* leave_out) {
    std::vector<std::pair<double, const Marker*>> near;
    for (const Marker& marker : markers) {
        const double distance = std::hypot(marker.centre.x - place.x, marker.centre.y - place.y);
        if (&marker != leave_out && distance < kNear_squares) {
            near.emplace_back(distance, &marker);
        }
    }
    if (near.empty()) {
        return std::nullopt;
    }
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    near.resize(std::min(near.size(), kNeighbours));
    std::vector<cv::Point2f> board;
    std::vector<cv::Point2f> image;
    const double half = 0.5 * side_squares;
    for (const auto& [distance, marker] : near) {
        for (const cv::Point2d corner : {cv::Point2d(-half, -half), {half, -half}, {half, half}, {-half, half}}) {
            board.emplace_back(marker->centre + corner - place);
        }
        image.insert(image.end(), marker->corners.begin(), marker->corners.end());
    }
    const cv::Mat map = cv::findHomography(board, image, 0);
    if (map.empty() || !(std::abs(map.at<double>(2, 2)) > 1e-9)) {
        return std::nullopt;
    }
    return cv::Point2d{map.at<double>(0, 2) / map.at<double>(2, 2), map.at<double>(1, 2) / map.at<double>(2, 2)};
}

/// How far a marker lies from where its neighbours put it, in its own sides; infinitely without neighbours.
double disagreement(const std::vector<Marker>& markers, double side_squares, const Marker& marker) {
    const auto expected = place_in_picture(markers, side_squares, marker.centre, &marker);
    if (!expected) {
        return std::numeric_limits<double>::infinity();
    }
    cv::Point2d middle;
    for (const cv::Point2f& corner : marker.corners) {
        middle += 0.25 * cv::Point2d(corner);
    }
    const double side = std::sqrt(cv::contourArea(marker.corners));
    return std::hypot(middle.x - expected->x, middle.y - expected->y) / std::max(side, 1.0);
}

/// The markers seen that agree with their neighbours: of 35 squares that show anything else, one passes for a marker.
std::vector<Marker> agreeing(const std::vector<SeenMarker>& seen, const std::vector<cv::Point2d>& centres,
                             double side_squares) {
    std::vector<Marker> markers;
    for (const SeenMarker& each : seen) {
        if (static_cast<std::size_t>(each.number) < centres.size()) {
            markers.push_back({centres[static_cast<std::size_t>(each.number)], each.corners});
        }
    }
    while (!markers.empty()) {
        std::vector<double> off;
        off.reserve(markers.size());
        for (const Marker& marker : markers) {
            off.push_back(disagreement(markers, side_squares, marker));
        }
        const auto worst = std::max_element(off.begin(), off.end());
        if (!(*worst > kDisagreement_sides)) {
            break;
        }
        markers.erase(markers.begin() + (worst - off.begin()));
    }
    return markers;
}

struct Reading {
    std::vector<Marker> markers;  // that agree
    std::size_t seen = 0;         // with them those that do not
};

Reading agreeing_markers(const cv::Mat& picture, const cv::Ptr<cv::aruco::Dictionary>& dictionary,
                         const std::vector<cv::Point2d>& centres, double side_squares) {
    const std::vector<SeenMarker> seen = seen_markers(picture, dictionary);
    return {agreeing(seen, centres, side_squares), seen.size()};
}

/// The blur of a lens out of focus, partly undone: markers are read from cells a few pixels wide.
cv::Mat sharpened(const cv::Mat& picture) {
    cv::Mat light;
    picture.convertTo(light, CV_32F);
    cv::Mat fine;
    cv::Mat coarse;
    cv::GaussianBlur(light, fine, {}, kFine_px);
    cv::GaussianBlur(light, coarse, {}, kCoarse_px);
    cv::Mat result;
    cv::Mat(fine + kSharpening * (fine - coarse)).convertTo(result, CV_8U);
    return result;
}

/// The markers of the picture, or of a sharpened copy where it shows fewer than it might and the copy more.
Reading best_markers(const cv::Mat& picture, const cv::Ptr<cv::aruco::Dictionary>& dictionary,
                     const std::vector<cv::Point2d>& centres, double side_squares) {
    Reading reading = agreeing_markers(picture, dictionary, centres, side_squares);
    if (static_cast<double>(reading.markers.size()) < kFewMarkers * static_cast<double>(centres.size())) {
        Reading more = agreeing_markers(sharpened(picture), dictionary, centres, side_squares);
        if (more.markers.size() > reading.markers.size()) {
            return more;
        }
    }
    return reading;
}

/// That more markers than `agreeing_as_stated` lie as on a board of another count, where they do: numbers run row by
/// row, so where they lie tells the columns, and the last one how many rows there are at least.
std::optional<std::string> other_count(const cv::Mat& picture, const scene::CharucoBoard& board, double side_squares,
                                       std::size_t agreeing_as_stated) {
    constexpr std::size_t kFewest = 4;
    constexpr int kMostColumns = 40;
    const std::vector<SeenMarker> seen = seen_markers(picture, dictionary_of(board, board.markers.size()));
    scene::CharucoBoard best = board;
    std::size_t most = 0;
    for (int columns = 2; columns <= kMostColumns && seen.size() >= kFewest; ++columns) {
        scene::CharucoBoard other = board;
        other.columns = columns;
        other.rows = 1;
        const int last = std::max_element(seen.begin(), seen.end(), [](const auto& a, const auto& b) {
                             return a.number < b.number;
                         })->number;
        while (marker_centres(other).size() <= static_cast<std::size_t>(last)) {
            ++other.rows;
        }
        const std::size_t count = agreeing(seen, marker_centres(other), side_squares).size();
        if (count > most) {
            most = count;
            best = other;
        }
    }
    if (most < kFewest || 2 * most < seen.size() || most <= agreeing_as_stated || best.columns == board.columns) {
        return std::nullopt;
    }
    return std::to_string(most) + " markers found that lie as on a board of " + std::to_string(best.columns) +
           " columns and " + std::to_string(best.rows) + " rows or more (squares = [" + std::to_string(best.columns) +
           ", " + std::to_string(best.rows) + "]), not of squares = [" + std::to_string(board.columns) + ", " +
           std::to_string(board.rows) + "]";
}

}  // namespace

ChartSearch find_charuco(const cv::Mat& picture, const scene::CharucoBoard& board) {
    const std::vector<cv::Point2d> centres = marker_centres(board);
    const double side_squares = board.marker_mm / board.square_mm;
    const auto dictionary = dictionary_of(board, centres.size());
    const auto [markers, seen] = best_markers(picture, dictionary, centres, side_squares);
    if (markers.empty()) {
        cv::Mat mirrored;
        cv::flip(picture, mirrored, 1);
        const bool is_mirrored = !agreeing_markers(mirrored, dictionary, centres, side_squares).markers.empty();
        return {.reason =
                    is_mirrored
                        ? "the board is seen mirrored"
                        : other_count(picture, board, side_squares, 0).value_or("none of the board's markers found")};
    }
    // On a board with other columns markers of one row agree with each other, and with no other row.
    if (static_cast<double>(markers.size()) < kMostAgree * static_cast<double>(seen)) {
        if (std::optional<std::string> reason = other_count(picture, board, side_squares, markers.size())) {
            return {.reason = std::move(*reason)};
        }
    }
    ChartSearch result;
    for (int row = 1; row < board.rows; ++row) {
        for (int column = 1; column < board.columns; ++column) {
            const cv::Point2d corner(column, row);
            const bool is_touched = std::any_of(markers.begin(), markers.end(), [&](const Marker& m) {
                return std::abs(m.centre.x - corner.x) < 1.0 && std::abs(m.centre.y - corner.y) < 1.0;
            });
            const auto place =
                is_touched ? place_in_picture(markers, side_squares, corner, nullptr) : std::optional<cv::Point2d>();
            const bool is_inside = place && place->x >= 0.0 && place->y >= 0.0 && place->x <= picture.cols - 1 &&
                                   place->y <= picture.rows - 1;
            result.points.push_back(is_inside ? cv::Point2f(*place) : cv::Point2f());
            result.found.push_back(is_inside);
        }
    }
    const auto count = std::count(result.found.begin(), result.found.end(), true);
    if (count < 4) {
        result.reason = "only " + std::to_string(markers.size()) + " of " + std::to_string(centres.size()) +
                        " markers found, with " + std::to_string(count) + " corners between them";
    }
    return result;
}

}  // namespace lensproof::calibration
