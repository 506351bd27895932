#include "engine/check/glass_lookup.h"

#include <algorithm>
#include <cmath>

#include "engine/spectral/wavelengths.h"

namespace lensproof {

namespace {

/// A step of 0.05 in n_d counts as much as one of 5 % in V_d.
double distance_on_glass_map(const Glass& glass, double n_d, double V_d) {
    const double dn = refractive_index(glass.formula, kLineD) - n_d;
    const double dv = abbe_number(glass.formula) / V_d - 1.0;
    return std::hypot(dn, dv);
}

/// Without case, blanks, hyphens and the prefixes of environment-friendly lines: what LAK9 and N-LAK9 share.
std::string bare_name(const std::string& name) {
    std::string bare;
    for (const char letter : name) {
        if (std::isalnum(static_cast<unsigned char>(letter)) != 0) {
            bare += static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
        }
    }
    const bool has_prefix = name.size() > 2 && name[1] == '-' && bare.size() > 1;
    return has_prefix ? bare.substr(1) : bare;
}

}  // namespace

GlassLookup look_up_glass(const std::vector<Glass>& glasses, const std::string& name,
                          const std::vector<std::string>& /*preferred_makers*/) {
    GlassLookup lookup{.glass = find_glass(glasses, name), .is_spelled_differently = false, .suggestions = {}};
    if (!lookup.glass) {
        for (const Glass& glass : glasses) {
            if (bare_name(glass.name) == bare_name(name)) {
                lookup.suggestions.push_back(glass.catalogue + " " + glass.name);
            }
        }
    }
    return lookup;
}

std::vector<Glass> nearest_glasses(const std::vector<Glass>& glasses, double n_d, double V_d, std::size_t count) {
    std::vector<Glass> nearest = glasses;
    const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(std::min(count, nearest.size()));
    std::ranges::partial_sort(nearest, middle, {},
                              [&](const Glass& glass) { return distance_on_glass_map(glass, n_d, V_d); });
    nearest.erase(middle, nearest.end());
    return nearest;
}

double expected_index_error(const std::vector<Glass>& glasses, double n_d, double V_d, double wavelength_nm) {
    double sum = 0.0;
    int count = 0;
    for (const Glass& glass : nearest_glasses(glasses, n_d, V_d, 40)) {
        if (covers(glass, wavelength_nm)) {
            const BuchdahlNormalLine model =
                buchdahl_normal_line(refractive_index(glass.formula, kLineD), abbe_number(glass.formula));
            const double error =
                refractive_index(model, wavelength_nm) - refractive_index(glass.formula, wavelength_nm);
            sum += error * error;
            ++count;
        }
    }
    return count > 0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace lensproof
