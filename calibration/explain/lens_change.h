// calibration/explain/lens_change.h — what may be a little otherwise in a lens than its prescription says, and by how
// much.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optics/lens.h"

namespace lensproof::calibration {

enum class ChangeKind { focus, gap, decentre, tilt, sensor_tilt, n_d, V_d, scale, sensor_shift };

/// A kind that a user may free, by its name on the command line; glass frees n_d and V_d. Scale and sensor shift are
/// always free: a pixel pitch is known to three digits or so, and no sensor is on the axis to a pixel.
inline constexpr std::array<std::string_view, 6> kFreeKinds = {"focus", "gaps",        "decentre",
                                                               "tilt",  "sensor-tilt", "glass"};

/// How far a kind's values lie from the prescription's: standard errors, in the kind's unit. Sources:
/// calibration/README.md.
struct Tolerance {
    ChangeKind kind;
    const char* unit;  // suffix of the name; none: a ratio
    double usual;      // of a lens that was made as it should be
    double fault;      // were it this that is wrong; 0: never looked for
};
inline constexpr std::array<Tolerance, 9> kTolerances = {{{ChangeKind::focus, "_mm", 0.2, 2.0},
                                                          {ChangeKind::gap, "_mm", 0.05, 1.0},
                                                          {ChangeKind::decentre, "_mm", 0.03, 0.5},
                                                          {ChangeKind::tilt, "_deg", 0.05, 1.0},
                                                          {ChangeKind::sensor_tilt, "_deg", 0.1, 1.0},
                                                          {ChangeKind::n_d, "", 5e-4, 0.05},
                                                          {ChangeKind::V_d, "", 0.3, 10.0},
                                                          {ChangeKind::scale, "", 1e-3, 0.0},
                                                          {ChangeKind::sensor_shift, "_mm", 0.2, 0.0}}};
const Tolerance& tolerance(ChangeKind kind);

/// One of them: a parameter, 0 for the prescription as it stands. Lens space (engine/optics/trace.h).
///
/// focus: the sensor's distance. gap: of air behind surface `first`. decentre, tilt: of the surfaces `first` to `last`
/// as one, along or about x or y and about the first one's vertex. sensor_tilt: about its middle. n_d, V_d: of the
/// glass behind `first`, its partial dispersions kept. scale: of the picture. sensor_shift: of the picture along x or
/// y.
struct LensChange {
    std::string name{};  // "gap_4_mm"
    ChangeKind kind = ChangeKind::focus;
    int first = 0;  // surfaces, counted from 1
    int last = 0;
    int axis = 0;      // 0: x, 1: y
    int profile = -1;  // of this profile's camera alone; −1: of all
};

/// What may be otherwise in `lens`, the kinds of `free` (kFreeKinds) and those that always are, with a focus for each
/// of so many profiles. Throws InputError for a kind that there is not.
std::vector<LensChange> lens_changes(const optics::Lens& lens, const std::vector<std::string>& free, int profiles);

/// Whether air follows the surface (from 1).
bool is_followed_by_air(const optics::Lens& lens, int surface);

}  // namespace lensproof::calibration
