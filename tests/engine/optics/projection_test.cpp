// Projections: alike near the axis, and beyond 90 degrees where they go so far.
#include "engine/optics/projection.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lensproof::optics::projection_test {

TEST(Projections, AgreeNearTheAxisAndHoldBeyondNinetyDegrees) {
    for (const Projection projection : {Projection::rectilinear, Projection::equidistant, Projection::equisolid,
                                        Projection::stereographic, Projection::orthographic}) {
        EXPECT_NEAR(projected_radius(projection, 1e-4), 1e-4, 1e-12) << projection_name(projection);
    }
    EXPECT_DOUBLE_EQ(projected_radius(Projection::equidistant, 2.0), 2.0);
    EXPECT_DOUBLE_EQ(projected_radius(Projection::equisolid, 2.0), 2.0 * std::sin(1.0));
}

}  // namespace lensproof::optics::projection_test
