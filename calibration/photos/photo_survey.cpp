#include "calibration/photos/photo_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "engine/base/file.h"
#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/formats/image/full_frame.h"
#include "engine/formats/image/jpeg.h"

namespace lensproof::calibration {
namespace {

namespace fs = std::filesystem;

constexpr double kWide_deg = 25.0;             // half the field from which on lenses without distortion are rare
constexpr double kNoDistortion_percent = 0.1;  // what a corrected picture may have left
constexpr double kFocalLengthMargin = 0.06;    // of cameras' own figures: rounding, and breathing at close focus

struct Surveyed {
    Picture picture;
    formats::PhotoHeader header;
};

bool in_use(const Surveyed& photo) {
    return photo.picture.left_out.empty();
}

Surveyed look_at(const fs::path& file, PictureRole role, const std::optional<formats::TransferCurve>& assumed,
                 std::map<std::string, std::string>& seen_bytes) {
    Surveyed photo{.picture = {.name = file.string(),
                               .role = role,
                               .load = [file, assumed] { return formats::read_photo(file, assumed); }},
                   .header = {}};
    try {
        photo.header = formats::read_photo_header(file, assumed);
        photo.picture.orientation = photo.header.orientation;
        const std::string bytes = read_file(file);
        photo.picture.jpeg_quality = formats::jpeg_quality(bytes);
        const auto [first, is_new] = seen_bytes.emplace(hash_text(bytes), file.string());
        if (!is_new) {
            photo.picture.left_out = "a copy of " + first->second;
        }
    } catch (const InputError& e) {
        photo.picture.left_out = e.what();
    }
    return photo;
}

/// The value that most of the pictures in use have, the first of several; empty values do not count.
std::string most_common(const std::vector<Surveyed>& photos, const std::function<std::string(const Surveyed&)>& value) {
    std::map<std::string, int> counts;
    for (const Surveyed& photo : photos) {
        if (in_use(photo) && !value(photo).empty()) {
            ++counts[value(photo)];
        }
    }
    std::string best;
    for (const Surveyed& photo : photos) {
        const std::string own = in_use(photo) ? value(photo) : "";
        if (!own.empty() && (best.empty() || counts[own] > counts[best])) {
            best = own;
        }
    }
    return best;
}

std::string pixels_in_words(const Surveyed& photo) {
    return fmt::format("{} × {} pixels", photo.header.width, photo.header.height);
}

std::string camera_in_words(const Surveyed& photo) {
    const formats::CameraNotes& notes = photo.header.notes;
    return notes.model.empty() ? "" : fmt::format("camera {} {}", notes.make, notes.model);
}

std::string lens_in_words(const Surveyed& photo) {
    return photo.header.notes.lens.empty() ? "" : "lens " + photo.header.notes.lens;
}

std::string focal_length_in_words(const Surveyed& photo) {
    const auto& focal = photo.header.notes.focal_length_mm;
    return focal ? fmt::format("focal length {:g} mm", *focal) : "";
}

std::string f_number_in_words(const Surveyed& photo) {
    return photo.header.notes.f_number ? fmt::format("f/{:g}", *photo.header.notes.f_number) : "";
}

void leave_out_others(std::vector<Surveyed>& photos, const std::function<std::string(const Surveyed&)>& value) {
    const std::string common = most_common(photos, value);
    for (Surveyed& photo : photos) {
        const std::string own = value(photo);
        if (in_use(photo) && !own.empty() && own != common) {
            photo.picture.left_out = fmt::format("{}, most of the others have {}", own, common);
        }
    }
}

/// Pictures whose sides are swapped have been turned by a program; which way, nothing says.
void leave_out_turned(std::vector<Surveyed>& photos) {
    const std::string common = most_common(photos, pixels_in_words);
    for (Surveyed& photo : photos) {
        if (in_use(photo) && photo.header.width != photo.header.height && pixels_in_words(photo) != common &&
            fmt::format("{} × {} pixels", photo.header.height, photo.header.width) == common) {
            photo.picture.left_out = fmt::format(
                "{}, most of the others have {}: turned by a program, so that the sensor's own rows are no longer "
                "known",
                pixels_in_words(photo), common);
        }
    }
}

void mark_other_apertures(std::vector<Surveyed>& photos) {
    const std::string common = most_common(photos, f_number_in_words);
    for (Surveyed& photo : photos) {
        const std::string own = f_number_in_words(photo);
        if (in_use(photo) && !own.empty() && own != common) {
            photo.picture.use_light = false;
            photo.picture.remark = fmt::format("{}, most of the others have {}: not used for vignetting", own, common);
        }
    }
}

/// The first picture in use stands for all, but for what differs.
formats::CameraNotes common_notes(const std::vector<Surveyed>& photos) {
    const std::string aperture = most_common(photos, f_number_in_words);
    formats::CameraNotes notes;
    bool first = true;
    for (const Surveyed& photo : photos) {
        const formats::CameraNotes& own = photo.header.notes;
        if (!in_use(photo) || f_number_in_words(photo) != aperture) {
            continue;
        }
        if (first) {
            notes = own;
            first = false;
        }
        notes.exposure_time_s = notes.exposure_time_s == own.exposure_time_s ? notes.exposure_time_s : std::nullopt;
        notes.iso = notes.iso == own.iso ? notes.iso : std::nullopt;
        notes.software = notes.software == own.software ? notes.software : "";
        notes.transfer = notes.transfer == own.transfer ? notes.transfer : "differs from picture to picture";
    }
    return notes;
}

}  // namespace

std::vector<fs::path> picture_files(const fs::path& file_or_folder) {
    if (!is_folder(file_or_folder)) {
        return {file_or_folder};
    }
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(file_or_folder)) {
        if (entry.is_regular_file() && formats::has_picture_name(entry.path()) &&
            entry.path().filename().string().front() != '.') {
            files.push_back(entry.path());
        }
    }
    if (files.empty()) {
        throw InputError(file_or_folder.string() + ": the folder has no picture: expected .jpg, .png, .tif, .dng, …");
    }
    std::ranges::sort(files);
    return files;
}

PhotoSurvey survey_photos(const std::vector<fs::path>& charts, const std::vector<fs::path>& flat_fields,
                          const std::optional<formats::TransferCurve>& assumed) {
    std::vector<Surveyed> photos;
    std::map<std::string, std::string> seen_bytes;
    for (const auto& [files, role] :
         {std::pair(&charts, PictureRole::chart), std::pair(&flat_fields, PictureRole::flat_field)}) {
        for (const fs::path& file : *files) {
            photos.push_back(look_at(file, role, assumed, seen_bytes));
        }
    }
    leave_out_others(photos, camera_in_words);
    leave_out_others(photos, lens_in_words);
    leave_out_others(photos, focal_length_in_words);
    leave_out_turned(photos);
    leave_out_others(photos, pixels_in_words);
    mark_other_apertures(photos);

    PhotoSurvey survey{.pictures = {}, .notes = common_notes(photos), .suspicions = {}};
    std::map<std::string, int> signs;
    for (Surveyed& photo : photos) {
        for (const std::string& sign : photo.header.suspicions) {
            signs[sign] += in_use(photo) ? 1 : 0;
        }
        survey.pictures.push_back(std::move(photo.picture));
    }
    for (const auto& [sign, count] : signs) {
        if (count > 0) {
            survey.suspicions.push_back(fmt::format("{} ({} of the pictures)", sign, count));
        }
    }
    return survey;
}

void take_survey(MeasureInput& input, const PhotoSurvey& survey) {
    input.pictures = survey.pictures;
    const formats::CameraNotes& notes = survey.notes;
    if (notes != formats::CameraNotes{.transfer = notes.transfer}) {
        input.source.notes = notes;
    }
    input.source.suspicions = survey.suspicions;
    if (input.source.camera == kUnknown && !notes.model.empty()) {
        input.source.camera = notes.make.empty() ? notes.model : notes.make + " " + notes.model;
    }
    if (input.source.lens == kUnknown && !notes.lens.empty()) {
        input.source.lens = notes.lens;
    }
    if (!input.pixel_pitch_um) {
        input.pixel_pitch_um = notes.pixel_pitch_um;
    }
}

Profile measure_surveyed(const MeasureInput& input) {
    Profile profile = measure(input);
    for (const std::string& sign : suspicions_of(profile)) {
        profile.source.suspicions.push_back(sign);
    }
    return profile;
}

std::vector<std::string> suspicions_of(const Profile& profile) {
    std::vector<std::string> signs;
    if (!profile.geometry) {
        return signs;
    }
    const double covered = profile.geometry->covered_image_height;
    const auto at_edge = [&](const Quantity& quantity) {
        const Curve* found = find_curve(profile, quantity.key());
        return found == nullptr ? std::nullopt : sample(*found, covered);
    };
    const auto angle = at_edge(kQuantities.field_angle);
    const auto distortion = at_edge(kQuantities.distortion);
    if (angle && distortion && angle->value > kWide_deg) {
        const double error = (distortion->upper_95 - distortion->lower_95) / 2.0;
        if (std::abs(distortion->value) < std::max(error, kNoDistortion_percent) && error < 1.0) {
            signs.push_back(fmt::format(
                "no distortion within its error ({:.3f} ± {:.3f} %) at {:.0f}° from the axis: lenses so wide have some",
                distortion->value, error, angle->value));
        }
    }
    if (profile.source.notes && profile.source.notes->equivalent_focal_length_mm) {
        const double stated = *profile.source.notes->equivalent_focal_length_mm;
        const double measured = focal_length_px(profile.geometry->model) * formats::kFullFrameDiagonal_mm /
                                (2.0 * half_diagonal_px(profile));
        if (std::abs(measured - stated) > kFocalLengthMargin * stated + 0.5) {
            signs.push_back(
                fmt::format("the measured focal length is {:.1f} mm on 36 × 24 mm, the camera states {:g} "
                            "mm: cropped, enlarged or corrected in the camera, or focused very near",
                            measured, stated));
        }
    }
    return signs;
}

}  // namespace lensproof::calibration
