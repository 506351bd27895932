#include "calibration/explain/lens_change.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/input_error.h"

namespace lensproof::calibration {

namespace {

const char* axis_name(int axis) {
    return axis == 0 ? "x" : "y";
}

class ChangeList {
  public:
    void add(const std::string& stem, LensChange change) {
        change.name = stem + tolerance(change.kind).unit;
        changes_.push_back(std::move(change));
    }
    /// Along or about x and y.
    void add_pair(const std::string& stem, LensChange change) {
        for (const int axis : {0, 1}) {
            change.axis = axis;
            const std::string surfaces =
                change.first > 0 ? fmt::format("_{}_{}", change.first, change.last) : std::string();
            add(fmt::format("{}_{}{}", stem, axis_name(axis), surfaces), change);
        }
    }
    [[nodiscard]] const std::vector<LensChange>& changes() const { return changes_; }

  private:
    std::vector<LensChange> changes_;
};

/// What is cemented or stands alone: surfaces with glass between them.
std::vector<std::array<int, 2>> element_groups(const optics::Lens& lens) {
    std::vector<std::array<int, 2>> groups;
    const int count = static_cast<int>(lens.surfaces.size());
    for (int first = 1; first <= count; ++first) {
        int last = first;
        while (last < count && !is_followed_by_air(lens, last)) {
            ++last;
        }
        if (last > first) {
            groups.push_back({first, last});
        }
        first = last;
    }
    return groups;
}

void add_glasses(const optics::Lens& lens, ChangeList& list) {
    for (int surface = 1; surface <= static_cast<int>(lens.surfaces.size()); ++surface) {
        if (is_followed_by_air(lens, surface)) {
            continue;
        }
        list.add(fmt::format("n_d_{}", surface), {.kind = ChangeKind::n_d, .first = surface});
        const auto& formula = lens.surfaces[static_cast<std::size_t>(surface) - 1].medium.formula;
        if (!std::holds_alternative<optics::ConstantIndex>(formula)) {
            list.add(fmt::format("V_d_{}", surface), {.kind = ChangeKind::V_d, .first = surface});
        }
    }
}

}  // namespace

const Tolerance& tolerance(ChangeKind kind) {
    return *std::ranges::find(kTolerances, kind, &Tolerance::kind);
}

bool is_followed_by_air(const optics::Lens& lens, int surface) {
    return lens.surfaces[static_cast<std::size_t>(surface) - 1].medium.formula ==
           optics::DispersionFormula(optics::ConstantIndex{1.0});
}

std::vector<LensChange> lens_changes(const optics::Lens& lens, const std::vector<std::string>& free, int profiles) {
    for (const std::string& kind : free) {
        if (std::ranges::find(kFreeKinds, kind) == kFreeKinds.end()) {
            throw InputError(fmt::format("--free is \"{}\", expected {}", kind, fmt::join(kFreeKinds, ", ")));
        }
    }
    const auto is_free = [&](std::string_view kind) { return std::ranges::find(free, kind) != free.end(); };
    ChangeList list;
    for (int p = 0; is_free("focus") && p < profiles; ++p) {
        list.add(profiles == 1 ? std::string("focus") : fmt::format("focus_{}", p + 1),
                 {.kind = ChangeKind::focus, .profile = p});
    }
    for (int surface = 1; is_free("gaps") && surface < static_cast<int>(lens.surfaces.size()); ++surface) {
        if (is_followed_by_air(lens, surface)) {
            list.add(fmt::format("gap_{}", surface), {.kind = ChangeKind::gap, .first = surface});
        }
    }
    const auto groups = element_groups(lens);
    for (const auto& [name, kind] : {std::pair{"decentre", ChangeKind::decentre}, {"tilt", ChangeKind::tilt}}) {
        for (const auto& [first, last] : groups) {
            if (is_free(name)) {
                list.add_pair(name, {.kind = kind, .first = first, .last = last});
            }
        }
    }
    if (is_free("sensor-tilt")) {
        list.add_pair("sensor_tilt", {.kind = ChangeKind::sensor_tilt});
    }
    if (is_free("glass")) {
        add_glasses(lens, list);
    }
    list.add("scale", {.kind = ChangeKind::scale});
    list.add_pair("sensor_shift", {.kind = ChangeKind::sensor_shift});
    return list.changes();
}

}  // namespace lensproof::calibration
