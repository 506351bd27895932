#include <string>
#include <string_view>

#include "engine/base/bytes.h"
#include "engine/optics/lens_bytes.h"
#include "engine/polynomial/polynomial_fit.h"
#include "polynomial_digest.h"

namespace lensproof::polynomial {

namespace {

/// Everything that a polynomial follows from.
std::string key_of(const optics::Lens& lens, const std::vector<double>& wavelengths_nm, const pupil::PupilMap& pupil,
                   double film_radius_mm, const FitSettings& settings) {
    std::string key(kPolynomialDigest);
    const auto& [wanted_um, entry, transmittance, rim, fitted, held_out, judging, most_terms] = settings;
    append_bytes(key, wanted_um, entry, transmittance, rim, fitted, held_out, judging, most_terms, film_radius_mm,
                 wavelengths_nm.size());
    for (const double nm : wavelengths_nm) {
        append_bytes(key, nm);
        optics::append_lens_bytes(key, optics::at_wavelength<double>(lens, nm));
    }
    return key + pupil.serialized();
}

}  // namespace

PolynomialLens kept_polynomial(const Cache& cache, const optics::Lens& lens, const std::vector<double>& wavelengths_nm,
                               const pupil::PupilMap& pupil, double film_radius_mm, const FitSettings& settings) {
    return kept<PolynomialLens>(cache, "polynomial", key_of(lens, wavelengths_nm, pupil, film_radius_mm, settings),
                                [&] { return fit_polynomial(lens, wavelengths_nm, pupil, film_radius_mm, settings); });
}

}  // namespace lensproof::polynomial
