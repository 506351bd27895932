// Forbes's aspheres as Zemax spells them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "engine/formats/prescription/forbes_asphere.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"
#include "tests/engine/formats/prescription/has_finding.h"

namespace lensproof::formats::zmx_shape_test {

/// A plano-convex lens 29.85 thick whose front has these lines, with the image where Thorlabs has it.
optics::Prescription lens_with(const std::string& front, const std::string& unit = "MM") {
    return parse_zmx("MODE SEQ\nUNIT " + unit +
                         " X W X CM MR CPMM\nENPD 45.72\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n" + front +
                         "  DISZ 29.85\n  GLAS ___BLANK 1 0 1.469597 0 0\n  DIAM 22.86 0\nSURF 2\n  CURV 0\n"
                         "  DISZ 19.687453064998852\n  DIAM 17.6 1\nSURF 3\n  DISZ 0\n",
                     "a.zmx");
}

std::string forbes(double kind, int terms, double radius, const std::vector<double>& a) {
    std::string lines = fmt::format("  TYPE QED_TYPE\n  XDAT 1 {}\n  XDAT 2 {}\n  XDAT 3 {}\n", kind, terms, radius);
    for (std::size_t m = 0; m < a.size(); ++m) {
        lines += fmt::format("  XDAT {} {} 0 0 1.0 0.0 0 \"\"\n", m + 4, a[m]);
    }
    return lines;
}

/// Of Thorlabs' ASL5040-UV, a diffraction-limited lens of f/0.9, what its file says of the front.
const std::string kBase = "  CURV 5.756078762782423225E-02\n  CONI -0.67609120640407927\n";
const std::vector<double> kTerms{-8.148370167576e-01, -3.2311e-01, 1.0591e-01, -5.058e-02, 9.87e-03, -2.2e-03};

// Its index at 405 nm is Malitson's of fused silica (J. Opt. Soc. Am. 55, 1205, 1965). The maker's plane of focus is
// that of the paraxial focus to a micrometre, so light of the whole aperture has to meet within one, and does within
// 0.6; with the terms along the axis, or about the sphere, it misses by hundreds.
TEST(ZmxShape, ForbesAspheresFocusAsMade) {
    const optics::Prescription lens = lens_with(kBase + forbes(0, 6, 27, kTerms));
    EXPECT_FALSE(has_finding(lens, "surface-type", ""));
    const auto traced = optics::at_wavelength<double>(optics::make_lens(lens, optics::GlassCatalogue{}), 405.0);
    for (const double height : {2.0, 8.0, 14.0, 18.0, 22.8}) {
        const optics::TracedRay<double> out = optics::trace(traced, Ray<double>{{0.0, height, -5.0}, {0.0, 0.0, 1.0}});
        ASSERT_EQ(out.status, optics::RayStatus::ok) << height;
        EXPECT_LT(std::abs(optics::meet_plane(out.ray, traced.image_z).point.y), 1e-3) << height;
    }
}

// Terms beyond the number of terms do not count, lengths are in the file's unit.
TEST(ZmxShape, ReadsBothOfForbessAspheres) {
    const auto front = [](const optics::Prescription& lens) { return lens.surfaces.at(0); };
    const std::vector<double> a{0.5, -0.25, 0.125};
    const optics::PrescribedSurface mild = front(lens_with(forbes(0, 2, 10, a)));
    EXPECT_TRUE(mild.along_normal);
    EXPECT_EQ(mild.asphere, powers_of_qbfs(std::vector<double>{0.5, -0.25}, 10.0));
    const optics::PrescribedSurface strong = front(lens_with(forbes(1, 3, 10, a), "CM"));
    EXPECT_FALSE(strong.along_normal);
    EXPECT_EQ(strong.asphere, powers_of_qcon(std::vector<double>{5.0, -2.5, 1.25}, 100.0));
}

TEST(ZmxShape, NamesWhatIsWrongWithAForbesAsphere) {
    const std::vector<double> ten(10, 0.1);
    EXPECT_TRUE(has_finding(lens_with(forbes(1, 10, 10, ten)), "surface-type", "a term a_9 = 0.1"));
    EXPECT_FALSE(has_finding(lens_with(forbes(1, 9, 10, ten)), "surface-type", ""));
    for (const std::string& damaged : {forbes(2, 3, 10, ten), forbes(0, 3, 0, ten), forbes(0, 3, -10, ten)}) {
        const optics::Prescription lens = lens_with(damaged);
        EXPECT_TRUE(has_finding(lens, "surface-type", "expected 0 or 1 in XDAT 1 and a length in XDAT 3"));
        EXPECT_FALSE(lens.surfaces.at(0).is_asphere());
        EXPECT_THROW(optics::make_lens(lens, {}), InputError);
    }
    EXPECT_THROW(lens_with("  TYPE QED_TYPE\n  XDAT 3 abc\n"), InputError);
    EXPECT_THROW(optics::make_lens(lens_with(forbes(0, 3, 1e-300, ten)), {}), InputError);
}

}  // namespace lensproof::formats::zmx_shape_test
