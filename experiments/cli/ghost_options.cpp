#include "experiments/cli/ghost_options.h"

#include <fmt/format.h>

#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof::cli {

namespace {

bool is_glass_surface(const optics::Lens& lens, int index) {
    const auto formula = [&](int i) {
        return i < 0 ? optics::DispersionFormula(optics::ConstantIndex{1.0})
                     : lens.surfaces[static_cast<std::size_t>(i)].medium.formula;
    };
    return !(formula(index) == formula(index - 1));
}

}  // namespace

void add_sensor_option(Command& command, MirrorOptions& mirrors) {
    command
        .add_option("--sensor-reflectance", mirrors.sensor,
                    "What the sensor reflects, 0 to 1, like a mirror and at every angle (default: nothing)")
        .check(in_range(0.0, 1.0))
        .type_name("R");
}

void add_mirror_options(Command& command, MirrorOptions& mirrors) {
    add_sensor_option(command, mirrors);
    command
        .add_option("--blade-reflectance", mirrors.blades,
                    "What the stop's blades reflect likewise, from either side (default: nothing)")
        .check(in_range(0.0, 1.0))
        .type_name("R");
}

optics::StrayMirrors<double> stray_mirrors(const MirrorOptions& mirrors) {
    return {.sensor = mirrors.sensor.value_or(0.0), .blades = mirrors.blades.value_or(0.0)};
}

optics::GhostPath parse_sequence(const std::vector<std::string>& names, const optics::Lens& lens,
                                 const MirrorOptions& mirrors) {
    const int count = static_cast<int>(lens.surfaces.size());
    const auto refuse = [&](const std::string& why) {
        throw InputError(
            fmt::format("--sequence is \"{}\": {}", printable(fmt::format("{}", fmt::join(names, ","))), why));
    };
    optics::GhostPath path;
    for (const std::string& name : names) {
        const std::optional<int> number = parse_exact<int>(name);
        if (name == kSensorName) {
            path.push_back(count);
        } else if (number && *number >= 1 && *number <= count) {
            path.push_back(*number - 1);
        } else {
            refuse(fmt::format("\"{}\" is no surface, expected a number from 1 to {}, or {} for the sensor",
                               printable(name), count, kSensorName));
        }
    }
    if (const std::string fault = optics::path_fault(path, count); !fault.empty()) {
        refuse(fault);
    }
    for (const int index : path) {
        if (index == count && !mirrors.sensor) {
            refuse("what the sensor reflects is not known, expected --sensor-reflectance R");
        }
        if (index == lens.stop_index() && !mirrors.blades && !is_glass_surface(lens, index)) {
            refuse(
                fmt::format("surface {} is the stop, and what its blades reflect is not known, expected "
                            "--blade-reflectance R",
                            index + 1));
        }
    }
    return path;
}

}  // namespace lensproof::cli
