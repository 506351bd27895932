// Spots whose sizes have closed forms, and how fast the sums over them converge.
#include "engine/analysis/spot.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/analysis/ray_fan.h"
#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_lens.h"

namespace lensproof::analysis::spot_test {

struct Subject {
    optics::Lens lens;
    optics::TraceLens<double> traced;
    optics::FieldBundle bundle;
    optics::RegionOutline outline;

    Subject(optics::Lens whole, double field, double object_distance = kInfinity)
        : lens(std::move(whole)), traced(optics::at_wavelength<double>(lens, spectral::kLineD)) {
        const optics::ChiefRays rays(lens, spectral::kLineD, optics::Rims::follow);
        bundle = optics::field_bundle(rays, field, object_distance).value();
        outline = beam_outline(traced, bundle);
    }

    [[nodiscard]] std::vector<SpotRay> spot(int rings) const { return spot_rays(traced, bundle, outline, rings); }
};

/// A stop of radius 3 mm, alone, 50 mm in front of the sensor.
optics::Lens bare_stop() {
    return made_of({{.thickness_mm = 50.0, .semi_diameter_mm = 3.0, .is_stop = true}});
}

/// An ellipsoid of conic constant −1/n² that focuses parallel light in its glass, and a sphere about the focus that the
/// light leaves through without being bent (Born & Wolf §4.2.2). The sensor stands `defocus` behind the focus.
constexpr double kIndex = 1.6;
constexpr double kRadius = 30.0;
constexpr double kFocus = kIndex * kRadius / (kIndex - 1.0);  // 80 mm behind the vertex
optics::Lens ellipsoid(double defocus) {
    constexpr double kThickness = 50.0;
    optics::PrescribedSurface front{.radius_mm = kRadius,
                                    .conic = -1.0 / (kIndex * kIndex),
                                    .thickness_mm = kThickness,
                                    .semi_diameter_mm = 12.0,
                                    .medium = {.n_d = kIndex}};
    const optics::PrescribedSurface rear{
        .radius_mm = kFocus - kThickness, .thickness_mm = kFocus - kThickness + defocus, .semi_diameter_mm = 15.0};
    return made_of({{.semi_diameter_mm = 10.0, .is_stop = true}, front, rear});
}

// A disc's shadow: parallel light casts the stop's own disc, rms radius a / √2, in whatever direction it goes; from a
// point at D it is (D + L) / D as large. Two rings are exact, sums of polynomials of degree 2.
TEST(Spot, ShadowOfAStop) {
    for (const double field : {0.0, 0.3, 1.2}) {
        for (const int rings : {2, 7}) {
            const SpotSize far = spot_size(Subject(bare_stop(), field).spot(rings));
            EXPECT_NEAR(far.rms, 3.0 / std::sqrt(2.0), 1e-12) << field;
            EXPECT_NEAR(far.centroid.x, 0.0, 1e-14);
            EXPECT_NEAR(far.centroid.y, 50.0 * std::tan(field), 1e-11);
            EXPECT_NEAR(far.max_radius, 3.0, 0.01);  // the outline's points, 30 of them or more
        }
    }
    const SpotSize near = spot_size(Subject(bare_stop(), 0.0, 20.0).spot(2));
    EXPECT_NEAR(near.rms, 3.0 * (70.0 / 20.0) / std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(near.max_radius, 3.0 * (70.0 / 20.0), 1e-11);
}

// A perfect focus is a point to the rounding of 80 mm.
TEST(Spot, EllipsoidHasAPerfectFocus) {
    const SpotSize size = spot_size(Subject(ellipsoid(0.0), 0.0).spot(8));
    EXPECT_LT(size.rms, 1e-13);
    EXPECT_LT(size.max_radius, 1e-13);
}

// Out of focus by δ, a ray is δ tan U' off, where it heads for the focus from the surface: tan U' = h / (F − z(h)). The
// mean of its square over the stop's disc, by Simpson's rule. The best focus is the focus itself. And every plane is
// reached from the rays of one.
TEST(Spot, DefocusOfAPerfectFocus) {
    constexpr double kStop = 10.0;
    constexpr int kIntervals = 200;
    constexpr double kConic = -1.0 / (kIndex * kIndex);
    double mean = 0.0;
    for (int i = 0; i <= kIntervals; ++i) {
        const double u = kStop * kStop * i / kIntervals;  // h², in which a disc is even
        const double sag = u / kRadius / (1.0 + std::sqrt(1.0 - (1.0 + kConic) * u / (kRadius * kRadius)));
        const double weight = (i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) / (3.0 * kIntervals);
        mean += weight * u / ((kFocus - sag) * (kFocus - sag));
    }
    for (const double defocus : {-0.5, 0.02, 1.0}) {
        const std::vector<SpotRay> rays = Subject(ellipsoid(defocus), 0.0).spot(8);
        EXPECT_NEAR(spot_size(rays).rms, std::abs(defocus) * std::sqrt(mean), 1e-12);
        EXPECT_LT(spot_size(rays, -defocus).rms, 1e-13);
        for (const double plane : {-1.0, 1.0}) {
            EXPECT_NEAR(spot_size(rays, plane).rms, std::abs(defocus + plane) * std::sqrt(mean), 1e-12);
        }
    }
}

// Sums over the beam of a real lens, on the axis and far off it with rims' corners in the outline: the rms at
// `kSpotRings` is that at twice as many to 1e-9 mm, in spots of up to 0.15 mm.
TEST(Spot, ConvergesWithTheRings) {
    for (const char* name : {"tessar", "double-gauss-angenieux", "muller-fisheye", "canon-ef-s-24"}) {
        const optics::Lens lens = formats::load_lens(name);
        const double largest = optics::ChiefRays(lens, spectral::kLineD).largest_field();
        for (const double fraction : {0.0, 0.5, 0.9}) {
            const Subject subject(lens, fraction * largest);
            const SpotSize coarse = spot_size(subject.spot(kSpotRings));
            const SpotSize fine = spot_size(subject.spot(2 * kSpotRings));
            EXPECT_NEAR(coarse.rms, fine.rms, 1e-9) << name << fraction;
            EXPECT_NEAR(coarse.centroid.y, fine.centroid.y, 1e-9) << name << fraction;
            EXPECT_GT(fine.rms, 1e-4);
        }
    }
}

// Around the outline they have converged as well: turned about its own axis by 33°, the lens is the same, but the nodes
// lie elsewhere, and in four quarters instead of two.
TEST(Spot, HasConvergedInAzimuth) {
    optics::Prescription prescription = formats::read_prescription(formats::find_lens_file("tessar"));
    const double field = 0.3;
    const SpotSize straight = spot_size(Subject(formats::load_lens("tessar"), field).spot(kSpotRings));
    prescription.groups = {{.first = 1,
                            .last = static_cast<int>(prescription.surfaces.size()),
                            .misalignment = {.tilt_deg = {0.0, 0.0, 33.0}}}};
    const Subject turned(optics::make_lens(prescription, formats::shipped_glasses()), field);
    EXPECT_FALSE(turned.outline.is_half);
    const SpotSize size = spot_size(turned.spot(kSpotRings));
    EXPECT_NEAR(size.rms, straight.rms, 1e-9);
    EXPECT_NEAR(size.centroid.y, straight.centroid.y, 1e-9);
    EXPECT_NEAR(size.centroid.x, 0.0, 1e-9);
}

// From rim to rim: the outermost rays pass, those a little further out do not; the middle ray of an odd count on the
// axis is the chief ray. Parallel light through a bare stop: the error is the offset, on the oblique plane.
TEST(RayFan, RunsFromRimToRim) {
    const optics::Lens lens = formats::load_lens("tessar");
    for (const double field : {0.0, 0.2, 0.4}) {
        const Subject subject(lens, field);
        for (const FanPlane plane : {FanPlane::tangential, FanPlane::sagittal}) {
            const std::vector<FanPoint> fan =
                ray_fan(subject.traced, subject.bundle, subject.outline, plane, subject.bundle.chief.image_point, 21);
            ASSERT_EQ(fan.size(), 21U);
            const auto status = [&](double offset) {
                const Vec2d at = plane == FanPlane::tangential ? Vec2d{0.0, offset} : Vec2d{offset, 0.0};
                return optics::trace(subject.traced, subject.bundle.ray(at)).status;
            };
            for (const FanPoint& end : {fan.front(), fan.back()}) {
                EXPECT_EQ(status((1.0 - 1e-12) * end.offset), optics::RayStatus::ok);
                EXPECT_NE(status((1.0 + 1e-12) * end.offset), optics::RayStatus::ok);
            }
            EXPECT_EQ(std::max(fan.back().pupil, -fan.front().pupil), 1.0);
            if (plane == FanPlane::sagittal) {  // symmetric: x errors odd, y errors even
                EXPECT_NEAR(fan.front().error.x, -fan.back().error.x, 1e-11);
                EXPECT_NEAR(fan.front().error.y, fan.back().error.y, 1e-11);
            }
        }
    }
    const Subject shadow(bare_stop(), 0.5);
    const Vec2d reference = shadow.bundle.chief.image_point;
    for (const FanPoint& point :
         ray_fan(shadow.traced, shadow.bundle, shadow.outline, FanPlane::tangential, reference, 5)) {
        EXPECT_NEAR(point.error.y, point.offset / std::cos(0.5), 1e-13);
        EXPECT_NEAR(point.error.y, 3.0 * point.pupil, 1e-12);
    }
}

// A beam whose chief ray is clipped has its meridional fan where the light is.
TEST(RayFan, BesideAClippedChiefRay) {
    const Subject subject(formats::load_lens("muller-fisheye"), radians(76.0));
    ASSERT_NE(subject.bundle.chief.status, optics::RayStatus::ok);
    ASSERT_GT(subject.outline.area, 0.0);
    const auto fan = ray_fan(subject.traced, subject.bundle, subject.outline, FanPlane::tangential, {}, 11);
    ASSERT_EQ(fan.size(), 11U);
    for (std::size_t i = 1; i + 1 < fan.size(); ++i) {
        EXPECT_EQ(optics::trace(subject.traced, subject.bundle.ray({0.0, fan[i].offset})).status,
                  optics::RayStatus::ok);
    }
    EXPECT_TRUE(ray_fan(subject.traced, subject.bundle, subject.outline, FanPlane::sagittal, {}, 11).empty());
}

}  // namespace lensproof::analysis::spot_test
