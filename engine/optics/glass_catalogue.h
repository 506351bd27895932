// engine/optics/glass_catalogue.h — the glasses that are known, and what a name in a prescription means among them.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optics/glass.h"

namespace lensproof::optics {

/// A glass that a name which is not known may have meant, and why it is thought so.
struct GlassSuggestion {
    std::string name;
    std::string catalogue;
    std::string reason;
};

/// What a name means.
struct GlassMatch {
    enum class How { exact, spelled_differently, none };

    std::optional<Glass> glass;
    How how = How::none;
    /// Further catalogues that have a glass of this name with another formula.
    std::vector<std::string> also_in;
    /// Where there is no glass: what to look at.
    std::vector<GlassSuggestion> suggestions;
};

/// Every glass that is known, in the order in which names are looked up: those that the user brought, the last file
/// first, then SCHOTT's line, SCHOTT's obsolete glasses, OHARA, HOYA, HIKARI, CDGM, and a few crystals and plastics.
class GlassCatalogue {
  public:
    GlassCatalogue() = default;

    /// Puts glasses in front of those that are there; their order is kept.
    void add(std::vector<Glass> glasses);

    [[nodiscard]] std::span<const Glass> glasses() const { return glasses_; }

    /// What `name` means. `LAK9`, `n-lak9`, `NLAK9`, `N LAK9`, `SCHOTT LAK9`, `LAK9 (SCHOTT)` and CODE V's
    /// `LAK9_SCHOTT` are understood: a maker's name asks for that maker alone, and letter case, blanks and hyphens do
    /// not count where that leaves one glass only. A name in several catalogues goes to the first of
    /// `preferred_catalogues` that has it, else to the first in the order above. A prefix is never added or dropped:
    /// LAK9 is not N-LAK9, which has other coefficients, so an unknown name has suggestions and no glass.
    [[nodiscard]] GlassMatch resolve(std::string_view name,
                                     std::span<const std::string> preferred_catalogues = {}) const;

    /// The `count` glasses nearest to these figures, 0.05 in n_d counting as much as 5 % in V_d; the nearest first.
    [[nodiscard]] std::vector<Glass> nearest(double n_d, double V_d, std::size_t count) const;

  private:
    std::vector<Glass> glasses_;
};

/// Suggestions in a sentence for a message: "perhaps N-LAK33A (SCHOTT): …"; or that there is none.
std::string suggestion_text(const std::vector<GlassSuggestion>& suggestions);

}  // namespace lensproof::optics
