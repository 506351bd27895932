// engine/polynomial/polynomial_lens.h — a lens as sparse polynomials of its traced rays, of known error.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/ray.h"
#include "engine/polynomial/exit_chart.h"
#include "engine/polynomial/polynomial_kernels.h"
#include "engine/polynomial/symmetric_map.h"

namespace lensproof::polynomial {

/// How far a polynomial is from its lens, measured over rays that it was not fitted to.
struct PolynomialError {
    /// On the film, µm: a ray that the polynomial lets out of the front is traced back exactly, without rims, and lands
    /// this far from the film point that it began at. Root mean square of the rays that pass the lens; and what 99.9 %
    /// of them keep, with a quarter to spare for other rays.
    double rms_um = 0.0;
    double bound_um = 0.0;
    /// How far the ray lies beside the traced one where it leaves the front, µm, rms: beside it in the beam, which
    /// blurs nothing.
    double entry_rms_um = 0.0;
    /// Of the film's irradiance, over the exact one: in all, and the largest of eight rings in radius.
    double irradiance = 0.0;
    double worst_irradiance = 0.0;
};

/// What stands between film and front: where polynomials take their inputs from, and how they are scaled.
struct PolynomialFrame {
    double film_radius_mm = 0.0;  // film points lie within, where the light ends before the film does that
    double film_z = 0.0;          // mm, lens space
    double pupil_z = 0.0;         // the plane that pupil points lie in
    double pupil_shear = 0.0;     // q = (pupil point − shear · film point) / radius
    double pupil_radius_mm = 0.0;
    double front_curvature = 0.0;  // of the sphere that exit_chart.h lays through the front vertex
    double front_w = 0.0;          // the largest |w|
    double front_shear = 0.0;      // rays in front are scaled as (u − shear · w) / radius
    double front_radius = 0.0;

    [[nodiscard]] SymmetricPoint inside(Vec2d film, Vec2d pupil, double t) const {
        const double per_film = 1.0 / film_radius_mm;
        const double per_pupil = 1.0 / pupil_radius_mm;
        return {per_film * film, per_pupil * (pupil - pupil_shear * film), t};
    }
    [[nodiscard]] SymmetricPoint outside(const ExitPoint<double>& at, double t) const {
        const double per_w = 1.0 / front_w;
        const double per_u = 1.0 / front_radius;
        return {per_w * at.w, per_u * (at.u - front_shear * at.w), t};
    }
};

/// A film ray at the lens's front.
struct PolynomialExit {
    Ray<double> ray;             // outwards; its origin on the sphere of exit_chart.h
    double transmittance = 0.0;  // of the glass; 0: a rim cuts the ray
};

/// A ray from the scene at the film.
struct PolynomialEnd {
    Vec2d film;
    Vec2d pupil;
    double transmittance = 0.0;
    double etendue = 0.0;  // on the film, over that in front of the lens: 1 but for the polynomial's error
};

/// A rotationally symmetric lens at its settings and the wavelengths of a band, as Schrade, Hanika and Dachsbacher
/// (Sparse high-degree polynomials for wide-angle lenses, 2016) have it: from a film point and a point of the pupil's
/// plane (pupil::PupilMap) the ray in front. Vectors are sums A x + B q of scalar polynomials (SymmetricMap), in front
/// of the lens they are those of exit_chart.h, so that 90° of field are nothing special. Rims that light meets are
/// polynomials too, r² over the rim's square, and cut where they exceed 1.
///
/// Film points lie within the frame's radius and pupil points in the map's region; beyond, polynomials mean nothing.
/// `end` is the inverse of the very same polynomials, found by Newton's method: paths from both ends agree to rounding.
class PolynomialLens {
  public:
    /// `exits`: vectors w and u, then the transmittance and the rims; `guess`: from rays in front the scaled film and
    /// pupil points, roughly. `band`: t of each wavelength. `fit_polynomial` makes them.
    PolynomialLens(const PolynomialFrame& frame, SymmetricMap exits, SymmetricMap guess, std::vector<double> band)
        : frame_(frame), exits_(std::move(exits)), guess_(std::move(guess)), band_(std::move(band)) {}

    [[nodiscard]] PolynomialExit exit(Vec2d film, Vec2d pupil, int wavelength) const;

    /// Of a ray towards the lens, its origin before it. Nothing where it does not arrive within the frame.
    [[nodiscard]] std::optional<PolynomialEnd> end(const Ray<double>& inwards, int wavelength) const;

    /// For many rays at once: `exit`, but for rounding; refers to this.
    [[nodiscard]] PolynomialTables tables() const;

    [[nodiscard]] const PolynomialFrame& frame() const { return frame_; }
    [[nodiscard]] const SymmetricMap& exits() const { return exits_; }
    [[nodiscard]] const std::vector<double>& band() const { return band_; }
    [[nodiscard]] int rims() const { return exits_.scalars() - 1; }
    [[nodiscard]] const PolynomialError& error() const { return error_; }
    void set_error(const PolynomialError& error) { error_ = error; }

    /// All of it as bytes, numbers as they lie in memory.
    [[nodiscard]] std::string serialized() const;
    /// Nothing where the bytes are not those of one.
    static std::optional<PolynomialLens> deserialized(std::string_view bytes);

  private:
    [[nodiscard]] bool passes(const SymmetricPoint& at) const;

    PolynomialFrame frame_;
    SymmetricMap exits_;
    SymmetricMap guess_;
    std::vector<double> band_;
    PolynomialError error_;
};

}  // namespace lensproof::polynomial
