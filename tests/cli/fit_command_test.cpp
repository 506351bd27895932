// `lensproof fit`: what a simulated profile's lens has, by the program.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/calibration/explain/simulated_profile.h"
#include "tests/cli/program.h"

namespace lensproof::fit_command_test {

using calibration::explain_test::simulated_profile;
using calibration::explain_test::Studio;

/// Few points and kinds: the program takes a second.
Studio small_studio() {
    Studio studio;
    studio.columns = 6;
    studio.rows = 4;
    return studio;
}

TEST(FitCommand, SaysWhatIsOtherwise) {
    const Workplace place;
    const Studio studio = small_studio();
    calibration::write_profile(simulated_profile(studio, {{"decentre_y_5_6_mm", 0.06}}, 1),
                               place.path() / "profile.json");
    const std::vector<std::string> command{"fit",    "profile.json",   "--lens",  "tessar",
                                           "--free", "focus,decentre", "--focus", "2000"};
    const nlohmann::json found = place.json(command);
    EXPECT_EQ(found["verdict"], "explained");
    EXPECT_GT(found["residual_rms_um_before"], 1.5 * found["residual_rms_um_after"].get<double>());
    const auto decentre = std::ranges::find_if(
        found["parameters"], [](const nlohmann::json& of) { return of["name"] == "decentre_y_5_6_mm"; });
    ASSERT_NE(decentre, found["parameters"].end());
    EXPECT_NEAR((*decentre)["value"], 0.06, 3.0 * (*decentre)["standard_error"].get<double>());
    EXPECT_EQ((*decentre)["prior_standard_error"], 0.03);
    EXPECT_TRUE((*decentre)["determined"].is_boolean());
    ASSERT_FALSE(found["undetermined"].empty());
    double squares = 0.0;
    for (const auto& component : found["undetermined"].back()["combination"]) {
        squares += component.get<double>() * component.get<double>();
    }
    EXPECT_NEAR(squares, 1.0, 0.15);  // shares below 0.15 are left out
    EXPECT_GT(found["undetermined"].back()["standard_error"], 0.5);

    const Outcome text = place.run(command);
    ASSERT_EQ(text.status, 0) << text.err;
    for (const char* words : {"tessar: explained", "held-out points", "decentre_y_5_6_mm", "tell these apart"}) {
        EXPECT_NE(text.out.find(words), std::string::npos) << text.out;
    }
}

TEST(FitCommand, RefusesWhatItCannotUse) {
    const Workplace place;
    const Studio studio = small_studio();
    calibration::Profile profile = simulated_profile(studio, {}, 1);
    calibration::write_profile(profile, place.path() / "profile.json");
    profile.width_px -= 100;
    calibration::write_profile(profile, place.path() / "other.json");
    place.file("stopless.csv",
               "surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind\n"
               "1,50,5,1.5,60,10,lens\n2,-50,95,,,10,lens\n");
    const auto refused = [&](const std::vector<std::string>& rest, const std::string& words) {
        std::vector<std::string> arguments{"fit", "profile.json"};
        arguments.insert(arguments.end(), rest.begin(), rest.end());
        const Outcome outcome = place.run(arguments);
        EXPECT_EQ(outcome.status, 2) << words;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    };
    refused({"other.json", "--lens", "tessar"}, "other.json is of another camera than profile.json");
    refused({"--lens", "tessar", "--free", "focus,stop"}, "--free is \"stop\", expected focus, gaps");
    refused({"--lens", "stopless.csv"}, "stop");
    refused({"none.json", "--lens", "tessar"}, "none.json");
    refused({}, "--lens");
}

}  // namespace lensproof::fit_command_test
