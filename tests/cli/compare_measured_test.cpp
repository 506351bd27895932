// `compare LENS --measured`: a lens against an entry that was made from what `analyze` says of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/calibration/photographed/dng_file.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::compare_measured_test {

constexpr double kHalfDiagonal_mm = 21.633307652783937;  // of 36 × 24 mm
constexpr double kUnit_mm = 12.0;
constexpr const char* kModel = "lensfun:Own 50mm f/2";

/// What is imaged at r (1 + k1 r² + k2 r⁴), r in kUnit_mm, through the heights that `analyze` finds at two fields.
struct TwoTerms {
    double k1 = 0.0;
    double k2 = 0.0;
};

TwoTerms own_terms(const Workplace& place, const std::string& lens) {
    const nlohmann::json found = place.json({"analyze", lens, "--fields", "15,23", "--wavelengths", "587.5618"});
    const double focal = found["paraxial"]["efl_mm"];
    const auto sample = [&](int i) {
        const double angle = found["fields"][i]["field_deg"].get<double>() * std::acos(-1.0) / 180.0;
        const double ideal = focal * std::tan(angle);
        return std::pair(std::pow(ideal / kUnit_mm, 2),
                         found["fields"][i]["chief_ray_height_mm"].get<double>() / ideal - 1.0);
    };
    const auto [x, a] = sample(0);
    const auto [y, b] = sample(1);
    const double k2 = (b / y - a / x) / (y - x);
    return {.k1 = a / x - k2 * x, .k2 = k2};
}

/// lensfun's poly5 with these terms.
std::string own_entry(const Workplace& place, const std::string& lens) {
    const TwoTerms terms = own_terms(place, lens);
    return fmt::format(
        "<!DOCTYPE lensdatabase SYSTEM \"lensfun-database.dtd\">\n<lensdatabase "
        "version=\"1\">\n<lens><maker>Own</maker>"
        "<model>Own 50mm f/2</model><mount>M</mount><cropfactor>1</cropfactor><calibration>"
        "<distortion model=\"poly5\" focal=\"50\" k1=\"{}\" k2=\"{}\"/>"
        "<tca model=\"linear\" focal=\"50\" kr=\"1.0001\" kb=\"1.0001\"/>"
        "<vignetting model=\"pa\" focal=\"50\" aperture=\"8\" distance=\"1000\" k1=\"-0.4\" k2=\"0\" k3=\"0\"/>"
        "</calibration></lens></lensdatabase>\n",
        terms.k1, terms.k2);
}

/// The same as its maker's correction: in units of the half-diagonal, but for half a pixel of thousands.
std::string own_dng(const Workplace& place, const std::string& lens) {
    using namespace calibration::synthetic;
    const TwoTerms terms = own_terms(place, lens);
    const double unit2 = std::pow(kHalfDiagonal_mm / kUnit_mm, 2);
    const std::array warp{1.0, terms.k1 * unit2, terms.k2 * unit2 * unit2, 0.0, 0.0, 0.0, 0.5, 0.5};
    const std::array gain{0.4, 0.0, 0.0, 0.0, 0.0, 0.5, 0.5};
    Dng dng{.opcodes = opcode_list({opcode(3, big_endian(gain)), warp_opcode(1, warp)})};
    dng.photo = with_focal_plane(dng.photo);
    return dng_bytes(dng);
}

TEST(CompareMeasured, ALensAgreesWithItsOwnEntryAndAnotherDoesNot) {
    const Workplace place;
    place.file("own.xml", own_entry(place, "xenon"));
    const Outcome right = place.run({"compare", "xenon", "--measured", kModel, "--lensfun-data", "own.xml",
                                     "--wavelength", "587.5618", "--json", "-"});
    ASSERT_EQ(right.status, 0) << right.err;
    const nlohmann::json json = nlohmann::json::parse(right.out);
    EXPECT_EQ(json["measured"]["source"], "lensfun");
    EXPECT_EQ(json["measured"]["maker"], "Own");
    EXPECT_EQ(json["measured"]["model"], "Own 50mm f/2");
    EXPECT_EQ(json["measured"]["crop_factor"], 1.0);
    EXPECT_EQ(json["measured"]["projection"], "rectilinear");
    const nlohmann::json& distortion = json["distortion"];
    EXPECT_LT(distortion["residual_rms_um"], 1.0);  // two terms through two heights
    EXPECT_NEAR(distortion["scale"], 1.0, 2e-4);
    EXPECT_NEAR(distortion["half_diagonal_mm"], kHalfDiagonal_mm, 1e-6);
    EXPECT_EQ(distortion["verdict"], "PASS");
    EXPECT_GT(distortion["limit_um"], 0.0);
    const auto& last = distortion["measured_percent"].back();
    EXPECT_NEAR(last[0], 1.0, 1e-6);
    EXPECT_NEAR(last[1], distortion["simulated_percent"].back()[1], 0.02);
    EXPECT_TRUE(json["chromatic_shift"].is_null());
    EXPECT_NEAR(json["vignetting"][0]["corner_measured"], 0.6, 1e-6);
    EXPECT_GT(json["vignetting"][0]["corner_simulated"], 0.3);

    const Outcome wrong =
        place.run({"compare", "nikkor-50-f12", "--measured", kModel, "--lensfun-data", "own.xml", "--json", "-"});
    EXPECT_EQ(wrong.status, 1);
    EXPECT_EQ(nlohmann::json::parse(wrong.out)["distortion"]["verdict"], "FAIL");
    EXPECT_GE(nlohmann::json::parse(wrong.out)["chromatic_shift"]["red"]["residual_rms_um"], 0.0);

    const Outcome text = place.run({"compare", "xenon", "--measured", kModel, "--lensfun-data", "own.xml"});
    EXPECT_NE(text.out.find("PASS"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("red − green"), std::string::npos) << text.out;
}

TEST(CompareMeasured, ALensAgreesWithItsMakersCorrectionAndAnotherDoesNot) {
    const Workplace place;
    place.file("own.dng", own_dng(place, "xenon"));
    const Outcome right =
        place.run({"compare", "xenon", "--measured", "dng:own.dng", "--wavelength", "587.5618", "--json", "-"});
    ASSERT_EQ(right.status, 0) << right.err;
    const nlohmann::json json = nlohmann::json::parse(right.out);
    EXPECT_EQ(json["measured"]["source"], "dng");
    EXPECT_EQ(json["measured"]["model"], "Own 50mm f/2");
    EXPECT_EQ(json["measured"]["distortion_model"], "warp-rectilinear");
    EXPECT_TRUE(json["measured"]["remarks"].empty());
    EXPECT_LT(json["distortion"]["residual_rms_um"], 1.0);  // two terms through two heights
    EXPECT_NEAR(json["distortion"]["scale"], 1.0, 2e-4);
    EXPECT_NEAR(json["distortion"]["half_diagonal_mm"], kHalfDiagonal_mm, 1e-6);
    EXPECT_EQ(json["distortion"]["verdict"], "PASS");
    EXPECT_NEAR(json["vignetting"][0]["corner_measured"], 1.0 / 1.4, 1e-3);

    const Outcome wrong = place.run({"compare", "nikkor-50-f12", "--measured", "dng:own.dng"});
    EXPECT_EQ(wrong.status, 1);
    EXPECT_TRUE(says(wrong.out, "FAIL"));
}

TEST(CompareMeasured, RefusesWhatItCannotCompare) {
    const Workplace place;
    place.file("own.xml", own_entry(place, "xenon"));
    const auto refused = [&](const std::vector<std::string>& rest, const std::vector<std::string>& words) {
        std::vector<std::string> arguments{"compare", "xenon"};
        arguments.insert(arguments.end(), rest.begin(), rest.end());
        expect_refused(place, arguments, words);
    };
    refused({"--measured", "lensfun:Own 50mm f/1", "--lensfun-data", "own.xml"}, {"own.xml", "Own 50mm f/2"});
    refused({"--measured", kModel, "--crop-factor", "1.5", "--lensfun-data", "own.xml"}, {"1.5"});
    refused({"--measured", kModel, "--lensfun-data", "none.xml"}, {"none.xml"});
    refused({"--measured", "Own 50mm f/2"}, {"lensfun:MODEL", "dng:FILE"});
    refused({"--measured", "dng:own.xml"}, {"own.xml", "no DNG"});
    refused({"--measured", "dng:none.dng"}, {"none.dng"});
    refused({"--measured", "dng:own.xml", "--lensfun-data", "own.xml"}, {"--lensfun-data"});
    refused({"--measured", kModel, "--lensfun-data", "own.xml", "--wavelength", "50"}, {"50"});
    refused({"--crop-factor", "1"}, {"--measured"});
    refused({}, {"--measured"});
    place.file("cut.xml", own_entry(place, "xenon").substr(0, 300));
    refused({"--measured", kModel, "--lensfun-data", "cut.xml"}, {"cut.xml"});
}

}  // namespace lensproof::compare_measured_test
