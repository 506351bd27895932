// engine/formats/prescription/design_program.h — what the readers of other programs' files have in common.
#pragma once
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <vector>

#include "engine/formats/prescription/remarks.h"
#include "engine/optics/prescription.h"

namespace lensproof::formats {

using PrescriptionTable = std::vector<optics::PrescribedSurface>;

bool is_among(const auto& words, std::string_view word) {
    return std::ranges::find(words, word) != std::end(words);
}

/// A prescription that is named after its file, and has it for its source.
optics::Prescription prescription_of(const std::filesystem::path& file);

/// The design's fields, and what they claim of the whole lens: the half field, or the image circle.
void take_fields(optics::Prescription& prescription, optics::DesignFields fields);

/// Says of the rows (from 0) that were mirrors that the axis has been unfolded at them.
void name_folds(const std::vector<int>& folds, const std::vector<optics::PrescribedSurface>& rows, Remarks& remarks);

/// Whether row `i` of one of the tables has another `member` than the prescription.
template <class Member>
bool differs(const std::vector<PrescriptionTable>& tables, const PrescriptionTable& rows, std::size_t i,
             Member optics::PrescribedSurface::*member) {
    return std::ranges::any_of(tables,
                               [&](const PrescriptionTable& table) { return !(table[i].*member == rows[i].*member); });
}

/// Gives the prescription's zoom positions the gaps that differ between their tables. Returns the rows, from 1, whose
/// decentre or tilt differs: a prescription cannot say so.
std::vector<int> take_zoom_gaps(optics::Prescription& prescription, const std::vector<PrescriptionTable>& tables);

}  // namespace lensproof::formats
