// experiments/cli/ghost_options.h — what commands that follow reflections take on the command line.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/optics/ghost_path.h"
#include "engine/optics/lens.h"
#include "experiments/cli/command_line.h"

namespace lensproof::cli {

/// The sensor among surfaces that are named by numbers.
inline constexpr const char* kSensorName = "image";

/// Reflectances that no prescription states.
struct MirrorOptions {
    std::optional<double> sensor;
    std::optional<double> blades;
};

/// Adds --sensor-reflectance alone.
void add_sensor_option(Command& command, MirrorOptions& mirrors);

/// Adds --sensor-reflectance and --blade-reflectance.
void add_mirror_options(Command& command, MirrorOptions& mirrors);

/// What is not given reflects nothing.
optics::StrayMirrors<double> stray_mirrors(const MirrorOptions& mirrors);

/// The surfaces of --sequence. Throws InputError naming what is wrong: no surface, one that light does not meet next,
/// or one whose reflectance would have to be given.
optics::GhostPath parse_sequence(const std::vector<std::string>& names, const optics::Lens& lens,
                                 const MirrorOptions& mirrors);

}  // namespace lensproof::cli
