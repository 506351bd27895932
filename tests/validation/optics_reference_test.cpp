// First-order data, Seidel sums, chief rays and illumination against an independent 50-digit tracer
// (../shared/optics_reference, whose README gives its conventions). Skipped, and said so, where that folder is not
// there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/analysis/seidel.h"
#include "engine/analysis/working_f_number.h"
#include "engine/base/angle.h"
#include "engine/base/file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/illumination.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"

namespace lensproof::optics_reference_test {

class OpticsReference : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const std::filesystem::path file = data_root() / ".." / "shared" / "optics_reference" /
                                           (std::string("tessar_brendel_100__") + GetParam() + ".json");
        if (!std::filesystem::exists(file)) {
            GTEST_SKIP() << "no reference numbers beside the checkout: " << file.lexically_normal().filename();
        }
        data_ = nlohmann::json::parse(read_file(file));
        optics::IndexOverrides overrides;
        if (std::string(GetParam()) == "const") {
            for (const auto& surface : data_["surfaces"]) {
                if (surface["material"] != "air") {
                    overrides[surface["material"]] = surface["n_after"]["d"];
                }
            }
        }
        lens_ = formats::load_lens("tessar", {.indices = overrides});
    }

    [[nodiscard]] double wavelength(const std::string& line) const {
        return data_["index_model"]["wavelengths_nm"][line].get<double>();
    }

    optics::Lens lens_;
    nlohmann::json data_;
};

// A dozen surfaces' worth of double arithmetic: 1e-12 relative leaves room for a hundred roundings.
TEST_P(OpticsReference, FirstOrderData) {
    for (const char* line : {"F", "d", "C", "g"}) {
        const nlohmann::json& expected = data_["paraxial"][line];
        const optics::ParaxialData data = optics::paraxial_data(optics::at_wavelength<double>(lens_, wavelength(line)));
        const auto near = [&](double value, const char* key) {
            EXPECT_NEAR(value / expected[key].get<double>(), 1.0, 1e-12) << line << " " << key;
        };
        near(data.efl, "efl");
        near(data.bfl, "bfl");
        near(data.ffl, "ffl");
        near(data.entrance_pupil_z, "entrance_pupil_z");
        near(data.entrance_pupil_diameter, "entrance_pupil_diameter");
        near(data.exit_pupil_z, "exit_pupil_z_from_last");
        near(data.exit_pupil_diameter, "exit_pupil_diameter");
        near(data.f_number, "f_number");
        near(data.front_principal_z, "z_front_principal");
        near(lens_.last_vertex_z() + data.rear_principal_z, "z_rear_principal");
        const double full_field = data_["lens"]["full_field_deg"].get<double>() * kDegree;
        near(optics::lagrange_invariant(optics::at_wavelength<double>(lens_, wavelength(line)), full_field).value(),
             "lagrange_invariant");
    }
    const optics::ParaxialData data = optics::paraxial_data(optics::at_wavelength<double>(lens_, wavelength("d")));
    EXPECT_NEAR(data.petzval_radius / data_["petzval"]["radius"].get<double>(), 1.0, 1e-12);
}

// The largest axial beam that passes every rim. Both were found by bisection to the last digits of a double.
TEST_P(OpticsReference, RealWorkingFNumber) {
    const double expected = data_["axial_real_beam_d"]["real_f_number_1_over_2sinU"];
    EXPECT_NEAR(analysis::real_working_f_number(optics::at_wavelength<double>(lens_, wavelength("d"))) / expected, 1.0,
                1e-12);
}

// Each surface's share against the largest of its kind: a surface's terms are products of a handful of paraxial heights
// and angles, good to 1e-13 of the largest.
TEST_P(OpticsReference, SeidelSums) {
    const double full_field = data_["lens"]["full_field_deg"].get<double>() * kDegree;
    const auto sums = analysis::seidel_sums(optics::at_wavelength<double>(lens_, wavelength("d")),
                                            optics::at_wavelength<double>(lens_, wavelength("F")),
                                            optics::at_wavelength<double>(lens_, wavelength("C")), full_field);
    ASSERT_TRUE(sums);
    const nlohmann::json& expected = data_["seidel"];
    ASSERT_EQ(sums->surfaces.size(), expected["per_surface"].size());
    const auto compare = [&](const char* key, auto term) {
        double largest = 0.0;
        for (const auto& surface : expected["per_surface"]) {
            largest = std::max(largest, std::abs(surface[key].get<double>()));
        }
        for (std::size_t i = 0; i < sums->surfaces.size(); ++i) {
            EXPECT_NEAR(sums->surfaces[i].*term, expected["per_surface"][i][key].get<double>(), 1e-12 * largest)
                << key << " of surface " << i + 1;
        }
        EXPECT_NEAR(sums->total.*term, expected["sum"][key].get<double>(), 1e-12 * largest) << key;
    };
    compare("S1", &analysis::SeidelTerms<double>::s1);
    compare("S2", &analysis::SeidelTerms<double>::s2);
    compare("S3", &analysis::SeidelTerms<double>::s3);
    compare("S4", &analysis::SeidelTerms<double>::s4);
    compare("S5", &analysis::SeidelTerms<double>::s5);
    compare("CL", &analysis::SeidelTerms<double>::c1);
    compare("CT", &analysis::SeidelTerms<double>::c2);
    const analysis::SeidelTerms<double>& stop = sums->surfaces[lens_.stop_index()];
    for (const double term : {stop.s1, stop.s2, stop.s3, stop.s4, stop.s5, stop.c1, stop.c2}) {
        EXPECT_EQ(term, 0.0);
    }
}

// Image heights of chief rays aimed from the stop: 1e-9 mm, as the reference asks of a good double tracer. Every field
// whose chief ray passes the rims; the reference follows them beyond, the aiming does not.
TEST_P(OpticsReference, ChiefRayHeights) {
    const double image_z = data_["image_planes"]["nominal"]["z"];
    optics::Lens lens = lens_;
    lens.image_z = image_z;
    int compared = 0;
    for (const auto& row : data_["chief_rays"]["rows"]) {
        if (!row["first_clipped_surface"].is_null()) {
            continue;
        }
        const optics::ChiefRays rays(lens, wavelength(row["wavelength"]));
        const double field = row["field_deg"].get<double>() * kDegree;
        const auto ray = rays.at_field(field);
        ASSERT_TRUE(ray) << row["field_deg"];
        EXPECT_NEAR(ray->field_angle, field, 1e-14);
        EXPECT_NEAR(ray->image_height, row["y_nominal"].get<double>(), 1e-9) << row["field_deg"] << row["wavelength"];
        ++compared;
    }
    EXPECT_GT(compared, 40);
}

// The projected solid angle of the bundle at the d line, to the reference's own accuracy of about 1e-7 (it does not
// look for the corners between two rims' arcs).
TEST_P(OpticsReference, ProjectedSolidAngle) {
    optics::Lens lens = lens_;
    lens.image_z = data_["image_planes"]["paraxial_d"]["z"];
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, wavelength("d"));
    int compared = 0;
    for (const auto& row : data_["relative_illumination"]["rows"]) {
        const double expected = row["projected_solid_angle"];
        const optics::Bundle bundle = optics::image_bundle(traced, row["image_y"]);
        EXPECT_NEAR(bundle.projected_solid_angle / expected, 1.0, 1e-7) << row["field_deg"];
        EXPECT_LT(bundle.transmitted, bundle.projected_solid_angle);
        ++compared;
    }
    EXPECT_GT(compared, 10);
}

INSTANTIATE_TEST_SUITE_P(Tessar, OpticsReference, testing::Values("const", "catalog"),
                         [](const auto& suite) { return std::string(suite.param); });

}  // namespace lensproof::optics_reference_test
