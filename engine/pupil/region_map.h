// engine/pupil/region_map.h — draws points of a plane from regions that change with place and wavelength.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/disc.h"
#include "engine/pupil/pupil_guides.h"

namespace lensproof::pupil {

/// A point that was drawn, mm, and the pdf that it was drawn with, 1/mm². A pdf of 0: no path is to be started,
/// its estimate is 0.
struct PupilSample {
    Vec2d point;
    double pdf = 0.0;
};

/// Draws points for a place and a wavelength of `PupilNodes`: evenly over the region there with the probability 1 − δ,
/// else evenly over the whole disc, δ the defensive fraction. A sample's pdf is that of the mixture,
/// (1 − δ) · [in the region] / its area + δ / the disc's area, wherever it came from; so ∫ f = E[f / pdf] for every
/// f on the disc, however wrong a region is. Where no light was found, all but δ of the samples start no path.
///
/// A position in the band says which wavelength: i / (n − 1) is that of lens i of n.
class RegionMap {
  public:
    RegionMap(const Disc& disc, double defensive_fraction, PupilNodes nodes);

    /// The point that (u, v) in the unit square maps to.
    [[nodiscard]] PupilSample sample(Vec2d at, double band_position, double u, double v) const;

    /// The pdf that `sample` draws a point with, 1/mm²; 0 outside the disc and the region.
    [[nodiscard]] double pdf(Vec2d at, double band_position, Vec2d point) const;

    /// The region's, mm²; 0 where there is none.
    [[nodiscard]] double area(Vec2d at, double band_position) const;

    /// All of it as bytes, numbers as they lie in memory.
    [[nodiscard]] std::string serialized() const;
    /// Nothing where the bytes are not those of a map. Damage that leaves every number in its range is not seen.
    static std::optional<RegionMap> deserialized(std::string_view bytes);

    [[nodiscard]] const Disc& disc() const { return disc_; }
    [[nodiscard]] double defensive_fraction() const { return defensive_fraction_; }
    [[nodiscard]] const PupilNodes& nodes() const { return nodes_; }

  private:
    /// Of what `sample` draws from the region alone.
    [[nodiscard]] double region_pdf(const PupilPlace& place, Vec2d point) const;

    Disc disc_;
    double defensive_fraction_;
    PupilNodes nodes_;
    PupilGuides guides_;  // made from the nodes
};

}  // namespace lensproof::pupil
