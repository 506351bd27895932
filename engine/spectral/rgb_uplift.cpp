#include "engine/spectral/rgb_uplift.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/base/bytes.h"

namespace lensproof::spectral {

namespace {

// The cube falls into three parts by which channel is largest. Each is a grid over the largest channel's value z and
// the two others' ratios to it, x and y, in cyclic order. Of an entry the table holds a, b, c times 2 √(z (1 − z)), c
// less what it is of a grey, 2z − 1: so it has no pole at black and white, and nothing there but a slope in u, z being
// smoothstep(u), in which it is interpolated.
constexpr std::size_t kRatios = 32;
constexpr std::size_t kValues = 32;
constexpr std::size_t kFloats = 3 * kValues * kRatios * kRatios * 3;

// Nearest to black and to white that reflectances go: within a tenth of an 8-bit step of either.
constexpr double kDarkest = 1e-6;
constexpr double kBrightest = 1.0 - 1e-4;
constexpr std::string_view kVersion = "RGB uplift 1";

double smoothstep(double u) {
    return u * u * (3.0 - 2.0 * u);
}

/// Smoothstep's inverse, for z in (0, 1).
double inverse_smoothstep(double z) {
    return 0.5 - std::sin(std::asin(1.0 - 2.0 * z) / 3.0);
}

double clamped_value(double z) {
    return std::clamp(z, kDarkest, kBrightest);
}

/// Entries stand in even steps of u from kDarkest to kBrightest.
double place_of_value(double z) {
    const double first = inverse_smoothstep(kDarkest);
    const double last = inverse_smoothstep(kBrightest);
    return (inverse_smoothstep(z) - first) / (last - first) * (kValues - 1);
}

double value_of(std::size_t index) {
    const double first = inverse_smoothstep(kDarkest);
    const double last = inverse_smoothstep(kBrightest);
    return clamped_value(smoothstep(first + (last - first) * static_cast<double>(index) / (kValues - 1)));
}

/// Closer together near 0, where colours are pure and parabolas steep, and near 1, where bright colours are pale.
double ratio_of(std::size_t index) {
    return smoothstep(static_cast<double>(index) / (kRatios - 1));
}

double place_of_ratio(double ratio) {
    return inverse_smoothstep(ratio) * (kRatios - 1);
}

double pole_scale(double z) {
    return 2.0 * std::sqrt(z * (1.0 - z));
}

std::size_t offset_of(std::size_t largest, std::size_t value, std::size_t y, std::size_t x) {
    return (((largest * kValues + value) * kRatios + y) * kRatios + x) * 3;
}

/// The colour of which `largest` is z, and the next two channels in cyclic order x z and y z.
Vec3d rgb_at(std::size_t largest, double z, double x, double y) {
    std::array<double, 3> rgb{};
    rgb[largest] = z;
    rgb[(largest + 1) % 3] = x * z;
    rgb[(largest + 2) % 3] = y * z;
    return {rgb[0], rgb[1], rgb[2]};
}

/// Fits entries, each from its neighbour.
class EntryFit {
  public:
    EntryFit(const RgbOfReflectance& colour, std::vector<float>& table) : colour_(colour), table_(table) {}

    /// Fits one entry and returns its parabola; `neighbour` is that of another, of value `neighbour_z`.
    Parabola fit(std::size_t largest, std::size_t value, std::size_t y, std::size_t x, const Parabola& neighbour,
                 double neighbour_z) {
        const double z = value_of(value);
        const Vec3d rgb = rgb_at(largest, z, ratio_of(x), ratio_of(y));
        const Parabola fitted = fitted_parabola(colour_, rgb, guess(rgb, z, neighbour, neighbour_z));
        for (std::size_t k = 0; k < 3; ++k) {
            const double entry = fitted[k] * pole_scale(z) - (k == 2 ? 2.0 * z - 1.0 : 0.0);
            table_[offset_of(largest, value, y, x) + k] = static_cast<float>(entry);
        }
        return fitted;
    }

  private:
    /// Parabolas of greyish and of dark colours grow as pole_scale shrinks, those of bright saturated ones stay.
    [[nodiscard]] Parabola guess(const Vec3d& rgb, double z, const Parabola& neighbour, double neighbour_z) const {
        const double scale = pole_scale(neighbour_z) / pole_scale(z);
        const Parabola scaled{scale * neighbour[0], scale * neighbour[1], scale * neighbour[2]};
        return missed_by(colour_, rgb, neighbour) < missed_by(colour_, rgb, scaled) ? neighbour : scaled;
    }

    const RgbOfReflectance& colour_;
    std::vector<float>& table_;
};

/// Steps outwards from grey, whose parabola is known, in the middle of z, and from there to black and white.
void fit_part(EntryFit& entries, std::size_t largest) {
    constexpr std::size_t kMiddle = kValues / 2;
    const double middle_z = value_of(kMiddle);
    Parabola row{0.0, 0.0, (2.0 * middle_z - 1.0) / pole_scale(middle_z)};
    for (std::size_t y = kRatios; y-- > 0;) {
        Parabola middle = row;
        for (std::size_t x = kRatios; x-- > 0;) {
            middle = entries.fit(largest, kMiddle, y, x, middle, middle_z);
            if (x == kRatios - 1) {
                row = middle;
            }
            Parabola last = middle;
            for (std::size_t value = kMiddle; value-- > 0;) {
                last = entries.fit(largest, value, y, x, last, value_of(value + 1));
            }
            last = middle;
            for (std::size_t value = kMiddle + 1; value < kValues; ++value) {
                last = entries.fit(largest, value, y, x, last, value_of(value - 1));
            }
        }
    }
}

/// Where `at` lies between two entries.
struct Place {
    std::size_t index = 0;
    double fraction = 0.0;
};

/// Of `at` steps from the first of `count` entries.
Place place(double at, std::size_t count) {
    const std::size_t index = std::min(static_cast<std::size_t>(std::max(0.0, at)), count - 2);
    return {.index = index, .fraction = at - static_cast<double>(index)};
}

double usable(double channel, double most) {
    return channel > 0.0 ? std::min(channel, most) : 0.0;  // NaN too is 0
}

}  // namespace

RgbUplift::RgbUplift() : table_(kFloats) {
    const RgbOfReflectance colour = rgb_of_reflectance();
    EntryFit entries(colour, table_);
    for (std::size_t largest = 0; largest < 3; ++largest) {
        fit_part(entries, largest);
    }
}

SigmoidSpectrum RgbUplift::reflectance(const Vec3d& rgb) const {
    const std::array<double, 3> channel{usable(rgb.x, 1.0), usable(rgb.y, 1.0), usable(rgb.z, 1.0)};
    const auto largest = static_cast<std::size_t>(std::max_element(channel.begin(), channel.end()) - channel.begin());
    const double z = clamped_value(channel[largest]);
    const auto ratio = [&](std::size_t next) {
        return channel[largest] > kDarkest ? channel[(largest + next) % 3] / channel[largest] : 1.0;
    };
    const Place value = place(place_of_value(z), kValues);
    const Place x = place(place_of_ratio(ratio(1)), kRatios);
    const Place y = place(place_of_ratio(ratio(2)), kRatios);
    SigmoidSpectrum spectrum;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto along_x = [&](std::size_t v, std::size_t row) {
            const float* const entry = &table_[offset_of(largest, value.index + v, y.index + row, x.index) + k];
            return entry[0] + x.fraction * (static_cast<double>(entry[3]) - entry[0]);
        };
        const auto along_y = [&](std::size_t v) {
            const double first = along_x(v, 0);
            return first + y.fraction * (along_x(v, 1) - first);
        };
        const double first = along_y(0);
        const double between = first + value.fraction * (along_y(1) - first);
        spectrum.coefficient[k] = static_cast<float>((between + (k == 2 ? 2.0 * z - 1.0 : 0.0)) / pole_scale(z));
    }
    return spectrum;
}

std::string RgbUplift::serialized() const {
    return {reinterpret_cast<const char*>(table_.data()), table_.size() * sizeof(float)};
}

std::optional<RgbUplift> RgbUplift::deserialized(std::string_view bytes) {
    std::vector<float> table;
    table.reserve(kFloats);
    while (const std::optional<float> number = take_bytes<float>(bytes)) {
        if (!std::isfinite(*number)) {
            return std::nullopt;
        }
        table.push_back(*number);
    }
    if (table.size() != kFloats || !bytes.empty()) {
        return std::nullopt;
    }
    return RgbUplift(std::move(table));
}

RgbUplift kept_rgb_uplift(const Cache& cache) {
    std::string key(kVersion);
    const RgbOfReflectance colour = rgb_of_reflectance();
    append_bytes(key, kRatios, kValues);
    for (std::size_t i = 0; i < colour.abscissa.size(); ++i) {
        append_bytes(key, colour.abscissa[i], colour.xyz_weight[i].x, colour.xyz_weight[i].y, colour.xyz_weight[i].z);
    }
    return kept<RgbUplift>(cache, "rgb-uplift", key, [] { return RgbUplift(); });
}

SigmoidSpectrum fitted_reflectance(const RgbUplift& uplift, const RgbOfReflectance& colour, const Vec3d& rgb) {
    const auto bounded = [](double channel) { return std::clamp(usable(channel, 1.0), kDarkest, kBrightest); };
    const auto& [a, b, c] = uplift.reflectance(rgb).coefficient;
    const Parabola fitted = fitted_parabola(colour, {bounded(rgb.x), bounded(rgb.y), bounded(rgb.z)}, {a, b, c});
    return {
        .coefficient = {static_cast<float>(fitted[0]), static_cast<float>(fitted[1]), static_cast<float>(fitted[2])}};
}

UpliftedLight uplifted_light(const RgbUplift& uplift, const Vec3d& rgb) {
    constexpr double kMost = std::numeric_limits<float>::max();
    const Vec3d bounded{usable(rgb.x, kMost), usable(rgb.y, kMost), usable(rgb.z, kMost)};
    const double largest = std::max({bounded.x, bounded.y, bounded.z});
    if (!(largest > 0.0)) {
        return {};
    }
    // At half of the brightest that a reflectance can be, where the spectra are smooth.
    const double scale = 2.0 * largest;
    return {.shape = uplift.reflectance(1.0 / scale * bounded), .scale = scale};
}

}  // namespace lensproof::spectral
