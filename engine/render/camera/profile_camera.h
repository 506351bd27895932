// engine/render/camera/profile_camera.h — a pinhole and a thin lens with a lens's own radial profile.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/render/camera/camera_paths.h"
#include "engine/render/camera/film_importance.h"
#include "engine/render/camera/lens_profile.h"
#include "engine/render/camera/packet/profile_path.h"
#include "engine/render/camera/path_weigher.h"

namespace lensproof::render {

/// What opens a profile camera.
struct ProfileOpening {
    bool is_pinhole = false;
    double focus_z = 0.0;  // of the plane of focus of a thin lens, lens space; −inf: far off
};

/// A LensProfile as a camera: each film point has its chief ray, which leaves the centre of the pupil of that field,
/// and the light that the profile says, evenly over the pupil. It answers what camera.h asks, in lens space.
///
///   pinhole     the chief ray alone.
///   thin lens   rays of one film point cross where its chief ray meets the plane of focus; from 90° on, which that
///               plane does not see, they are parallel. The pupil is an ellipse across the chief ray. Its area is what
///               etendue says: illumination E at film radius r takes A = E / (τ J) of light's cross-section where chief
///               rays fill the solid angle J = sin θ θ′ / r a film area. Sagittally it is as wide as on the axis: a
///               disc across the axis when E falls as cos⁴, a narrower one where rims vignette.
///
/// With angles (no tangents), so that a field may pass 90°. Of a film point x and a point q of the pupil (from its
/// centre z_e, across the chief ray), v being the reciprocal distance to the focus along that ray and κ that along the
/// axis (v = κ cos θ), rays outside fill the etendue
///
///     K dx dq,   K = J / g,   1 / g = (1 + v dz_e/dθ sin θ) (1 + κ q_z) / (1 + v² q²)²:
///
/// dx to the plane of focus along the chief rays, which turn about a moving pupil, and dq to the directions there. So
/// what light brings is E / A over K of its etendue, which is τ g, and camera paths draw it with 1 / (A K) = τ g / E. A
/// pinhole counts for all of A at q = 0 and v = 0; light of a point at distance t from it sees the pupil's centre move,
/// by t_c = −dz_e/dθ sin θ of the distance tangentially, so that its pdf is t (t − t_c) / A per solid angle.
///
/// Light that comes in aims at a disc that holds the pupils of all film points which it may reach. From points nearer
/// than some of the lens's own size, `near_mm`, chief rays may cross: none is drawn.
class ProfileCamera {
  public:
    /// Throws InputError for a focus among the pupils.
    ProfileCamera(LensProfile profile, const ProfileOpening& opening);

    /// The same samples on the film as an exact camera's. Held by it: the camera.
    class Paths {
      public:
        /// `level`: that of `trace_batch`.
        Paths(const ProfileCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid,
              PathCarry carry, std::optional<SimdLevel> level = {});

        void start(const CameraPathRange& range) { samples_.start(range); }
        bool fill(CameraPathBuffer& buffer);
        /// Samples where the film gets no light are none.
        [[nodiscard]] std::int64_t started() const { return started_; }

      private:
        void append(PathStarts& starts, CameraPathBuffer& buffer);
        /// Where the others end of the chunk's paths, which begin with `first`.
        void meet_film(const CameraPathBuffer& buffer, std::size_t first, SharedPaths& chunk) const;

        FilmSamples samples_;
        PathWeigher weigher_;
        optics::RayBatch<double> rays_;
        Sensor sensor_;
        spectral::SpectralGrid grid_;
        const ProfileCamera* camera_;
        const PathKernels* kernels_;
        std::int64_t started_ = 0;
        PathCarry carry_;
        bool is_box_;  // wider filters draw film points unevenly: the hero stays alone
    };

    [[nodiscard]] FilmImportance importance(const Sensor& sensor, const Ray<double>& ray,
                                            const spectral::PathWavelengths& path) const;
    [[nodiscard]] std::optional<LensSample> sample(const LightOrigin& from, const spectral::PathWavelengths& path,
                                                   double u, double v) const;
    [[nodiscard]] PathPdf pdf(const LightOrigin& from, const Ray<double>& outwards,
                              const spectral::PathWavelengths& path) const;

    [[nodiscard]] const LensProfile& profile() const { return profile_; }
    /// From the pupil on the axis: no point nearer sends light by `sample`.
    [[nodiscard]] double near_mm() const { return near_mm_; }
    /// All that rays meet in it, as bytes.
    [[nodiscard]] std::string bytes() const;

  private:
    using Chief = ProfileChief<double>;
    /// A ray outside, as all wavelengths share it.
    struct Meeting {
        Chief chief;
        Vec2d offset;  // q, mm
    };
    struct Disc {
        Chief chief;
        double radius = 0.0;
        double distance = 0.0;  // of the origin from its centre
    };

    [[nodiscard]] RadialCurve::At pupil_at(double angle) const;
    [[nodiscard]] Chief chief_at(double angle, Vec2d azimuth) const;
    [[nodiscard]] Chief chief_along(const Vec3d& outwards) const;
    [[nodiscard]] Chief chief_through(const Vec3d& point) const;
    /// Through an origin that light may be drawn from.
    [[nodiscard]] std::optional<Chief> chief_of(const LightOrigin& from) const;
    /// A, mm², of a film point at this radius, where the profile's curves are so.
    [[nodiscard]] double pupil_area(std::uint16_t wavelength, double radius, double angle_slope, double sine,
                                    double illumination) const;
    [[nodiscard]] std::optional<Meeting> meet(const Ray<double>& ray) const;
    [[nodiscard]] FilmImportance film(const Sensor& sensor, const Meeting& meeting,
                                      const spectral::PathWavelengths& path) const;
    [[nodiscard]] Disc disc_of(const LightOrigin& from, const Chief& chief) const;
    [[nodiscard]] double pinhole_pdf(const Disc& disc, std::uint16_t wavelength) const;
    /// Sagittal and tangential, of a pupil of that area.
    [[nodiscard]] Vec2d semi_axes(std::uint16_t wavelength, double area) const;

    /// Curves as packets look them up.
    struct CurveColumns {
        std::vector<double> pieces;
        std::size_t pieces_each = 0;
        std::vector<double> per_step;
        std::vector<double> end;

        /// `of(profile)`: the curve of each.
        template <class Profiles, class Of>
        CurveColumns(const Profiles& profiles, const Of& of);
        [[nodiscard]] RadialCurves view() const {
            return {pieces.data(), static_cast<double>(pieces_each), per_step.data(), end.data()};
        }
    };
    /// For as long as this stays where it is.
    [[nodiscard]] ProfileTables tables() const;

    LensProfile profile_;
    ProfileOpening opening_;
    std::vector<double> axial_radius_;  // of the pupil, a wavelength each
    std::vector<double> transmittance_;
    bool is_found_in_a_step_;  // every field angle's radius: else each is searched by itself
    CurveColumns field_angle_;
    CurveColumns radius_;
    CurveColumns illumination_;
    CurveColumns pupil_z_;
    double widest_radius_ = 0.0;     // of all pupils' semi-axes
    double steepest_pupil_ = 0.0;    // |dz_e/dθ|
    double largest_vergence_ = 0.0;  // κ
    double near_mm_ = 0.0;
    double lead_mm_ = 0.0;  // from pupil to front: rays begin so far out
};

}  // namespace lensproof::render
