#include "engine/render/stray/wave_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/input_error.h"

namespace lensproof::render {

namespace {

constexpr double kMmPerUm = 1e-3;

double sinc(double x) {
    return x == 0.0 ? 1.0 : std::sin(x) / x;
}

}  // namespace

WaveImage::WaveImage(const optics::Lens& lens, const Ray<double>& chief, double wavelength_nm, double airy_mm)
    : pixel_mm_(airy_mm / kPixelsPerAiry) {
    const optics::FieldBundle bundle{.chief = {.field_angle = 0.0, .front = chief, .image_height = 0.0}};
    const std::array<analysis::WeightedWavelength, 1> wavelength{{{.wavelength_nm = wavelength_nm}}};
    const analysis::PolychromaticField field = analysis::polychromatic_field(lens, bundle, wavelength_nm, wavelength);
    const analysis::Psf psf = analysis::fft_psf(field, {.size = kFft, .pixel_um = pixel_mm_ / kMmPerUm});
    const double aberration = psf.largest_aberration_um * kMmPerUm / airy_mm;
    if (!(aberration <= 0.5 * kReachAiry)) {
        throw InputError(
            fmt::format("{}: a sun's rays at {} nm land up to {:.3g} λN from their chief ray, expected {} "
                        "at most: such an image is made by rays, without the pass \"waves\"",
                        lens.name, wavelength_nm, aberration, 0.5 * kReachAiry));
    }
    if (psf.status != analysis::PupilStatus::ok) {
        throw InputError(
            fmt::format("{}: a sun's rays at {} nm cross in the pupil, whose wave is not known: its image "
                        "is made by rays, without the pass \"waves\"",
                        lens.name, wavelength_nm));
    }
    integrate_light(field, lens.dust);
    spread(psf);
}

void WaveImage::integrate_light(const analysis::PolychromaticField& field,
                                const std::optional<optics::FrontDust>& dust) {
    constexpr int kRings = 6;
    const analysis::PolychromaticField::Part& part = field.parts.front();
    for (const optics::RegionNode& node : optics::region_quadrature(part.outline, kRings)) {
        const Ray<double> ray = field.bundle.ray(node.point);
        const optics::TracedRay<double> traced = optics::trace_past_rims(part.lens, ray);
        light_mm2_ += node.weight * traced.transmittance * (dust ? dust->clear(ray, part.lens) : 1.0);
        nodes_.push_back({.front = ray.origin, .light_mm2 = light_mm2_});
    }
}

void WaveImage::spread(const analysis::Psf& psf) {
    constexpr auto kSide = static_cast<std::size_t>(kSize);
    constexpr int kFirst = kFft / 2 - kReach;
    fractions_.assign(kSide * kSide, 0.0F);
    double sum = 0.0;
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            const Vec2d at{static_cast<double>(column - kReach), static_cast<double>(row - kReach)};
            if (length(at) > kReach) {
                continue;
            }
            // A cell at the pupil's edge counts as much as lies inside: such means fade the picture like this.
            const double faded = sinc(std::numbers::pi * at.x / kFft) * sinc(std::numbers::pi * at.y / kFft);
            const double irradiance = psf.at(kFirst + row, kFirst + column) / (faded * faded);
            fractions_[static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column)] =
                static_cast<float>(irradiance);
            sum += irradiance;
        }
    }
    const double to_fraction = static_cast<double>(fractions_.size()) / sum;
    for (float& fraction : fractions_) {
        fraction = static_cast<float>(fraction * to_fraction);
    }
    // Between drawing by the light and evenly by the logarithm of the distance, as edges' rays are drawn.
    distribution_ = scene::PixelDistribution(kSize, kSize, [&](int row) {
        std::vector<double> squares(kSide);
        for (int column = 0; column < kSize; ++column) {
            const double fraction =
                fractions_[static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column)];
            squares[static_cast<std::size_t>(column)] =
                fraction * fraction * (1.0 + std::hypot(column - kReach, row - kReach));
        }
        return squares;
    });
}

WaveImage::Draw WaveImage::draw(double u1, double u2) const {
    const scene::PixelDistribution::Draw drawn = distribution_.draw({u1, u2});
    const Vec2d at = static_cast<double>(kSize) * drawn.at;
    const auto row = static_cast<std::size_t>(std::min(static_cast<int>(at.y), kSize - 1));
    const auto column = static_cast<std::size_t>(std::min(static_cast<int>(at.x), kSize - 1));
    constexpr double kMiddle = kReach + 0.5;  // of the pixel that the chief ray meets
    return {.offset = pixel_mm_ * Vec2d{at.x - kMiddle, at.y - kMiddle},
            .weight = fractions_[row * static_cast<std::size_t>(kSize) + column] / drawn.pdf};
}

Vec3d WaveImage::front(double u) const {
    const auto node = std::ranges::upper_bound(nodes_, u * light_mm2_, {}, &Node::light_mm2);
    return (node == nodes_.end() ? nodes_.back() : *node).front;
}

}  // namespace lensproof::render
