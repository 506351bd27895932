// engine/check/restoration.h — how well a table meets the claims about its focal length and back focus.
#pragma once
#include "engine/check/checked_lens.h"

namespace lensproof::check {

/// What changes of a table are judged by: the focal length and the image's distance that are claimed of it.
class Restoration {
  public:
    explicit Restoration(const CheckedLens& checked);

    /// Whether anything is claimed that a change could restore.
    [[nodiscard]] bool has_claims() const { return efl_ || image_distance_; }

    /// The larger of the two departures from the claims, over the focal length; infinite where the table has
    /// no focus.
    [[nodiscard]] double residual(const ParaxialTable& table) const;

    /// As the table is.
    [[nodiscard]] double residual_as_given() const { return as_given_; }

    // A change restores the claims when it brings both within what rounding explains, from well outside.
    static constexpr double kRestored = 0.003;
    static constexpr double kBetterBy = 5.0;
    [[nodiscard]] bool restores(double residual) const {
        return residual < kRestored && residual * kBetterBy < as_given_;
    }

  private:
    std::optional<double> efl_;
    std::optional<double> image_distance_;
    double object_distance_ = 0.0;
    bool image_distance_is_bfl_ = false;
    double as_given_ = 0.0;
};

}  // namespace lensproof::check
