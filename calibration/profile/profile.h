// calibration/profile/profile.h — what was measured about a lens in a picture, as a value and as a JSON file.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/geometry/board_shape.h"
#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/geometry/planar_pose.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "calibration/light/vignetting_models.h"
#include "calibration/lines/scene_line.h"
#include "calibration/picture/picture_account.h"
#include "calibration/picture/picture_traits.h"
#include "calibration/profile/profile_line.h"
#include "calibration/profile/quantity.h"
#include "calibration/profile/self_test_result.h"
#include "calibration/sharpness/profile_edge.h"
#include "calibration/sharpness/profile_star.h"
#include "calibration/statistics/curve.h"
#include "engine/base/json_archive.h"

namespace lensproof::calibration {

inline constexpr std::string_view kProfileSchema = "lensproof-profile/1";

/// Where the pictures come from. What is unknown is empty.
struct ProfileSource {
    std::string kind;  // "render" or "photo"
    std::vector<std::string> images;
    std::string camera;
    std::string lens;
    /// What the camera noted in the pictures used (JSON key "settings").
    std::optional<formats::CameraNotes> notes = std::nullopt;
    /// Signs of corrections in the camera, or by a program since, in words (JSON key "suspicions").
    std::vector<std::string> suspicions = {};
};

/// The camera model with its uncertainty.
struct ProfileGeometry {
    CameraModel model;
    std::vector<double> covariance;  // row by row, in the order of parameter_names(model)
    /// Of the parameters in the same order, by what repeats from view to view (geometry/fit_geometry.h); empty for
    /// fewer than five views and in profiles from before (JSON key "view_standard_error" beside "standard_error").
    std::vector<double> view_standard_error = {};
    double reprojection_rms_px = 0.0;
    int views_used = 0;
    int points_used = 0;
    double covered_image_height = 0.0;
    std::optional<BoardShape> board;            // "board_shape": where it was fitted
    std::optional<UncertaintyMap> uncertainty;  // "projection_uncertainty"
    std::optional<ModelChoice> choice;          // "model_choice": where the model was chosen, not given

    [[nodiscard]] double standard_error(std::size_t parameter) const;
};

struct ProfilePoint {
    Vec2d chart_mm{};
    Vec2d image_px{};
    Vec2d residual_px{};  // measured minus model
    bool used = true;     // false: an outlier that the fit left out
    /// Of the measured place, along x and y, from the picture's noise (JSON key "standard_error_px",
    /// calibration/detection/refine.h); none where it is not known.
    std::optional<Vec2d> standard_error_px = std::nullopt;
    /// In place of `chart_mm`, of what is infinitely far away: a unit vector in a frame that the view's rotation turns
    /// into the camera's (JSON key "direction").
    std::optional<Vec3d> direction = std::nullopt;
};

/// A picture in which a chart was looked for, or known directions.
struct ProfileView {
    std::string image;
    bool found = false;
    std::string reason;                   // why not (JSON key "reason"); empty where found
    std::optional<PictureTraits> traits;  // of the channel that geometry is measured in; where found
    std::optional<Pose> pose;             // where the geometry was measured
    std::vector<ProfilePoint> points;
    /// How sure it is which point is which: "certain", "half-turn", "quarter-turn" or "whole-pitches" (JSON key
    /// "numbering", calibration/detection/numbering.h); empty where it is not known.
    std::string numbering = {};
    /// Of charts of straight lines: how straight each is under the model (JSON key "lines",
    /// calibration/profile/profile_line.h).
    std::vector<ProfileLine> lines = {};
};

/// Whether it has points of a chart whose place before the camera is known.
bool has_posed_chart(const ProfileView& view);

/// The terms of a fit, with their covariance (row by row, in the order of the names).
struct FittedTerms {
    std::vector<std::string> names;
    std::vector<double> values;
    std::vector<double> covariance;

    friend bool operator==(const FittedTerms&, const FittedTerms&) = default;
};

/// Curves, the terms of the fits behind them, and what could not be measured are called as
/// calibration/profile/quantity.h says. What could not be measured is absent, and has its reason in `not_measured`; so
/// has a self-test that was asked for and could not be made.
struct Profile {
    std::string name;
    ProfileSource source;
    int width_px = 0;
    int height_px = 0;
    std::vector<std::string> channels;
    std::optional<double> pixel_pitch_um;
    std::optional<ProfileGeometry> geometry;
    /// Every picture, used or left out, in the order given (JSON key "pictures").
    std::vector<PictureAccount> pictures;
    std::vector<ProfileView> views;  // the pictures in which a chart was looked for
    std::map<std::string, Curve> curves;
    std::map<std::string, FittedTerms> terms;
    /// The edges measured, by channel (JSON key "sharpness", calibration/sharpness/profile_edge.h).
    std::map<std::string, std::vector<ProfileEdge>> sharpness;
    /// The Siemens stars measured, by channel (JSON key "siemens_stars", calibration/sharpness/profile_star.h).
    std::map<std::string, std::vector<ProfileStar>> siemens_stars;
    /// Long edges of pictures without a chart, the straight ones `used` (JSON key "scene_lines",
    /// calibration/lines/scene_line.h).
    std::vector<SceneLine> scene_lines;
    /// Formulas for the vignetting of each channel, the one to choose first, and what they are held against (JSON keys
    /// "vignetting_models" and "shading", calibration/light/vignetting_json.h).
    std::map<std::string, std::vector<VignettingModel>> vignetting_models;
    std::map<std::string, ShadingGrid> shading;
    std::map<std::string, std::string> not_measured;
    /// What a reader has to know before the numbers, in words (JSON key "warnings"; without it where there is nothing).
    std::vector<std::string> warnings = {};
    std::optional<SelfTest> self_test;
};

/// Half the picture's diagonal, px: the unit of image heights.
double half_diagonal_px(const Profile& profile);

/// The curve of that key; null where there is none.
const Curve* find_curve(const Profile& profile, const std::string& key);

/// Why that part (calibration/profile/quantity.h) was not measured; `otherwise` where the profile does not say.
std::string why_not_measured(const Profile& profile, const char* part, const std::string& otherwise);

/// The profile's JSON, to write and to read: schema "lensproof-profile/1". A stretch_y that was held at 0 is not
/// written; numbers are written so that reading returns the same bits.
void fields(JsonArchive& json, Profile& profile);

/// Reads what `to_json` wrote. Throws InputError naming `file`, the key, what was found and what is expected.
Profile parse_profile(std::string_view text, const std::string& file);

Profile read_profile(const std::filesystem::path& file);

/// Whole or not at all.
void write_profile(const Profile& profile, const std::filesystem::path& file);

}  // namespace lensproof::calibration
