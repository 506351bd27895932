// Paraxial rays surface by surface against 50 digits, against Lagrange's invariant and against where they have to go.
#include "engine/analysis/paraxial_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::analysis::paraxial_rays_test {

using Rays = std::vector<RayAtSurface>;

optics::TraceLens<double> shipped(const char* name) {
    return optics::at_wavelength<double>(formats::load_lens(name), spectral::kLineD);
}

Rays marginal_ray(const optics::TraceLens<double>& lens, double object_distance = kInfinity) {
    return ray_at_surfaces(lens, optics::paraxial_marginal_ray(lens, object_distance).value());
}

Rays chief_ray(const optics::TraceLens<double>& lens, double field_deg) {
    return ray_at_surfaces(lens, optics::paraxial_chief_ray(lens, field_deg * kDegree).value());
}

// The Brendel Tessar at the d line, its full stop, 24°, by a tracer of 50 digits that shares nothing with this one.
// Its A = n i is listed, not i. Indices agree to 1e-12, which heights of 20 mm and slopes of 1 multiply by tens.
TEST(ParaxialRays, OfTheTessarAreThoseOfFiftyDigits) {
    struct Row {
        double y, u, A, y_chief, u_chief, A_chief;
    };
    constexpr std::array<Row, 8> kExpected = {
        {{18.32594979368111, -0.1742755036537243, 0.4264824248005844, -6.160211183118999, 0.32187497975185003,
          0.3018679409957831},
         {16.618049857874613, -0.2034992392382578, -0.538358926183279, -3.0058363815508686, 0.35381312454578295,
          0.5883637047635949},
         {16.190701455474272, -0.28622631141208454, -0.23346037002414854, -2.2628288200047244, 0.5439492355780587,
          0.536574614211859},
         {15.0, -0.28622631141208454, -0.28622631141208454, 0.0, 0.5439492355780587, 0.5439492355780587},
         {13.855094754351661, -0.08301827386947971, -0.5208198561860713, 2.175796942312235, 0.3460908397559427,
          0.5071087861653897},
         {13.699850582215735, 0.07801675109648468, 0.41273091142425733, 2.8229868126558477, 0.6116474587000394,
          0.6806185511177245},
         {14.529948813882331, 0.013853666041148188, 0.15701821267696714, 9.330915773224268, 0.3409756129677452,
          0.6623810155357521},
         {14.627617159472427, -0.18323287175259023, -0.4823049870556454, 11.734793844646871, 0.4108009180565909,
          0.17087464848703718}}};
    constexpr double kTolerance = 1e-10;
    const optics::TraceLens<double> lens = shipped("tessar");
    const Rays marginal = marginal_ray(lens);
    const Rays chief = chief_ray(lens, 24.0);
    ASSERT_EQ(marginal.size(), kExpected.size());
    for (std::size_t i = 0; i < kExpected.size(); ++i) {
        SCOPED_TRACE(i + 1);
        const Row& row = kExpected[i];
        const double n = lens.surfaces[i].index_before;
        EXPECT_NEAR(marginal[i].height, row.y, kTolerance);
        EXPECT_NEAR(marginal[i].slope, row.u, kTolerance);
        EXPECT_NEAR(n * marginal[i].incidence, row.A, kTolerance);
        EXPECT_NEAR(chief[i].height, row.y_chief, kTolerance);
        EXPECT_NEAR(chief[i].slope, row.u_chief, kTolerance);
        EXPECT_NEAR(n * chief[i].incidence, row.A_chief, kTolerance);
    }
}

constexpr const char* kLenses[] = {"tessar", "petzval", "triplet-cooke", "double-gauss-lowenthal", "muller-fisheye"};

// n (y ū − ȳ u) is the same in every space, and by i = u + c y so is n (y ī − ȳ i) at every surface. The terms of the
// difference are some times the invariant, and each surface rounds a few times.
TEST(ParaxialRays, KeepLagrangesInvariantAtEverySurface) {
    for (const char* name : kLenses) {
        const optics::TraceLens<double> lens = shipped(name);
        const double invariant = optics::lagrange_invariant(lens, 10.0 * kDegree).value();
        for (const double object_distance : {kInfinity, 500.0}) {
            const Rays marginal = marginal_ray(lens, object_distance);
            const Rays chief = chief_ray(lens, 10.0);
            for (std::size_t i = 0; i < marginal.size(); ++i) {
                SCOPED_TRACE(testing::Message() << name << ", surface " << i + 1);
                const RayAtSurface& m = marginal[i];
                const RayAtSurface& c = chief[i];
                EXPECT_NEAR(lens.surfaces[i].index_before * (m.height * c.incidence - c.height * m.incidence),
                            invariant, 1e-12 * std::abs(invariant));
                EXPECT_NEAR(lens.surfaces[i].index_after * (m.height * c.slope - c.height * m.slope), invariant,
                            1e-12 * std::abs(invariant));
            }
        }
    }
}

// The marginal ray meets the stop's edge and ends in the image point on the axis, the chief ray crosses the stop's
// centre; lengths of some hundred mm, rounded some tens of times.
TEST(ParaxialRays, GoThroughTheStopAndToTheImage) {
    for (const char* name : kLenses) {
        SCOPED_TRACE(name);
        const optics::TraceLens<double> lens = shipped(name);
        const auto stop = static_cast<std::size_t>(
            std::ranges::find_if(lens.surfaces, &optics::TraceSurface<double>::is_stop) - lens.surfaces.begin());
        const Rays marginal = marginal_ray(lens, 1000.0);
        EXPECT_NEAR(std::abs(marginal[stop].height), std::sqrt(lens.surfaces[stop].semi_diameter_squared), 1e-12);
        EXPECT_NEAR(marginal.back().height + marginal.back().slope * optics::paraxial_image_distance(lens, 1000.0), 0.0,
                    1e-11);
        EXPECT_NEAR(chief_ray(lens, 10.0)[stop].height, 0.0, 1e-12);
    }
}

}  // namespace lensproof::analysis::paraxial_rays_test
