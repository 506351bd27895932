// tests/cli/command_line_test.cpp — what the program promises on its command line: statuses, streams, bytes.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "engine/base/data_root.h"
#include "engine/base/file.h"
#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"
#include "tests/complaint.h"

namespace lensproof::command_line_test {

using Json = nlohmann::json;

const std::vector<std::string> kCommands = {"demo",     "check",      "convert",  "analyze", "trace",  "ghosts",
                                            "render",   "merge",      "chart",    "measure", "fit",    "compare",
                                            "export",   "run",        "tradeoff", "plan",    "lenses", "glasses",
                                            "coatings", "completion", "manual"};

std::string rays_text() {
    return std::string(kRayHeader) + kAxialRay + "b,0,19,-10,0,0,1,486.1327\nc,0,40,-10,0,0,1,587.5618\n";
}

TEST(Help, ListsEveryCommandAndShowsAnExampleOfEach) {
    const Workplace place;
    const Outcome all = place.run({"--help"});
    EXPECT_EQ(all.status, 0);
    for (const std::string& command : kCommands) {
        SCOPED_TRACE(command);
        EXPECT_TRUE(says(all.out, "\n  " + command + " "));
        const Outcome one = place.run({command, "--help"});
        EXPECT_EQ(one.status, 0);
        EXPECT_EQ(one.err, "");
        EXPECT_TRUE(says(one.out, "Example: lensproof " + command));
    }
}

TEST(Version, SaysCommitAndLibraries) {
    const Workplace place;
    const Outcome version = place.run({"--version"});
    ASSERT_EQ(version.status, 0) << version.err;
    std::string numbered;
    for (const char* library : {"OpenCV", "Ceres", "OpenImageIO", "OpenEXR", "Embree", "Eigen", "assimp"}) {
        numbered += (numbered.empty() ? "" : ", ") + std::string(library) + R"( [0-9]+(\.[0-9]+)+)";
    }
    EXPECT_TRUE(
        std::regex_match(version.out, std::regex("lensproof [0-9]+(\\.[0-9]+)+\ncommit ([0-9a-f]{40}|unknown)\nbuilt "
                                                 "by [A-Za-z]+ [0-9]+(\\.[0-9]+)+ against " +
                                                 numbered + "\n")))
        << version.out;
}

// Of a checkout, and of a worktree beside it, which keeps its own files in the checkout's.
TEST(Version, KnowsACheckoutsCommitAndAWorktrees) {
    const Workplace place;
    const std::string first(40, '1');
    const std::string second(40, '2');
    place.file("main/.git/HEAD", "ref: refs/heads/main\n");
    place.file("main/.git/packed-refs", "# pack-refs with: peeled\n" + first + " refs/heads/main\n");
    place.file("main/.git/refs/heads/side", second + "\n");
    place.file("main/.git/worktrees/side/HEAD", "ref: refs/heads/side\n");
    place.file("main/.git/worktrees/side/commondir", "../..\n");
    place.file("side/.git", "gitdir: " + (place.path() / "main/.git/worktrees/side").string() + "\n");
    for (const auto& [folder, commit] : std::map<std::string, std::string>{{"main", first}, {"side", second}}) {
        const Variable home("LENSPROOF_HOME", (place.path() / folder).string());
        EXPECT_TRUE(says(place.run({"--version"}).out, "\ncommit " + commit + "\n")) << folder;
    }
}

TEST(Lists, NameWhatShipsWithItsSource) {
    const Workplace place;
    const Json lenses = place.json({"lenses"})["lenses"];
    std::vector<std::string> names;
    for (const Json& lens : lenses) {
        names.push_back(lens["lens"]);
        EXPECT_FALSE(lens["source"].get<std::string>().empty());
    }
    for (const char* name : {"muller-fisheye", "petzval", "tessar"}) {
        EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
    }
    const Json glasses = place.json({"glasses"})["glasses"];
    for (const Json& glass : glasses) {
        EXPECT_FALSE(glass["source"].get<std::string>().empty()) << glass;
    }
}

TEST(Coatings, AreListedWithWhatTheyReflect) {
    const Workplace place;
    const Json result = place.json({"coatings"});
    EXPECT_NEAR(result["bare_reflectance_at_550_nm_percent"].get<double>(), 4.2389,
                1e-3);  // ((n - 1)/(n + 1))², 1.51852
    std::vector<std::string> names;
    for (const Json& coating : result["coatings"]) {
        names.push_back(coating["coating"]);
        EXPECT_FALSE(coating["source"].get<std::string>().empty());
        EXPECT_TRUE(says(coating["notes"], "Assumed"));
        EXPECT_LT(coating["mean_reflectance_400_to_700_nm_percent"].get<double>(), 2.0);
        EXPECT_GE(coating["absorptance_at_550_nm_percent"].get<double>(), -1e-12);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"broadband", "mgf2", "quarter-half-quarter", "v-coat"}));
    EXPECT_TRUE(says(place.run({"coatings"}).out, "assumed"));
    place.file(
        "short.toml",
        "name = \"short\"\nsource = \"me\"\nlayers = [{ n = [[500, 1.38], [600, 1.37]], thickness_nm = 100 }]\n");
    place.file("own.toml", "name = \"own\"\nsource = \"me\"\nlayers = [{ n = 1.38, quarter_wave_nm = 550.0 }]\n");
    const Json own = place.json({"coatings", "own.toml", "mgf2", "--on", "SF6", "--plots", "plots"});
    ASSERT_EQ(own["coatings"].size(), 2U);
    EXPECT_EQ(own["coatings"][0]["coating"], "own");
    EXPECT_EQ(own["coatings"][0]["spectra"].size(), 5U);
    for (const char* file : {"own-wavelength.svg", "own-angle.svg", "mgf2-wavelength.svg", "mgf2-angle.svg"}) {
        EXPECT_TRUE(says(place.content(std::string("plots/") + file), "<svg")) << file;
    }
    for (const auto& [arguments, words] :
         {std::pair{std::vector<std::string>{"coatings", "mgf3"}, "did you mean \"mgf2\"?"},
          std::pair{std::vector<std::string>{"chart", "checkerbord", "-o", "b.pdf"}, "did you mean \"checkerboard\"?"},
          {{"coatings", "--on", "GLAS"}, "--on GLAS"},
          {{"coatings", "short.toml"}, "short.toml: 400 nm is outside the range of a coating's layer"}}) {
        const Outcome refused = place.run(arguments);
        EXPECT_EQ(refused.status, 2);
        EXPECT_TRUE(says(refused.err, words));
    }
}

// Both polarisations from both sides: of a single face by Fresnel, and as much through it both ways; nothing gets out
// beyond the critical angle.
TEST(Coatings, SayBothPolarisationsOnRequest) {
    const Workplace place;
    place.file("none.toml", "name = \"none\"\nsource = \"me\"\nlayers = [{ n = 1.5, thickness_nm = 90.0 }]\n");
    const Json result =
        place.json({"coatings", "none.toml", "--on", "1.5", "--angles", "0,60", "--wavelengths", "500"});
    EXPECT_EQ(result["glass"], "n = 1.5");
    const Json& powers = result["coatings"][0]["powers"];
    ASSERT_EQ(powers.size(), 4U);
    EXPECT_NEAR(powers[0]["s"]["reflectance"].get<double>(), 0.04, 1e-14);
    EXPECT_EQ(powers[1]["from"], "glass");
    EXPECT_NEAR(powers[1]["p"]["transmittance"].get<double>(), 0.96, 1e-14);
    const double inside = std::asin(std::sin(std::acos(0.5)) / 1.5);
    const double s = std::sin(std::acos(0.5) - inside) / std::sin(std::acos(0.5) + inside);
    EXPECT_EQ(powers[2]["angle_deg"], 60.0);
    EXPECT_NEAR(powers[2]["s"]["reflectance"].get<double>(), s * s, 1e-14);
    EXPECT_NEAR(powers[3]["s"]["reflectance"].get<double>(), 1.0, 1e-14);
    EXPECT_TRUE(says(place.run({"coatings", "mgf2", "--angles", "30"}).out, "R s %"));
    expect_refused(place, {"coatings", "mgf2", "--angles", "90"}, {"--angles", "below 90"});
    expect_refused(place, {"coatings", "mgf2", "--wavelengths", "500"}, {"--angles"});
    expect_refused(place, {"coatings", "mgf2", "--on", "0.5"}, {"--on", "1 to 10"});
}

// A ray along the axis passes six faces to air: all with a quarter wave, all bare, one only.
TEST(Coatings, AreWornOnRequest) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + "a,0,0,-10,0,0,1,550\n");
    const auto passes = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"trace", "tessar", "--rays", "rays.csv"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return place.json(arguments)["rows"].back()["transmittance"].get<double>();
    };
    const double bare = passes({});
    EXPECT_EQ(passes({"--coating", "none"}), bare);
    EXPECT_GT(passes({"--coating", "mgf2"}), 1.2 * bare);
    EXPECT_GT(passes({"--coating", "broadband"}), passes({"--coating", "mgf2"}));
    EXPECT_GT(passes({"--coating", "1=mgf2"}), bare);
    const auto of_axis = [&](const char* coating) {
        return place
            .json({"analyze", "tessar", "--fields", "0", "--wavelengths", "550", "--coating",
                   coating})["fields"][0]["transmittance"]
            .get<double>();
    };
    EXPECT_NEAR(of_axis("none"), bare, 1e-12);
    EXPECT_NEAR(of_axis("mgf2"), passes({"--coating", "mgf2"}), 1e-12);
    const Outcome refused = place.run({"trace", "tessar", "--rays", "rays.csv", "--coating", "9=mgf2"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(says(refused.err, "from 1 to 8"));
}

TEST(Glasses, ShowsTheSheetOfAGlassAsItsMakerDoes) {
    const Workplace place;
    const Json sheet = place.json({"glasses", "NBK7_SCHOTT"})["glasses"][0];
    EXPECT_EQ(sheet["glass"], "N-BK7");
    EXPECT_EQ(sheet["lines"].size(), 13U);
    EXPECT_NEAR(sheet["P_gF"].get<double>(), 0.5349, 1e-4);
    EXPECT_GT(sheet["internal_transmittance"].size(), 20U);
    EXPECT_TRUE(says(place.run({"glasses", "N-BK7"}).out, "1.516800"));
    const Outcome unknown = place.run({"glasses", "N-LLF7"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_TRUE(says(unknown.err, "perhaps LLF7 (SCHOTT)"));
}

TEST(Glasses, ThatTheUserBringsComeFirst) {
    const Workplace place;
    place.file("mine.csv", "glass,formula,coefficients,min_nm,max_nm\nBK7,constant,1.5,400,700\n");
    place.file("bad.agf", "NM\n");
    place.file("rays.csv", rays_text());
    const Json own = place.json({"glasses", "BK7", "--glass-catalogue", "mine.csv"});
    EXPECT_EQ(own["glasses"][0]["n_d"], 1.5);
    EXPECT_EQ(own["glasses"][0]["also_in"][0], "SCHOTT");
    EXPECT_EQ(place.run({"trace", "tessar", "--rays", "rays.csv", "--glass-catalogue", "mine.csv"}).status, 0);
    for (const char* file : {"bad.agf", "missing.agf", "rays.txt", "rays.csv"}) {
        const Outcome refused = place.run({"glasses", "--glass-catalogue", file});
        EXPECT_EQ(refused.status, 2) << file;
        EXPECT_TRUE(says(refused.err, file));
    }
}

TEST(StandardOutput, HoldsOnlyTheJsonWhereItIsAskedFor) {
    const Workplace place;
    place.file("rays.csv", rays_text());
    place.file("scene.toml", small_scene());
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"lenses"},
                                                      {"trace", "tessar", "--rays", "rays.csv"},
                                                      {"render", "scene.toml", "-o", "out.exr"},
                                                      {"compare", "out.png", "out.png"}}) {
        SCOPED_TRACE(arguments.front());
        std::vector<std::string> asking = arguments;
        asking.insert(asking.end(), {"--json", "-"});
        const Outcome outcome = place.run(asking);
        EXPECT_EQ(outcome.status, 0);
        EXPECT_EQ(outcome.err, "") << "a progress bar is for terminals";
        EXPECT_TRUE(Json::accept(outcome.out)) << outcome.out;
    }
}

TEST(StandardOutput, KeepsItsTextWhereTheJsonGoesToAFile) {
    const Workplace place;
    const std::string json = place.run({"glasses", "--json", "-"}).out;
    const std::string text = place.run({"glasses"}).out;
    EXPECT_EQ(place.run({"glasses", "--json", "result.json"}).out, text);
    EXPECT_EQ(place.content("result.json"), json);
}

TEST(StandardOutput, ThatCannotBeWrittenIsStatus3) {
    const Workplace place;
    place.file("rays.csv", rays_text());
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--help"}, {"trace", "tessar", "--rays", "rays.csv"}}) {
        SCOPED_TRACE(arguments.front());
        const Outcome full = place.run(arguments, Stream::full_disk);
        EXPECT_EQ(full.status, 3);
        EXPECT_TRUE(says(full.err, "No space left"));
        const Outcome closed = place.run(arguments, Stream::closed);
        EXPECT_EQ(closed.status, 3);
        EXPECT_TRUE(says(closed.err, "standard output"));
        EXPECT_EQ(place.run(arguments, Stream::closed, Stream::closed).status, 3);
    }
}

// As `| head` does: the reader has all it wanted. `glasses` says more than a buffer holds.
TEST(StandardOutput, WhoseReaderHasGoneEndsQuietly) {
    const Workplace place;
    for (const char* command : {"--help", "glasses", "lenses"}) {
        const Outcome gone = place.run({command}, Stream::reader_gone);
        EXPECT_EQ(gone.status, 0) << command;
        EXPECT_EQ(gone.err, "") << command;
    }
}

TEST(StandardOutput, ThatIsClosedDoesNotSpoilAFile) {
    const Workplace place;
    place.file("rays.csv", rays_text());
    ASSERT_EQ(place.run({"trace", "tessar", "--rays", "rays.csv", "-o", "open.csv"}).status, 0);
    EXPECT_EQ(place.run({"trace", "tessar", "--rays", "rays.csv", "-o", "closed.csv"}, Stream::closed).status, 0);
    EXPECT_EQ(place.content("closed.csv"), place.content("open.csv"));
}

TEST(StandardError, ThatCannotBeWrittenLeavesTheStatus) {
    const Workplace place;
    for (const Stream err : {Stream::closed, Stream::full_disk}) {
        EXPECT_EQ(place.run({"frobnicate"}, Stream::captured, err).status, 2);
        EXPECT_EQ(place.run({"trace", "nonesuch", "--rays", "rays.csv"}, Stream::captured, err).status, 2);
    }
}

TEST(Output, ToAFullDiskIsStatus3) {
    const Workplace place;
    place.file("rays.csv", rays_text());
    struct stat before {};
    ASSERT_EQ(::stat("/dev/full", &before), 0);
    const Outcome outcome = place.run({"trace", "tessar", "--rays", "rays.csv", "-o", "/dev/full"});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_TRUE(says(outcome.err, "/dev/full"));
    struct stat after {};
    ASSERT_EQ(::stat("/dev/full", &after), 0);
    EXPECT_EQ(after.st_rdev, before.st_rdev) << "the device is still a device";
    EXPECT_TRUE(S_ISCHR(after.st_mode));
}

TEST(Output, MakesTheFoldersOnItsWayAndLeavesNothingBeside) {
    const Workplace place;
    place.file("rays.csv", rays_text());
    EXPECT_EQ(place.run({"trace", "tessar", "--rays", "rays.csv", "-o", "new/er/out.csv"}).status, 0);
    EXPECT_EQ(place.names(), (std::vector<std::string>{"new", "new/er", "new/er/out.csv", "rays.csv"}));
}

TEST(Paths, MayHoldSpacesAndAnyLetters) {
    const Workplace place;
    place.file("my läns/stråle 1.csv", rays_text());
    place.file("my läns/scène é.toml", small_scene());
    EXPECT_EQ(place.run({"trace", "tessar", "--rays", "my läns/stråle 1.csv", "-o", "ut put/ø.csv"}).status, 0);
    EXPECT_EQ(cells_of(place.content("ut put/ø.csv")).front().front(), "id");
    EXPECT_EQ(place.run({"render", "my läns/scène é.toml", "--samples", "1"}).status, 0);
    EXPECT_TRUE(place.has("scène é.exr"));
    EXPECT_TRUE(place.has("scène é.png"));
}

// What Windows' editors and spreadsheets make of a text file: lines that end in CR LF, a byte order mark in front.
TEST(Trace, ReadsFilesAsWindowsWritesThem) {
    const Workplace place;
    place.file("rays.csv", rays_text());
    const std::string plain = place.run({"trace", "tessar", "--rays", "rays.csv"}).out;
    std::string windows = rays_text();
    for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 2) {
        windows.replace(at, 1, "\r\n");
    }
    place.file("rays.csv", "\xEF\xBB\xBF" + windows);
    EXPECT_EQ(place.run({"trace", "tessar", "--rays", "rays.csv"}).out, plain);
}

TEST(Trace, NamesWhereEachRayEnds) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) +
                               "through,0,1,-10,0,0,1,587.5618\n"
                               "rim,0,19.5,-10,0,0,1,587.5618\n"
                               "stop,0,18.5,-10,0,0,1,587.5618\n"
                               "beside,0,60,-10,0,0,1,587.5618\n");
    std::map<std::string, std::string> last;
    for (const auto& row : cells_of(place.run({"trace", "tessar", "--rays", "rays.csv"}).out)) {
        last[row.front()] = row[1] + " " + row.back();
    }
    EXPECT_EQ(last["through"], "image ok");
    EXPECT_EQ(last["rim"], "1 clipped");
    EXPECT_EQ(last["stop"], "4 stopped");
    EXPECT_EQ(last["beside"], "1 missed");
}

// Light's way can be turned: the image row's ray, sent back, leaves the front along the line that it came by. The
// image point is printed to the last digit, so that what remains is the tracing's own rounding over 10² mm.
TEST(Trace, SentBackFromTheImageReturnsToWhereItCameFrom) {
    const Workplace place;
    place.file("there.csv", std::string(kRayHeader) + "a,3,11,-10,0.01,-0.02,1,587.5618\n");
    const auto there = cells_of(place.run({"trace", "tessar", "--rays", "there.csv"}).out);
    const std::vector<std::string>& image = there.back();
    ASSERT_EQ(image[1], "image");
    const auto turned = [](const std::string& number) {
        return number.front() == '-' ? number.substr(1) : "-" + number;
    };
    place.file("back.csv", std::string(kRayHeader) + "a," + image[2] + "," + image[3] + "," + image[4] + "," +
                               turned(image[5]) + "," + turned(image[6]) + "," + turned(image[7]) + ",587.5618\n");
    const auto back = cells_of(place.run({"trace", "tessar", "--rays", "back.csv", "--reverse"}).out);
    ASSERT_EQ(back.size(), there.size() - 1) << "every surface, and no image plane";
    const std::vector<std::string>& front = back.back();
    ASSERT_EQ(front[1], "1");
    for (std::size_t i = 2; i < 5; ++i) {
        EXPECT_NEAR(std::stod(front[i]), std::stod(there[1][i]), 1e-11);
    }
    const double norm = std::sqrt(0.01 * 0.01 + 0.02 * 0.02 + 1.0);
    EXPECT_NEAR(std::stod(front[5]), -0.01 / norm, 1e-13);
    EXPECT_NEAR(std::stod(front[6]), 0.02 / norm, 1e-13);
    EXPECT_NEAR(std::stod(front[7]), -1.0 / norm, 1e-13);
}

TEST(Trace, HasTheSameRowsInEveryPrecisionAndInJson) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + "a,3,11,-10,0.01,-0.02,1,587.5618\n");
    const auto in = [&](const char* precision) {
        return cells_of(place.run({"trace", "tessar", "--rays", "rays.csv", "--precision", precision}).out);
    };
    const auto exact = in("extended");
    const auto doubles = in("double");
    const auto floats = in("float");
    const Json rows = place.json({"trace", "tessar", "--rays", "rays.csv"})["rows"];
    ASSERT_EQ(doubles.size(), exact.size());
    ASSERT_EQ(floats.size(), exact.size());
    ASSERT_EQ(rows.size() + 1, exact.size());
    for (std::size_t i = 1; i < exact.size(); ++i) {
        for (std::size_t k = 2; k < 5; ++k) {
            EXPECT_NEAR(std::stod(doubles[i][k]), std::stod(exact[i][k]), 1e-12);
            EXPECT_NEAR(std::stod(floats[i][k]), std::stod(exact[i][k]), 1e-3);
            EXPECT_EQ(rows[i - 1]["point_mm"][k - 2].get<double>(), std::stod(doubles[i][k])) << "not a digit is lost";
        }
    }
    EXPECT_NE(doubles, floats);
}

TEST(Trace, TakesABytewiseIdIntoItsJson) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + "\xE9,0,1,-10,0,0,1,587.5618\n");
    const Outcome outcome = place.run({"trace", "tessar", "--rays", "rays.csv", "--json", "-"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(Json::accept(outcome.out));
}

TEST(Render, GivesTheSameBytesForEveryNumberOfThreadsAndOtherBytesForAnotherSeed) {
    const Workplace place;
    place.file("scene.toml", small_scene());
    const auto render = [&](const char* name, const char* threads, const char* seed) {
        EXPECT_EQ(place.run({"render", "scene.toml", "--threads", threads, "--seed", seed, "-o", name}).status, 0);
    };
    render("one.exr", "1", "7");
    render("two.exr", "2", "7");
    render("other.exr", "1", "8");
    for (const char* kind : {".exr", ".png"}) {
        SCOPED_TRACE(kind);
        const auto bytes = [&](const std::string& name) { return place.content(name + kind); };
        EXPECT_FALSE(bytes("one").empty());
        EXPECT_EQ(bytes("one"), bytes("two"));
        EXPECT_NE(bytes("one"), bytes("other"));
    }
}

TEST(Render, SaysWhereWavelengthsWereClampedToTheGlasses) {
    const Workplace place;
    place.file("scene.toml", with(small_scene(), "layers = 4", "layers = 4\nwavelengths_nm = [300, 1000]"));
    const Outcome outcome = place.run({"render", "scene.toml", "-o", "out.exr"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(says(outcome.err, "400 to 700 nm"));
}

TEST(Render, OfASinglePixelIsAPicture) {
    const Workplace place;
    place.file("scene.toml", with(with(small_scene(), "[8, 6]", "[1, 1]"), "[72.0, 54.0]", "[1.0, 1.0]"));
    EXPECT_EQ(place.run({"render", "scene.toml", "-o", "out.exr"}).status, 0);
    EXPECT_EQ(place.run({"compare", "out.exr", "out.exr", "--rms-limit", "1e-9"}).status, 0);
}

TEST(Compare, EndsIn1WhereALimitIsBroken) {
    const Workplace place;
    place.file("scene.toml", small_scene());
    ASSERT_EQ(place.run({"render", "scene.toml", "--seed", "1", "-o", "a.exr"}).status, 0);
    ASSERT_EQ(place.run({"render", "scene.toml", "--seed", "2", "-o", "b.exr"}).status, 0);
    EXPECT_EQ(place.run({"compare", "a.exr", "b.exr"}).status, 0) << "no limit, no failure";
    EXPECT_EQ(place.run({"compare", "a.exr", "a.exr", "--rms-limit", "1e-9"}).status, 0);
    EXPECT_EQ(place.run({"compare", "a.exr", "b.exr", "--rms-limit", "1e-9"}).status, 1);
}

TEST(Run, WritesItsReportAndItsProfileReadsBack) {
    const Workplace place;
    const std::string text = small_experiment();
    const std::string limit = "[simulations.limits]\ndistortion_rms_px = ";
    place.file("good.toml", text + limit + "50.0\n");
    place.file("bad.toml", text + limit + "1e-9\n");
    const Outcome good = place.run({"run", "good.toml", "-o", "good", "--json", "-"});
    EXPECT_EQ(good.status, 0) << good.err;
    EXPECT_EQ(good.err, "");
    EXPECT_EQ(good.out, place.content("good/report.json"));
    EXPECT_TRUE(place.has("good/report.html"));
    EXPECT_EQ(place.run({"run", "bad.toml", "-o", "bad"}).status, 1) << "no measurement is that good";
    EXPECT_EQ(place.content("good/profiles/a.json"), place.content("bad/profiles/a.json"));

    const std::string profile = "good/profiles/a.json";
    EXPECT_EQ(place.run({"compare", profile, profile, "--position-limit", "50"}).status, 0);
    EXPECT_EQ(place.run({"compare", "tessar", profile, "--focus", "10000", "--position-limit", "50"}).status, 0);
    place.file("unknown.toml",
               with(read_file(data_root() / "lenses/tessar.toml"), "\"LLF7\"", "\"XLLF7\", n_d = 1.549, V_d = 45.4"));
    const Outcome unknown = place.run({"compare", "unknown.toml", profile, "--focus", "10000", "--json", "-"});
    ASSERT_EQ(unknown.status, 0) << unknown.err;
    EXPECT_EQ(Json::parse(unknown.out)["findings"][0]["code"], "glass-unknown");
    EXPECT_TRUE(says(unknown.err, "XLLF7"));
    const std::string whole = place.content(profile);
    const Json parsed = Json::parse(whole);
    Json edited = parsed;
    edited["image_size_px"] = {0, 0};
    for (const auto& [content, word] :
         std::vector<std::pair<std::string, std::string>>{{whole.substr(0, whole.size() / 2), "not JSON"},
                                                          {with(whole, "lensproof-profile/1", "other/1"), "schema"},
                                                          {edited.dump(), "image_size_px"}}) {
        SCOPED_TRACE(word);
        place.file("broken.json", content);
        expect_refused(place, {"compare", "broken.json", profile}, {"broken.json", word});
    }
    // A profile that was measured without the pixel pitch is compared with that of the command, without a new
    // measurement.
    const double pitch = parsed["pixel_pitch_um"];
    edited = parsed;
    edited["pixel_pitch_um"] = nullptr;
    place.file("no-pitch.json", edited.dump());
    const std::vector<std::string> of_lens = {"compare", "tessar", "no-pitch.json", "--focus", "10000", "--json", "-"};
    EXPECT_TRUE(says(place.run(of_lens).err, "expected --pixel-pitch"));
    std::vector<std::string> with_pitch = of_lens;
    with_pitch.insert(with_pitch.end(), {"--pixel-pitch", std::to_string(pitch)});
    const Json found = Json::parse(place.run(with_pitch).out);
    const Json stated = Json::parse(place.run({"compare", "tessar", profile, "--focus", "10000", "--json", "-"}).out);
    EXPECT_EQ(found["curves"], stated["curves"]);
    expect_refused(place, {"compare", "tessar", profile, "--focus", "10000", "--pixel-pitch", "1.5"},
                   {"--pixel-pitch"});
    edited = parsed;
    edited["curves"] = Json::object();
    place.file("bare.json", edited.dump());
    for (const char* limit_option : {"--position-limit", "--vignetting-limit", "--chromatic-limit"}) {
        EXPECT_EQ(place.run({"compare", "bare.json", profile, limit_option, "1"}).status, 2)
            << limit_option << " cannot be held against nothing";
    }
}

}  // namespace lensproof::command_line_test
