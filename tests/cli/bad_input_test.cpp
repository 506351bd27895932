// tests/cli/bad_input_test.cpp — an input that cannot be used ends in exit status 2, one message that says where and
// what, and no file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <tuple>

#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"

namespace lensproof::bad_input_test {

constexpr const char* kChart = R"([chart]
kind = "checkerboard"
squares = [12, 9]
square_mm = 560.0
)";

std::string noise(std::size_t size) {
    std::string bytes(size, '\0');
    std::uint32_t state = 1;
    std::ranges::generate(bytes, [&] { return static_cast<char>((state = 1664525U * state + 1013904223U) >> 24U); });
    return bytes;
}

std::string picture_head(int width, int height) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
}

/// A Radiance HDR of one grey: a picture without a chart.
std::string grey_picture(int width, int height) {
    return picture_head(width, height) + std::string(static_cast<std::size_t>(4 * width * height), '\x80');
}

/// One edit to a good file, and what the message has to say of it beside the file's name.
struct BadEdit {
    const char* what;
    std::string from;
    std::string to;
    std::vector<std::string> words;
};

/// That the command refuses `file` by each of the edits to its text.
void expect_edits_refused(const Workplace& place, const std::vector<std::string>& command, const std::string& file,
                          const std::string& text, const std::vector<BadEdit>& edits) {
    for (const BadEdit& edit : edits) {
        SCOPED_TRACE(edit.what);
        place.file(file, with(text, edit.from, edit.to));
        std::vector<std::string> words = edit.words;
        words.push_back(file);
        expect_refused(place, command, words);
    }
}

TEST(BadCommandLine, NamesTheOption) {
    const Workplace place;
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
        {{}, "expected a command"},
        {{"trace", "tessar", "--rays"}, "--rays"},
        {{"trace", "tessar", "--rays", "r.csv", "--precision", "half"}, "--precision"},
        {{"lenses", "--json"}, "--json"},
        {{"lenses", "--threads", "many"}, "--threads"},
        {{"lenses", "--seed", "-1"}, "--seed"},
        {{"render", "scene.toml", "--samples", "0"}, "--samples"},
        {{"measure", "a.png"}, "--chart"},
        {{"compare", "a.json", "b.json", "--position-limit", "nan"}, "--position-limit"},
        {{"analyze", "tessar", "--image-distance", ""}, "--image-distance"},
    };
    for (const auto& [arguments, word] : cases) {
        SCOPED_TRACE(word);
        expect_refused(place, arguments, {word});
    }
}

TEST(BadCommandLine, NamesWhatIsUnknownAndWhatIsNearest) {
    const Workplace place;
    const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> cases = {
        {{"analyze", "tesar"}, {"neither a file nor a lens that ships", "\"tessar\"? Known are: biotar, "}},
        {{"chekc", "tessar"}, {"\"chekc\" is no command", "did you mean \"check\"?", "Try: lensproof --help"}},
        {{"analyse", "tessar", "--json", "-"}, {"\"analyse\"", "\"analyze\"?"}},
        {{"frobnicate"}, {"\"frobnicate\" is no command"}},
        {{"--json", "-", "check", "tessar"}, {"\"--json\" is no option of lensproof", "known are: --help, --version"}},
        {{"--verison"}, {"\"--verison\" is no option of lensproof", "\"--version\"?"}},
        {{"analyze", "tessar", "--fnumber", "3"},
         {"\"--fnumber\" is no option of analyze", "\"--f-number\"?", "lensproof analyze --help"}},
        {{"analyze", "--ring=4"}, {"\"--ring\"", "\"--rings\"?"}},
        {{"analyze", "tessar", "petzval"}, {"\"petzval\" is more than analyze takes"}},
    };
    for (const auto& [arguments, words] : cases) {
        SCOPED_TRACE(testing::PrintToString(arguments));
        expect_refused(place, arguments, words);
    }
}

TEST(BadCommandLine, WhatAChartCannotBeIsSaidOfTheOption) {
    const Workplace place;
    const Outcome outcome = place.run({"chart", "checkerboard", "--squares", "1x1"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("--squares"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find(".toml"), std::string::npos) << outcome.err;
    expect_refused(place, {"check", "a\x1b[31m\u202elmot.x"}, {"a\\u001b[31m\\u202elmot.x"});
}

TEST(BadFile, AWavelengthThatNoGlassCoversIsNamedByItsLine) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay + "far,0,0,-10,0,0,1,9000\n");
    expect_refused(place, {"trace", "tessar", "--rays", "rays.csv"},
                   {"rays.csv:3: wavelength_nm", "9000 nm is outside"});
}

TEST(BadFile, EveryCommandNamesAFileThatItCannotRead) {
    const Workplace place;
    place.file("folder.toml/inside", "");
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    place.file("chart.toml", kChart);
    place.file("file", "");
    const std::string long_name = std::string(300, 'x') + ".toml";
    const std::vector<std::vector<std::string>> cases = {
        {"trace", "missing.toml", "--rays", "rays.csv"},
        {"trace", long_name, "--rays", "rays.csv"},
        {"trace", "", "--rays", "rays.csv"},
        {"render", "missing.toml", "-o", "out.exr"},
        {"render", "folder.toml", "-o", "out.exr"},
        {"measure", "missing.png", "--chart", "chart.toml", "-o", "out.json"},
        {"measure", "folder.toml", "--chart", "chart.toml", "-o", "out.json"},
        {"compare", "missing.json", "missing.json"},
        {"run", "missing.toml", "-o", "out"},
        {"run", "file/in.toml", "-o", "out"},
    };
    for (const std::vector<std::string>& arguments : cases) {
        SCOPED_TRACE(arguments[0] + " " + arguments[1]);
        expect_refused(place, arguments, {arguments[1]});
    }
    expect_refused(place, {"trace", "tessar", "--rays", "folder.toml"}, {"folder.toml", "folder"});
    expect_refused(place, {"measure", "missing.png", "--chart", "folder.toml"}, {"folder.toml", "folder"});
}

TEST(BadFile, EveryCommandRefusesAFileOfNoise) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    place.file("chart.toml", kChart);
    for (const char* file : {"noise.toml", "noise.csv", "noise.json", "noise.png", "noise.exr", "noise.jpg"}) {
        place.file(file, noise(3000));
    }
    place.file("empty.png", "");
    place.file("empty.toml", "");
    expect_refused(place, {"trace", "noise.toml", "--rays", "rays.csv"}, {"noise.toml:1", "not TOML"});
    expect_refused(place, {"trace", "noise.csv", "--rays", "rays.csv"}, {"noise.csv:1", "header"});
    expect_refused(place, {"trace", "tessar", "--rays", "noise.csv"}, {"noise.csv:1", "header"});
    expect_refused(place, {"render", "noise.png", "-o", "out.exr"}, {"noise.png:1", "not TOML"});
    expect_refused(place, {"render", "empty.toml", "-o", "out.exr"}, {"empty.toml:1", "camera", "missing"});
    expect_refused(place, {"run", "noise.toml", "-o", "out"}, {"noise.toml:1", "not TOML"});
    expect_refused(place, {"compare", "noise.json", "noise.json"}, {"noise.json", "not JSON"});
    for (const char* picture : {"noise.png", "noise.exr", "noise.jpg", "empty.png"}) {
        expect_refused(place, {"measure", picture, "--chart", "chart.toml", "-o", "out.json"}, {picture, "picture"});
    }
}

TEST(BadFile, AnEndlessDeviceIsNotReadToItsEnd) {
    const Workplace place;
    place.file("chart.toml", kChart);
    expect_refused(place, {"measure", "/dev/zero", "--chart", "chart.toml"}, {"/dev/zero"});
}

TEST(BadRays, NameTheLineAndTheCell) {
    const Workplace place;
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"a,nan,0,0,0,0,1,550", "x_mm"},  {"a,0,0,1e999,0,0,1,550", "z_mm"},  {"a,0,0,1e300,0,0,1,550", "z_mm"},
        {"a,0,0,0,x,0,1,550", "dx"},      {"a,0,0,0,0,0,0,550", "direction"}, {"a,0,0,0,0,0,1,-550", "wavelength"},
        {"a,0,0,0,0,0,1,", "wavelength"}, {"a,0,0,0,0,0,1,550,", "9 cells"}};
    for (const auto& [row, word] : cases) {
        SCOPED_TRACE(row);
        place.file("rays.csv", std::string(kRayHeader) + kAxialRay + row + "\n");
        expect_refused(place, {"trace", "tessar", "--rays", "rays.csv", "-o", "out.csv"}, {"rays.csv:3", word});
    }
    place.file("rays.csv", kRayHeader);
    expect_refused(place, {"trace", "tessar", "--rays", "rays.csv"}, {"rays.csv", "no ray"});
    place.file("rays.csv", "x,y\n1,2\n");
    expect_refused(place, {"trace", "tessar", "--rays", "rays.csv"}, {"rays.csv:1", "x,y", "id,x_mm"});
}

TEST(BadRays, AWavelengthOutsideAGlassNamesTheGlassAndItsRange) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + "a,0,0,-10,0,0,1,300\n");
    expect_refused(place, {"trace", "tessar", "--rays", "rays.csv"}, {"300 nm", "LAK9", "320"});
}

TEST(BadIndex, IsRefused) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    for (const char* index : {"LAK9", "LAK9=nan", "LAK9=0.5", "NOPE=1.5"}) {
        SCOPED_TRACE(index);
        const std::string name = std::string(index).substr(0, 4);
        expect_refused(place, {"trace", "tessar", "--rays", "rays.csv", "--index", index}, {"--index", name});
    }
}

TEST(BadLens, NamesTheLineTheKeyAndWhatItHolds) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    const std::vector<BadEdit> edits = {
        {"negative rim", "semi_diameter_mm = 10.0", "semi_diameter_mm = -10.0", {":5:", "semi_diameter_mm", "-10"}},
        {"no rim's number", "semi_diameter_mm = 10.0", "semi_diameter_mm = nan", {":5:", "semi_diameter_mm", "nan"}},
        {"a rim like a planet",
         "semi_diameter_mm = 10.0",
         "semi_diameter_mm = 1e9",
         {":5:", "semi_diameter_mm", "1e7"}},
        {"negative thickness", "thickness_mm =  5.0", "thickness_mm = -5.0", {":5:", "thickness_mm", "-5"}},
        {"no radius", "radius_mm =  50.0", "radius_mm = nan", {":5:", "radius_mm", "nan", "inf"}},
        {"unknown glass", "BK7", "UNOBTAINIUM", {":5:", "glass", "UNOBTAINIUM", "lensproof glasses"}},
        {"unknown key", "radius_mm =  50.0", "radus_mm = 50.0", {":5:", "radus_mm", "not a key", "thickness_mm"}},
        {"a key that need not be there",
         "semi_diameter_mm = 10.0",
         "semi_diam_mm = 10.0",
         {":5:", "did you mean \"semi_diameter_mm\"?"}},
        {"a key that must",
         "thickness_mm =  5.0",
         "thicknes_mm = 5.0",
         {"thickness_mm: is missing", "\"thicknes_mm\""}},
        {"no stop", "stop = true", "radius_mm = inf", {"0 aperture stops"}},
        {"a mirror of glass",
         "semi_diameter_mm =  8.0",
         "semi_diameter_mm = 8.0, mirror = true, glass = 'BK7'",
         {"glass", "stands on a mirror"}},
        {"cut off", "]\n", "", {"not TOML"}},
        {"a key twice", "name = ", "name = 'x'\nname = ", {":2:", "not TOML"}},
    };
    expect_edits_refused(place, {"trace", "lens.toml", "--rays", "rays.csv"}, "lens.toml", kSinglet, edits);
    expect_refused(place, {"trace", "nonesuch", "--rays", "rays.csv"}, {"nonesuch", "tessar"});
}

TEST(BadScene, NamesTheLineTheKeyAndWhatItHolds) {
    const Workplace place;
    const std::vector<BadEdit> edits = {
        {"wider than the lens opens", "f_number = 8.0", "f_number = 1.0", {"camera", "f/1 ", "f/2.7"}},
        {"inside the focal point", "focus_distance_mm = 10000.0", "focus_distance_mm = 50.0", {"camera", "50", "78.4"}},
        {"too many pixels", "[8, 6]", "[100000, 100000]", {":6:", "pixels", "100000"}},
        {"no pixels", "[8, 6]", "[0, 0]", {":6:", "pixels"}},
        {"oblong pixels", "[8, 6]", "[8, 7]", {":6:", "pixels", "square"}},
        {"unknown lens", "\"tessar\"", "\"nonesuch\"", {"camera", "nonesuch", "petzval"}},
        {"misspelt key", "iso = 100.0", "iso = 100.0\nisso = 1", {":9:", "isso"}},
        {"misspelt setting", "samples_per_pixel", "sample_per_pixel", {":20:", "\"samples_per_pixel\"?"}},
        {"no size of squares", "560.0", "nan", {":14:", "square_mm", "nan"}},
        {"no distance", "distance_mm = 10000.0\n\n[render]", "distance_mm = 0\n[render]", {"distance_mm"}},
        {"no samples", "samples_per_pixel = 4", "samples_per_pixel = 0", {":20:", "samples_per_pixel", "0"}},
        {"no glass passes", "layers = 4", "wavelengths_nm = [1000, 1100]", {"1000"}},
    };
    expect_edits_refused(place, {"render", "scene.toml", "-o", "out.exr"}, "scene.toml", small_scene(), edits);
}

TEST(BadPicture, IsNamed) {
    const Workplace place;
    place.file("chart.toml", kChart);
    place.file("grey.hdr", grey_picture(64, 48));
    place.file("wide.hdr", grey_picture(80, 48));
    place.file("one.hdr", grey_picture(1, 1));
    place.file("cut.hdr", grey_picture(64, 48).substr(0, 400));
    place.file("huge.hdr", picture_head(100000, 100000) + "\1\2\3");
    const std::vector<std::string> chart = {"--chart", "chart.toml", "-o", "out.json"};
    const auto measure = [&](std::vector<std::string> pictures, const std::vector<std::string>& words) {
        SCOPED_TRACE(pictures.front());
        pictures.insert(pictures.begin(), "measure");
        pictures.insert(pictures.end(), chart.begin(), chart.end());
        expect_refused(place, pictures, words);
    };
    measure({"grey.hdr"}, {"grey.hdr", "no 11 × 8 checkerboard"});
    measure({"one.hdr"}, {"one.hdr", "no 11 × 8 checkerboard"});
    measure({"grey.hdr", "wide.hdr"}, {"wide.hdr", "80 × 48", "64 × 48"});
    measure({"cut.hdr"}, {"cut.hdr"});
    measure({"huge.hdr"}, {"huge.hdr", "100000 × 100000"});
    measure({"chart.toml"}, {"chart.toml", "not a picture"});
    expect_refused(place, {"compare", "grey.hdr", "wide.hdr"}, {"64 × 48", "80 × 48"});
    expect_refused(place, {"compare", "grey.hdr", "grey.hdr", "--position-limit", "1"}, {"--position-limit"});
    expect_refused(place, {"compare", "tessar", "grey.hdr"}, {"tessar", "grey.hdr"});
    expect_refused(place, {"compare", "tessar", "petzval"}, {"tessar", "petzval"});
}

TEST(BadChart, IsRefusedBeforeAnyPictureIsRead) {
    const Workplace place;
    expect_edits_refused(place, {"measure", "missing.png", "--chart", "chart.toml"}, "chart.toml", kChart,
                         {{"no squares", "[12, 9]", "[0, 0]", {"chart.toml:", "squares"}},
                          {"no chart's kind", "\"checkerboard\"", "\"mona lisa\"", {"chart.toml:", "kind"}},
                          {"unknown table", "[chart]", "[charts]", {"chart.toml:", "chart"}}});
}

/// The scene above as an experiment of one view.
std::string small_experiment() {
    std::string text = with(small_scene(), "[camera]", "[[simulations]]\nname = \"a\"\n[simulations.camera]");
    text = with(text, "[chart]", "[simulations.chart]");
    text = with(text, "[pose]", "[[simulations.views]]");
    return "title = \"An experiment\"\n" + text;
}

TEST(BadExperiment, NamesTheLineAndTheKeyBeforeAnythingIsRendered) {
    const Workplace place;
    const std::string good = small_experiment();
    const std::string comparison = "[[comparisons]]\nof = \"a\"\nwith = \"a\"\nlimit = 1.0\ncurve = ";
    const std::string twin = good.substr(good.find("[[simulations]]"), good.find("[render]") - good.find("[[simul"));
    const std::vector<std::tuple<std::string, std::string, std::vector<std::string>>> cases = {
        {"a name twice", good + twin, {"name", "twice"}},
        {"no view", with(good, "[[simulations.views]]\ndistance_mm = 10000.0\n", ""), {"view"}},
        {"wider than the lens opens", with(good, "f_number = 8.0", "f_number = 1.0"), {"camera", "f/1 ", "f/2.7"}},
        {"an unknown lens", with(good, "\"tessar\"", "\"nonesuch\""), {"camera", "nonesuch"}},
        {"an unknown curve", good + comparison + "\"distorsion\"\n", {"curve", "distorsion", "distortion_percent"}},
        {"an unknown subject",
         with(good + comparison, "of = \"a\"", "of = \"b\"") + "\"radial_px\"\n",
         {"of", "\"b\""}},
        {"a manifest that is not there", good + "[[photos]]\nname = \"p\"\nmanifest = \"m.toml\"\n", {"m.toml"}},
    };
    for (const auto& [what, text, words] : cases) {
        SCOPED_TRACE(what);
        place.file("experiment.toml", text);
        expect_refused(place, {"run", "experiment.toml", "-o", "out"}, words);
    }
    place.file("experiment.toml", good);
    place.file("file", "");
    expect_refused(place, {"run", "experiment.toml", "-o", "file"}, {"file"});
    // What turns out later: no chart is found in pictures of 8 × 6 pixels.
    const Outcome outcome = place.run({"run", "experiment.toml", "-o", "out"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err.rfind("lensproof: experiment.toml: a: no 11 × 8 checkerboard found in any of 2 pictures", 0),
              0U)
        << outcome.err;
    EXPECT_FALSE(place.has("out/report.html"));
}

TEST(BadOutput, IsRefusedBeforeTheWork) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    place.file("scene.toml", small_scene());
    place.file("folder/inside", "");
    place.file("folder.exr/inside", "");
    place.file("beside.png/inside", "");
    for (const char* out : {"folder", "new/", "rays.csv/out.csv"}) {
        SCOPED_TRACE(out);
        expect_refused(place, {"trace", "tessar", "--rays", "rays.csv", "-o", out}, {out});
    }
    expect_refused(place, {"lenses", "--json", "folder"}, {"folder"});
    for (const char* out : {"folder.exr", "out.png"}) {
        SCOPED_TRACE(out);
        expect_refused(place, {"render", "scene.toml", "-o", out}, {out});
    }
    expect_refused(place, {"render", "scene.toml", "-o", "beside.exr"}, {"beside.png"});
    // Where it would be kept if it were interrupted, with the picture so far beside it.
    const std::string long_name(240, 'x');
    expect_refused(place, {"render", "scene.toml", "-o", long_name + ".exr"}, {".exr.checkpoint.exr", "255"});
    expect_refused(place, {"render", "scene.toml", "-o", "a.exr", "--checkpoint", long_name + "123456789012"},
                   {"123456789012.exr", "255"});
}

}  // namespace lensproof::bad_input_test
