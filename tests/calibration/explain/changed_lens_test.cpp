// Where a changed lens images, against the engine's own chief rays of a prescription that says the same.
#include "calibration/explain/changed_lens.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibration/explain/lens_residuals.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/prescription.h"

namespace lensproof::calibration::changed_lens_test {

constexpr double kWavelength_nm = 546.1;
const std::vector<std::string> kAllKinds{kFreeKinds.begin(), kFreeKinds.end()};

/// All changes at once, none of them 0.
Eigen::VectorXd some_values(const std::vector<LensChange>& changes) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(changes.size()));
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        const double sign = i % 3 == 0 ? -1.0 : 1.0;
        values[i] = sign * (0.5 + 0.1 * static_cast<double>(i % 7)) *
                    tolerance(changes[static_cast<std::size_t>(i)].kind).usual;
    }
    return values;
}

double value_of(const std::vector<LensChange>& changes, const Eigen::VectorXd& values, const std::string& name) {
    return values[std::ranges::find(changes, name, &LensChange::name) - changes.begin()];
}

/// The Tessar with gaps, elements and glasses changed in its prescription.
optics::Lens changed_by_prescription(const std::vector<LensChange>& changes, const Eigen::VectorXd& values) {
    const auto value = [&](const std::string& name) { return value_of(changes, values, name); };
    optics::Prescription tessar = formats::read_prescription(formats::find_lens_file("tessar"));
    for (const int gap : {3, 4, 6}) {
        tessar.surfaces[static_cast<std::size_t>(gap) - 1].thickness_mm += value("gap_" + std::to_string(gap) + "_mm");
    }
    for (const auto& [first, last] : {std::pair{1, 3}, {5, 6}, {7, 8}}) {
        const std::string which = std::to_string(first) + "_" + std::to_string(last);
        tessar.groups.push_back(
            {.first = first,
             .last = last,
             .misalignment = {{value("decentre_x_" + which + "_mm"), value("decentre_y_" + which + "_mm")},
                              {value("tilt_x_" + which + "_deg"), value("tilt_y_" + which + "_deg"), 0.0}}});
    }
    return optics::make_lens(tessar, formats::shipped_glasses());
}

// The engine turns about x and then about the turned y, this room about the fixed y: they differ by the product of the
// angles. So each axis is tilted by itself. Chief rays are aimed to 1e-12 rad, which at 100 mm is 1e-10 mm.
TEST(ChangedLens, ImagesAsThePrescriptionThatSaysTheSame) {
    const optics::Lens tessar = formats::load_lens("tessar");
    const std::vector<LensChange> changes = lens_changes(tessar, kAllKinds, 1);
    for (const char left_out : {'x', 'y'}) {
        Eigen::VectorXd values = some_values(changes);
        for (std::size_t i = 0; i < changes.size(); ++i) {
            const ChangeKind kind = changes[i].kind;
            const bool is_prescribed =
                kind == ChangeKind::gap || kind == ChangeKind::decentre || kind == ChangeKind::tilt;
            if (!is_prescribed || (kind == ChangeKind::tilt && changes[i].axis == (left_out == 'x' ? 0 : 1))) {
                values[static_cast<Eigen::Index>(i)] = 0.0;
            }
        }
        const optics::ChiefRays expected(changed_by_prescription(changes, values), kWavelength_nm,
                                         optics::Rims::follow);
        const ChangedLens changed(tessar, kWavelength_nm, changes, values, 0);
        for (const Vec3d& object :
             {Vec3d{0.0, 0.0, -2000.0}, Vec3d{300.0, -200.0, -1500.0}, Vec3d{-600.0, 500.0, -2500.0}}) {
            const auto ray = expected.from_point(object);
            const auto landing = changed.image_of(object, std::nullopt, false);
            ASSERT_TRUE(ray && landing);
            EXPECT_NEAR(landing->image_mm.x, ray->image_point.x, 1e-8);
            EXPECT_NEAR(landing->image_mm.y, ray->image_point.y, 1e-8);
        }
    }
}

// n_d and V_d of a glass: its index at the d line moves by the first, the difference of the F and C lines by both, as
// in the definition V_d = (n_d − 1) / (n_F − n_C). A singlet of such a glass is what the prescription makes of them.
TEST(ChangedLens, GlassFollowsItsTwoNumbers) {
    optics::Prescription biotar = formats::read_prescription(formats::find_lens_file("biotar"));
    const optics::Lens lens = optics::make_lens(biotar, formats::shipped_glasses());
    const std::vector<LensChange> changes = lens_changes(lens, {"glass"}, 1);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(changes.size()));
    values[std::ranges::find(changes, "n_d_7", &LensChange::name) - changes.begin()] = 0.01;
    values[std::ranges::find(changes, "V_d_7", &LensChange::name) - changes.begin()] = -2.0;
    *biotar.surfaces[6].medium.n_d += 0.01;
    *biotar.surfaces[6].medium.V_d -= 2.0;
    const optics::Lens other = optics::make_lens(biotar, formats::shipped_glasses());
    const Vec3d object{0.0, -300.0, -1000.0};
    // At the d line the same to rounding; elsewhere the made glasses' partial dispersions differ by some 1e-3 of
    // n_F − n_C, 0.02: 1e-5 in the index, a hundredth of what is changed here and some 1e-4 mm in the image.
    for (const auto& [nm, tolerance_mm] : {std::pair{587.5618, 1e-9}, {486.1327, 3e-4}, {656.2725, 3e-4}}) {
        const auto landing = ChangedLens(lens, nm, changes, values, 0).image_of(object, std::nullopt, false);
        const auto before = ChangedLens(lens, nm, changes, 0.0 * values, 0).image_of(object, std::nullopt, false);
        const auto ray = optics::ChiefRays(other, nm, optics::Rims::follow).from_point(object);
        ASSERT_TRUE(landing && before && ray);
        EXPECT_NEAR(landing->image_mm.y, ray->image_height, tolerance_mm) << nm;
        EXPECT_GT(std::abs(landing->image_mm.y - before->image_mm.y), 10.0 * tolerance_mm);
    }
}

// Derivatives against central differences: a step of h leaves h² of the third derivative and 1e-12 / h of rounding in
// images that are aimed to 1e-12 mm or so; at h = 1e-3 tolerances that is below 1e-5 of a derivative.
TEST(ChangedLens, DerivativesAreThoseOfTheImage) {
    for (const char* name : {"tessar", "biotar", "nikkor-fisheye-16"}) {
        const optics::Lens lens = formats::load_lens(name);
        const std::vector<LensChange> changes = lens_changes(lens, kAllKinds, 1);
        const Eigen::VectorXd values = some_values(changes);
        const Vec3d object{200.0, -150.0, -1000.0};
        const auto image = [&](const Eigen::VectorXd& at, const Vec3d& from) {
            return ChangedLens(lens, kWavelength_nm, changes, at, 0).image_of(from, std::nullopt, false)->image_mm;
        };
        const auto landing = ChangedLens(lens, kWavelength_nm, changes, values, 0).image_of(object, std::nullopt, true);
        ASSERT_TRUE(landing) << name;
        for (Eigen::Index i = 0; i < values.size(); ++i) {
            const double h = 0.1 * tolerance(changes[static_cast<std::size_t>(i)].kind).usual;
            const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(values.size(), i);
            const Vec2d slope = (1.0 / (2.0 * h)) * (image(values + step, object) - image(values - step, object));
            const double scale = 1e-5 * (1.0 + std::hypot(slope.x, slope.y));
            EXPECT_NEAR(landing->by_change(0, i), slope.x, scale)
                << name << " " << changes[static_cast<std::size_t>(i)].name;
            EXPECT_NEAR(landing->by_change(1, i), slope.y, scale)
                << name << " " << changes[static_cast<std::size_t>(i)].name;
        }
        const Vec2d by_x =
            0.5 * (image(values, object + Vec3d{1.0, 0.0, 0.0}) - image(values, object - Vec3d{1.0, 0.0, 0.0}));
        EXPECT_NEAR(landing->by_point(0, 0), by_x.x, 1e-5 * std::abs(by_x.x));
    }
}

}  // namespace lensproof::calibration::changed_lens_test
