// engine/formats/prescription/prescription_forms.h — the forms that prescriptions are written in, each from and to a
// text.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optics/prescription.h"

namespace lensproof::formats {

inline constexpr int kMostSurfaces = 1000;  // in a file of any form; more is no lens

/// How the project's own form says the system's aperture and the fields' kind.
struct ApertureKey {
    const char* key;
    optics::ApertureKind kind;
};
inline constexpr std::array kApertureKeys = {
    ApertureKey{"entrance_pupil_diameter_mm", optics::ApertureKind::entrance_pupil_diameter},
    ApertureKey{"f_number", optics::ApertureKind::f_number},
    ApertureKey{"working_f_number", optics::ApertureKind::working_f_number},
    ApertureKey{"object_numerical_aperture", optics::ApertureKind::object_numerical_aperture},
};
struct FieldKindName {
    const char* name;
    optics::FieldKind kind;
};
inline constexpr std::array kFieldKinds = {
    FieldKindName{"angle", optics::FieldKind::angle},
    FieldKindName{"object-height", optics::FieldKind::object_height},
    FieldKindName{"paraxial-image-height", optics::FieldKind::paraxial_image_height},
    FieldKindName{"image-height", optics::FieldKind::image_height},
};

/// Each takes a file's bytes; `file` names it in messages and in the prescription. See `read_prescription`.
optics::Prescription parse_toml_prescription(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_csv_prescription(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_zmx(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_zar(const std::string& bytes, const std::filesystem::path& file);
optics::Prescription parse_seq(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_pbrt_lens(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_optiland(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_rayoptics(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_fx(const std::string& text, const std::filesystem::path& file);

/// A prescription in another form, and what that form cannot say.
struct WrittenPrescription {
    std::string text;
    std::vector<optics::Finding> lost;
};

WrittenPrescription to_toml(const optics::Prescription& prescription);
WrittenPrescription to_csv(const optics::Prescription& prescription);
WrittenPrescription to_zmx(const optics::Prescription& prescription);
WrittenPrescription to_pbrt_lens(const optics::Prescription& prescription);

}  // namespace lensproof::formats
