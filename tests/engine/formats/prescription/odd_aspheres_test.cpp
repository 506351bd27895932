// A patent's lens with aspheres of every power from r³ to r²⁰, US 2017/0351051 A1, example 1, against what others make
// of it.
#include <gtest/gtest.h>

#include <vector>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "tests/places.h"

namespace lensproof::formats::odd_aspheres_test {

optics::TraceLens<double> patent() {
    return optics::at_wavelength<double>(load_lens((reference_numbers_folder() / "odd-aspheres.toml").string()),
                                         spectral::kLineD);
}

/// A ray, and its point on the last surface, its direction behind it and its optical path to it.
struct ExactRay {
    Vec3d origin;
    Vec3d direction;
    Vec3d point;
    Vec3d outwards;
    double optical_path;
};

// By tests/validation/reference_numbers/exact_rays.py with 50 digits. Fields of 0 to 30°, heights up to 7 mm.
const std::vector<ExactRay> kExactRays = {
    {{0, 0, -20}, {0, 0, 1}, {0, 0, 51.316}, {0, 0, 1}, 91.3589147},
    {{0, 3, -20},
     {0, 0, 1},
     {0, 1.8615606702847025, 51.29807856805327},
     {0, -0.13409597973859683, 0.9909683487467932},
     91.21563065661672},
    {{4, -2, -20},
     {0, 0, 1},
     {2.5135029883812368, -1.2567514941906184, 51.275155025344276},
     {-0.17875708069068738, 0.08937854034534369, 0.9798251796257733},
     91.0344678368479},
    {{2, 5, -20},
     {0, 0, 1},
     {1.2689141612349766, 3.1722854030874412, 51.25561679083283},
     {-0.08946495457606433, -0.22366238644016082, 0.9705519866522323},
     90.88173480057435},
    {{0, -4.937155459837019, -20},
     {0, 0.17364817766693036, 0.984807753012208},
     {0, 3.248553023297376, 51.26141408532253},
     {0, 0.049702256863014, 0.9987640790811027},
     91.81523065297507},
    {{1, -2.9371554598370193, -20},
     {0, 0.17364817766693036, 0.984807753012208},
     {0.6115190330826737, 4.438669656774761, 51.21213169612793},
     {-0.04411417335802218, -0.03623773562584822, 0.9983690531189604},
     91.41319963880044},
    {{-2, -7.937155459837019, -20},
     {0, 0.17364817766693036, 0.984807753012208},
     {-1.2362325614252512, 1.431620360453438, 51.29749723512293},
     {0.08837159695089447, 0.17859243053640017, 0.9799465315043723},
     92.1087398379637},
    {{0, -10.191166559453666, -20},
     {0, 0.3420201433256687, 0.9396926207859084},
     {0, 6.496552683131293, 51.09750829476534},
     {0, 0.11303237623859531, 0.9935913052769014},
     93.27547825052991},
    {{2, -8.191166559453666, -20},
     {0, 0.3420201433256687, 0.9396926207859084},
     {1.1933203992365398, 7.552006913145509, 51.01324332993648},
     {-0.08461394928151351, 0.037739367195613494, 0.9956988599725622},
     92.5364496922076},
    {{1, -12.191166559453666, -20},
     {0, 0.3420201433256687, 0.9396926207859084},
     {0.5965399313496741, 5.4202325019764634, 51.16211775222167},
     {-0.04237490317491225, 0.1883165065157294, 0.9811937937811409},
     93.84829105512864},
    {{1, -16.165807537309522, -20},
     {0, 0.5, 0.8660254037844386},
     {0.5675276989588754, 9.785861271806048, 50.81785637518089},
     {-0.03886367830574456, 0.21088915273641676, 0.9767371088305511},
     96.04255081702105},
    {{0, 1e-06, -20},
     {0, 0, 1},
     {0, 6.142918457034307e-07, 51.315999999999995},
     {0, -4.469911385779631e-08, 0.999999999999999},
     91.35891469999999},
};

// At two rims terms of 300 mm, and of 700 in the slopes, cancel but for a thousandth: an ulp of them is 6e-14 mm,
// 1e-13. From there it is 30 mm to the last surface.
TEST(OddAspheres, RaysAreThoseOfFiftyDigits) {
    const optics::TraceLens<double> lens = patent();
    for (const ExactRay& exact : kExactRays) {
        const auto traced = optics::trace<optics::Direction::forward, optics::Rims::follow>(
            lens, Ray<double>{exact.origin, normalized(exact.direction)});
        EXPECT_LT(length(traced.ray.origin - exact.point), 5e-12);
        EXPECT_LT(length(traced.ray.direction - exact.outwards), 5e-13);
        EXPECT_NEAR(traced.optical_path, exact.optical_path, 5e-12);
    }
}

// The patent's own focal length and back focus, to which odd terms add nothing, as another tracer gave them to a tenth
// of a micrometre.
TEST(OddAspheres, FirstOrderLeavesThemOut) {
    const optics::ParaxialData data = optics::paraxial_data(patent());
    EXPECT_NEAR(data.efl, 22.3718, 5e-5);
    EXPECT_NEAR(data.bfl, 13.7428, 5e-5);
}

}  // namespace lensproof::formats::odd_aspheres_test
