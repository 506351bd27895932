// calibration/photos/photo_survey.h — which photographs of a set belong together, before any is measured.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/measure/measure.h"
#include "engine/formats/image/transfer_curve.h"

namespace lensproof::calibration {

/// A folder's pictures by name, or the file itself. Throws InputError for a folder without a picture.
std::vector<std::filesystem::path> picture_files(const std::filesystem::path& file_or_folder);

/// What the files' headers say.
struct PhotoSurvey {
    std::vector<Picture> pictures;  // all of them, those to be left out with the reason
    formats::CameraNotes notes;     // what those in use agree on; focal length and f-number of most
    std::vector<std::string> suspicions;
};

/// Reads the headers of `charts` and `flat_fields`, and says for each whether it is to be used.
///
/// Left out: files that cannot be read, copies (the same bytes as a file before), pictures of another camera, lens or
/// focal length than most, and of another size (the sensor's rows: a portrait held upright counts as what the sensor
/// saw, whatever its EXIF orientation, but one that a program has turned no longer says which way). What a picture does
/// not say is no reason. Pictures of another f-number than most give no light samples: vignetting differs.
PhotoSurvey survey_photos(const std::vector<std::filesystem::path>& charts,
                          const std::vector<std::filesystem::path>& flat_fields,
                          const std::optional<formats::TransferCurve>& assumed);

/// A camera's or lens's name that nothing states.
inline constexpr const char* kUnknown = "unknown";

/// The survey's pictures, and what their cameras noted where `input` says nothing else: camera and lens of the name
/// "unknown", and the pixel pitch.
void take_survey(MeasureInput& input, const PhotoSurvey& survey);

/// `measure`, and in the profile's source what the result shows of corrections.
Profile measure_surveyed(const MeasureInput& input);

/// What a finished measurement shows of corrections that the camera may have made: no distortion within its error where
/// a lens so wide has some, or another focal length than the camera states.
std::vector<std::string> suspicions_of(const Profile& profile);

}  // namespace lensproof::calibration
