#include "calibration/picture/picture_account.h"

namespace lensproof::calibration {

void fields(JsonArchive& json, formats::CameraNotes& notes) {
    json.optional("make", notes.make)
        .optional("model", notes.model)
        .optional("lens", notes.lens)
        .optional("software", notes.software)
        .optional("transfer", notes.transfer);
    const auto positive = [&](const char* key, std::optional<double>& number) {
        json.optional(key, number).expect(key, number.value_or(1.0) > 0.0, "a number above 0");
    };
    positive("focal_length_mm", notes.focal_length_mm);
    positive("equivalent_focal_length_mm", notes.equivalent_focal_length_mm);
    positive("f_number", notes.f_number);
    positive("exposure_time_s", notes.exposure_time_s);
    positive("iso", notes.iso);
    positive("pixel_pitch_um", notes.pixel_pitch_um);
    if (const auto crop = notes.crop_factor()) {
        json.derived("crop_factor", *crop);
    }
}

void fields(JsonArchive& json, PictureAccount& account) {
    std::optional<int> turned = account.orientation == 1 ? std::nullopt : std::optional(account.orientation);
    json.field("image", account.image)
        .field("role", account.role)
        .field("used", account.used)
        .optional("reason", account.reason)
        .optional("exif_orientation", turned);
    account.orientation = turned.value_or(1);
}

}  // namespace lensproof::calibration
