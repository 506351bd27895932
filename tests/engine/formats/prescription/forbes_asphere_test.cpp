#include "engine/formats/prescription/forbes_asphere.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"
#include "engine/optics/multiprecision.h"
#include "tests/complaint.h"
#include "tests/engine/formats/prescription/has_finding.h"

namespace lensproof::formats::forbes_asphere_test {

/// Coefficients of r⁴, r⁶, … of one polynomial over a radius of 1.
std::vector<double> powers_of(int m) {
    std::vector<double> a(kForbesTerms);
    a[m] = 1.0;
    const optics::AsphereTerms terms = powers_of_qcon(a, 1.0);
    return {terms.begin() + 1, terms.end()};
}

// Forbes 2007 lists the first of them: 1, −(5 − 6x), 15 − 14x(3 − 2x), −{35 − 12x[14 − x(21 − 10x)]},
// 70 − 3x{168 − 5x[84 − 11x(8 − 3x)]}. Whole numbers come out as such.
TEST(Qcon, FirstPolynomialsAreThoseOfThePaper) {
    const std::vector<std::vector<double>> published = {
        {1}, {-5, 6}, {15, -42, 28}, {-35, 168, -252, 120}, {70, -504, 1260, -1320, 495}};
    for (std::size_t m = 0; m < published.size(); ++m) {
        std::vector<double> expected = published[m];
        expected.resize(kForbesTerms);
        EXPECT_EQ(powers_of(static_cast<int>(m)), expected) << m;
    }
}

// What defines them: ∫ x⁴ Q_m Q_n dx over 0 … 1 is 0, and 1 / (2m + 5) for m = n; and Q_m(1) = 1. The sums are of
// products up to 3e12, in long double.
TEST(Qcon, PolynomialsAreOrthogonal) {
    for (int m = 0; m < kForbesTerms; ++m) {
        const std::vector<double> q = powers_of(m);
        long double at_rim = 0.0L;
        for (const double coefficient : q) {
            at_rim += coefficient;
        }
        EXPECT_EQ(at_rim, 1.0L) << m;
        for (int n = 0; n <= m; ++n) {
            const std::vector<double> p = powers_of(n);
            long double integral = 0.0L;
            for (int i = 0; i < kForbesTerms; ++i) {
                for (int k = 0; k < kForbesTerms; ++k) {
                    integral += static_cast<long double>(q[i]) * p[k] / (i + k + 5);
                }
            }
            EXPECT_NEAR(static_cast<double>(integral), m == n ? 1.0 / (2 * m + 5) : 0.0, 1e-5) << m << ", " << n;
        }
    }
}

// Of a radius that is no power of two, against Jacobi's polynomials by their recurrence, which loses no digits: the sum
// of nine terms of 1 µm to 1 fm.
TEST(Qcon, PowersKeepTheSagToAFemtometre) {
    constexpr double kRadius = 13.7;
    const std::vector<double> a(kForbesTerms, 1e-3);
    const optics::AsphereTerms terms = powers_of_qcon(a, kRadius);
    for (int step = 0; step <= 100; ++step) {
        const double r = kRadius * step / 100;
        const long double u2 = static_cast<long double>(r) * r / (static_cast<long double>(kRadius) * kRadius);
        long double before = 0.0L;
        long double here = 1.0L;
        long double sum = 0.0L;
        for (int m = 0; m < kForbesTerms; ++m) {
            sum += a[m] * here;
            const long double s = 2.0L * m + 4.0L;
            const long double after = ((s + 1.0L) * (s * (s + 2.0L) * (2.0L * u2 - 1.0L) - 16.0L) * here -
                                       2.0L * m * (m + 4.0L) * (s + 2.0L) * before) /
                                      (2.0L * (m + 1.0L) * (m + 5.0L) * s);
            before = here;
            here = after;
        }
        double sag = 0.0;
        for (int i = optics::kAsphereTerms; i > 0; --i) {
            sag = sag * r * r + terms[i - 1];
        }
        EXPECT_NEAR(sag * r * r, static_cast<double>(u2 * u2 * sum), 1e-12) << r;
    }
}

/// Forbes's Qbfs_m at x by the recurrences of his 2010 paper, for any number type.
template <class T>
std::vector<T> qbfs(int count, const T& x) {
    using std::sqrt;
    std::vector<T> p = {T(2), T(6) - T(8) * x};
    std::vector<T> f = {T(2)};
    std::vector<T> q = {T(1)};
    T g(0);
    for (int m = 1; m < count; ++m) {
        const T h = m == 1 ? T(0) : -T(m) * T(m - 1) / (T(2) * f[m - 2]);
        g = -(T(1) + g * h) / f[m - 1];
        f.push_back(sqrt(T(m) * T(m + 1) + T(3) - g * g - h * h));
        q.push_back((p[m] - g * q[m - 1] - (m == 1 ? T(0) : h * q[m - 2])) / f[m]);
        p.push_back((T(2) - T(4) * x) * p[m] - p[m - 1]);
    }
    return q;
}

/// The sag of Forbes's mild asphere as he defines it.
template <class T>
T mild_sag(double curvature, double conic, const std::vector<double>& a, double radius, const T& r) {
    using std::sqrt;
    const T c(curvature);
    const T k(conic);
    const T bent = c * c * r * r;
    const T u2 = r * r / (T(radius) * T(radius));
    const std::vector<T> q = qbfs(static_cast<int>(a.size()), u2);
    T sum(0);
    for (std::size_t m = 0; m < a.size(); ++m) {
        sum = sum + T(a[m]) * q[m];
    }
    const T root = sqrt(T(1) - (T(1) + k) * bent);
    return c * r * r / (T(1) + root) + sqrt(T(1) - k * bent) / root * u2 * (T(1) - u2) * sum;
}

double at(const optics::AsphereTerms& terms, double u2) {
    double sum = 0.0;
    for (int i = optics::kAsphereTerms; i > 0; --i) {
        sum = (sum + terms[i - 1]) * u2;
    }
    return sum;
}

// Forbes 2007, eq. 2.7: 1, (13 − 16x)/√19, √(2/95) [29 − 4x (25 − 19x)], √(2/2545) {207 − 4x [315 − x (577 − 320x)]}.
TEST(Qbfs, FirstPolynomialsAreThoseOfThePaper) {
    for (const double x : {0.1, 0.35, 0.7, 0.95}) {
        const double published[] = {1.0, (13 - 16 * x) / std::sqrt(19.0),
                                    std::sqrt(2.0 / 95) * (29 - 4 * x * (25 - 19 * x)),
                                    std::sqrt(2.0 / 2545) * (207 - 4 * x * (315 - x * (577 - 320 * x)))};
        for (std::size_t m = 0; m < std::size(published); ++m) {
            std::vector<double> a(m + 1);
            a[m] = 1.0;
            EXPECT_NEAR(at(powers_of_qbfs(a, 1.0), x), x * (1 - x) * published[m], 1e-13) << m << ", " << x;
        }
    }
}

// What defines them: (2 / π) ∫ S_m'(u) S_n'(u) du / √(1 − u²) over 0 … 1 is δ_mn for S_m = u² (1 − u²) Qbfs_m(u²). With
// u = cos θ the slopes are polynomials in the cosine, of degree 19 at most, which 40 even steps integrate exactly.
TEST(Qbfs, SlopesAreOrthonormal) {
    constexpr int kSteps = 40;
    std::vector<std::vector<double>> slopes;
    for (int m = 0; m < kForbesTerms; ++m) {
        std::vector<double> a(static_cast<std::size_t>(m) + 1);
        a.back() = 1.0;
        const optics::AsphereTerms terms = powers_of_qbfs(a, 1.0);
        std::vector<double>& slope = slopes.emplace_back();
        for (int step = 0; step < kSteps; ++step) {
            const double u = std::cos(0.5 * std::numbers::pi * (step + 0.5) / kSteps);
            double sum = 0.0;
            for (int i = optics::kAsphereTerms; i > 0; --i) {
                sum = sum * u * u + 2 * i * terms[i - 1];
            }
            slope.push_back(sum * u);
        }
    }
    for (int m = 0; m < kForbesTerms; ++m) {
        for (int n = 0; n <= m; ++n) {
            double mean = 0.0;
            for (int step = 0; step < kSteps; ++step) {
                mean += slopes[m][step] * slopes[n][step] / kSteps;
            }
            EXPECT_NEAR(mean, m == n ? 1.0 : 0.0, 1e-7) << m << ", " << n;
        }
    }
}

optics::PrescribedSurface mild_row(double radius_mm, double conic, const std::vector<double>& a, double Q_radius) {
    optics::PrescribedSurface row;
    row.radius_mm = radius_mm;
    row.conic = conic;
    row.asphere = powers_of_qbfs(a, Q_radius);
    row.along_normal = true;
    return row;
}

// Powers in double against the definition in a hundred digits, to c r = 0.9: what their rounding leaves of a term of
// 1 mm.
TEST(Qbfs, PowersKeepTheSag) {
    constexpr double kRadius = 13.7;
    const double curvature = 0.9 / kRadius;
    for (int m = 0; m < kForbesTerms; ++m) {
        std::vector<double> a(static_cast<std::size_t>(m) + 1);
        a.back() = 1.0;
        optics::SurfaceShape<double> shape{.curvature = curvature, .along_normal = true};
        shape.asphere = powers_of_qbfs(a, kRadius);
        shape.terms = optics::kAsphereTerms;
        double furthest = 0.0;
        for (int step = 0; step <= 100; ++step) {
            const double r = kRadius * step / 100;
            const auto exact = static_cast<double>(
                mild_sag<optics::Multiprecision>(curvature, 0.0, a, kRadius, optics::Multiprecision(r)));
            furthest = std::max(furthest, std::abs(optics::sag(shape, r, 0.0) - exact));
        }
        EXPECT_LT(furthest, 2e-10) << m;
    }
}

// Optiland 0.6.3's ForbesQNormalSlopeGeometry of the same numbers, whose sag 30 digits (mpmath) agree with to 2e-15.
TEST(Qbfs, SagAndNormalAreOptilands) {
    const std::vector<double> a = {0.4, -0.12, 0.03, 0.0, -0.01, 0.0, 0.0, 0.0, 0.002};
    const optics::SurfaceShape<double> shape = optics::prescribed_shape(mild_row(20.0, -0.3, a, 12.5));
    struct Point {
        double r;
        double sag;
        Vec3d normal;  // towards −z
    };
    const std::vector<Point> points = {
        {0.5, 0.006446933736219486, {0.015468177398287592, 0.020624236531050125, -0.9996676329438132}},
        {3.0, 0.23323084511321066, {0.09281860019909138, 0.12375813359878854, -0.9879618574748853}},
        {6.0, 0.9498582895282558, {0.18377492214718807, 0.2450332295295842, -0.9519377576375974}},
        {9.0, 2.173672725995759, {0.26701166541058957, 0.35601555388078615, -0.8955209075893318}},
        {11.0, 3.2814296016582314, {0.31037420445144437, 0.41383227260192584, -0.8558099691895732}},
        {12.4, 4.154095741985054, {0.32138792140712474, 0.42851722854283314, -0.8444422945444983}}};
    for (const Point& point : points) {
        const Vec3d where{0.6 * point.r, 0.8 * point.r, point.sag};
        EXPECT_NEAR(optics::sag(shape, where.x, where.y), point.sag, 1e-13) << point.r;
        const Vec3d normal = normalized(optics::implicit_surface(shape, where).gradient);
        EXPECT_LT(length(normal + point.normal), 1e-13) << point.r;
    }
}

optics::Prescription parse(const std::string& keys) {
    return parse_toml_prescription(
        "name = \"x\"\nsource = \"y\"\nsurfaces = [{ radius_mm = 40.0, thickness_mm = 1.0, " + keys + " }]\n",
        "a.toml");
}

std::string complaint(const std::string& keys) {
    return complaint_about([&] { parse(keys); });
}

TEST(Qcon, StandsInATomlSurface) {
    const optics::PrescribedSurface surface =
        parse("A4 = 1e-6, A6 = 2e-9, Qcon = [0.5, -0.25], Q_radius_mm = 10.0").surfaces[0];
    EXPECT_DOUBLE_EQ(surface.term(4), 1e-6 + (0.5 + 0.25 * 5) * 1e-4);
    EXPECT_DOUBLE_EQ(surface.term(6), 2e-9 - 0.25 * 6 * 1e-6);
    EXPECT_EQ(surface.term(8), 0.0);
    EXPECT_TRUE(says(complaint("Qcon = [0.5]"), "Q_radius_mm"));
    EXPECT_TRUE(says(complaint("Q_radius_mm = 10.0"), "stands without Qbfs or Qcon"));
    EXPECT_TRUE(says(complaint("Qcon = [0.5], Q_radius_mm = 0.0"), "Q_radius_mm"));
    EXPECT_TRUE(says(complaint("Qcon = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1], Q_radius_mm = 10.0"), "holds 10 coefficients"));
}

TEST(Qbfs, StandsInATomlSurface) {
    const optics::PrescribedSurface surface =
        parse("conic = -0.5, Qbfs = [0.5, -0.25], Q_radius_mm = 10.0").surfaces[0];
    EXPECT_TRUE(surface.along_normal);
    EXPECT_EQ(surface.asphere, powers_of_qbfs(std::vector<double>{0.5, -0.25}, 10.0));
    EXPECT_TRUE(says(complaint("Qbfs = [0.5], Q_radius_mm = 10.0, A4 = 1e-6"), "Qbfs: stands beside A2, A4"));
    EXPECT_TRUE(says(complaint("Qbfs = [0.5], Q_radius_mm = 10.0, Qcon = [0.5]"), "along the conic's normal"));
    EXPECT_TRUE(says(complaint("along_normal = true, A3 = 1e-6"), "along the conic's normal"));
    EXPECT_TRUE(says(complaint("Qbfs = [0.5]"), "Q_radius_mm"));
}

/// A lens with a mild asphere of 80 µm in front.
optics::Prescription mild_lens() {
    return parse_toml_prescription(R"(
name = "mild"
source = "test"
surfaces = [
  { radius_mm = 25.0, thickness_mm = 4.0, n_d = 1.55, V_d = 60.0, semi_diameter_mm = 8.0, Q_radius_mm = 8.0, Qbfs = [0.05, -0.02, 0.005, 0.001] },
  { radius_mm = -60.0, thickness_mm = 1.0, semi_diameter_mm = 8.0 },
  { stop = true, thickness_mm = 40.0, semi_diameter_mm = 6.0 },
]
)",
                                   "mild.toml");
}

TEST(Qbfs, IsWrittenToTomlWithoutALoss) {
    const WrittenPrescription written = to_toml(mild_lens());
    EXPECT_TRUE(written.lost.empty());
    EXPECT_TRUE(says(written.text, "along_normal = true"));
    const optics::Prescription again = parse_toml_prescription(written.text, "mild.toml");
    EXPECT_EQ(again.surfaces[0].asphere, mild_lens().surfaces[0].asphere);
    EXPECT_TRUE(again.surfaces[0].along_normal);
}

// Forms that know no such surface get powers along the axis; what that costs is said, and holds: at c r = 0.32 the
// powers to r²⁰ keep the sag to 8e-14 mm, and so every ray inside the aperture to a few times that.
TEST(Qbfs, IsWrittenAsPowersElsewhere) {
    const WrittenPrescription zmx = to_zmx(mild_lens());
    const WrittenPrescription csv = to_csv(mild_lens());
    for (const WrittenPrescription& written : {zmx, csv}) {
        const auto said = std::ranges::find(written.lost, "lost-normal-terms", &optics::Finding::code);
        ASSERT_NE(said, written.lost.end());
        EXPECT_EQ(said->severity, optics::Severity::info);
        EXPECT_TRUE(says(said->message, "within 8e-14 mm up to 8 mm"));
    }
    const auto traced = [](const optics::Prescription& lens) {
        return optics::at_wavelength<double>(optics::make_lens(lens, optics::GlassCatalogue{}), 587.5618);
    };
    const optics::TraceLens<double> mild = traced(mild_lens());
    for (const optics::TraceLens<double>& written :
         {traced(parse_zmx(zmx.text, "mild.zmx")), traced(parse_csv_prescription(csv.text, "mild.csv"))}) {
        for (const double height : {-4.0, -2.0, 1.0, 4.0, 5.5}) {
            const Ray<double> ray{{0.5, height, -2.0}, normalized(Vec3d{0.02, -0.1, 1.0})};
            const optics::TracedRay<double> through = optics::trace(mild, ray);
            ASSERT_EQ(through.status, optics::RayStatus::ok);
            EXPECT_LT(length(through.ray.origin - optics::trace(written, ray).ray.origin), 1e-12);
            EXPECT_LT(length(through.ray.direction - optics::trace(written, ray).ray.direction), 1e-12);
        }
    }
}

// A hemisphere's 1 / cos is no polynomial of that degree: the error that is stated is the one that there is.
TEST(Qbfs, WhatPowersCannotKeepIsSaid) {
    optics::Prescription steep = mild_lens();
    steep.surfaces[0] = mild_row(8.2, 0.0, {0.05, -0.02, 0.005, 0.001}, 8.0);
    steep.surfaces[0].semi_diameter_mm = 8.0;
    steep.surfaces[0].thickness_mm = 10.0;
    const WrittenPrescription written = to_zmx(steep);
    const auto said = std::ranges::find(written.lost, "lost-normal-terms", &optics::Finding::code);
    ASSERT_NE(said, written.lost.end());
    EXPECT_EQ(said->severity, optics::Severity::warning);
    const optics::PrescribedSurface powers = parse_zmx(written.text, "steep.zmx").surfaces[0];
    EXPECT_EQ(powers.asphere[0], steep.surfaces[0].asphere[0]);
    double furthest = 0.0;
    for (int step = 1; step <= 1000; ++step) {
        const double r = 0.9 * 8.2 * step / 1000;
        furthest = std::max(furthest, std::abs(optics::sag(optics::prescribed_shape(powers), r, 0.0) -
                                               optics::sag(optics::prescribed_shape(steep.surfaces[0]), r, 0.0)));
    }
    EXPECT_TRUE(says(said->message, fmt::format("within {:.1g} mm", furthest)));
}

/// What Optiland 0.6.3 saves of `mild_lens` with the stop in front, cut to what matters.
const std::string kOptiland = R"({
 "version": 1.0, "name": "mild", "aperture": {"type": "EPD", "value": 10.0}, "fields": {"fields": []},
 "wavelengths": {"wavelengths": [{"value": 0.5875618, "is_primary": true, "unit": "um"}], "polarization": "ignore"},
 "surface_group": {"surfaces": [
  {"type": "ObjectSurface", "geometry": {"type": "Plane", "cs": {"z": -Infinity}, "radius": Infinity},
   "material_post": {"type": "IdealMaterial", "index": 1.0, "absorp": 0.0}},
  {"type": "Surface", "thickness": 4, "geometry": {"type": "ForbesQNormalSlopeGeometry", "cs": {"z": 0.0},
   "surface_config": {"radius": 25.0, "conic": 0.0, "norm_radius": 8.0,
                      "terms": {"0": 0.05, "1": -0.02, "2": 0.005, "3": 0.001}},
   "solver_config": {"tol": 1e-06, "max_iter": 100}},
   "material_post": {"type": "IdealMaterial", "index": 1.55, "absorp": 0.0}, "is_stop": true},
  {"type": "Surface", "thickness": 40, "geometry": {"type": "StandardGeometry", "cs": {"z": 4.0}, "radius": -60.0,
   "conic": 0.0}, "material_post": {"type": "IdealMaterial", "index": 1.0, "absorp": 0.0}},
  {"type": "Surface", "thickness": 0.0, "geometry": {"type": "Plane", "cs": {"z": 44.0}, "radius": Infinity},
   "material_post": {"type": "IdealMaterial", "index": 1.0, "absorp": 0.0}}]}})";

// A skew ray of the 5° field through that lens, by Optiland's own tracer, which solves to 1e-6 mm of the surface.
TEST(Qbfs, OptilandsFileIsTracedAsOptilandDoes) {
    optics::Prescription lens = parse_optiland(kOptiland, "a.json");
    EXPECT_TRUE(lens.surfaces[0].along_normal);
    lens.surfaces[0].semi_diameter_mm = 8.0;
    lens.surfaces[1].semi_diameter_mm = 8.0;
    const optics::TraceLens<double> traced =
        optics::at_wavelength<double>(optics::make_lens(lens, optics::GlassCatalogue{}), 587.5618);
    const double field = 5.0 * std::numbers::pi / 180.0;
    const Ray<double> ray{{1.5, 3.62511336, -10.0}, {0.0, std::sin(field), std::cos(field)}};
    const optics::TracedRay<double> out = optics::trace(traced, ray);
    const Vec3d point = optics::meet_plane(out.ray, traced.image_z).point;
    EXPECT_NEAR(point.x, -0.4827656924130679, 2e-6);
    EXPECT_NEAR(point.y, 2.169134359554669, 2e-6);
    EXPECT_NEAR(out.ray.direction.x, -0.04736745112118903, 1e-7);
    EXPECT_NEAR(out.ray.direction.y, -0.05797273669157757, 1e-7);
    std::string without_radius = kOptiland;
    without_radius.replace(without_radius.find("\"norm_radius\": 8.0"), 18, "\"norm_radius\": null");
    EXPECT_TRUE(has_finding(parse_optiland(without_radius, "a.json"), "shape-not-read", "norm_radius"));
}

}  // namespace lensproof::formats::forbes_asphere_test
