// engine/render/camera/film_importance.h — what light that comes to a camera finds there: where on the film it lands,
// and with which pdfs paths from either end make that ray.
#pragma once
#include <array>
#include <cstddef>

#include "engine/base/ray.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

/// The pdf of a ray that paths draw which carry all of their wavelengths, and of one that the hero alone takes. 0: they
/// cannot draw it.
struct PathPdf {
    double shared = 0.0;
    double hero = 0.0;
};

/// The one is the mean over a path's wavelengths, each of which might have been the hero (balance heuristic); the other
/// the first's.
template <class PdfOf>
PathPdf over_heroes(const PdfOf& pdf_of) {
    PathPdf pdf{.shared = 0.0, .hero = pdf_of(std::size_t{0})};
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        pdf.shared += (i == 0 ? pdf.hero : pdf_of(i)) / spectral::kWavelengthsPerPath;
    }
    return pdf;
}

/// Where light comes from on its path into a camera: a point (mm) or, from far off, the direction (of unit length) that
/// it travels in.
struct LightOrigin {
    Vec3d at;
    bool is_far = false;
};

/// A ray into the camera that was drawn for light from an origin.
struct LensSample {
    Ray<double> ray;  // lens space, towards the camera
    Vec3d direction;  // the same in the origin's frame
    Vec3d end;        // in the origin's frame: the light arrives if nothing stands between the origin and this
    PathPdf pdf;      // per solid angle; of far light per mm² across it
};

/// What becomes of a ray into the camera at each of a path's wavelengths.
struct FilmImportance {
    std::array<Vec2d, spectral::kWavelengthsPerPath> at_px;
    /// The power that arrives on the film over that of the ray's etendue outside: the transmittance of a lens. 0: the
    /// ray does not arrive.
    std::array<double, spectral::kWavelengthsPerPath> transmittance{};
    /// With which a camera path with this wavelength for its hero draws the ray: per etendue outside, times a pixel's
    /// area.
    std::array<double, spectral::kWavelengthsPerPath> pdf{};

    [[nodiscard]] bool is_dark() const;
    /// That of camera paths which carry `wavelength` and end in its pixel, whichever of their wavelengths is the hero.
    [[nodiscard]] double shared_pdf(std::size_t wavelength) const;
};

/// What a camera path that carries all of its wavelengths counts at each, by the balance heuristic of SharedRays, in
/// the pixel about `centre_px`, where its hero's film point lies; and `drawn`, with which pdfs it was.
std::array<float, spectral::kWavelengthsPerPath> shared_weights(const FilmImportance& film, Vec2d centre_px,
                                                                PathPdf& drawn);

}  // namespace lensproof::render
