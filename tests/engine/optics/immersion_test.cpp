// Objects that do not lie in air, against Abbe's aplanatic points and Gauss's equations.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"
#include "tests/complaint.h"

namespace lensproof::optics::immersion_test {

constexpr double kOil = 1.515;
constexpr double kGreen_nm = 546.074;

/// An object in oil that fills the space up to the rear of a sphere of radius R: it stands in the sphere's aplanatic
/// point, R / n behind the centre as light runs, and its image R n behind the centre, towards the object (Abbe 1873;
/// Born & Wolf, §4.2.3).
Prescription aplanat(double R, double numerical_aperture) {
    Prescription lens{.name = "aplanat", .surfaces = {}};
    lens.object_medium.n_d = kOil;
    lens.object_distance_mm = R + R / kOil;
    lens.aperture = {ApertureKind::object_numerical_aperture, numerical_aperture};
    lens.surfaces = {{.radius_mm = -R, .thickness_mm = 100.0, .rim_mm = R, .medium = {}, .is_stop = true}};
    return lens;
}

TEST(Immersion, AnAplanaticSphereIsStigmatic) {
    const double R = 3.0;
    const TraceLens<double> lens = at_wavelength<double>(make_lens(aplanat(R, 1.2), {}), kGreen_nm);
    EXPECT_EQ(lens.surfaces.front().index_before, kOil);
    const double object_z = -R - R / kOil;
    const double image_z = -R - R * kOil;
    const BasicConjugates<double> conjugates = paraxial_conjugates(lens, -object_z);
    EXPECT_NEAR(conjugates.image_distance, image_z, 1e-13 * R * kOil);
    EXPECT_NEAR(conjugates.magnification, kOil * kOil, 1e-13 * kOil * kOil);
    for (const double angle : {0.0, 0.3, -0.6, 0.85}) {
        const TracedRay<double> out = trace<Direction::forward, Rims::follow>(
            lens, {{0.0, 0.0, object_z}, {0.0, std::sin(angle), std::cos(angle)}});
        ASSERT_TRUE(gets_through(out.status));
        EXPECT_NEAR(meet_plane(out.ray, image_z).point.y, 0.0, 1e-13 * R * kOil);
        // n sin U = n' sin U' m: Abbe's condition with the magnification n².
        EXPECT_NEAR(kOil * std::sin(angle), kOil * kOil * out.ray.direction.y, 1e-14);
    }
}

// The numerical aperture n sin U counts the oil, and opens the stop to what its paraxial ray of that tangent needs.
TEST(Immersion, ANumericalApertureCountsTheMedium) {
    const double R = 3.0;
    const Lens lens = make_lens(aplanat(R, 0.5), {});
    EXPECT_NEAR(lens.surfaces.front().semi_diameter, (R + R / kOil) * std::tan(std::asin(0.5 / kOil)), 1e-12 * R);
}

// Water in front of a thin lens of power φ: front focal length n / φ, rear 1 / φ, the nodal points (1 − n) / φ behind
// the principal ones (Gauss).
TEST(Immersion, HasTwoFocalLengths) {
    Prescription prescription{.name = "in water", .surfaces = {}};
    prescription.object_medium.n_d = 1.333;
    prescription.surfaces = {{.thickness_mm = 60.0, .semi_diameter_mm = 5.0, .medium = {}, .is_stop = true}};
    prescription.surfaces.front().radius_mm = -20.0;
    const TraceLens<double> lens = at_wavelength<double>(make_lens(prescription, {}), kGreen_nm);
    const double power = (1.0 - 1.333) / -20.0;
    const ParaxialData data = paraxial_data(lens);
    EXPECT_NEAR(data.efl, 1.0 / power, 1e-13 / power);
    EXPECT_NEAR(data.front_efl, 1.333 / power, 1e-13 / power);
    EXPECT_NEAR(data.ffl, -1.333 / power, 1e-13 / power);
    EXPECT_NEAR(data.front_nodal_z, (1.0 - 1.333) / power, 1e-13 / power);
    EXPECT_TRUE(says(lensproof::complaint_about([&] { require_air_in_front(make_lens(prescription, {}), "a camera"); }),
                     "a camera takes light from air"));
}

}  // namespace lensproof::optics::immersion_test
