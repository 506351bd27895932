// experiments/studies/cameras/reference_curves.h — what others say of a measured camera's lens, as curves beside its
// own.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/profile/profile.h"
#include "engine/base/toml.h"
#include "experiments/studies/cameras/measured_camera.h"

namespace lensproof::studies {

/// A source of curves as a file states it: "profile:FILE.json", measured before; "lens:NAME", a prescription's own
/// rays, focused at infinity; "lensfun:MODEL", the database; "dng:FILE", the maker's corrections.
struct ReferenceSource {
    std::string stated;
    std::filesystem::path file{};  // that it is read from, if it is

    /// "lensfun: Canon EF 50mm f/1.8"
    [[nodiscard]] std::string label() const;
};

bool is_reference(const std::string& text);

/// Throws InputError naming file, line and `key` where the text is none, or what it names is not there. Files are
/// looked for beside the table's.
ReferenceSource read_reference(const TomlTable& table, const std::string& key, const std::string& text);

/// The list under `references`.
std::vector<ReferenceSource> read_references(TomlTable& table);

/// The files that they are read from.
std::vector<std::filesystem::path> files_of(const std::vector<ReferenceSource>& sources);

/// Adds the curves of each.
void add_references(const std::vector<ReferenceSource>& sources, MeasuredCamera& camera, double f_number);

/// Its curves over the frame of the measured camera: distortion, chromatic shift and vignetting, as far as it has them.
/// `f_number` (0: not known) chooses lensfun's vignetting, to within a sixth of a stop. Throws InputError where the
/// camera's pixel pitch is needed and not known.
calibration::Profile reference_curves(const ReferenceSource& source, const calibration::Profile& camera,
                                      double f_number);

}  // namespace lensproof::studies
