// A region map as bytes, and back.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "engine/pupil/region_map.h"

namespace lensproof::pupil {

namespace {

// Comes first; to be changed with what follows it. Another order of bytes reads another number.
constexpr double kMark = 20261121.01;
constexpr std::size_t kHead = 7;
constexpr std::size_t kNumbersPerRegion = 2 + 2 * (kPupilPanels + 1);

void append(std::vector<double>& numbers, const std::vector<double>& more) {
    numbers.insert(numbers.end(), more.begin(), more.end());
}

void append_region(std::vector<double>& numbers, const PupilRegion& region) {
    numbers.push_back(region.left);
    numbers.push_back(region.width);
    for (const PupilColumn& column : region.columns) {
        numbers.push_back(column.lower);
        numbers.push_back(column.upper);
    }
}

/// Takes numbers from the front.
std::vector<double> taken(std::span<const double>& numbers, std::size_t count) {
    const std::span<const double> front = numbers.first(count);
    numbers = numbers.subspan(count);
    return {front.begin(), front.end()};
}

PupilRegion taken_region(std::span<const double>& numbers, PupilSymmetry symmetry) {
    const std::vector<double> values = taken(numbers, kNumbersPerRegion);
    PupilRegion region{.left = values[0], .width = values[1]};
    for (std::size_t i = 0; i < region.columns.size(); ++i) {
        region.columns[i] = {.lower = values[2 + 2 * i], .upper = values[3 + 2 * i]};
    }
    region.sum_areas(symmetry);
    return region;
}

bool is_sound(const PupilRegion& region) {
    return region.width >= 0.0 &&
           std::ranges::all_of(region.columns, [](const PupilColumn& column) { return column.lower <= column.upper; });
}

/// Rising from 0 to 1.
bool is_sound_axis(const std::vector<double>& nodes) {
    return nodes.front() == 0.0 && (nodes.size() == 1 || nodes.back() == 1.0) &&
           std::ranges::adjacent_find(nodes, std::ranges::greater_equal{}) == nodes.end();
}

bool is_sound(const PupilNodes& nodes) {
    return is_sound_axis(nodes.positions) && is_sound_axis(nodes.fractions) && nodes.fractions.size() > 1 &&
           std::ranges::all_of(nodes.ends, [](double end) { return end > 0.0; }) &&
           std::ranges::all_of(nodes.regions, [](const PupilRegion& region) { return is_sound(region); });
}

bool is_count(double value) {
    constexpr double kMost = 1e6;
    return value >= 0.0 && value <= kMost && value == std::floor(value);
}

}  // namespace

std::string RegionMap::serialized() const {
    std::vector<double> numbers = {kMark,
                                   disc_.radius,
                                   defensive_fraction_,
                                   nodes_.symmetry == PupilSymmetry::mirror ? 1.0 : 0.0,
                                   static_cast<double>(nodes_.azimuths),
                                   static_cast<double>(nodes_.positions.size()),
                                   static_cast<double>(nodes_.fractions.size())};
    append(numbers, nodes_.positions);
    append(numbers, nodes_.ends);
    append(numbers, nodes_.fractions);
    for (const PupilRegion& region : nodes_.regions) {
        append_region(numbers, region);
    }
    std::string bytes(numbers.size() * sizeof(double), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
}

std::optional<RegionMap> RegionMap::deserialized(std::string_view bytes) {
    std::vector<double> numbers(bytes.size() / sizeof(double));
    if (bytes.size() % sizeof(double) != 0 || numbers.size() < kHead) {
        return std::nullopt;
    }
    std::memcpy(numbers.data(), bytes.data(), bytes.size());
    const bool is_finite = std::ranges::all_of(numbers, [](double value) { return std::isfinite(value); });
    if (!is_finite || numbers[0] != kMark || !(numbers[1] > 0.0) || !(numbers[2] > 0.0 && numbers[2] <= 1.0) ||
        !std::all_of(numbers.begin() + 3, numbers.begin() + kHead, is_count)) {
        return std::nullopt;
    }
    PupilNodes nodes{.symmetry = numbers[3] == 1.0 ? PupilSymmetry::mirror : PupilSymmetry::none,
                     .azimuths = static_cast<std::size_t>(numbers[4])};
    const auto positions = static_cast<std::size_t>(numbers[5]);
    const auto fractions = static_cast<std::size_t>(numbers[6]);
    const double regions = numbers[4] * numbers[5] * numbers[6];
    if (static_cast<double>(numbers.size()) !=
        kHead + (1.0 + numbers[4]) * numbers[5] + numbers[6] + regions * static_cast<double>(kNumbersPerRegion)) {
        return std::nullopt;
    }
    const Disc disc{.radius = numbers[1]};
    const double defensive_fraction = numbers[2];
    if (!(regions > 0.0)) {
        return positions + fractions == 0 ? std::optional(RegionMap(disc, defensive_fraction, {})) : std::nullopt;
    }
    std::span<const double> rest = std::span<const double>(numbers).subspan(kHead);
    nodes.positions = taken(rest, positions);
    nodes.ends = taken(rest, positions * nodes.azimuths);
    nodes.fractions = taken(rest, fractions);
    while (!rest.empty()) {
        nodes.regions.push_back(taken_region(rest, nodes.symmetry));
    }
    return is_sound(nodes) ? std::optional(RegionMap(disc, defensive_fraction, std::move(nodes))) : std::nullopt;
}

}  // namespace lensproof::pupil
