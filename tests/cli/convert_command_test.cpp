// tests/cli/convert_command_test.cpp — `lensproof convert`: files written, warnings said, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::convert_command_test {

using Json = nlohmann::json;

constexpr const char* kRays =
    "id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\n"
    "a,3,11,-10,0.01,-0.02,1,587.5618\nb,-5,2,-10,0.1,0.2,1,486.1327\nc,0,19,-10,0,0,1,656.2725\n";

constexpr const char* kZoom = R"(name = "A zoom"
source = "made for this test"
surfaces = [
  { radius_mm = 50.0, thickness_mm = 4.0, n_d = 1.5, semi_diameter_mm = 10.0 },
  { radius_mm = -50.0, thickness_mm = 3.0, semi_diameter_mm = 10.0 },
  { stop = true, thickness_mm = 45.0, semi_diameter_mm = 5.0 },
]
[[zoom]]
name = "wide"
gaps_mm = { 2 = 3.0 }
[[zoom]]
name = "tele"
gaps_mm = { 2 = 9.5 }
)";

TEST(Convert, WritesALensThatTracesTheSame) {
    const Workplace place;
    place.file("rays.csv", kRays);
    const std::string original = place.run({"trace", "tessar", "--rays", "rays.csv"}).out;
    std::string in = "tessar";
    for (const std::string out : {"a.toml", "b.csv", "c.TOML"}) {  // each from the one before
        SCOPED_TRACE(out);
        const Outcome outcome = place.run({"convert", in, out});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(place.run({"trace", out, "--rays", "rays.csv"}).out, original);
        in = out;
    }
}

TEST(Convert, WarnsOfWhatTheFormCannotSayAndIsDone) {
    const Workplace place;
    const Outcome outcome = place.run({"convert", "petzval", "p.dat", "--json", "-"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(says(outcome.err, "warning: surface 1: of B270 its index"));
    const Json said = Json::parse(outcome.out);
    EXPECT_EQ(said["out"], "p.dat");
    EXPECT_TRUE(says(said["in"].get<std::string>(), "petzval.toml"));
    EXPECT_TRUE(said["remarks"].empty());
    const bool names_dispersion = std::ranges::any_of(said["lost"], [](const Json& lost) {
        return lost["code"] == "lost-dispersion" && lost["severity"] == "warning" && lost["surface"] == 1;
    });
    EXPECT_TRUE(names_dispersion) << said["lost"];
    EXPECT_TRUE(says(place.content("p.dat"), "\n0\t25.3\t0\t36\n")) << "a diameter, and 0 for air";
}

TEST(Convert, SaysWhatTheReaderDidNotUnderstand) {
    const Workplace place;
    place.file("a.fx", "#!wobble 3\n10 3 abbe 1.5 60 5\n100000 20 iris 5\n");
    const Outcome outcome = place.run({"convert", "a.fx", "a.toml", "--json", "a.json"});
    EXPECT_EQ(outcome.status, 0);
    const nlohmann::json remark = nlohmann::json::parse(place.content("a.json"))["remarks"][0];
    EXPECT_TRUE(remark["surface"].is_null()) << "it is of the lens as a whole: " << remark;
    EXPECT_TRUE(says(outcome.err, "warning: a line that begins with \"!wobble\" is not understood (a.fx)"));
}

TEST(Convert, TakesOneZoomPosition) {
    const Workplace place;
    place.file("zoom.toml", kZoom);
    EXPECT_EQ(place.run({"convert", "zoom.toml", "tele.csv", "--zoom", "tele"}).err, "");
    EXPECT_TRUE(says(place.content("tele.csv"), "2,-50,9.5,"));
    const Outcome first = place.run({"convert", "zoom.toml", "first.csv"});
    EXPECT_EQ(first.status, 0);
    EXPECT_TRUE(says(first.err, "\"wide\""));
    EXPECT_TRUE(says(place.content("first.csv"), "2,-50,3,"));
    EXPECT_EQ(place.run({"convert", "zoom.toml", "both.toml"}).err, "");
    EXPECT_TRUE(says(place.content("both.toml"), "[[zoom]]\nname = \"tele\""));
    const Outcome refused = place.run({"convert", "zoom.toml", "x.csv", "--zoom", "macro"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(says(refused.err, "wide, tele"));
    EXPECT_FALSE(place.has("x.csv"));
}

TEST(Convert, RefusesWhatItCannotReadOrWrite) {
    const Workplace place;
    place.file("noise.dat", "12 apples");
    place.file("folder.toml/inside", "");
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
        {{"tessar", "a.json"}, ".toml, .csv"},        {{"tessar", "a"}, ".toml, .csv"},
        {{"tessar", "folder.toml"}, "folder.toml"},   {{"nonesuch", "a.toml"}, "nonesuch"},
        {{"noise.dat", "a.toml"}, "noise.dat:1"},     {{"tessar", "a.toml", "--zoom", "2"}, "no zoom positions"},
        {{"tessar", "noise.dat/a.toml"}, "noise.dat"}};
    for (const auto& [arguments, word] : cases) {
        std::vector<std::string> all = arguments;
        all.insert(all.begin(), "convert");
        SCOPED_TRACE(word);
        expect_refused(place, all, {word});
    }
}

}  // namespace lensproof::convert_command_test
