#include "engine/formats/prescription/design_program.h"

#include <cmath>

#include "engine/base/angle.h"

namespace lensproof::formats {

optics::Prescription prescription_of(const std::filesystem::path& file) {
    optics::Prescription prescription;
    prescription.file = file;
    prescription.name = file.stem().string();
    prescription.source = "the file " + file.filename().string();
    return prescription;
}

double field_angle_deg(double x_deg, double y_deg) {
    const double x = std::abs(x_deg);
    const double y = std::abs(y_deg);
    const bool is_oblique = x != 0.0 && y != 0.0 && std::max(x, y) < 90.0;
    return is_oblique ? std::atan(std::hypot(std::tan(x * kDegree), std::tan(y * kDegree))) / kDegree
                      : std::hypot(x, y);
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
