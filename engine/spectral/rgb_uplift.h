// engine/spectral/rgb_uplift.h — from a picture's RGB to spectra.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/cache.h"
#include "engine/base/vec.h"
#include "engine/spectral/rgb_fit.h"
#include "engine/spectral/sigmoid_spectrum.h"

namespace lensproof::spectral {

/// A table of SigmoidSpectrum over the cube of linear sRGB, in which to look up the smooth reflectance that has a
/// colour under D65 (Jakob and Hanika 2019, §5). Half of all colours come back within 0.05 of ΔE*ab, 99 in 100 within
/// 0.5, all within 2; greys are constant.
class RgbUplift {
  public:
    /// Fits every entry, in about a second; `kept_rgb_uplift` does so once. Throws InputError where the project's own
    /// data of observer and illuminant is damaged.
    RgbUplift();

    /// The reflectance of colour `rgb`; what lies outside [0, 1] is taken to the nearest inside, NaN to 0.
    [[nodiscard]] SigmoidSpectrum reflectance(const Vec3d& rgb) const;

    /// As bytes and back; nothing where the bytes are none of these.
    [[nodiscard]] std::string serialized() const;
    static std::optional<RgbUplift> deserialized(std::string_view bytes);

  private:
    explicit RgbUplift(std::vector<float> table) : table_(std::move(table)) {}

    std::vector<float> table_;
};

/// The table: from the cache where it was made from these very data, else it is made, and kept.
RgbUplift kept_rgb_uplift(const Cache& cache);

/// The reflectance of colour `rgb` to a thousandth of ΔE*ab, at the cost of a fit: for single colours. `colour` as
/// rgb_of_reflectance() gives it.
SigmoidSpectrum fitted_reflectance(const RgbUplift& uplift, const RgbOfReflectance& colour, const Vec3d& rgb);

/// A light or an environment of any brightness: `scale` · `shape` · the spectrum of its white.
struct UpliftedLight {
    SigmoidSpectrum shape;
    double scale = 0.0;
};

/// The light whose colour against its white is `rgb`; negative and NaN count as 0, infinite as the largest float.
UpliftedLight uplifted_light(const RgbUplift& uplift, const Vec3d& rgb);

}  // namespace lensproof::spectral
