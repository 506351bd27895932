#include "engine/formats/prescription/design_program.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/optics/design_fields.h"

namespace lensproof::formats {

optics::Prescription prescription_of(const std::filesystem::path& file) {
    optics::Prescription prescription;
    prescription.file = file;
    prescription.name = file.stem().string();
    prescription.source = "the file " + file.filename().string();
    return prescription;
}

void take_fields(optics::Prescription& prescription, optics::DesignFields fields) {
    double largest = 0.0;
    for (const Vec2d& point : fields.points) {
        largest = std::max(largest, fields.kind == optics::FieldKind::angle ? std::abs(optics::oblique_angle_deg(point))
                                                                            : std::hypot(point.x, point.y));
    }
    if (largest > 0.0 && fields.kind == optics::FieldKind::angle) {
        prescription.stated.half_field_deg = largest;
    } else if (largest > 0.0 && fields.kind != optics::FieldKind::object_height) {
        prescription.stated.image_circle_mm = 2.0 * largest;
    }
    if (std::ranges::all_of(fields.vignetting,
                            [](const optics::PupilVignetting& each) { return each == optics::PupilVignetting{}; })) {
        fields.vignetting.clear();
    }
    prescription.fields = std::move(fields);
}

void name_folds(const std::vector<int>& folds, const std::vector<optics::PrescribedSurface>& rows, Remarks& remarks) {
    for (const int fold : folds) {
        remarks.add("fold", optics::Severity::info, 0,
                    fmt::format("{}: a flat mirror that folds the axis; it is unfolded, and the mirror's rim is "
                                "left out",
                                rows[static_cast<std::size_t>(fold)].where));
    }
}

std::vector<int> take_zoom_gaps(optics::Prescription& prescription, const std::vector<PrescriptionTable>& tables) {
    using Row = optics::PrescribedSurface;
    std::vector<int> misplaced;
    for (std::size_t row = 0; row < prescription.surfaces.size(); ++row) {
        const int number = static_cast<int>(row) + 1;
        const bool has_gaps = differs(tables, prescription.surfaces, row, &Row::thickness_mm);
        for (std::size_t i = 0; has_gaps && i < tables.size(); ++i) {
            prescription.zoom[i].gaps_mm[number] = tables[i][row].thickness_mm;
        }
        if (differs(tables, prescription.surfaces, row, &Row::misalignment)) {
            misplaced.push_back(number);
        }
    }
    return misplaced;
}

}  // namespace lensproof::formats
