// The tracer's formulas where others lose their digits: against themselves in a hundred digits, and against closed
// forms.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/base/input_error.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"
#include "engine/optics/multiprecision.h"

namespace lensproof::optics::extreme_optics_test {

using Exact = Multiprecision;

constexpr double kUlp = std::numeric_limits<double>::epsilon();
constexpr double kWide = 1e6;

/// (curvature, vertex z, index behind), in air.
struct Row {
    double curvature;
    double z;
    double index_after;
};

TraceLens<double> lens_of(const std::vector<Row>& rows, double index_before = 1.0) {
    TraceLens<double> lens{.surfaces = {}, .image_z = 100.0};
    for (const Row& row : rows) {
        lens.surfaces.push_back(make_trace_surface(row.curvature, row.z, kWide, index_before, row.index_after, false));
        index_before = row.index_after;
    }
    return lens;
}

TracedRay<Exact> exact_trace(const TraceLens<double>& lens, const Ray<double>& ray) {
    return trace(convert_lens<Exact>(lens), convert_ray<Exact>(ray));
}

double distance(const Vec3d& a, const Vec3<Exact>& b) {
    return static_cast<double>(length(convert_vector<Exact>(a) - b));
}

// The same numbers in a hundred digits: nothing is rounded, and what follows from them follows in a hundred digits.
TEST(ConvertLens, KeepsEveryNumberAndFormsTheRestAnew) {
    const TraceLens<double> lens = at_wavelength<double>(formats::load_lens("tessar"), 550.0);
    const TraceLens<Exact> exact = convert_lens<Exact>(lens);
    ASSERT_EQ(exact.surfaces.size(), lens.surfaces.size());
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        const TraceSurface<double>& from = lens.surfaces[i];
        const TraceSurface<Exact>& to = exact.surfaces[i];
        EXPECT_EQ(to.curvature, Exact(from.curvature));
        EXPECT_EQ(to.vertex_z, Exact(from.vertex_z));
        EXPECT_EQ(to.index_after, Exact(from.index_after));
        EXPECT_LT(abs(to.forward_ratio * to.index_after - to.index_before), Exact("1e-98"));
        EXPECT_EQ(to.is_stop, from.is_stop);
        // A semi-diameter of the file, whose square no double holds.
        const double semi_diameter = formats::load_lens("tessar").surfaces[i].semi_diameter;
        EXPECT_EQ(to.semi_diameter_squared, Exact(semi_diameter) * Exact(semi_diameter));
    }
    const TraceLens<double> back = convert_lens<double>(exact);
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        EXPECT_EQ(back.surfaces[i].semi_diameter_squared, lens.surfaces[i].semi_diameter_squared);
        EXPECT_EQ(back.surfaces[i].forward_ratio, lens.surfaces[i].forward_ratio);
    }
}

// At both ends of its range every glass that ships has an index, real and above 1; and those of Sellmeier's formula
// have it to what rounding the wavelength and one addition of numbers of size n² leave, a few ulps, near the resonances
// too.
TEST(ExtremeOptics, GlassFormulasHoldAtTheEndsOfTheirRanges) {
    int sellmeier = 0;
    const GlassCatalogue& catalogue = formats::shipped_glasses();
    for (const Glass& glass : catalogue.glasses()) {
        for (const double nm : {glass.min_wavelength_nm, glass.max_wavelength_nm}) {
            const double index = refractive_index(glass.formula, nm);
            EXPECT_TRUE(index > 1.0 && index < 5.0) << glass.name << " at " << nm << " nm: " << index;
            const auto* formula = std::get_if<Sellmeier>(&glass.formula);
            if (formula == nullptr) {
                continue;
            }
            const Exact um2 = Exact(nm) * Exact(nm) / Exact(1000000);
            Exact n2 = Exact(1) + Exact(formula->constant);
            double amplified = 1.0;  // Σ of what each term makes of the relative error of λ²
            for (const Sellmeier::Term& term : formula->terms) {
                const Exact part = Exact(term.b) * um2 / (um2 - Exact(term.c));
                n2 += part;
                amplified += std::abs(static_cast<double>(part * um2 / (um2 - Exact(term.c))));
            }
            EXPECT_NEAR(index, static_cast<double>(sqrt(n2)), 4 * kUlp * amplified / index) << glass.name;
            ++sellmeier;
        }
    }
    EXPECT_GT(sellmeier, 500);
}

// From a point on the axis, however far, the ray's height and slope at the lens are known to an ulp, and so is where it
// meets a sphere.
TEST(ExtremeOptics, AFarObjectOnTheAxisLosesNothing) {
    const TraceLens<double> sphere = lens_of({{1.0 / 12.0, 0.0, 1.5}});
    for (double distance_mm = 1e2; distance_mm < 2e15; distance_mm *= 10.0) {
        for (const double height : {1.0, 4.3, 8.9}) {
            const Ray<double> ray{{0.0, 0.0, -distance_mm}, normalized(Vec3d{0.0, height / distance_mm, 1.0})};
            const TracedRay<double> traced = trace(sphere, ray);
            const TracedRay<Exact> exact = exact_trace(sphere, ray);
            EXPECT_LT(distance(traced.ray.origin, exact.ray.origin), 20 * kUlp * 12.0) << distance_mm;
            EXPECT_LT(distance(traced.ray.direction, exact.ray.direction), 10 * kUlp) << distance_mm;
        }
    }
}

// At exactly 90° from the axis d_z is a zero of either sign, and light at the height z meets a dome of radius R at
// y = −√(R² − (R − z)²) under cos i = |y| / R.
TEST(ExtremeOptics, LightAt90DegreesMeetsTheFrontOfADome) {
    constexpr double kRadius = 10.0;
    for (const double zero : {0.0, -0.0}) {
        for (const double z : {0.5, 3.0, 9.0}) {
            const Intersection<double> met =
                intersect(Vec3d{0.0, -100.0, z}, Vec3d{0.0, 1.0, zero}, 1.0 / kRadius, 1.0);
            ASSERT_TRUE(met.hit);
            const double y = std::sqrt(kRadius * kRadius - (kRadius - z) * (kRadius - z));
            EXPECT_NEAR(met.point.y, -y, 40 * kUlp * 100.0);
            EXPECT_NEAR(met.cos_incidence, y / kRadius, 40 * kUlp);
        }
    }
}

// Near the critical angle cos² i' = 1 − μ² sin² i. With sin² i formed from the sine it is good to a few ulps of 1 for
// μ = 4; from the cosine it would be 16 times as bad.
TEST(ExtremeOptics, TheCriticalAngleOfAHighIndexKeepsItsDigits) {
    const TraceLens<double> exit = lens_of({{0.0, 0.0, 1.0}}, 4.0);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> below(1e-6, 1e-4);
    double worst = 0.0;
    for (int i = 0; i < 200; ++i) {
        const double sine = 0.25 * (1.0 - below(random));
        const Ray<double> ray{{0.0, 0.0, -1.0}, {0.0, sine, std::sqrt(1.0 - sine * sine)}};
        const TracedRay<double> traced = trace(exit, ray);
        ASSERT_EQ(traced.status, RayStatus::ok);
        // Without the exact ray's normalisation: sin i is the number given.
        const Exact cos2 = Exact(1) - Exact(16) * Exact(sine) * Exact(sine);
        const Exact found(traced.ray.direction.z);
        worst = std::max(worst, std::abs(static_cast<double>(found * found - cos2)));
    }
    EXPECT_LT(worst, 2.5 * kUlp);
}

// Snell's invariant n (d × n̂) and the direction's length, near grazing incidence on a sphere and on a flat. The point,
// and with it the normal, is known to an ulp over cos i.
TEST(ExtremeOptics, SnellsInvariantHoldsUpToGrazing) {
    constexpr double kIndex = 1.7;
    for (const double curvature : {0.0, 0.1}) {
        const TraceLens<double> surface = lens_of({{curvature, 0.0, kIndex}});
        for (double grazing = 1e-1; grazing > 1e-7; grazing *= 0.1) {
            // On the sphere at the height R (1 − g² / 2), parallel to the axis; on the flat at the angle g.
            const double height = (1.0 - 0.5 * grazing * grazing) / 0.1;
            const Ray<double> ray = curvature > 0.0
                                        ? Ray<double>{{0.0, height, -3.0}, {0.0, 0.0, 1.0}}
                                        : Ray<double>{{0.0, 0.0, -grazing}, normalized(Vec3d{0.0, 1.0, grazing})};
            const TracedRay<double> out = trace(surface, ray);
            ASSERT_EQ(out.status, RayStatus::ok);
            const Vec3d& p = out.ray.origin;
            const Vec3d normal = normalized(Vec3d{-curvature * p.x, -curvature * p.y, 1.0 - curvature * p.z});
            const Vec3d before = cross(ray.direction, normal);
            const Vec3d after = kIndex * cross(out.ray.direction, normal);
            EXPECT_NEAR(length(before - after), 0.0, 16 * kUlp + 4 * kUlp * kUlp / (grazing * grazing));
            EXPECT_NEAR(length(out.ray.direction), 1.0, 8 * kUlp);
        }
    }
}

// |d'|² − 1 = μ² (|d|² − 1): over many surfaces the errors add up and do not grow.
TEST(ExtremeOptics, DirectionsStayUnitVectorsOver200Surfaces) {
    std::vector<Row> rows;
    rows.reserve(200);
    for (int i = 0; i < 200; ++i) {
        rows.push_back({(i % 3 - 1) / 80.0, 0.5 * i, i % 2 == 0 ? 1.7 : 1.0});
    }
    const TracedRay<double> out =
        trace(lens_of(rows), Ray<double>{{0.0, 2.0, -5.0}, normalized(Vec3d{0.01, 0.03, 1.0})});
    ASSERT_EQ(out.status, RayStatus::ok);
    EXPECT_NEAR(length(out.ray.direction), 1.0, 200 * kUlp);
}

// The little light that passes near grazing is known to ulps of itself, against a hundred digits; equal indices pass
// all of it, and cosines whose product no double holds divide no 0 by 0.
TEST(ExtremeOptics, FresnelKeepsTheDigitsOfGrazingLight) {
    for (double cosine = 1.0; cosine > 1e-150; cosine *= 1e-5) {
        const double cos_inside = std::sqrt((1.5 - 1.0) * (1.5 + 1.0) + cosine * cosine) / 1.5;
        const double found = fresnel_transmittance(1.0 / 1.5, cosine, cos_inside).value();
        const auto exact = static_cast<double>(
            fresnel_transmittance<Exact>(Exact(1) / Exact(1.5), Exact(cosine), Exact(cos_inside)).value());
        EXPECT_NEAR(found, exact, 12 * kUlp * exact) << cosine;
    }
    for (const double cosine : {1.0, 0.3, 1e-9, 1e-100, 1e-161, 5e-300}) {
        EXPECT_EQ(fresnel_transmittance(1.5 / 1.5, cosine, cosine).value(), 1.0) << cosine;
    }
    EXPECT_EQ(fresnel_transmittance(1.0F / 1.0F, 1e-22F, 1e-22F).value(), 1.0F);
}

/// What `count` surfaces leave of light that grazes each, between indices as near to each other as numbers are, over
/// the power of one.
template <class T>
double left_by_grazed(int count) {
    const T epsilon = std::numeric_limits<T>::epsilon();
    const T ratio = T(1) - epsilon;
    const T cosine = std::sqrt(epsilon);
    const auto one = fresnel_transmittance(ratio, cosine, std::sqrt(ratio * ratio * cosine * cosine + T(2) * epsilon));
    LeftBySurfaces<T> left;
    for (int i = 0; i < count; ++i) {
        left.pass(one);
        left.end_surface();
    }
    return static_cast<double>(left.value()) / std::pow(static_cast<double>(one.value()), count);
}

// The fraction of what surfaces leave keeps its range in float and in double: each step rounds by some ulps.
TEST(ExtremeOptics, ManyGrazedSurfacesLeaveWhatEachLeaves) {
    for (const int count : {1, 2, 7, 8, 9, 60}) {
        EXPECT_NEAR(left_by_grazed<float>(count), 1.0, 4.0 * count * std::numeric_limits<float>::epsilon()) << count;
        EXPECT_NEAR(left_by_grazed<double>(count), 1.0, 4.0 * count * std::numeric_limits<double>::epsilon()) << count;
    }
}

/// A conic in glass of 1.5, as a special surface.
TraceLens<double> conic_lens(double curvature, double conic) {
    TraceLens<double> lens = lens_of({{curvature, 0.0, 1.5}});
    SpecialSurface<double> special;
    special.has_shape = true;
    special.shape = {.curvature = curvature, .conic = conic};
    lens.specials.push_back(special);
    lens.surfaces.front().special = 0;
    return lens;
}

// Conic constants of a million: slanted rays onto an ellipsoid 20 µm across, and onto a hyperboloid that is nearly a
// cone. The ray's numbers are of size 5 mm, and its point is known to a few ulps of that. The conic's normal turns by
// c (1 + k) times an error of the point along the axis, which for an ellipsoid is that of numbers of the size of its r.
TEST(ExtremeOptics, ConicConstantsOfAMillionKeepTheirDigits) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const double conic : {1e6, 1e4, -1e4, -1e6}) {
        const TraceLens<double> lens = conic_lens(0.1, conic);
        const double reach = conic > 0.0 ? 7.0 / std::sqrt(conic) : 5.0;
        int met = 0;
        for (int i = 0; i < 200; ++i) {
            const Vec3d direction = normalized(Vec3d{unit(random), unit(random), 1.0});
            const Vec3d aim{reach * unit(random), reach * unit(random), 0.0};
            const Ray<double> ray{aim - direction, direction};
            const TracedRay<double> traced = trace(lens, ray);
            const TracedRay<Exact> exact = exact_trace(lens, ray);
            ASSERT_EQ(traced.status, exact.status) << conic;
            if (traced.status == RayStatus::ok) {
                ++met;
                EXPECT_LT(distance(traced.ray.origin, exact.ray.origin), 8 * kUlp * 5.0) << conic;
            }
        }
        EXPECT_GT(met, 50) << conic;
    }
}

// A point of an asphere or a toroid that a ray comes to from in front is found, though the ray comes within a degree of
// a right angle to the axis, where it meets the vertex's plane and the conic far away or not at all.
TEST(ExtremeOptics, ShapesAreFoundByRaysFromTheSide) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const bool is_toroid : {false, true}) {
        int asked = 0;
        int missed = 0;
        while (asked < 1000) {
            SurfaceShape<double> shape{.curvature = unit(random) / 20.0, .conic = 2.0 * unit(random)};
            if (is_toroid) {
                shape.is_toroid = true;
                shape.curvature_x = unit(random) / 15.0;
            } else {
                shape.terms = 4;
                shape.asphere = {0.0, 3e-4 * unit(random), 3e-6 * unit(random), 3e-8 * unit(random)};
            }
            const double x = 6.0 * unit(random);
            const double y = 6.0 * unit(random);
            const double z = sag(shape, x, y);
            const double angle = 1.4 + 0.15 * unit(random);
            const double turn = 3.14 * unit(random);
            const Vec3d direction{std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)};
            const Implicit<double> at = implicit_surface(shape, Vec3d{x, y, z});
            if (!std::isfinite(z) || !(dot(at.gradient, direction) > 0.01 * length(at.gradient))) {
                continue;  // no surface there, or met from behind, or nearly touched
            }
            ++asked;
            const Vec3d from = Vec3d{x, y, z} - 30.0 * direction;
            const auto [met, normal] = intersect(shape, from, direction, 1.0);
            missed += met.hit ? 0 : 1;
            if (met.hit) {
                EXPECT_NEAR(implicit_surface(shape, met.point).value, 0.0, 1e-11);
                EXPECT_GT(dot(normal, direction), 0.0);
            }
        }
        EXPECT_EQ(missed, 0) << (is_toroid ? "toroid" : "asphere");
    }
}

TEST(ExtremeOptics, AClosedStopStopsTheAxisToo) {
    TraceLens<double> lens = lens_of({{0.0, 0.0, 1.0}});
    lens.surfaces.front() = make_trace_surface(0.0, 0.0, 0.0, 1.0, 1.0, true);
    const Ray<double> axis{{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}};
    EXPECT_EQ(trace(lens, axis).status, RayStatus::stopped);
    EXPECT_EQ(exact_trace(lens, axis).status, RayStatus::stopped);
}

// A ray on a rim of 5 mm at (3, 4) passes, the next double beyond is clipped.
TEST(ExtremeOptics, ARayOnTheRimPasses) {
    TraceLens<double> lens = lens_of({{0.0, 0.0, 1.5}});
    lens.surfaces.front() = make_trace_surface(0.0, 0.0, 5.0, 1.0, 1.5, false);
    const auto status_at = [&](double y) { return trace(lens, Ray<double>{{3.0, y, -5.0}, {0.0, 0.0, 1.0}}).status; };
    EXPECT_EQ(status_at(4.0), RayStatus::ok);
    EXPECT_EQ(status_at(std::nextafter(4.0, 5.0)), RayStatus::clipped);
}

Lens lens_with(double first_thickness, double second_thickness, double index_between) {
    Prescription prescription;
    for (const double thickness : {first_thickness, second_thickness, 10.0}) {
        PrescribedSurface row;
        row.thickness_mm = thickness;
        row.semi_diameter_mm = 5.0;
        prescription.surfaces.push_back(row);
    }
    prescription.surfaces[0].is_stop = true;
    if (index_between != 1.0) {
        prescription.surfaces[1].medium.n_d = index_between;
    }
    return make_lens(prescription, GlassCatalogue{});
}

// A dummy may stand anywhere; glass may not run backwards.
TEST(ExtremeOptics, NegativeThicknessesAreForDummies) {
    const Lens lens = lens_with(-1e9, 1e9, 1.0);
    EXPECT_EQ(lens.surfaces[1].vertex_z, -1e9);
    EXPECT_EQ(lens.surfaces[2].vertex_z, 0.0);
    EXPECT_THROW(lens_with(1.0, -2.0, 1.5), InputError);
    EXPECT_THROW(lens_with(1e11, 1.0, 1.0), InputError);
}

}  // namespace lensproof::optics::extreme_optics_test
