// Analysis over the field against an independent 50-digit tracer (../shared/optics_reference, whose README gives its
// conventions). Skipped, and said so, where that folder is not there.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/analysis/beam_outline.h"
#include "engine/analysis/ray_pencil.h"
#include "engine/io/file.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/lens.h"

namespace lensproof {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

class FieldReference : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const std::filesystem::path file = data_root() / ".." / "shared" / "optics_reference" /
                                           (std::string("tessar_brendel_100__") + GetParam() + ".json");
        if (!std::filesystem::exists(file)) {
            GTEST_SKIP() << "no reference numbers beside the checkout: " << file.lexically_normal().filename();
        }
        data_ = nlohmann::json::parse(read_file(file));
        IndexOverrides overrides;
        if (std::string(GetParam()) == "const") {
            for (const auto& surface : data_["surfaces"]) {
                if (surface["material"] != "air") {
                    overrides[surface["material"]] = surface["n_after"]["d"];
                }
            }
        }
        lens_ = load_lens("tessar", {.indices = overrides});
        lens_.image_z = data_["image_planes"]["paraxial_d"]["z"];
    }

    [[nodiscard]] double wavelength(const std::string& line) const {
        return data_["index_model"]["wavelengths_nm"][line].get<double>();
    }

    Lens lens_;
    nlohmann::json data_;
};

// The beam's cross-section at the d line, to the reference's own accuracy of about 1e-7: it does not look for corners,
// and indeed agrees to 1e-15 as long as there are none.
TEST_P(FieldReference, BeamArea) {
    const TraceLens<double> lens = at_wavelength<double>(lens_, wavelength("d"));
    const ChiefRays rays(lens_, wavelength("d"), Rims::follow);
    int compared = 0;
    for (const auto& row : data_["vignetting"]["rows"]) {
        const auto chief = rays.at_field(row["field_deg"].get<double>() * kDegree);
        ASSERT_TRUE(chief) << row["field_deg"];
        const RegionOutline outline = beam_outline(lens, {.chief = *chief});
        EXPECT_NEAR(outline.area / row["area_perp"].get<double>(), 1.0, row["field_deg"] < 5.0 ? 1e-13 : 1e-7)
            << row["field_deg"];
        ++compared;
    }
    EXPECT_GT(compared, 10);
}

// Tangential and sagittal foci along every chief ray that the reference lists them for. It asks for 1e-8 mm; a focal
// distance of 100 mm in double after eight surfaces should do 1e-11.
TEST_P(FieldReference, AstigmaticFoci) {
    int compared = 0;
    for (const char* line : {"F", "d", "C"}) {
        const TraceLens<double> lens = at_wavelength<double>(lens_, wavelength(line));
        const ChiefRays rays(lens_, wavelength(line), Rims::follow);
        for (const auto& row : data_["chief_rays"]["rows"]) {
            if (row["wavelength"] != line) {
                continue;
            }
            const auto chief = rays.at_field(row["field_deg"].get<double>() * kDegree);
            ASSERT_TRUE(chief) << row["field_deg"];
            const auto pencil = ray_pencil(lens, {.chief = *chief});
            ASSERT_TRUE(pencil);
            const AstigmaticFoci foci = astigmatic_foci(*pencil, lens_.image_z);
            EXPECT_NEAR(foci.tangential, row["astigmatic_focus"]["dz_T_from_paraxial_d"].get<double>(), 1e-11)
                << row["field_deg"];
            EXPECT_NEAR(foci.sagittal, row["astigmatic_focus"]["dz_S_from_paraxial_d"].get<double>(), 1e-11)
                << row["field_deg"];
            ++compared;
        }
    }
    EXPECT_GT(compared, 70);
}

INSTANTIATE_TEST_SUITE_P(Tessar, FieldReference, testing::Values("const", "catalog"),
                         [](const auto& suite) { return std::string(suite.param); });

}  // namespace
}  // namespace lensproof
