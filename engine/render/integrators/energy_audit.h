// engine/render/integrators/energy_audit.h — where all the light goes that comes into a camera.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "engine/render/integrators/view.h"
#include "engine/render/stray/fate_entrance.h"

namespace lensproof::render {

/// A part of the light that comes in, with its standard error, to first order.
struct EnergyFraction {
    double fraction = 0.0;
    double standard_error = 0.0;
};

/// Light in = what each fate takes: the fractions add up to 1. They are estimates of their own, which know nothing of
/// the films that passes make, and so check them.
struct EnergyAudit {
    double light_in = 0.0;  // through the first surface's rim, W·nm⁻¹, the mean over the band
    std::array<EnergyFraction, kFates> fractions;  // in the order of Fate

    [[nodiscard]] const EnergyFraction& operator[](Fate fate) const {
        return fractions[static_cast<std::size_t>(fate)];
    }
};

/// "imaged", "ghosts", …, in the order of Fate.
const std::array<std::string, kFates>& fate_names();

/// Follows that many light paths from all that shines on an exact camera. Throws InputError as FateEntrance does.
EnergyAudit energy_audit(const View& view, std::uint32_t paths);

}  // namespace lensproof::render
