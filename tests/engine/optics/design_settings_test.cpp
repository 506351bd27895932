// What a design's aperture and fields make of a lens: its stop, the rims that are not stated, the angles of its fields.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/design_fields.h"
#include "engine/optics/meridional_bundle.h"
#include "engine/optics/paraxial.h"
#include "tests/complaint.h"

namespace lensproof::optics::design_settings_test {

/// A lens that ships, without any semi-diameter.
Prescription bare(const std::string& name) {
    Prescription lens = formats::read_prescription(formats::find_lens_file(name));
    for (PrescribedSurface& row : lens.surfaces) {
        row.semi_diameter_mm.reset();
        row.rim_mm.reset();
    }
    lens.stated = {};
    return lens;
}

Lens made(const Prescription& prescription) {
    return make_lens(prescription, formats::shipped_glasses());
}

TEST(SystemAperture, OpensTheStop) {
    Prescription lens = bare("tessar");
    lens.aperture = {ApertureKind::entrance_pupil_diameter, 20.0};
    EXPECT_NEAR(paraxial_data(at_wavelength<double>(made(lens), spectral::kLineD)).entrance_pupil_diameter, 20.0,
                1e-12);
    lens.aperture = {ApertureKind::f_number, 5.6};
    EXPECT_NEAR(paraxial_data(at_wavelength<double>(made(lens), spectral::kLineD)).f_number, 5.6, 1e-12);
    lens.object_distance_mm = 500.0;
    lens.aperture = {ApertureKind::working_f_number, 5.6};
    EXPECT_NEAR(paraxial_conjugates(at_wavelength<double>(made(lens), spectral::kLineD), 500.0).working_f_number, 5.6,
                1e-12);
    // The sine that is stated makes a paraxial ray of that tangent.
    lens.aperture = {ApertureKind::object_numerical_aperture, 0.02};
    EXPECT_NEAR(
        paraxial_conjugates(at_wavelength<double>(made(lens), spectral::kLineD), 500.0).object_numerical_aperture,
        0.02 / std::sqrt(1.0 - 0.02 * 0.02), 1e-14);
}

// The pupil is that of the file's reference wavelength, not of the d line.
TEST(SystemAperture, IsOfTheReferenceWavelength) {
    Prescription lens = bare("tessar");
    lens.wavelengths_nm = {435.8343, 656.2725};
    lens.aperture = {ApertureKind::f_number, 5.6};
    EXPECT_NEAR(paraxial_data(at_wavelength<double>(made(lens), 435.8343)).f_number, 5.6, 1e-12);
}

TEST(SystemAperture, ThatOpensNoStopIsRefused) {
    Prescription flat;
    flat.file = "flat.zmx";
    flat.surfaces = {{.thickness_mm = 5.0, .medium = {.n_d = 1.5}, .is_stop = true}, {.thickness_mm = 9.0}};
    flat.aperture = {ApertureKind::f_number, 4.0};
    EXPECT_TRUE(says(lensproof::complaint_about([&] { return make_lens(flat, {}); }), "flat.zmx: its aperture, f/4"));
    flat.aperture = {ApertureKind::object_numerical_aperture, 0.5};
    EXPECT_THROW(make_lens(flat, {}), InputError) << "the object is far away";
}

/// Whether every field's meridional beam fills the stop: its outermost rays end there.
bool stop_is_filled(const Lens& lens, const std::vector<double>& fields_deg, double wavelength_nm) {
    const auto traced = at_wavelength<double>(lens, wavelength_nm);
    const ChiefRays chief_rays(lens, wavelength_nm);
    const double opening = lens.surfaces[lens.stop_index()].semi_diameter;
    return std::ranges::all_of(fields_deg, [&](double field) {
        const auto chief = chief_rays.at_field(field * kDegree);
        if (!chief) {
            return false;
        }
        const MeridionalBundle bundle = meridional_bundle(traced, *chief);
        const auto reaches_edge = [&](double offset) {
            double height = 0.0;
            trace(traced, bundle.ray({0.0, offset}), [&](const SurfaceEvent<double>& event) {
                height = event.surface == lens.stop_index() ? std::abs(event.ray.origin.y) : height;
            });
            return height > (1.0 - 1e-9) * opening;
        };
        return reaches_edge(bundle.lower) && reaches_edge(bundle.upper);
    });
}

struct Case {
    std::string lens;
    std::vector<double> fields_deg;
    double f_number;
    friend void PrintTo(const Case& c, std::ostream* out) { *out << c.lens; }
};

class UnstatedRims : public testing::TestWithParam<Case> {};

// Just as wide as the light needs: it fills the stop at every field, and a thousandth off any rim that the largest
// field or the axis reaches cuts it.
TEST_P(UnstatedRims, AreThoseOfRealRays) {
    const Case& c = GetParam();
    Prescription lens = bare(c.lens);
    lens.aperture = {ApertureKind::f_number, c.f_number};
    for (const double field : c.fields_deg) {
        lens.fields.points.push_back({0.0, field});
    }
    const Lens open = made(lens);
    EXPECT_TRUE(stop_is_filled(open, c.fields_deg, spectral::kLineD));
    for (std::size_t i = 0; i < open.surfaces.size(); ++i) {
        if (open.surfaces[i].is_stop) {
            continue;
        }
        Lens narrowed = open;
        narrowed.surfaces[i].semi_diameter *= 0.999;
        EXPECT_FALSE(stop_is_filled(narrowed, c.fields_deg, spectral::kLineD)) << "surface " << i + 1;
    }
}

INSTANTIATE_TEST_SUITE_P(Lenses, UnstatedRims,
                         testing::Values(Case{"tessar", {0.0, 14.0, 20.0}, 4.0}, Case{"petzval", {0.0, 8.0}, 4.0},
                                         Case{"muller-fisheye", {0.0, 60.0, 85.0}, 8.0}),
                         [](const auto& c) { return c.param.lens == "muller-fisheye" ? "fisheye" : c.param.lens; });

// A pupil that is half as high above the chief ray needs less of the rims on that side.
TEST(UnstatedRims, VignettingFactorsNarrowThem) {
    Prescription lens = bare("tessar");
    lens.aperture = {ApertureKind::f_number, 4.0};
    lens.fields.points = {{0.0, 20.0}};
    const Lens whole = made(lens);
    lens.fields.vignetting = {{.decentre = {}, .compression = {0.0, 0.4}}};
    const Lens vignetted = made(lens);
    EXPECT_LT(vignetted.surfaces.front().semi_diameter, 0.97 * whole.surfaces.front().semi_diameter);
    EXPECT_LT(vignetted.surfaces.back().semi_diameter, 0.97 * whole.surfaces.back().semi_diameter);
    // A field in x alone has its meridian there.
    lens.fields.points = {{20.0, 0.0}};
    lens.fields.vignetting = {{.decentre = {}, .compression = {0.4, 0.0}}};
    EXPECT_EQ(made(lens).surfaces.front().semi_diameter, vignetted.surfaces.front().semi_diameter);
}

TEST(UnstatedRims, NeedAnAperture) {
    EXPECT_TRUE(says(lensproof::complaint_about([] { return made(bare("tessar")); }),
                     "expected semi_diameter_mm, or stated.f_number"));
}

// A stop without a size, all other rims stated: the axial beam fills it, and would not fill a wider one.
TEST(UnstatedRims, OfTheStopAloneIsWhatTheOthersLeave) {
    Prescription lens = formats::read_prescription(formats::find_lens_file("tessar"));
    lens.stated = {};
    std::ranges::find_if(lens.surfaces, &PrescribedSurface::is_stop)->semi_diameter_mm.reset();
    Lens open = made(lens);
    EXPECT_TRUE(stop_is_filled(open, {0.0}, spectral::kLineD));
    EXPECT_EQ(open.findings.at(0).code, "stop-size");
    open.surfaces[open.stop_index()].semi_diameter *= 1.001;
    EXPECT_FALSE(stop_is_filled(open, {0.0}, spectral::kLineD));
}

// Each kind of field against what it says of the chief ray of the angle that it became.
TEST(DesignFields, BecomeTheAnglesOfTheirChiefRays) {
    Prescription prescription = formats::read_prescription(formats::find_lens_file("tessar"));
    const Lens lens = made(prescription);
    const auto traced = at_wavelength<double>(lens, spectral::kLineD);
    const ChiefRays chief_rays(lens, spectral::kLineD);
    const auto fields = [&](FieldKind kind, double distance) {
        prescription.fields = {.kind = kind, .points = {{0.0, 0.0}, {0.0, 21.0}, {0.0, -21.0}, {9.0, 12.0}}};
        return design_fields_deg(prescription, lens, spectral::kLineD, distance);
    };
    const auto angles = fields(FieldKind::angle, kInfinity);
    ASSERT_EQ(angles.size(), 3U) << "either side of the axis is one field";
    EXPECT_EQ(angles[1], 21.0);
    // The direction (tan 9°, tan 12°, 1).
    EXPECT_NEAR(angles[2], std::atan(std::hypot(std::tan(9.0 * kDegree), std::tan(12.0 * kDegree))) / kDegree, 1e-13);

    const auto heights = fields(FieldKind::image_height, kInfinity);
    ASSERT_EQ(heights.size(), 3U);
    EXPECT_NEAR(chief_rays.at_field(heights[1] * kDegree)->image_height, 21.0, 1e-11);
    EXPECT_NEAR(chief_rays.at_field(heights[2] * kDegree)->image_height, 15.0, 1e-11);

    const auto paraxial = fields(FieldKind::paraxial_image_height, kInfinity);
    EXPECT_NEAR(std::tan(paraxial[1] * kDegree) * paraxial_data(traced).efl, 21.0, 1e-11);

    const auto objects = fields(FieldKind::object_height, 400.0);
    ASSERT_EQ(objects.size(), 3U);
    const Ray<double> front = chief_rays.at_field(objects[1] * kDegree)->front;
    EXPECT_NEAR(front.origin.y + (-400.0 - front.origin.z) * front.direction.y / front.direction.z, -21.0, 1e-10);

    // At a finite distance the paraxial chief ray of the object that images there.
    const auto near = fields(FieldKind::paraxial_image_height, 400.0);
    const double object_height = 21.0 / paraxial_conjugates(traced, 400.0).magnification;
    EXPECT_NEAR(std::tan(near[1] * kDegree) * (400.0 + paraxial_data(traced).entrance_pupil_z), -object_height, 1e-11);
}

TEST(DesignFields, LeaveOutWhatTheLensHasNot) {
    Prescription prescription = formats::read_prescription(formats::find_lens_file("tessar"));
    prescription.fields = {.kind = FieldKind::object_height, .points = {{0.0, 5.0}}, .vignetting = {}};
    EXPECT_TRUE(design_fields_deg(prescription, made(prescription), spectral::kLineD, kInfinity).empty())
        << "heights of an object at infinity say nothing";
    prescription.fields = {};
    EXPECT_TRUE(design_fields_deg(prescription, made(prescription), spectral::kLineD, kInfinity).empty());
}

}  // namespace lensproof::optics::design_settings_test
