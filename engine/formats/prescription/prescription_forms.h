// engine/formats/prescription/prescription_forms.h — the forms that prescriptions are written in, each from and to a
// text.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "engine/optics/prescription.h"

namespace lensproof::formats {

inline constexpr int kMostSurfaces = 1000;  // in a file of any form; more is no lens

/// Each takes a file's bytes; `file` names it in messages and in the prescription. See `read_prescription`.
optics::Prescription parse_toml_prescription(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_csv_prescription(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_zmx(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_seq(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_pbrt_lens(const std::string& text, const std::filesystem::path& file);
optics::Prescription parse_optiland(const std::string& text, const std::filesystem::path& file);
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
