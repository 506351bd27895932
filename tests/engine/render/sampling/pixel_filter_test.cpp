#include "engine/render/sampling/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::render::pixel_filter_test {

constexpr int kSteps = 256 * 1024;  // a multiple of the parts that draws are even within

// Midpoint sums of 2.6e5 steps of smooth pieces: exact to better than 1e-6.
TEST(PixelFilter, HasIntegralOneAndDrawsFollowIt) {
    for (const std::string& name : PixelFilter::known_names()) {
        const PixelFilter filter = PixelFilter::named(name);
        double integral = 0.0;
        double second_moment = 0.0;
        const double step = 2.0 * filter.radius_px() / kSteps;
        for (int i = 0; i < kSteps; ++i) {
            const double x = (i + 0.5) * step - filter.radius_px();
            integral += filter(x) * step;
            second_moment += x * x * filter(x) * step;
        }
        EXPECT_NEAR(integral, 1.0, 1e-6) << name;
        // Weighted draws, evenly over their number, have the same moments, whatever pdf they are drawn with.
        double weight = 0.0;
        double first_drawn = 0.0;
        double second_drawn = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            const auto [offset, of_draw] = filter.draw((i + 0.5) / kSteps);
            EXPECT_LE(std::abs(offset), filter.radius_px());
            weight += of_draw / kSteps;
            first_drawn += of_draw * offset / kSteps;
            second_drawn += of_draw * offset * offset / kSteps;
        }
        EXPECT_NEAR(weight, 1.0, 1e-6) << name;
        EXPECT_NEAR(first_drawn, 0.0, 1e-6) << name;
        EXPECT_NEAR(second_drawn, second_moment, 1e-6) << name;
    }
}

// Closed forms: a box's variance is 1/12, a tent's 1/6, Mitchell's 1/9 (film_test.cpp says why). Published values: the
// cubic at its centre is (6 − 2B)/6 = 8/9, at ±1 B/6 = 1/18; the window's sum is a0 per unit of its length.
TEST(PixelFilter, HasTheShapesThatItsNamesSay) {
    EXPECT_NEAR(PixelFilter::named("mitchell")(0.0), 8.0 / 9.0, 1e-12);
    EXPECT_NEAR(PixelFilter::named("mitchell")(-1.0), 1.0 / 18.0, 1e-12);
    EXPECT_NEAR(PixelFilter::named("tent")(0.25), 0.75, 1e-12);
    EXPECT_NEAR(PixelFilter::named("blackman-harris")(0.0), 1.0 / (0.35875 * 3.0), 1e-12);
    EXPECT_NEAR(PixelFilter::named("gaussian")(0.5) / PixelFilter::named("gaussian")(0.0),
                (std::exp(-0.5) - std::exp(-4.5)) / (1.0 - std::exp(-4.5)), 1e-12);
    EXPECT_LT(PixelFilter::named("mitchell").draw(0.01).weight, 0.0) << "in a negative lobe";
    EXPECT_THROW(PixelFilter::named("lanczos"), InputError);
}

}  // namespace lensproof::render::pixel_filter_test
