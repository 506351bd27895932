#include "calibration/twins/pixel_account.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calibration/comparison/spline_surface.h"
#include "calibration/comparison/warp.h"
#include "calibration/detection/working_copy.h"
#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {

namespace {

/// The pixels inside the points' hull in the photo.
std::vector<cv::Point> pixels_among(const std::vector<TwinPoint>& points, int width, int height) {
    std::vector<cv::Point> corners;
    corners.reserve(points.size());
    for (const TwinPoint& point : points) {
        corners.emplace_back(static_cast<int>(std::lround(point.photo_px.x)),
                             static_cast<int>(std::lround(point.photo_px.y)));
    }
    std::vector<cv::Point> hull;
    cv::convexHull(corners, hull);
    cv::Mat mask = cv::Mat::zeros(height, width, CV_8U);
    cv::fillConvexPoly(mask, hull, cv::Scalar(255));
    std::vector<cv::Point> pixels;
    cv::findNonZero(mask, pixels);
    return pixels;
}

/// A quantity at those pixels.
Eigen::VectorXd values_at(const cv::Mat& plane, const std::vector<cv::Point>& pixels) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(pixels.size()));
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        values[static_cast<Eigen::Index>(i)] = static_cast<double>(plane.at<float>(pixels[i]));
    }
    return values;
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& design, const Eigen::VectorXd& values) {
    return least_norm_solution(design.transpose() * design, design.transpose() * values);
}

double rms_left(const Eigen::MatrixXd& design, const Eigen::VectorXd& values) {
    return std::sqrt((values - design * least_squares(design, values)).squaredNorm() /
                     static_cast<double>(values.size()));
}

constexpr Eigen::Index kLightTerms = 7;

/// 1, and the twin times 1, x, y, x², xy, y².
Eigen::MatrixXd light_design(const Eigen::VectorXd& twin, const std::vector<cv::Point>& pixels, const FrameScale& frame,
                             Eigen::Index more = 0) {
    Eigen::MatrixXd design(twin.size(), kLightTerms + more);
    for (Eigen::Index i = 0; i < twin.size(); ++i) {
        const cv::Point& at = pixels[static_cast<std::size_t>(i)];
        const Vec2d u = frame.unit(at.x, at.y);
        design.row(i).head<kLightTerms>() << 1.0, twin[i], twin[i] * u.x, twin[i] * u.y, twin[i] * u.x * u.x,
            twin[i] * u.x * u.y, twin[i] * u.y * u.y;
    }
    return design;
}

/// Powers of a place up to the third degree, or the first for fewer than 20 points.
Eigen::VectorXd place_terms(const Vec2d& u, std::size_t points) {
    constexpr std::size_t kManyPoints = 20;
    Eigen::VectorXd terms(points < kManyPoints ? 3 : 10);
    terms.head<3>() << 1.0, u.x, u.y;
    if (points >= kManyPoints) {
        terms.tail<7>() << u.x * u.x, u.x * u.y, u.y * u.y, u.x * u.x * u.x, u.x * u.x * u.y, u.x * u.y * u.y,
            u.y * u.y * u.y;
    }
    return terms;
}

/// What the twin shows of the places where the photo shows the same.
cv::Mat moved_to_photo(const formats::Image& twin, int channel, const std::vector<TwinPoint>& points,
                       const std::vector<cv::Point>& pixels, const FrameScale& frame) {
    const auto count = static_cast<Eigen::Index>(points.size());
    Eigen::MatrixXd design(count, place_terms({}, points.size()).size());
    Eigen::MatrixXd moves(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
        const TwinPoint& point = points[static_cast<std::size_t>(i)];
        design.row(i) = place_terms(frame.unit(point.photo_px.x, point.photo_px.y), points.size());
        moves.row(i) << point.twin_px.x - point.photo_px.x, point.twin_px.y - point.photo_px.y;
    }
    const Eigen::MatrixXd terms = least_norm_solution(design, moves);
    const SplineSurface surface(twin, channel, 1);
    cv::Mat moved = channel_plane(twin, channel);
    for (const cv::Point& at : pixels) {
        const Eigen::Vector2d by = terms.transpose() * place_terms(frame.unit(at.x, at.y), points.size());
        const Vec2d from{at.x + by.x(), at.y + by.y()};
        if (surface.covers(from)) {
            moved.at<float>(at) = static_cast<float>(surface.at(from));
        }
    }
    return moved;
}

cv::Mat blurred(const cv::Mat& plane, double sigma_px) {
    cv::Mat result;
    cv::GaussianBlur(plane, result, cv::Size(), sigma_px, sigma_px, cv::BORDER_REPLICATE);
    return result;
}

double explained(double before, double after) {
    return std::sqrt(std::max(0.0, before * before - after * after));
}

}  // namespace

PixelAccount account_of_pixels(const PhotoAndTwin& pictures, const std::vector<TwinPoint>& points) {
    const formats::Image& twin = pictures.twin;
    const FrameScale frame(twin.width, twin.height);
    const std::vector<cv::Point> pixels = pixels_among(points, twin.width, twin.height);
    const Eigen::VectorXd photo = values_at(channel_plane(pictures.photo, pictures.photo_channel), pixels);
    const Eigen::VectorXd as_it_is = values_at(channel_plane(twin, pictures.twin_channel), pixels);
    const double gain = as_it_is.sum() > 0.0 ? photo.sum() / as_it_is.sum() : 0.0;
    const double first = std::sqrt((photo - gain * as_it_is).squaredNorm() / static_cast<double>(photo.size()));
    const double lit = rms_left(light_design(as_it_is, pixels, frame), photo);
    const cv::Mat moved = moved_to_photo(twin, pictures.twin_channel, points, pixels, frame);
    const Eigen::VectorXd in_place = values_at(moved, pixels);
    const double placed = rms_left(light_design(in_place, pixels, frame), photo);
    Eigen::MatrixXd design = light_design(in_place, pixels, frame, 2);
    design.col(kLightTerms) = values_at(blurred(moved, 1.0), pixels);
    design.col(kLightTerms + 1) = values_at(blurred(moved, 2.0), pixels);
    const double sharp = rms_left(design, photo);
    const double noise = std::hypot(pictures.photo_noise, gain * pictures.twin_noise);
    return {.pixels = static_cast<int>(pixels.size()),
            .as_rendered = first / pictures.contrast,
            .light = explained(first, lit) / pictures.contrast,
            .place = explained(lit, placed) / pictures.contrast,
            .sharpness = explained(placed, sharp) / pictures.contrast,
            .noise = std::min(noise, sharp) / pictures.contrast,
            .unexplained = explained(sharp, noise) / pictures.contrast};
}

formats::Image difference_among(const PhotoAndTwin& pictures, const std::vector<TwinPoint>& points) {
    const formats::Image& photo = pictures.photo;
    formats::Image difference = formats::make_image(photo.width, photo.height, {"Y"});
    std::ranges::fill(difference.pixels, std::nanf(""));
    for (const cv::Point& pixel : pixels_among(points, photo.width, photo.height)) {
        const auto by = static_cast<double>(photo.at(pixel.x, pixel.y, pictures.photo_channel)) -
                        static_cast<double>(pictures.twin.at(pixel.x, pixel.y, pictures.twin_channel));
        difference.at(pixel.x, pixel.y, 0) = static_cast<float>(by / pictures.contrast);
    }
    return difference;
}

formats::Image in_light_of(const formats::Image& twin, const formats::Image& photo,
                           const std::vector<TwinPoint>& points) {
    const std::vector<cv::Point> pixels = pixels_among(points, twin.width, twin.height);
    formats::Image lit = formats::make_image(photo.width, photo.height, photo.channels);
    for (int c = 0; c < photo.channel_count(); ++c) {
        const int from = std::max(0, formats::find_channel(twin, photo.channels[static_cast<std::size_t>(c)]));
        const cv::Mat plane = channel_plane(twin, from);
        const Eigen::VectorXd shown = values_at(plane, pixels);
        Eigen::MatrixXd design(shown.size(), 2);
        design << Eigen::VectorXd::Ones(shown.size()), shown;
        const Eigen::VectorXd terms = least_squares(design, values_at(channel_plane(photo, c), pixels));
        for (int y = 0; y < lit.height; ++y) {
            for (int x = 0; x < lit.width; ++x) {
                lit.at(x, y, c) =
                    static_cast<float>(std::max(0.0, terms[0] + terms[1] * static_cast<double>(plane.at<float>(y, x))));
            }
        }
    }
    return lit;
}

void fields(JsonArchive& json, PixelAccount& account) {
    json.field("pixels", account.pixels)
        .field("as_rendered", account.as_rendered)
        .field("light", account.light)
        .field("place", account.place)
        .field("sharpness", account.sharpness)
        .field("noise", account.noise)
        .field("unexplained", account.unexplained);
}

}  // namespace lensproof::calibration
