// Ideal lenses, gratings and kinoforms in the tracer, against what they are meant to do: points imaged to points over
// equal paths, the grating equation, Rowland's circle, and another program's rays.
#include "engine/optics/thin_element.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/dual_numbers.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"
#include "tests/complaint.h"

namespace lensproof::optics::thin_element_test {

constexpr double kWavelength_nm = 587.0;
constexpr double kFocal = 50.0;

StatedMedium medium(double n) {
    StatedMedium stated;
    if (n != 1.0) {
        stated.n_d = n;
    }
    return stated;
}

PrescribedSurface plane(double thickness_mm, double n = 1.0) {
    return {.thickness_mm = thickness_mm, .semi_diameter_mm = 40.0, .medium = medium(n)};
}

PrescribedSurface ideal(double focal_mm, double thickness_mm, double n = 1.0) {
    PrescribedSurface row = plane(thickness_mm, n);
    row.ideal_focal_length_mm = focal_mm;
    return row;
}

PrescribedSurface grating(double lines_per_mm, double order, double radius_mm, double thickness_mm) {
    PrescribedSurface row = plane(thickness_mm);
    row.radius_mm = radius_mm;
    row.phase = PhaseElement{.order = order, .lines_per_mm = lines_per_mm};
    return row;
}

Lens lens_of(std::vector<PrescribedSurface> surfaces, std::size_t stop = 0, double object_distance_mm = kInfinity) {
    Prescription prescription{.name = "thin", .surfaces = std::move(surfaces)};
    prescription.surfaces[stop].is_stop = true;
    prescription.object_distance_mm = object_distance_mm;
    prescription.wavelengths_nm = {kWavelength_nm};
    return make_lens(prescription, {});
}

TraceLens<double> traced(const Lens& lens) {
    return at_wavelength<double>(lens, kWavelength_nm);
}

/// From one point to another: the tracer's origin and unit direction.
Ray<double> ray_from_to(const Vec3d& from, const Vec3d& to) {
    return {from, normalized(to - from)};
}

/// The optical path to where the ray comes closest to the point.
double path_to(const TracedRay<double>& ray, const Vec3d& point, double index = 1.0) {
    return ray.optical_path + index * dot(point - ray.ray.origin, ray.ray.direction);
}

constexpr double kHeights[] = {-30.0, -7.0, 0.0, 1e-3, 20.0};

/// The lens behind a medium of another index than air's.
TraceLens<double> behind(double index, TraceLens<double> lens) {
    TraceSurface<double>& front = lens.surfaces.front();
    front.index_before = index;
    front.forward_ratio = index / front.index_after;
    front.reverse_ratio = front.index_after / index;
    return lens;
}

// A point at the distance s in front of a lens of power 1/f between two media is imaged to n'/s' = 1/f − n/s, magnified
// by −n s' / (n' s), by all rays at once and over one path: 1e-12 is some forty ulps of it, for as many operations with
// numbers of its size. Any point of the plane, 45° off the axis too.
TEST(IdealLens, ImagesAPlaneToAPlaneOverEqualPaths) {
    const double s = 120.0;
    for (const auto& [n, n_behind] : {std::pair(1.0, 1.0), std::pair(1.33, 1.0), std::pair(1.0, 1.5)}) {
        const double image = n_behind / (1.0 / kFocal - n / s);
        const TraceLens<double> lens = behind(n, traced(lens_of({ideal(kFocal, image, n_behind)}, 0, s)));
        const double magnification = -n * image / (n_behind * s);
        for (const double y : {0.0, 10.0, -s}) {
            const Vec3d point{3.0, y, -s};
            std::optional<double> first;
            for (const double height : kHeights) {
                const TracedRay<double> out = trace(lens, ray_from_to(point, {0.5 * height, 0.8 * height, 0.0}));
                ASSERT_EQ(out.status, RayStatus::ok);
                const PlanePoint<double> met = meet_plane(out.ray, image);
                EXPECT_NEAR(met.point.x, magnification * point.x, 1e-12 * s);
                EXPECT_NEAR(met.point.y, magnification * point.y, 1e-12 * s);
                const double path = out.optical_path + n_behind * met.distance;
                first = first.value_or(path);
                EXPECT_NEAR(path, *first, 1e-12 * path) << n << " " << n_behind << " " << y << " " << height;
                EXPECT_EQ(out.transmittance, 1.0);
            }
        }
    }
}

// Plane waves from any angle meet in f tan θ over paths that are equal from their wavefront on; and back.
TEST(IdealLens, FocusesPlaneWavesAtFTanTheta) {
    const TraceLens<double> lens = traced(lens_of({ideal(kFocal, kFocal)}));
    for (const double angle : {0.0, 0.3, -0.7, 1.4}) {
        const Vec3d along{0.0, std::sin(angle), std::cos(angle)};
        std::optional<double> first;
        for (const double height : kHeights) {
            // From the wavefront through the vertex, 100 mm before.
            const Vec3d on_lens{0.6 * height, height, 0.0};
            const Vec3d start = on_lens - (100.0 + dot(on_lens, along)) * along;
            const TracedRay<double> out = trace(lens, Ray<double>{start, along});
            const PlanePoint<double> met = meet_plane(out.ray, lens.image_z);
            EXPECT_NEAR(met.point.y, kFocal * std::tan(angle), 1e-13 * kFocal / std::cos(angle));
            EXPECT_NEAR(met.point.x, 0.0, 1e-13 * kFocal / std::cos(angle));
            const double path = out.optical_path + met.distance;
            first = first.value_or(path);
            EXPECT_NEAR(path, *first, 1e-13 * std::abs(path) + 1e-13 * kFocal / std::cos(angle));
            const TracedRay<double> back = trace<Direction::reverse>(lens, reverse_ray(met.point, out.ray.origin));
            EXPECT_NEAR(length(back.ray.direction + along), 0.0, 1e-14);
            EXPECT_NEAR(back.optical_path, path - (100.0 + dot(on_lens, along)), 1e-13 * path);
        }
    }
}

// Behind a mirror light runs against z, and a lens of positive focal length focuses it there too.
TEST(IdealLens, FocusesBehindAMirror) {
    PrescribedSurface mirror = plane(-20.0);
    mirror.is_mirror = true;
    const TraceLens<double> lens = traced(lens_of({mirror, ideal(kFocal, -kFocal)}));
    EXPECT_NEAR(paraxial_data(lens).efl, kFocal, 1e-14 * kFocal);
    std::optional<double> first;
    for (const double height : kHeights) {
        const TracedRay<double> out = trace(lens, Ray<double>{{height, 0.2 * height, -100.0}, {0.0, 0.0, 1.0}});
        const PlanePoint<double> met = meet_plane(out.ray, lens.image_z);
        EXPECT_NEAR(length(Vec2d{met.point.x, met.point.y}), 0.0, 1e-13 * kFocal);
        const double path = out.optical_path + lens.surfaces.back().index_after * met.distance;
        first = first.value_or(path);
        EXPECT_NEAR(path, *first, 1e-13 * path);
    }
}

// Two ideal lenses a distance d apart: 1/f = 1/f1 + 1/f2 − d / (f1 f2), back focus f (1 − d / f1) (Gauss), no Petzval
// sum, and the second sees the first's image, so that paths through both are equal too.
TEST(IdealLens, LensesAddUpAsGaussHasIt) {
    const double f1 = 80.0;
    const double f2 = -60.0;
    const double d = 30.0;
    const double f = 1.0 / (1.0 / f1 + 1.0 / f2 - d / (f1 * f2));
    const TraceLens<double> lens = traced(lens_of({ideal(f1, d), ideal(f2, f * (1.0 - d / f1))}));
    const ParaxialData data = paraxial_data(lens);
    EXPECT_NEAR(data.efl, f, 1e-14 * f);
    EXPECT_NEAR(data.bfl, f * (1.0 - d / f1), 1e-14 * f);
    EXPECT_TRUE(std::isinf(data.petzval_radius));
    std::optional<double> first;
    for (const double height : {-20.0, 5.0, 30.0}) {
        const TracedRay<double> out = trace(lens, Ray<double>{{height, 0.0, -10.0}, {0.0, 0.0, 1.0}});
        const PlanePoint<double> met = meet_plane(out.ray, lens.image_z);
        EXPECT_NEAR(met.point.x, 0.0, 1e-13 * f);
        first = first.value_or(out.optical_path + met.distance);
        EXPECT_NEAR(out.optical_path + met.distance, *first, 1e-12 * f);
    }
}

// Focusing tells the ideal lens where its object is: the sensor moves to 1/(1/f − 1/s), and paths are equal there.
TEST(IdealLens, IsFocusedWithItsObject) {
    const Lens focused = focused_at(lens_of({ideal(kFocal, kFocal)}), 200.0, kWavelength_nm);
    const TraceLens<double> lens = traced(focused);
    EXPECT_NEAR(lens.image_z, 1.0 / (1.0 / kFocal - 1.0 / 200.0), 1e-13 * kFocal);
    const double axial = 200.0 + lens.image_z;
    const TracedRay<double> out = trace(lens, ray_from_to({0.0, 0.0, -200.0}, {0.0, 25.0, 0.0}));
    EXPECT_NEAR(out.optical_path + meet_plane(out.ray, lens.image_z).distance, axial, 1e-13 * axial);
}

// d(image point) / d(slope) is f exactly, by numbers that carry derivatives.
TEST(IdealLens, CarriesDerivatives) {
    using Jet = ceres::Jet<double, 1>;
    const TraceLens<Jet> lens = convert_lens<Jet>(traced(lens_of({ideal(kFocal, kFocal)})));
    const Jet slope(0.4, 0);
    const Ray<Jet> ray{{Jet(2.0), Jet(3.0), Jet(0.0)}, normalized(Vec3<Jet>{Jet(0.0), slope, Jet(1.0)})};
    const TracedRay<Jet> out = trace(lens, ray);
    const Jet y = meet_plane(out.ray, lens.image_z).point.y;
    EXPECT_NEAR(y.a, kFocal * 0.4, 1e-13 * kFocal);
    EXPECT_NEAR(y.v[0], kFocal, 1e-13 * kFocal);
}

TEST(IdealLens, RefusesWhatIsNone) {
    const auto why = [](const PrescribedSurface& row) { return lensproof::complaint_about([&] { lens_of({row}); }); };
    PrescribedSurface curved = ideal(kFocal, kFocal);
    curved.radius_mm = 100.0;
    EXPECT_TRUE(says(why(curved), "expected a flat surface"));
    EXPECT_TRUE(says(why(ideal(0.0, kFocal)), "ideal_focal_length_mm"));
}

// The grating equation in space: along the lines nothing changes, across them n' sin θ' = n sin θ + m λ N, whatever the
// angle to the lines (conical diffraction; Born & Wolf, §8.6.1), and waves stay plane: paths from one wavefront to the
// other are equal. From both sides.
TEST(Grating, FollowsTheGratingEquation) {
    const double lines = 600.0;
    for (const double order : {-1.0, 0.0, 1.0, 2.0}) {
        const TraceLens<double> lens = traced(lens_of({grating(lines, order, kInfinity, 10.0)}));
        const double step = order * lines * kWavelength_nm * 1e-6;
        for (const Vec3d& along : {Vec3d{0.0, 0.0, 1.0}, normalized(Vec3d{0.2, -0.1, 0.9})}) {
            std::optional<double> first;
            for (const double height : kHeights) {
                const Vec3d on{0.3 * height, height, 0.0};
                const TracedRay<double> out = trace(lens, Ray<double>{on - (20.0 + dot(on, along)) * along, along});
                ASSERT_EQ(out.status, RayStatus::ok);
                EXPECT_NEAR(out.ray.direction.x, along.x, 1e-15);
                EXPECT_NEAR(out.ray.direction.y, along.y + step, 1e-15);
                EXPECT_NEAR(length(out.ray.direction), 1.0, 4e-16);
                const double to_wavefront = out.optical_path - dot(on, out.ray.direction);
                first = first.value_or(to_wavefront);
                EXPECT_NEAR(to_wavefront, *first, 1e-13);
                const TracedRay<double> back =
                    trace<Direction::reverse>(lens, Ray<double>{on + out.ray.direction, -1.0 * out.ray.direction});
                EXPECT_NEAR(length(back.ray.direction + along), 0.0, 1e-15);
            }
        }
    }
}

// Of orders that the grating equation gives no angle for, the status says so.
TEST(Grating, NamesEvanescentOrders) {
    const TraceLens<double> lens = traced(lens_of({grating(600.0, 3.0, kInfinity, 10.0)}));  // m λ N = 1.057
    const TracedRay<double> out = trace(lens, Ray<double>{{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}});
    EXPECT_EQ(out.status, RayStatus::evanescent);
    EXPECT_STREQ(status_name(out.status), "evanescent");
    EXPECT_EQ(out.surface, 0);
    EXPECT_FALSE(gets_through(out.status));
    const double tilted = -0.5;
    EXPECT_EQ(trace(lens, Ray<double>{{0.0, 0.0, -5.0}, {0.0, tilted, std::sqrt(1.0 - tilted * tilted)}}).status,
              RayStatus::ok);
}

// A concave reflection grating of radius R, lines at equal distances along its chord: light from a point on the circle
// of diameter R through its vertex comes to a focus on that circle (Rowland 1883; Beutler 1945), r' = R cos β. The
// coma term vanishes there, so that rays y off the vertex miss the focus by spherical aberration, (y/R)³ R at most.
TEST(Grating, FocusesOnRowlandsCircle) {
    const double R = 1000.0;
    PrescribedSurface concave = grating(300.0, 1.0, -R, -R);
    concave.is_mirror = true;
    const TraceLens<double> lens = traced(lens_of({concave}));
    const double alpha = 0.3;
    const double r = R * std::cos(alpha);
    const Vec3d source{0.0, -r * std::sin(alpha), -r * std::cos(alpha)};
    const double sin_beta = std::sin(alpha) + 300.0 * kWavelength_nm * 1e-6;
    const double cos_beta = std::sqrt(1.0 - sin_beta * sin_beta);
    const double out_r = R * cos_beta;
    const Vec3d focus{0.0, out_r * sin_beta, -out_r * cos_beta};
    const double path_at_vertex = r + out_r;
    for (const double y : {-10.0, -3.0, 0.0, 5.0, 10.0}) {
        const double sag = -y * y / (R + std::sqrt(R * R - y * y));
        const TracedRay<double> out = trace(lens, ray_from_to(source, {0.0, y, sag}));
        ASSERT_EQ(out.status, RayStatus::ok);
        const PlanePoint<double> met = meet_plane(out.ray, focus.z);
        const double off = std::pow(std::abs(y) / R, 3) * R;
        EXPECT_NEAR(met.point.y, focus.y, off + 1e-12 * R) << y;
        const double path = path_to(out, focus, lens.surfaces.back().index_after);
        EXPECT_NEAR(path, path_at_vertex, off * std::abs(y) / R + 1e-12 * R) << y;
    }
}

// Optiland's own tests hold it to these rays through a plate with 200 lines a mm on its rear, flat and curved (R = 50
// mm, k = 1; the lines equally spaced in projection), at 587 nm in the order −1: ten digits of each.
TEST(Grating, AgreesWithOptiland) {
    const auto rear = [](double radius_mm, double conic) {
        PrescribedSurface row = grating(200.0, -1.0, radius_mm, 30.0);
        row.conic = conic;
        return traced(lens_of({plane(5.0, 1.5168235484), row}, 1));  // N-BK7
    };
    const auto direction_of = [](const TraceLens<double>& lens, double y) {
        return trace(lens, Ray<double>{{0.0, y, -10.0}, {0.0, 0.0, 1.0}}).ray.direction;
    };
    EXPECT_NEAR(direction_of(rear(kInfinity, 0.0), 7.5).y, -0.1174, 1e-15);
    EXPECT_NEAR(direction_of(rear(kInfinity, 0.0), 7.5).z, 0.9930847094, 5e-11);
    EXPECT_NEAR(direction_of(rear(50.0, 1.0), 0.0).y, -0.1174, 1e-15);
    EXPECT_NEAR(direction_of(rear(50.0, 1.0), 7.5).y, -0.0379603895, 5e-11);
}

// A kinoform Σ c_i r^(2i) on a plane: with c_1 = −1/(2 f) and c_2 = 1 / (8 f³) it is the path f − √(f² + r²) to sixth
// order, and so focuses at f; in the order m at the wavelength λ at f λ₀ / (m λ) near the axis.
TEST(Kinoform, FocusesWhereItsPathsAreEqual) {
    PrescribedSurface row = plane(kFocal);
    row.phase = PhaseElement{.design_wavelength_nm = kWavelength_nm};
    row.phase->radial = {-0.5 / kFocal, 0.125 / std::pow(kFocal, 3)};
    const Lens lens = lens_of({row});
    const TraceLens<double> at_design = traced(lens);
    for (const double y : {0.5, 2.0, 5.0}) {
        const TracedRay<double> out = trace(at_design, Ray<double>{{0.0, y, -1.0}, {0.0, 0.0, 1.0}});
        const PlanePoint<double> met = meet_plane(out.ray, kFocal);
        const double left_out = std::pow(y / kFocal, 6) / 16.0 * kFocal;  // of the path
        EXPECT_NEAR(met.point.y, 0.0, 7.0 * left_out * kFocal / y + 1e-13);
        EXPECT_NEAR(path_to(out, {0.0, 0.0, kFocal}), 1.0 + kFocal, 1.1 * left_out + 1e-13);
    }
    EXPECT_NEAR(paraxial_data(at_design).efl, kFocal, 1e-14 * kFocal);
    EXPECT_NEAR(paraxial_data(at_wavelength<double>(lens, 450.0)).efl, kFocal * kWavelength_nm / 450.0, 1e-13 * kFocal);
}

TEST(Grating, IsNothingForWhatKnowsRefractionAlone) {
    const Lens lens = lens_of({grating(600.0, 1.0, kInfinity, 10.0)});
    EXPECT_TRUE(says(lensproof::complaint_about([&] { require_refraction_alone(lens, "a ghost"); }), "gratings"));
}

}  // namespace lensproof::optics::thin_element_test
