#include "engine/optics/glass_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/infinity.h"
#include "engine/base/nearest_name.h"
#include "engine/base/text.h"
#include "engine/optics/glass_name.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

namespace {

/// A name as it was asked for: the glass, and the maker where one is named.
struct AskedName {
    std::string glass;
    std::string maker;
};

/// "SCHOTT LAK9", "LAK9 (SCHOTT)", "LAK9_SCHOTT", "Schott: LAK9": a maker among those that `is_maker` knows.
template <class IsMaker>
AskedName asked_name(std::string_view text, const IsMaker& is_maker) {
    constexpr std::string_view kSeparators = " \t_:/,()[]";
    std::vector<std::string_view> parts;
    for (std::size_t begin = text.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
        const std::size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = text.find_first_not_of(kSeparators, end);
    }
    AskedName asked{.glass = std::string(trimmed(text)), .maker = ""};
    if (parts.size() < 2) {
        return asked;
    }
    const bool first = is_maker(parts.front());
    if (!first && !is_maker(parts.back())) {
        return asked;
    }
    asked.maker = first ? parts.front() : parts.back();
    parts.erase(first ? parts.begin() : parts.end() - 1);
    asked.glass.assign(parts.front().data(), parts.back().data() + parts.back().size());  // as it is separated itself
    return asked;
}

/// Nikon's glass is Hikari's.
bool is_catalogue(std::string_view maker, const std::string& catalogue) {
    return same_letters(maker, catalogue) || (same_letters(maker, "NIKON") && catalogue == "HIKARI");
}

using Found = std::vector<const Glass*>;

/// The first of the preferred catalogues, else the first of all.
const Glass* preferred(const Found& found, std::span<const std::string> catalogues) {
    for (const std::string& catalogue : catalogues) {
        for (const Glass* glass : found) {
            if (is_catalogue(catalogue, glass->catalogue)) {
                return glass;
            }
        }
    }
    return found.front();
}

bool is_of_the_visible(const Glass& glass) {
    return covers(glass, spectral::kLineF) && covers(glass, spectral::kLineC);
}

std::string figures(const Glass& glass) {
    if (!is_of_the_visible(glass)) {
        return fmt::format("{:.0f} to {:.0f} nm", glass.min_wavelength_nm, glass.max_wavelength_nm);
    }
    return fmt::format("n_d {:.5f}, V_d {:.2f}", refractive_index(glass.formula, spectral::kLineD),
                       abbe_number(glass.formula));
}

/// Collects suggestions, each glass once, the best first.
class Suggestions {
  public:
    void add(const Glass& glass, const std::string& reason) {
        constexpr std::size_t kMost = 8;
        const bool known = std::ranges::any_of(
            list_, [&](const auto& s) { return s.name == glass.name && s.catalogue == glass.catalogue; });
        if (!known && list_.size() < kMost) {
            list_.push_back({glass.name, glass.catalogue, fmt::format("{} ({})", reason, figures(glass))});
        }
    }
    [[nodiscard]] bool empty() const { return list_.empty(); }
    std::vector<GlassSuggestion> take() { return std::move(list_); }

  private:
    std::vector<GlassSuggestion> list_;
};

/// Whether `longer` is `shorter` behind one of the prefixes by which makers mark a new composition or process.
bool is_prefixed(std::string_view longer, std::string_view shorter) {
    constexpr std::string_view kPrefixes = "NPSLEJHDKQM";
    return longer.size() == shorter.size() + 1 && longer.ends_with(shorter) &&
           kPrefixes.find(longer.front()) != std::string_view::npos;
}

double distance(const Glass& glass, double n_d, double V_d) {
    if (!is_of_the_visible(glass)) {
        return kInfinity;
    }
    return std::hypot(refractive_index(glass.formula, spectral::kLineD) - n_d,
                      std::log(abbe_number(glass.formula) / V_d));
}

std::vector<GlassSuggestion> suggestions_for(const AskedName& asked, std::span<const Glass> glasses,
                                             const GlassCatalogue& catalogue) {
    Suggestions suggestions;
    if (const std::optional<GlassCode> code = parse_glass_code(asked.glass)) {
        constexpr double kRoundedIndex = 0.00051;
        constexpr double kRoundedAbbe = 0.051;
        for (const Glass& glass : glasses) {
            if (std::abs(refractive_index(glass.formula, spectral::kLineD) - code->n_d) < kRoundedIndex &&
                std::abs(abbe_number(glass.formula) - code->V_d) < kRoundedAbbe) {
                suggestions.add(glass, "has that code");
            }
        }
        if (suggestions.empty()) {
            for (const Glass& glass : catalogue.nearest(code->n_d, code->V_d, 3)) {
                suggestions.add(glass, "nearest to the code");
            }
        }
        return suggestions.take();
    }
    const std::string bare = bare_name(asked.glass);
    constexpr std::size_t kLongestName = 40;
    if (bare.empty() || bare.size() > kLongestName) {
        return suggestions.take();
    }
    std::vector<std::string> names;
    std::ranges::transform(glasses, std::back_inserter(names), [](const Glass& g) { return bare_name(g.name); });
    const auto suggest = [&](const auto& matches, const char* reason) {
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (matches(names[i])) {
                suggestions.add(glasses[i], reason);
            }
        }
    };
    suggest([&](const std::string& name) { return name == bare; },
            asked.maker.empty() ? "the same but for hyphens and blanks" : "of that name, by another maker");
    suggest([&](const std::string& name) { return is_prefixed(name, bare); },
            "of that type, with a prefix: another composition");
    suggest([&](const std::string& name) { return is_prefixed(bare, name); },
            "of that type, without the prefix: another composition");
    suggest([&](const std::string& name) { return name.size() == bare.size() + 1 && name.starts_with(bare); },
            "a later version by its letter");
    if (suggestions.empty()) {
        suggest([&](const std::string& name) { return spelling_distance(name, bare) == 1; }, "spelled nearly so");
    }
    return suggestions.take();
}

}  // namespace

void GlassCatalogue::add(std::vector<Glass> glasses) {
    glasses_.insert(glasses_.begin(), std::make_move_iterator(glasses.begin()), std::make_move_iterator(glasses.end()));
}

GlassMatch GlassCatalogue::resolve(std::string_view name, std::span<const std::string> preferred_catalogues) const {
    const AskedName asked = asked_name(name, [&](std::string_view part) {
        return std::ranges::any_of(glasses_, [&](const Glass& glass) { return is_catalogue(part, glass.catalogue); });
    });
    Found exact;
    Found alike;
    for (const Glass& glass : glasses_) {
        if (!asked.maker.empty() && !is_catalogue(asked.maker, glass.catalogue)) {
            continue;
        }
        if (same_letters(asked.glass, glass.name)) {
            exact.push_back(&glass);
        } else if (same_spelling(asked.glass, glass.name) && !bare_name(asked.glass).empty()) {
            alike.push_back(&glass);
        }
    }
    GlassMatch match;
    const bool one_name =
        std::ranges::all_of(alike, [&](const Glass* glass) { return same_letters(glass->name, alike.front()->name); });
    const Found& found = exact.empty() && one_name ? alike : exact;
    if (found.empty()) {
        match.suggestions = suggestions_for(asked, glasses_, *this);
        return match;
    }
    const Glass* glass = preferred(found, preferred_catalogues);
    match.glass = *glass;
    match.how = exact.empty() ? GlassMatch::How::spelled_differently : GlassMatch::How::exact;
    for (const Glass* other : found) {
        const bool named = std::ranges::find(match.also_in, other->catalogue) != match.also_in.end();
        if (other->catalogue != glass->catalogue && !(other->formula == glass->formula) && !named) {
            match.also_in.push_back(other->catalogue);
        }
    }
    return match;
}

std::vector<Glass> GlassCatalogue::nearest(double n_d, double V_d, std::size_t count) const {
    std::vector<double> distances;
    distances.reserve(glasses_.size());
    for (const Glass& glass : glasses_) {
        const double d = distance(glass, n_d, V_d);
        distances.push_back(std::isfinite(d) ? d : HUGE_VAL);
    }
    std::vector<std::size_t> order(glasses_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return distances[i]; });
    std::vector<Glass> nearest;
    for (std::size_t i = 0; i < std::min(count, order.size()); ++i) {
        nearest.push_back(glasses_[order[i]]);
    }
    return nearest;
}

std::string suggestion_text(const std::vector<GlassSuggestion>& suggestions) {
    if (suggestions.empty()) {
        return "nothing like it is known; `lensproof glasses` lists what is";
    }
    std::string text = "perhaps ";
    for (const GlassSuggestion& suggestion : suggestions) {
        text += fmt::format("{}{} ({}): {}", &suggestion == &suggestions.front() ? "" : "; or ", suggestion.name,
                            suggestion.catalogue, suggestion.reason);
    }
    return text;
}

}  // namespace lensproof::optics
