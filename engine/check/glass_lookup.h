// engine/check/glass_lookup.h — what the checks ask of the glasses that are known.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/optics/glass.h"
#include "engine/optics/prescription.h"

namespace lensproof {

struct GlassLookup {
    std::optional<Glass> glass;
    bool is_spelled_differently = false;   // found, though not to the letter
    std::vector<std::string> suggestions;  // where it was not found: what may be meant
};

GlassLookup look_up_glass(const std::vector<Glass>& glasses, const std::string& name,
                          const std::vector<std::string>& preferred_makers);

/// The `count` known glasses nearest to an index and an Abbe number, the nearest first.
std::vector<Glass> nearest_glasses(const std::vector<Glass>& glasses, double n_d, double V_d, std::size_t count);

/// How far the index of a glass given by n_d and V_d alone is expected to be off at a wavelength, rms.
double expected_index_error(const std::vector<Glass>& glasses, double n_d, double V_d, double wavelength_nm);

}  // namespace lensproof
