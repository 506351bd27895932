#include "calibration/export/opencv_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "calibration/export/covered_frame.h"
#include "calibration/statistics/linear_fit.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr int kFitColumns = 49;
constexpr double kLargestSlope = 30.0;  // of X/Z: 88°; OpenCV's functions, fisheyes' too, divide by Z
constexpr int kPinholeReweightings = 12;

cv::Matx33d matrix_of(const OpencvCamera& camera) {
    return {camera.focal_px, 0.0, camera.centre_px.x, 0.0, camera.focal_y_px(), camera.centre_px.y, 0.0, 0.0, 1.0};
}

bool is_in_front(const Vec3d& direction) {
    return std::hypot(direction.x, direction.y) < kLargestSlope * direction.z;
}

/// Where OpenCV images `direction`, which is in front.
Vec2d opencv_projection(const OpencvCamera& camera, const Vec3d& direction) {
    const std::vector<cv::Point3d> points{{direction.x, direction.y, direction.z}};
    std::vector<cv::Point2d> pixels;
    const cv::Vec3d none(0.0, 0.0, 0.0);
    if (camera.fisheye) {
        cv::fisheye::projectPoints(points, pixels, none, none, matrix_of(camera), camera.distortion);
    } else {
        cv::projectPoints(points, none, none, matrix_of(camera), camera.distortion, pixels);
    }
    return {pixels[0].x, pixels[0].y};
}

/// Rows of a linear fit, two for each point of the frame.
struct Rows {
    Eigen::Index columns = 0;
    std::vector<double> coefficients;  // row by row
    std::vector<double> values;
    std::vector<double> sigmas;

    void add(const std::vector<double>& row, double value, double sigma) {
        columns = static_cast<Eigen::Index>(row.size());
        coefficients.insert(coefficients.end(), row.begin(), row.end());
        values.push_back(value);
        sigmas.push_back(sigma);
    }
    [[nodiscard]] std::optional<std::vector<double>> solution() const {
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const auto count = static_cast<Eigen::Index>(values.size());
        const auto fit = fit_linear({.a = Eigen::Map<const RowMajor>(coefficients.data(), count, columns),
                                     .y = Eigen::Map<const Eigen::VectorXd>(values.data(), count),
                                     .row_sigma = Eigen::Map<const Eigen::VectorXd>(sigmas.data(), count),
                                     .group = {}},
                                    0.0);
        if (!fit) {
            return std::nullopt;
        }
        return std::vector<double>(fit->parameters.data(), fit->parameters.data() + fit->parameters.size());
    }
};

/// r(θ) = f θ + f k1 θ³ + … is linear in (cx, cy, f, f k1, …, f k4).
std::optional<OpencvCamera> fit_fisheye(const std::vector<FramePoint>& frame) {
    Rows rows;
    for (const FramePoint& point : frame) {
        const Vec3d& d = point.direction;
        const double lateral = std::hypot(d.x, d.y);
        const double angle = std::atan2(lateral, d.z);
        const double sigma = point.covered ? 1.0 : kUncoveredSigma;
        std::vector<double> across{1.0, 0.0};
        std::vector<double> down{0.0, 1.0};
        double power = angle;
        for (int term = 0; term < 5; ++term, power *= angle * angle) {
            across.push_back(lateral > 0.0 ? power * d.x / lateral : 0.0);
            down.push_back(lateral > 0.0 ? power * d.y / lateral : 0.0);
        }
        rows.add(across, point.pixel_px.x, sigma);
        rows.add(down, point.pixel_px.y, sigma);
    }
    const auto p = rows.solution();
    if (!p) {
        return std::nullopt;
    }
    const double f = (*p)[2];
    return OpencvCamera{.fisheye = true,
                        .focal_px = f,
                        .centre_px = {(*p)[0], (*p)[1]},
                        .distortion = {(*p)[3] / f, (*p)[4] / f, (*p)[5] / f, (*p)[6] / f}};
}

/// One coordinate's row of the pinhole with N/D radially: linear in (cx, cy, f, f k1, f k2, f p1, f p2, f k3) and,
/// after multiplying by D, in k4…k6, as far as there are `coefficients`. Divided by the last round's D. With the last
/// round's centre taken off it stays linear: (u − c) D = f x N + (c' − c) D.
std::vector<double> pinhole_row(const FramePoint& point, bool across, std::size_t coefficients,
                                const OpencvCamera& last, double denominator) {
    const double x = point.direction.x / point.direction.z;
    const double y = point.direction.y / point.direction.z;
    const double r2 = x * x + y * y;
    const double along = (across ? x : y) / denominator;
    const double offset = across ? point.pixel_px.x - last.centre_px.x : point.pixel_px.y - last.centre_px.y;
    const double diagonal = r2 + 2.0 * (across ? x * x : y * y);
    std::vector<double> row{across ? 1.0 : 0.0,
                            across ? 0.0 : 1.0,
                            along,
                            along * r2,
                            along * r2 * r2,
                            across ? 2.0 * x * y : diagonal,
                            across ? diagonal : 2.0 * x * y,
                            along * r2 * r2 * r2};
    const double scaled = -offset / denominator;
    row.insert(row.end(), {scaled * r2, scaled * r2 * r2, scaled * r2 * r2 * r2});
    row.resize(3 + coefficients);
    return row;
}

/// k4, k5, k6 of OpenCV's rational model; 0 where there are none.
double denominator_at(const OpencvCamera& camera, const Vec3d& direction) {
    if (camera.distortion.size() < 8) {
        return 1.0;
    }
    const double r2 = (direction.x * direction.x + direction.y * direction.y) / (direction.z * direction.z);
    return 1.0 + r2 * (camera.distortion[5] + r2 * (camera.distortion[6] + r2 * camera.distortion[7]));
}

/// Without a denominator one round is exact.
std::optional<OpencvCamera> fit_pinhole(const std::vector<FramePoint>& frame, std::size_t coefficients) {
    OpencvCamera camera;
    for (int round = 0; round < (coefficients > 5 ? kPinholeReweightings : 1); ++round) {
        Rows rows;
        for (const FramePoint& point : frame) {
            if (!is_in_front(point.direction)) {
                if (point.covered) {
                    return std::nullopt;
                }
                continue;
            }
            const double denominator = denominator_at(camera, point.direction);
            if (!(denominator > 0.0)) {
                return std::nullopt;
            }
            const double sigma = point.covered ? 1.0 : kUncoveredSigma;
            rows.add(pinhole_row(point, true, coefficients, camera, denominator),
                     (point.pixel_px.x - camera.centre_px.x) / denominator, sigma);
            rows.add(pinhole_row(point, false, coefficients, camera, denominator),
                     (point.pixel_px.y - camera.centre_px.y) / denominator, sigma);
        }
        const auto p = rows.solution();
        if (!p) {
            return std::nullopt;
        }
        const double f = (*p)[2];
        camera.focal_px = f;
        camera.centre_px = {camera.centre_px.x + (*p)[0], camera.centre_px.y + (*p)[1]};
        camera.distortion.assign(p->begin() + 3, p->end());
        for (std::size_t i = 0; i < std::min<std::size_t>(5, coefficients); ++i) {
            camera.distortion[i] /= f;
        }
    }
    return camera;
}

/// The profile's own parameters, where OpenCV has the same model and it is among the choices.
std::optional<OpencvCamera> same_model(const CameraModel& model, const OpencvChoices& choices) {
    const bool brown = kind_name(model) == BrownConrady::kind;
    if (!brown && kind_name(model) != KannalaBrandt::kind) {
        return std::nullopt;
    }
    const std::vector<std::string> order = brown ? std::vector<std::string>{"k1", "k2", "p1", "p2", "k3"}
                                                 : std::vector<std::string>{"k1", "k2", "k3", "k4"};
    const std::vector<std::string> names = parameter_names(model);
    const std::vector<double> values = parameters(model);
    OpencvCamera camera{.fisheye = !brown,
                        .focal_px = focal_length_px(model),
                        .stretch_y = stretch_y(model),
                        .centre_px = centre_px(model),
                        .distortion = std::vector<double>(order.size(), 0.0)};
    for (std::size_t i = 3; i + 1 < names.size(); ++i) {
        const auto place = std::ranges::find(order, names[i]);
        if (place != order.end()) {
            camera.distortion[static_cast<std::size_t>(place - order.begin())] = values[i];
        } else if (values[i] != 0.0) {
            return std::nullopt;
        }
    }
    if (!brown) {
        return choices.fisheye ? std::optional(camera) : std::nullopt;
    }
    const auto fits = std::ranges::find_if(choices.pinhole_coefficients, [&](std::size_t count) {
        return std::all_of(camera.distortion.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(count, 5)),
                           camera.distortion.end(), [](double k) { return k == 0.0; });
    });
    if (fits == choices.pinhole_coefficients.end()) {
        return std::nullopt;
    }
    camera.distortion.resize(*fits, 0.0);
    return camera;
}

/// The frame with square pixels: heights over the principal point without their stretch.
std::vector<FramePoint> square_pixels(std::vector<FramePoint> frame, const CameraModel& model) {
    const double centre = centre_px(model).y;
    for (FramePoint& point : frame) {
        point.pixel_px.y = centre + (point.pixel_px.y - centre) / (1.0 + stretch_y(model));
    }
    return frame;
}

/// A camera that was fitted to square pixels, with the model's stretch.
std::optional<OpencvCamera> stretched(std::optional<OpencvCamera> camera, const CameraModel& model) {
    if (camera) {
        const double centre = centre_px(model).y;
        camera->stretch_y = stretch_y(model);
        camera->centre_px.y = centre + (camera->centre_px.y - centre) * (1.0 + camera->stretch_y);
    }
    return camera;
}

}  // namespace

OpencvCamera opencv_camera(const Profile& profile, const OpencvChoices& choices) {
    const ProfileGeometry& geometry = exported_geometry(profile);
    const std::vector<FramePoint> frame = frame_points(profile, kFitColumns);
    std::vector<FramePoint> in_front;
    std::ranges::copy_if(frame, std::back_inserter(in_front),
                         [](const FramePoint& p) { return is_in_front(p.direction); });
    std::optional<OpencvCamera> best;
    const auto consider = [&](std::optional<OpencvCamera> candidate) {
        if (!candidate || !(candidate->focal_px > 0.0)) {
            return;
        }
        const auto difference = largest_difference_px(
            in_front, [&](const Vec3d& direction) { return std::optional(opencv_projection(*candidate, direction)); });
        if (difference && (!best || *difference < best->largest_difference_px)) {
            candidate->largest_difference_px = *difference;
            best = std::move(candidate);
        }
    };
    consider(same_model(geometry.model, choices));
    if (!best) {
        const std::vector<FramePoint> square = square_pixels(frame, geometry.model);
        for (const std::size_t coefficients : choices.pinhole_coefficients) {
            consider(stretched(fit_pinhole(square, coefficients), geometry.model));
        }
        if (choices.fisheye) {
            consider(stretched(fit_fisheye(square), geometry.model));
        }
    }
    if (!best) {
        throw InputError(
            fmt::format("no {} of the target's follows the profile's {}: expected a model that images one "
                        "to one{}",
                        choices.fisheye ? "camera model" : "pinhole", kind_name(geometry.model),
                        choices.fisheye ? "" : ", less than 88° from the axis"));
    }
    best->notes = {fmt::format(
        "{} with {} coefficients, differs from the profile's {} by at most {:.3g} px within the covered {:.0f} % of "
        "the half diagonal",
        best->fisheye ? "fisheye" : "pinhole", best->distortion.size(), kind_name(geometry.model),
        best->largest_difference_px, 100.0 * geometry.covered_image_height)};
    if (in_front.size() < frame.size()) {
        best->notes.push_back(fmt::format(
            "{:.0f} % of the frame see 88° from the axis or more, where OpenCV's own functions project nothing; the "
            "difference is that of the rest",
            100.0 - 100.0 * static_cast<double>(in_front.size()) / static_cast<double>(frame.size())));
    }
    return *best;
}

}  // namespace lensproof::calibration
