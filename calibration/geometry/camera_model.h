// calibration/geometry/camera_model.h — where a camera images a direction: the known lens models over any number type.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "calibration/geometry/fisheye_models.h"
#include "calibration/geometry/perspective_models.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

// Frames. Camera: x to the right, y down, z into the scene, origin at the centre of projection (OpenCV's frame).
// Pixels: the centre of the top-left pixel is (0, 0). Angles are in radians and measured from the z axis.
//
// A model is a flat array of parameters, so that one template serves double and ceres::Jet. The first three are alike
// in every model: focal length (the slope of r(θ) on the axis) and principal point, px; the last is `stretch_y`
// (radial_model.h), 0 for square pixels. A model whose other parameters are 0 is the projection that its name says.
// Formulas stand at the models.

/// In the order of ModelKind.
using CameraModel = std::variant<BrownConrady, RationalBrownConrady, Division, Poly3, Poly5, PtLens, KannalaBrandt,
                                 Equidistant, Equisolid, Stereographic, Orthographic, Spline>;

enum class ModelKind {
    brown_conrady,
    brown_conrady_rational,
    division,
    poly3,
    poly5,
    ptlens,
    kannala_brandt,
    equidistant,
    equisolid,
    stereographic,
    orthographic,
    spline
};

/// "brown-conrady", "kannala-brandt", …: every model's name, in the order of ModelKind.
std::vector<std::string> model_kind_names();
/// None for an unknown name.
std::optional<ModelKind> model_kind(std::string_view name);
ModelKind kind(const CameraModel& model);
/// The model of this kind with all parameters 0.
CameraModel empty_model(ModelKind kind);

std::string kind_name(const CameraModel& model);
std::vector<std::string> parameter_names(const CameraModel& model);
std::vector<double> parameters(const CameraModel& model);
/// The model with other parameters, the first of `parameters(model)` or all.
CameraModel with_parameters(const CameraModel& model, const std::vector<double>& values);

/// What the parameters behind the first three are, as indices into `parameters`. Those that are in neither list are
/// constants of the model (a normalisation), which a fit leaves alone.
struct ModelTerms {
    std::vector<int> radial;  // in the order in which a fit with fewer terms takes them
    std::vector<int> tangential;
};
ModelTerms model_terms(const CameraModel& model);

/// True for a model whose undistorted picture is the pinhole's, r = f tan θ.
bool is_perspective(const CameraModel& model);

double focal_length_px(const CameraModel& model);
/// The vertical focal length over the horizontal one, less 1.
double stretch_y(const CameraModel& model);
Vec2d centre_px(const CameraModel& model);

/// The pixel that shows `point` (camera frame, any unit), if the model images it.
std::optional<Vec2d> project(const CameraModel& model, const Vec3d& point);

/// The radial function r(θ), px, before heights are stretched, where the model images the angle.
double radius_px(const CameraModel& model, double angle_rad);

/// Its inverse on the branch that starts on the axis: the angle imaged at `radius_px`, to machine precision. None
/// beyond the first maximum of r(θ), where the model folds back, and beyond 90° (perspective) or 180° (fisheye).
std::optional<double> field_angle_rad(const CameraModel& model, double radius_px);

/// `field_angle_rad` in a table, for millions of radii: linear between radii a quarter of a pixel apart. At a radius of
/// r px this is off by 8e-3 θ''(r), which is 2e-5 px in the picture of a lens of 300 px and less in longer ones.
class FieldAngles {
  public:
    FieldAngles(const CameraModel& model, double largest_radius_px);

    /// None where the model has none, and beyond the table.
    [[nodiscard]] std::optional<double> at(double radius_px) const;

  private:
    std::vector<double> angles_;  // NaN: none
};

/// The unit direction that `pixel` shows, on the same branch as `field_angle_rad`.
std::optional<Vec3d> unproject(const CameraModel& model, const Vec2d& pixel);
/// The same with the model's angles from a table.
std::optional<Vec3d> unproject(const CameraModel& model, const Vec2d& pixel, const FieldAngles& angles);

/// The angle that the model's undistorted projection with this focal length images at `radius_px`; above π for none.
double undistorted_angle_rad(ModelKind kind, double focal_px, double radius_px);

}  // namespace lensproof::calibration
