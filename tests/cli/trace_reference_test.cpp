// tests/cli/trace_reference_test.cpp — the command `trace` against rays traced by others with 50 digits.
//
// The numbers lie in ../shared/optics_reference beside the repository; its README states the conventions and the
// tolerances that are used here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"
#include "tests/places.h"

namespace lensproof::trace_reference_test {

using Json = nlohmann::json;
constexpr double kPointTolerance_mm = 1e-9;
constexpr double kDirectionTolerance = 1e-12;

/// Surfaces are counted from 1; nothing where the ray passes every rim.
Json first_clipped(const std::vector<TraceRow>& rows) {
    for (const TraceRow& row : rows) {
        if (row.status == "clipped" || row.status == "stopped") {
            EXPECT_EQ(row.status == "stopped", row.surface == "4") << "surface 4 is the stop";
            return std::stoi(row.surface);
        }
    }
    return nullptr;
}

/// Where the ray of an image row meets another plane, x and y.
std::array<double, 2> at_plane(const TraceRow& image, double z) {
    const double along = (z - image.point[2]) / image.direction[2];
    return {image.point[0] + along * image.direction[0], image.point[1] + along * image.direction[1]};
}

/// A reference file, and what the command says of all of its rays in one go.
class TracedReference {
  public:
    explicit TracedReference(const std::string& name) {
        std::ifstream stream(shared_data() / "optics_reference" / name);
        reference_ = Json::parse(stream);
        std::string csv = kRayHeader;
        for (const Json& ray : reference_["rays"]["rays"]) {
            csv += ray_line(ray["id"].get<std::string>() + wavelength_name(ray), triple(ray["origin"]),
                            triple(ray["direction"]), wavelength(ray));
        }
        const Json& chiefs = reference_["chief_rays"]["rows"];
        for (std::size_t i = 0; i < chiefs.size(); ++i) {
            csv += ray_line(chief_id(i), triple(chiefs[i]["origin"]), triple(chiefs[i]["direction"]),
                            wavelength(chiefs[i]));
        }
        const Json& fans = reference_["ray_fans"]["fans"];
        for (std::size_t i = 0; i < fans.size(); ++i) {
            for (std::size_t k = 0; k < fans[i]["points"].size(); ++k) {
                csv += ray_line(fan_id(i, k), triple(fans[i]["points"][k]["origin"]), triple(fans[i]["direction"]),
                                wavelength(fans[i]));
            }
        }
        place_.file("rays.csv", csv);
        std::vector<std::string> arguments = {"trace", "tessar", "--rays", "rays.csv", "--no-clip", "-o", "out.csv"};
        if (reference_["index_model"]["id"] == "const") {
            for (const auto& [glass, index] : constant_indices()) {
                arguments.insert(arguments.end(), {"--index", glass + "=" + exact(index)});
            }
        }
        const Outcome outcome = place_.run(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.out + outcome.err, "");
        rows_ = read_trace_rows(place_.content("out.csv"));
    }

    [[nodiscard]] const Json& reference() const { return reference_; }
    [[nodiscard]] const std::vector<TraceRow>& rows(const std::string& id) const { return rows_.at(id); }
    [[nodiscard]] const TraceRow& image(const std::string& id) const { return rows(id).back(); }
    [[nodiscard]] static std::string wavelength_name(const Json& entry) { return entry["wavelength"]; }
    [[nodiscard]] static std::string chief_id(std::size_t row) { return "chief" + std::to_string(row); }
    [[nodiscard]] static std::string fan_id(std::size_t fan, std::size_t point) {
        return "fan" + std::to_string(fan) + "-" + std::to_string(point);
    }
    [[nodiscard]] double plane_z(const char* plane) const { return reference_["image_planes"][plane]["z"]; }

  private:
    [[nodiscard]] double wavelength(const Json& entry) const {
        return reference_["index_model"]["wavelengths_nm"][wavelength_name(entry)];
    }

    [[nodiscard]] std::map<std::string, double> constant_indices() const {
        std::map<std::string, double> indices;
        for (const Json& surface : reference_["surfaces"]) {
            if (surface["material"] != "air" && surface["n_after"]["d"] != 1.0) {
                indices[surface["material"]] = surface["n_after"]["d"];
            }
        }
        return indices;
    }

    Workplace place_;
    Json reference_;
    TraceRows rows_;
};

class TraceReference : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(shared_data() / "optics_reference" / GetParam())) {
            GTEST_SKIP() << "the reference numbers are not beside the repository: "
                         << shared_data() / "optics_reference" << GetParam();
        }
    }
};

TEST_P(TraceReference, EverySurfaceOfEveryRay) {
    const TracedReference traced(GetParam());
    int compared = 0;
    for (const Json& ray : traced.reference()["rays"]["rays"]) {
        const std::string id = ray["id"].get<std::string>() + TracedReference::wavelength_name(ray);
        SCOPED_TRACE(id);
        // A ray that had to travel backwards to a surface is beyond its physical edge, and any answer to it is good.
        if (!ray["negative_segment"].is_null()) {
            continue;
        }
        ASSERT_EQ(ray["status"], "ok") << "the file has only rays that get through; teach this test the others";
        const std::vector<TraceRow>& rows = traced.rows(id);
        ASSERT_EQ(rows.size(), ray["surfaces"].size() + 1);
        for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
            const Json& surface = ray["surfaces"][i];
            EXPECT_EQ(rows[i].surface, std::to_string(surface["i"].get<int>()));
            expect_near(rows[i].point, {surface["x"], surface["y"], surface["z"]}, kPointTolerance_mm);
            expect_near(rows[i].direction, {surface["L"], surface["M"], surface["N"]}, kDirectionTolerance);
            EXPECT_NEAR(rows[i].optical_path, surface["opl"].get<double>(), kPointTolerance_mm);
        }
        const Json& nominal = ray["image"]["nominal"];
        EXPECT_EQ(rows.back().surface, "image");
        expect_near(rows.back().point, {nominal["x"], nominal["y"], nominal["z"]}, kPointTolerance_mm);
        EXPECT_NEAR(rows.back().optical_path, nominal["opl"].get<double>(), kPointTolerance_mm);
        EXPECT_EQ(first_clipped(rows), ray["first_clipped_surface"]);
        ++compared;
    }
    EXPECT_EQ(compared, 96);
}

TEST_P(TraceReference, ChiefRaysMeetBothImagePlanesAtTheirHeights) {
    const TracedReference traced(GetParam());
    const Json& chiefs = traced.reference()["chief_rays"]["rows"];
    for (std::size_t i = 0; i < chiefs.size(); ++i) {
        SCOPED_TRACE(i);
        const TraceRow& image = traced.image(TracedReference::chief_id(i));
        EXPECT_NEAR(image.point[1], chiefs[i]["y_nominal"].get<double>(), kPointTolerance_mm);
        EXPECT_NEAR(at_plane(image, traced.plane_z("paraxial_d"))[1], chiefs[i]["y_paraxial_d"].get<double>(),
                    kPointTolerance_mm);
        expect_near(image.direction, triple(chiefs[i]["exit_direction"]), kDirectionTolerance);
        EXPECT_EQ(first_clipped(traced.rows(TracedReference::chief_id(i))), chiefs[i]["first_clipped_surface"]);
    }
}

TEST_P(TraceReference, RayFansErrFromTheChiefRayAsTheReferenceSays) {
    const TracedReference traced(GetParam());
    const Json& chiefs = traced.reference()["chief_rays"]["rows"];
    const Json& fans = traced.reference()["ray_fans"]["fans"];
    const double z = traced.plane_z("paraxial_d");
    int compared = 0;
    for (std::size_t i = 0; i < fans.size(); ++i) {
        const double field = fans[i]["field_deg"];
        const auto chief = std::find_if(chiefs.begin(), chiefs.end(), [&](const Json& row) {
            return row["wavelength"] == "d" && row["field_deg"] == field;
        });
        ASSERT_NE(chief, chiefs.end()) << "field " << field;
        for (std::size_t k = 0; k < fans[i]["points"].size(); ++k) {
            SCOPED_TRACE(TracedReference::fan_id(i, k));
            const Json& point = fans[i]["points"][k];
            const std::vector<TraceRow>& rows = traced.rows(TracedReference::fan_id(i, k));
            EXPECT_EQ(first_clipped(rows), point["first_clipped_surface"]);
            const std::array<double, 2> met = at_plane(rows.back(), z);
            EXPECT_NEAR(met[0], point["ex"].get<double>(), kPointTolerance_mm);
            EXPECT_NEAR(met[1] - (*chief)["y_paraxial_d"].get<double>(), point["ey"].get<double>(), kPointTolerance_mm);
            ++compared;
        }
    }
    EXPECT_EQ(compared, 756);
}

INSTANTIATE_TEST_SUITE_P(Tessar, TraceReference,
                         testing::Values("tessar_brendel_100__const.json", "tessar_brendel_100__catalog.json"),
                         [](const auto& file) {
                             return std::string(file.param).find("const") == std::string::npos ? "CatalogueGlass"
                                                                                               : "ConstantIndices";
                         });

}  // namespace lensproof::trace_reference_test
