// engine/check/checker.h — the sanity checker: what is wrong with a prescription, before anything is rendered with it.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::check {

struct CheckSettings {
    std::optional<double> wavelength_nm;       // of the first-order data and of the rays; default: the file's reference
    optics::IndexOverrides indices;            // constant indices in place of glasses
    std::optional<std::size_t> zoom_position;  // counted from 0; without one, every position is checked
    bool manufacture = false;                  // whether customs of manufacture are held against the lens, too
};

/// The lens's first-order data at one zoom position, which has no name where the lens does not zoom.
struct ComputedData {
    std::string zoom_position;
    optics::ParaxialData paraxial;
    double wavelength_nm = spectral::kLineD;
};

/// What a finding speaks of: the file as its reader took it; the lens, and whether it is another than was meant or
/// none; how glass is made.
enum class ReportSection { file, lens, manufacture };

constexpr std::string_view section_name(ReportSection section) {
    constexpr std::array<std::string_view, 3> kNames = {"file", "lens", "manufacture"};
    return kNames[static_cast<std::size_t>(section)];
}

struct CheckReport {
    std::vector<optics::Finding> findings;  // the reader's remarks first, then errors, warnings and infos
    std::vector<ComputedData> computed;     // a position of the zoom each; empty where nothing could be computed
    std::size_t remarks = 0;                // how many of the findings are the reader's

    /// Of findings[i].
    [[nodiscard]] ReportSection section(std::size_t i) const;

    /// Whether no finding is an error.
    [[nodiscard]] bool ok() const;
};

/// Judges the table by itself, by its glasses, by its first-order data and by real rays, and against what is claimed
/// of it: `claims`, and where it is silent the prescription's own. What the table makes impossible to judge is said,
/// not skipped in silence. Nothing is mended: where one changed digit would restore the claims, that is a finding
/// "suggestion".
///
/// Each rule stands with its source beside the check. Never throws for what a prescription may hold.
CheckReport check_prescription(const optics::Prescription& prescription, const optics::StatedData& claims,
                               const optics::GlassCatalogue& glasses, const CheckSettings& settings = {});

}  // namespace lensproof::check
