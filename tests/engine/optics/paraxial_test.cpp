#include "engine/optics/paraxial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics::paraxial_test {

TraceSurface<double> surface(double curvature, double z, double before, double after, double semi_diameter = 10.0,
                             bool is_stop = false) {
    return make_trace_surface(curvature, z, semi_diameter, before, after, is_stop);
}

// A ball lens with the stop at its middle: efl = n R / (2 (n − 1)), bfl = efl − R (Hecht, Optics, §6.1).
TEST(Paraxial, BallLens) {
    constexpr double n = 1.5;
    constexpr double R = 10.0;
    const TraceLens<double> ball{
        {surface(1 / R, 0, 1, n), surface(0, R, n, n, 2.0, true), surface(-1 / R, 2 * R, n, 1)}, 30.0};
    const ParaxialData data = paraxial_data(ball);
    const double efl = n * R / (2 * (n - 1));
    EXPECT_NEAR(data.efl, efl, 1e-13);
    EXPECT_NEAR(data.bfl, efl - R, 1e-13);
    EXPECT_NEAR(data.ffl, -(efl - R), 1e-13);
    // Symmetric about its middle, a centre of curvature: both pupils stand there, magnified n times.
    EXPECT_NEAR(data.entrance_pupil_z, R, 1e-12);
    EXPECT_NEAR(data.exit_pupil_z, -R, 1e-12);
    EXPECT_NEAR(data.entrance_pupil_diameter, 4.0 * n, 1e-12);
    EXPECT_NEAR(data.exit_pupil_diameter, 4.0 * n, 1e-12);
}

// Newton: object and image distances from the focal points multiply to efl².
TEST(Paraxial, ConjugatesObeyNewton) {
    const TraceLens<double> tessar = at_wavelength<double>(formats::load_lens("tessar"), spectral::kLineD);
    const ParaxialData data = paraxial_data(tessar);
    for (const double distance : {200.0, 1000.0, 1e4, 1e7}) {
        const double x = distance + data.ffl;
        const double x_image = paraxial_image_distance(tessar, distance) - data.bfl;
        EXPECT_NEAR(x * x_image, data.efl * data.efl, 1e-9 * distance);
    }
    EXPECT_NEAR(paraxial_image_distance(tessar, INFINITY), data.bfl, 1e-12);
}

// Published numbers: the Brendel Tessar's back focus is listed as 79.831 mm, its focal length as 100.
TEST(Paraxial, TessarHasItsPublishedFocus) {
    const ParaxialData data = paraxial_data(at_wavelength<double>(formats::load_lens("tessar"), spectral::kLineD));
    EXPECT_NEAR(data.bfl, 79.831, 0.0005);
    EXPECT_NEAR(data.efl, 100.0, 0.05);
}

TEST(Lens, FNumberSetsTheStop) {
    const Lens lens = with_f_number(formats::load_lens("tessar"), 8.0);
    EXPECT_NEAR(paraxial_data(at_wavelength<double>(lens, spectral::kLineD)).f_number, 8.0, 1e-12);
    EXPECT_THROW(with_f_number(formats::load_lens("tessar"), 1.4), InputError);
}

TEST(Lens, FocusMovesTheSensorToTheImage) {
    const Lens lens = focused_at(formats::load_lens("tessar"), 1000.0);
    EXPECT_NEAR(lens.image_z - lens.last_vertex_z(),
                paraxial_image_distance(at_wavelength<double>(lens, spectral::kLineD), 1000.0), 1e-12);
    EXPECT_THROW(focused_at(formats::load_lens("tessar"), 50.0), InputError);
}

}  // namespace lensproof::optics::paraxial_test
