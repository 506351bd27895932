#include "engine/check/sag.h"

#include <algorithm>

#include "engine/optics/lens.h"

namespace lensproof::check {

double sag_at(const optics::PrescribedSurface& row, double r, Section section) {
    const bool along_y = section == Section::along_y;
    return optics::sag(optics::prescribed_shape(row), along_y ? 0.0 : r, along_y ? r : 0.0);
}

double separation_at(const optics::PrescribedSurface& row, const optics::PrescribedSurface& next, double r) {
    const auto along = [&](Section section) {
        return row.thickness_mm + sag_at(next, r, section) - sag_at(row, r, section);
    };
    return std::min(along(Section::along_y), along(Section::along_x));
}

}  // namespace lensproof::check
