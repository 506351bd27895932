#include "calibration/export/opencv_yaml.h"

#include <opencv2/core/persistence.hpp>

#include "calibration/export/opencv_camera.h"

namespace lensproof::calibration {
namespace {

std::string yaml_of(const Profile& profile, const OpencvExport& result, const OpencvCamera& camera) {
    cv::FileStorage file("camera.yaml",
                         cv::FileStorage::WRITE | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
    file.writeComment("lensproof export; the centre of the top-left pixel is (0, 0)");
    for (const std::string& note : result.notes) {
        file.writeComment(note);
    }
    file << "profile" << profile.name;
    file << "image_width" << profile.width_px << "image_height" << profile.height_px;
    file << "model" << result.model << "fisheye_model" << (camera.fisheye ? 1 : 0);
    const cv::Matx33d matrix{
        camera.focal_px, 0.0, camera.centre_px.x, 0.0, camera.focal_y_px(), camera.centre_px.y, 0.0, 0.0, 1.0};
    file << "camera_matrix" << cv::Mat(matrix);
    file << "distortion_coefficients" << cv::Mat(camera.distortion).reshape(1, 1);
    file << "avg_reprojection_error" << profile.geometry->reprojection_rms_px;
    file << "largest_difference_px" << camera.largest_difference_px;
    return file.releaseAndGetString();
}

}  // namespace

OpencvExport opencv_export(const Profile& profile) {
    const OpencvCamera camera = opencv_camera(profile, {.pinhole_coefficients = {5, 8}, .fisheye = true});
    OpencvExport result{.yaml = {},
                        .model = camera.fisheye ? "fisheye" : "pinhole",
                        .distortion = camera.distortion,
                        .largest_difference_px = camera.largest_difference_px,
                        .notes = camera.notes};
    result.yaml = yaml_of(profile, result, camera);
    return result;
}

}  // namespace lensproof::calibration
