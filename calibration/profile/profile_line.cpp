#include "calibration/profile/profile_line.h"

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {
namespace {
constexpr std::size_t kFewestPoints = 8;
constexpr double kPlaneUnknowns = 2.0;  // of a plane through the camera

std::optional<ProfileLine> straightness_of(const LinePoints& line, const CameraModel& model) {
    std::vector<Vec2d> pixels;
    std::vector<Eigen::Vector3d> directions;
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    double noise = 0.0;
    for (const LinePoint& point : line.points) {
        if (const auto direction = unproject(model, point.image_px)) {
            pixels.push_back(point.image_px);
            directions.emplace_back(direction->x, direction->y, direction->z);
            moments += directions.back() * directions.back().transpose();
            noise += point.standard_error_px * point.standard_error_px;
        }
    }
    if (pixels.size() < kFewestPoints) {
        return std::nullopt;
    }
    const Eigen::Vector3d normal = symmetric_eigen(moments).vectors.col(0);
    double squares = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Eigen::Vector3d foot = directions[i] - normal.dot(directions[i]) * normal;
        const auto pixel = project(model, {foot.x(), foot.y(), foot.z()});
        if (!pixel) {
            return std::nullopt;
        }
        squares += std::pow(pixel->x - pixels[i].x, 2) + std::pow(pixel->y - pixels[i].y, 2);
    }
    const auto count = static_cast<double>(pixels.size());
    const double rms = std::sqrt(squares / (count - kPlaneUnknowns));
    return ProfileLine{.is_column = line.is_column,
                       .index = line.index,
                       .points = static_cast<int>(pixels.size()),
                       .rms_px = rms,
                       .rms_standard_error_px = rms / std::sqrt(2.0 * (count - kPlaneUnknowns)),
                       .noise_px = std::sqrt(noise / count)};
}

}  // namespace

std::vector<ProfileLine> straightness(const std::vector<LinePoints>& lines, const CameraModel& model) {
    std::vector<ProfileLine> result;
    for (const LinePoints& line : lines) {
        if (const auto one = straightness_of(line, model)) {
            result.push_back(*one);
        }
    }
    return result;
}

void fields(JsonArchive& json, ProfileLine& line) {
    json.one_of("along", line.is_column, {"row", "column"}, "\"column\" or \"row\"")
        .field("index", line.index)
        .field("points", line.points)
        .field("rms_px", line.rms_px)
        .field("rms_standard_error_px", line.rms_standard_error_px)
        .field("noise_px", line.noise_px);
}

}  // namespace lensproof::calibration
