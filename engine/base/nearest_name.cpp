#include "engine/base/nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace lensproof {

int spelling_distance(std::string_view a, std::string_view b) {
    // Rows of the usual table (Damerau 1964, neighbours swapped once): two above the current one.
    std::vector<int> before(b.size() + 1);
    std::vector<int> above(b.size() + 1);
    std::vector<int> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) {
        above[j] = static_cast<int>(j);
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const int change = a[i - 1] == b[j - 1] ? 0 : 1;
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
        std::swap(before, above);
        std::swap(above, row);
    }
    return above[b.size()];
}

namespace {

/// None where no candidate that `is_near(letters, candidate)` takes is there.
template <class IsNear>
const std::string* nearest_of(const std::string& name, const std::vector<std::string>& candidates,
                              const IsNear& is_near) {
    constexpr std::size_t kLongest = 100;
    const std::string* nearest = nullptr;
    int least = static_cast<int>(kLongest);
    for (const std::string& candidate : candidates) {
        if (name.size() <= kLongest && candidate.size() <= kLongest) {
            const int letters = spelling_distance(name, candidate);
            if (letters < least && is_near(letters, candidate)) {
                least = letters;
                nearest = &candidate;
            }
        }
    }
    return nearest;
}

/// Empty where none is near.
std::string nearest_hint(const std::string& name, const std::vector<std::string>& known) {
    const std::string* nearest = nearest_of(name, known, [](int letters, const std::string& candidate) {
        return letters <= std::max(1, static_cast<int>(candidate.size() / 3));
    });
    return nearest == nullptr ? "" : fmt::format("; did you mean \"{}\"?", *nearest);
}

}  // namespace

std::string name_hint(const std::string& name, const std::vector<std::string>& known) {
    constexpr std::size_t kMostListed = 10;
    std::string hint = nearest_hint(name, known);
    if (!hint.empty()) {
        return hint;
    }
    return known.empty() || known.size() > kMostListed ? "" : fmt::format("; known are: {}", fmt::join(known, ", "));
}

std::string missing_name_hint(const std::string& missing, const std::vector<std::string>& there) {
    const std::string* nearest = nearest_of(missing, there, [](int letters, const std::string& candidate) {
        return 3 * letters < static_cast<int>(candidate.size());
    });
    return nearest == nullptr ? "" : fmt::format("; is \"{}\" meant to be it?", *nearest);
}

std::string complete_name_hint(const std::string& name, const std::vector<std::string>& known) {
    const std::string hint = nearest_hint(name, known);
    return fmt::format("{} are: {}", hint.empty() ? "; known" : hint + " Known", fmt::join(known, ", "));
}

}  // namespace lensproof
