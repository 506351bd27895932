#include "engine/base/nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace lensproof {

namespace {

std::size_t distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t k = 0; k < b.size(); ++k) {
            const std::size_t changed = diagonal + (a[i] == b[k] ? 0 : 1);
            diagonal = row[k + 1];
            row[k + 1] = std::min({changed, row[k] + 1, row[k + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::string name_hint(const std::string& name, const std::vector<std::string>& known) {
    constexpr std::size_t kLongest = 100;
    constexpr std::size_t kMostListed = 10;
    const std::string* nearest = nullptr;
    std::size_t least = kLongest;
    for (const std::string& candidate : known) {
        if (name.size() <= kLongest && candidate.size() <= kLongest) {
            const std::size_t letters = distance(name, candidate);
            if (letters < least && letters <= std::max<std::size_t>(1, candidate.size() / 3)) {
                least = letters;
                nearest = &candidate;
            }
        }
    }
    if (nearest != nullptr) {
        return fmt::format("; did you mean \"{}\"?", *nearest);
    }
    return known.empty() || known.size() > kMostListed ? "" : fmt::format("; known are: {}", fmt::join(known, ", "));
}

}  // namespace lensproof
