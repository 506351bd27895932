// engine/pupil/entrance_map.h — through which part of the front element light from each direction enters a lens.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/pupil/entrance_beam.h"
#include "engine/pupil/pupil_map.h"
#include "engine/pupil/region_map.h"

namespace lensproof::pupil {

/// A ray into the lens, its offset in its beam, mm, and the pdf that it was drawn with, 1/mm² of the plane across
/// the beam. A pdf of 0: no path is to be started, its estimate is 0.
struct EntranceSample {
    Ray<double> ray;
    Vec2d offset;
    double pdf = 0.0;
};

/// Draws the first rays of paths of light: for each direction of the scene, rays of its light that may pass the lens,
/// evenly over a region across them that holds all such and little else. It is PupilMap seen from the other side, with
/// the field angle in the place of the sensor's radius, up to 160° and the last light.
///
/// With f the transmittance of a ray, or 0 where it does not pass: a far source of irradiance E (across its light)
/// sends the flux E · E[f / pdf] through the lens, and an even scene of radiance L the flux L · E[f / pdf] a
/// steradian. No cosine comes in, since pdfs are per mm² across the light. A source of intensity I at the map's
/// distance sends I · E[f · solid_angle_per_mm2 / pdf] (EntranceBeam).
class EntranceMap {
  public:
    /// `band` and `settings` as PupilMap has them. `by_angle`: the lens is rotationally symmetric, its stop's blades
    /// aside. `distance_mm`: of the sources from the centre of the front sphere (EntranceBeam), beyond its radius.
    EntranceMap(const std::vector<optics::TraceLens<double>>& band, bool by_angle, double distance_mm = kInfinity,
                const PupilMapSettings& settings = {});

    /// The whole front element for every direction: the baseline that maps are judged against.
    static EntranceMap whole_element(const optics::TraceLens<double>& lens, double distance_mm = kInfinity);

    /// The light of a source at the map's distance that travels along `direction` (of unit length) to the centre of the
    /// front sphere.
    [[nodiscard]] EntranceBeam beam(const Vec3d& direction) const;

    /// The ray of `beam`, one of this map's, that (u, v) in the unit square maps to.
    [[nodiscard]] EntranceSample sample(const EntranceBeam& beam, double band_position, double u, double v) const;

    /// The pdfs that `sample` draws an offset with at several positions, 1/mm², into as many of `found`; 0 outside the
    /// disc and the region.
    void pdfs(const EntranceBeam& beam, std::span<const double> band_positions, Vec2d offset,
              std::span<double> found) const;

    /// The area that is drawn from but for the defensive fraction, mm²; 0 where no light was found.
    [[nodiscard]] double region_area(const EntranceBeam& beam, double band_position) const;

    /// The largest field angle that light was found at in the band, rad; 0 where there is none.
    [[nodiscard]] double largest_angle() const;

    /// All of it as bytes, and back, as PupilMap has it.
    [[nodiscard]] std::string serialized() const;
    static std::optional<EntranceMap> deserialized(std::string_view bytes);

  private:
    EntranceMap(const BoundingSphere& front, double distance_mm, RegionMap regions);

    BoundingSphere front_;
    double distance_mm_;
    RegionMap regions_;
};

}  // namespace lensproof::pupil
