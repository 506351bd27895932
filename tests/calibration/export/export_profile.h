// Profiles of known lenses, for the tests of calibration/export.
#pragma once
#include <cmath>

#include "calibration/profile/profile.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::synthetic {

/// A profile whose model is `model`, of a picture of that size, measured as far as `covered` of its half diagonal.
inline Profile profile_of(const CameraModel& model, int width_px, int height_px, double covered = 0.9) {
    Profile profile;
    profile.name = "synthetic -- <lens>";
    profile.source = {.kind = "photo", .images = {}, .camera = "a camera", .lens = "a lens & more"};
    profile.width_px = width_px;
    profile.height_px = height_px;
    ProfileGeometry geometry;
    geometry.model = model;
    geometry.covariance.assign(parameters(model).size() * parameters(model).size(), 0.0);
    geometry.covered_image_height = covered;
    profile.geometry = geometry;
    return profile;
}

/// A curve of `value(height)` at heights up to 1.
template <class Value>
Curve curve_of(const Value& value) {
    Curve curve;
    for (const double height : standard_image_heights()) {
        append(curve, height, {value(height), value(height), value(height)});
    }
    curve.covered_image_height = 1.0;
    return curve;
}

/// Pixels on a lattice, about 9 × 7 over the frame, that lie within `covered` of the half diagonal about the principal
/// point.
inline std::vector<Vec2d> covered_pixels(const Profile& profile) {
    std::vector<Vec2d> pixels;
    const Vec2d centre = centre_px(profile.geometry->model);
    for (int j = 0; j < 7; ++j) {
        for (int i = 0; i < 9; ++i) {
            const Vec2d p{(profile.width_px - 1.0) * i / 8.0, (profile.height_px - 1.0) * j / 6.0};
            if (std::hypot(p.x - centre.x, p.y - centre.y) <
                profile.geometry->covered_image_height * half_diagonal_px(profile)) {
                pixels.push_back(p);
            }
        }
    }
    return pixels;
}

}  // namespace lensproof::calibration::synthetic
