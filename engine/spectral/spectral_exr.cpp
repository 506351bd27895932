#include "engine/spectral/spectral_exr.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "engine/spectral/planck.h"

namespace lensproof::spectral {

namespace {

/// The layout's SI prefixes as powers of ten.
constexpr std::array<std::pair<std::string_view, int>, 18> kPrefixes{{{"", 0},
                                                                      {"Y", 24},
                                                                      {"Z", 21},
                                                                      {"E", 18},
                                                                      {"P", 15},
                                                                      {"T", 12},
                                                                      {"G", 9},
                                                                      {"M", 6},
                                                                      {"k", 3},
                                                                      {"h", 2},
                                                                      {"da", 1},
                                                                      {"d", -1},
                                                                      {"c", -2},
                                                                      {"m", -3},
                                                                      {"u", -6},
                                                                      {"n", -9},
                                                                      {"p", -12},
                                                                      {"f", -15}}};

std::optional<int> power_of_ten(std::string_view prefix) {
    const auto* const found =
        std::find_if(kPrefixes.begin(), kPrefixes.end(), [&](const auto& known) { return known.first == prefix; });
    return found == kPrefixes.end() ? std::nullopt : std::optional(found->second);
}

bool is_layer(std::string_view layer) {
    return layer == "T" || (layer.size() == 2 && layer[0] == 'S' && layer[1] >= '0' && layer[1] <= '3');
}

/// Takes an unsigned number with a decimal comma from the front of `text`. The grammar is the layout's: 5e-1 and ,5
/// too.
std::optional<double> take_number(std::string_view& text) {
    std::string number(text);
    std::replace(number.begin(), number.end(), ',', '.');
    double value = 0.0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    const auto length = static_cast<std::size_t>(end - number.data());
    // from_chars also reads a sign, "inf" and "nan".
    const bool starts_as_number = !text.empty() && text.find_first_of("0123456789,") == 0;
    if (error != std::errc() || !starts_as_number || text.substr(0, length).find('.') != std::string_view::npos) {
        return std::nullopt;
    }
    text.remove_prefix(length);
    return value;
}

/// Metres or hertz, prefixed, as nm.
std::optional<double> to_nanometres(double value, std::string_view unit) {
    const bool is_frequency = unit.ends_with("Hz");
    if (!is_frequency && !unit.ends_with("m")) {
        return std::nullopt;
    }
    unit.remove_suffix(is_frequency ? 2 : 1);
    const std::optional<int> power = power_of_ten(unit);
    if (!power) {
        return std::nullopt;
    }
    return is_frequency ? 1e9 * kSpeedOfLight / (value * std::pow(10.0, *power)) : value * std::pow(10.0, *power + 9);
}

}  // namespace

std::string spectral_channel_name(double wavelength_nm) {
    std::string name = fmt::format("{:.6f}", wavelength_nm);
    std::replace(name.begin(), name.end(), '.', ',');
    return "S0." + name + "nm";
}

std::optional<SpectralChannel> parse_spectral_channel(std::string_view name) {
    const std::size_t dot = name.find('.');
    if (dot == std::string_view::npos || !is_layer(name.substr(0, dot))) {
        return std::nullopt;
    }
    std::string_view rest = name.substr(dot + 1);
    const std::optional<double> number = take_number(rest);
    const std::optional<double> wavelength_nm = number ? to_nanometres(*number, rest) : std::nullopt;
    if (!wavelength_nm || !(*wavelength_nm > 0.0 && std::isfinite(*wavelength_nm))) {
        return std::nullopt;
    }
    return SpectralChannel{.layer = std::string(name.substr(0, dot)), .wavelength_nm = *wavelength_nm};
}

std::map<std::string, std::string> spectral_attributes(const std::string& units) {
    return {{"spectralLayoutVersion", "1.0"}, {"emissiveUnits", units}};
}

}  // namespace lensproof::spectral
