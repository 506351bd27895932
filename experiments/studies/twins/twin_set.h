// experiments/studies/twins/twin_set.h — the photos of a chart, and a lens to render them again through.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/explain/twin_camera.h"
#include "calibration/profile/profile.h"
#include "engine/base/json.h"
#include "experiments/studies/cameras/photo_set.h"

namespace lensproof::studies {

/// What a table [[twins]] states.
struct TwinSettings {
    std::string name;
    std::string photos;              // the name of a [[photos]]
    std::filesystem::path manifest;  // theirs
    std::string lens;
    std::optional<double> f_number;           // none: what the photos state
    std::optional<double> focus_distance_mm;  // from the first vertex; none: the charts'
    std::vector<std::string> free;            // what may be otherwise in the lens (calibration::kFreeKinds)
    std::string response;                     // of the twin's sensor
    int samples_per_pixel = 64;
    std::optional<double> limit_px;  // of the lens's fraction of the displacements; none: kTwinLimitFraction
    Json stated;                     // what pictures follow from
};

/// The fraction of a half-diagonal that a lens may be off by where nothing is stated: as in [[photographed_lenses]].
inline constexpr double kTwinLimitFraction = 1e-3;

/// The lens, fitted to the photos' profile as far as the settings allow: scale and sensor shift always.
struct FittedTwin {
    calibration::SeenPoints seen;  // the views to be rendered, and where their points are
    calibration::TwinCamera camera;
    std::vector<std::vector<Vec2d>> predicted;  // where it images them, px
    double f_number = 0.0;
    double efl_mm = 0.0;
    bool is_pitch_known = false;  // else it is chosen so that the focal length in pixels is the photos'
    int points_not_imaged = 0;
    std::vector<std::string> changes;  // in words
};

/// Throws InputError for a profile without geometry, photos that state no f-number where the table does not, and a lens
/// that does not image the points.
FittedTwin fit_twin(const TwinSettings& settings, const calibration::Profile& profile);

}  // namespace lensproof::studies
