// experiments/studies/chart_pictures/film_rays.h — where the rays of object points meet the film, in the film's
// colours.
#pragma once
#include <optional>
#include <vector>

#include "engine/analysis/spot.h"
#include "engine/optics/lens.h"
#include "engine/render/camera/camera.h"
#include "experiments/studies/chart_pictures/light_moments.h"

namespace lensproof::studies {

/// Of equal width; more move no centroid by 0.2 µm (chart_features_test.cpp).
inline constexpr int kBandsOfFilmRays = 9;

/// The bundles of object points through a camera's lens, of light of the colour that the camera is balanced to, at a
/// handful of wavelengths that stand for all.
class FilmRays {
  public:
    /// Throws InputError for a camera without a lens, or with one that is not rotationally symmetric.
    explicit FilmRays(const render::Camera& camera, int bands = kBandsOfFilmRays);

    /// The chief ray's place on the film, mm in lens space, and its field angle, radians, in the green. `point`: in
    /// lens space. Nothing where there is no such ray.
    struct Chief {
        Vec2d place;
        double field = 0.0;
    };
    [[nodiscard]] std::optional<Chief> chief(const Vec3d& point) const;

    /// The point's rays, `fraction` of whose light counts, onto `light`; in lens space.
    void add(const Vec3d& point, double fraction, std::vector<FilmLight>& light) const;

    /// The projected solid angle of the beam seen from the image point, sr, in the green.
    [[nodiscard]] double solid_angle(const Vec3d& point) const;

  private:
    struct Band {
        optics::TraceLens<double> lens;
        optics::ChiefRays chief_rays;
        Vec3d rgb;
    };
    [[nodiscard]] const Band& green() const { return bands_[bands_.size() / 2]; }

    std::vector<Band> bands_;
};

}  // namespace lensproof::studies
