#include "engine/optics/paraxial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics::paraxial_test {

// Published numbers: the Brendel Tessar's back focus is listed as 79.831 mm, its focal length as 100.
TEST(Paraxial, TessarHasItsPublishedFocus) {
    const ParaxialData data = paraxial_data(at_wavelength<double>(formats::load_lens("tessar"), spectral::kLineD));
    EXPECT_NEAR(data.bfl, 79.831, 0.0005);
    EXPECT_NEAR(data.efl, 100.0, 0.05);
}

TEST(Lens, FNumberSetsTheStop) {
    const Lens lens = with_f_number(formats::load_lens("tessar"), 8.0);
    EXPECT_NEAR(paraxial_data(at_wavelength<double>(lens, spectral::kLineD)).f_number, 8.0, 1e-12);
    const Lens in_the_blue = with_f_number(formats::load_lens("tessar"), 8.0, 450.0);
    EXPECT_NEAR(paraxial_data(at_wavelength<double>(in_the_blue, 450.0)).f_number, 8.0, 1e-12);
    EXPECT_THROW(with_f_number(formats::load_lens("tessar"), 1.4), InputError);
}

TEST(Lens, FocusMovesTheSensorToTheImage) {
    const Lens lens = focused_at(formats::load_lens("tessar"), 1000.0);
    EXPECT_NEAR(lens.image_z - lens.last_vertex_z(),
                paraxial_image_distance(at_wavelength<double>(lens, spectral::kLineD), 1000.0), 1e-12);
    EXPECT_THROW(focused_at(formats::load_lens("tessar"), 50.0), InputError);
}

// The image of a near object comes as far from the sensor as infinity's, in the colour that is asked for, and in no
// other: 60 bisections settle the drive to its last bits.
TEST(Lens, GroupsFocusAtTheWavelength) {
    Lens lens = formats::load_lens("tessar");
    lens.focus_groups = {{.first = 1, .last = 8}};
    const auto defocus = [](const Lens& at, double object_distance, double wavelength_nm) {
        return at.last_vertex_z() + paraxial_image_distance(at_wavelength<double>(at, wavelength_nm), object_distance) -
               at.image_z;
    };
    for (const double wavelength_nm : {450.0, spectral::kLineD, 650.0}) {
        const Lens focused = focused_at(lens, 2000.0, wavelength_nm);
        const double distance = 2000.0 + focused.surfaces.front().vertex_z;
        const double aim = defocus(lens, kInfinity, wavelength_nm);
        EXPECT_NEAR(defocus(focused, distance, wavelength_nm), aim, 1e-11);
        const double other_nm = wavelength_nm == 450.0 ? 650.0 : 450.0;
        EXPECT_GT(std::abs(defocus(focused, distance, other_nm) - defocus(lens, kInfinity, other_nm)), 1e-5);
    }
}

}  // namespace lensproof::optics::paraxial_test
