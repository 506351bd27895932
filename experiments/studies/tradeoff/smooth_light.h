// experiments/studies/tradeoff/smooth_light.h — how smooth the light of a pass is.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "experiments/studies/tradeoff/pilot.h"

namespace lensproof::studies {

/// Light, and what smoothing would take from it.
///
/// Two films of independent noise have nothing in common but the light: the mean of the products of what the same
/// filter makes of both is that of the light alone, squared. What a Gaussian of width σ takes from light is told by
/// what one of 2σ takes beside it. Of an edge of height 1 and length L in an area A the one has the mean square 0.2337
/// σ L/A, the other 0.0914 σ L/A (both by ∫₀^∞ Q(u/a) Q(u/b) du = (a + b − √(a² + b²)) / (2 √(2π)), Q being the
/// Gaussian's upper tail), and what is taken from smoother light grows faster than σ: so what is found at a larger
/// width, where there is less noise, bounds what is lost at a smaller one. Of light in points more is lost than that
/// tells; where the finest width surely has more than the bound allows, all that is finer is told.
class SmoothLight {
  public:
    using Films = std::array<formats::Image, 2>;

    /// `films`: RGB; `mean`: of the picture that the light is a part of; `coarser`: px of that picture in one of
    /// theirs.
    SmoothLight(const Films& films, const Vec3d& mean, double coarser);

    /// The root mean square over the picture of what a Gaussian of standard deviation `sigma_px` takes away or adds,
    /// over the picture's mean.
    [[nodiscard]] Measured lost(double sigma_px) const;

  private:
    /// The mean square of what lies between the widths sigma and 2 sigma, px of the films.
    [[nodiscard]] Measured between(double sigma) const;
    /// That of all that is finer, which has all noise of a pixel.
    [[nodiscard]] Measured beyond(double sigma) const;

    Films films_;  // over the mean
    double coarser_;
};

/// A pass of a pilot's scene by itself, of more pixels than the pilot's.
struct PassFilms {
    SmoothLight::Films rgb;
    int samples = 0;             // of a pixel and a seed
    double ns_per_sample = 0.0;  // of one core

    /// Other samples of the same pass and seeds.
    void add(const PassFilms& more);

    /// Their light over all that goes straight. Its error is what the films differ by, pixel by pixel.
    [[nodiscard]] Measured fraction(const Pilot& pilot) const;
    [[nodiscard]] SmoothLight smoothness(const Pilot& pilot) const;
};

/// With seeds from `first_seed` on. Throws InputError where the camera has no such light.
PassFilms pass_films(const Pilot& pilot, const std::string& pass, int first_seed, const render::SampleRange& samples);

/// Those with seeds from 0 on, of as many samples as were asked for yet: what is missing is rendered and added.
class KeptFilms {
  public:
    explicit KeptFilms(const Pilot& pilot) : pilot_(&pilot) {}
    const PassFilms& of(const std::string& pass, int samples);

  private:
    const Pilot* pilot_;
    std::map<std::string, PassFilms> films_;
};

/// How a pass is rendered whose light is smooth: spread by the widest that may be of these, px, and with so many fewer
/// samples. The narrowest leaves a third of the variance that all samples would (render::smoothing_gain).
inline constexpr std::array kSmoothings = {8.0, 4.0, 2.0};
inline constexpr std::uint32_t kFewerWhereSmooth = 16;

}  // namespace lensproof::studies
