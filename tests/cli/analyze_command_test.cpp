// tests/cli/analyze_command_test.cpp — `lensproof analyze` as a user meets it: its JSON, its plots, what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace lensproof::analyze_command_test {

using Json = nlohmann::json;

Json analysis(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "analyze");
    return Workplace().json(arguments);
}

TEST(Analyze, TheJsonHasEveryKeyOfTheContract) {
    const Json json = analysis({"tessar", "--fields", "0,5,30.1", "--wavelengths", "587.5618,486.1327"});
    EXPECT_EQ(json["lens"], "tessar");
    EXPECT_EQ(json["reference_wavelength_nm"], 587.5618);
    for (const char* key :
         {"efl_mm", "bfl_mm", "ffl_mm", "entrance_pupil_z_mm", "entrance_pupil_diameter_mm", "exit_pupil_z_mm",
          "exit_pupil_diameter_mm", "f_number", "total_track_mm", "petzval_radius_mm", "lagrange_invariant_mm"}) {
        EXPECT_TRUE(json["paraxial"][key].is_number()) << key;
    }
    ASSERT_EQ(json["seidel"]["surfaces"].size(), 8U);
    EXPECT_EQ(json["seidel"]["surfaces"][7]["surface"], 8);
    double s1 = 0.0;
    for (const Json& surface : json["seidel"]["surfaces"]) {
        s1 += surface["s1"].get<double>();
    }
    EXPECT_NEAR(s1, json["seidel"]["total"]["s1"].get<double>(), 1e-15);
    ASSERT_EQ(json["fields"].size(), 6U);
    for (const Json& row : json["fields"]) {
        for (const char* key : {"field_deg", "wavelength_nm", "status", "chief_ray_height_mm", "distortion_percent",
                                "tangential_focus_mm", "sagittal_focus_mm", "relative_illumination", "vignetting",
                                "spot_rms_um", "spot_centroid_mm", "wavefront_rms_waves", "lateral_colour_um"}) {
            EXPECT_TRUE(row.contains(key)) << key;
        }
        EXPECT_EQ(row["distortion_plane"], "paraxial");
    }
    EXPECT_EQ(json["fields"][2]["field_deg"], 5.0);  // as it was given
    EXPECT_EQ(json["fields"][0]["status"], "ok");
    EXPECT_EQ(json["fields"][4]["status"], "clipped");  // 30.1° is beyond the field
}

// The plane that distortion is told in is the paraxial image's and stated so: a sensor 3 mm off changes no number of
// it.
TEST(Analyze, DistortionIsThatOfALensInFocus) {
    const std::vector<std::string> asked = {"tessar", "--fields", "0,0.01,12,20"};
    std::vector<std::string> out_of_focus = asked;
    out_of_focus.insert(out_of_focus.end(), {"--image-distance", "85"});
    const Json focused = analysis(asked)["fields"];
    const Json blurred = analysis(out_of_focus)["fields"];
    ASSERT_EQ(focused.size(), blurred.size());
    for (std::size_t i = 0; i < focused.size(); ++i) {
        const double percent = blurred[i]["distortion_percent"].get<double>();
        EXPECT_NEAR(percent, focused[i]["distortion_percent"].get<double>(), 1e-9);
        EXPECT_NE(blurred[i]["spot_rms_um"], focused[i]["spot_rms_um"]);
        // Other colours are of another size on the axis, too.
        if (blurred[i]["field_deg"].get<double>() < 0.1 && blurred[i]["wavelength_nm"] == blurred[0]["wavelength_nm"]) {
            EXPECT_NEAR(percent, 0.0, 1e-5);
        }
    }
}

// Asked for, the veiling glare index is there with its parts; a sensor that reflects adds to it, and says so alone
// there.
TEST(Analyze, GivesTheVeilingGlareIndexOnRequest) {
    EXPECT_FALSE(analysis({"tessar", "--fields", "0"}).contains("veiling_glare"));
    const Json black = analysis({"tessar", "--fields", "0", "--veiling-glare"})["veiling_glare"];
    EXPECT_NEAR(black["index_percent"].get<double>(),
                black["ghosts_percent"].get<double>() + black["blur_percent"].get<double>(), 1e-12);
    EXPECT_EQ(black["barrel_percent"], 0.0);
    EXPECT_GT(black["standard_error_percent"], 0.0);
    EXPECT_LT(black["standard_error_percent"], 0.03 * black["index_percent"].get<double>());
    const Json mirror =
        analysis({"tessar", "--fields", "0", "--veiling-glare", "--sensor-reflectance", "1"})["veiling_glare"];
    EXPECT_GT(mirror["index_percent"], black["index_percent"]);
    const Json polarised = analysis({"tessar", "--fields", "0", "--veiling-glare", "--polarised"})["veiling_glare"];
    EXPECT_EQ(polarised["index_percent"], black["index_percent"]);
    EXPECT_NEAR(polarised["polarised"]["index_percent"].get<double>() - polarised["index_percent"].get<double>(),
                polarised["polarised"]["difference_percent"].get<double>(), 1e-12);
    EXPECT_LT(polarised["polarised"]["difference_standard_error_percent"], polarised["standard_error_percent"]);
    expect_refused({}, {"analyze", "tessar", "--sensor-reflectance", "0.1"}, {"--veiling-glare"});
    expect_refused({}, {"analyze", "tessar", "--polarised"}, {"--veiling-glare"});
}

// What is asked for is what is reported, to rounding.
TEST(Analyze, TheFNumberIsThatAtTheReferenceWavelength) {
    for (const char* reference_nm : {"450", "550", "700"}) {
        const Json json =
            analysis({"tessar", "--f-number", "5", "--reference-wavelength", reference_nm, "--fields", "0"});
        EXPECT_NEAR(json["paraxial"]["f_number"].get<double>(), 5.0, 1e-12);
    }
}

// 50 digits give the ray through the stop's edge and that through its centre at 24° (as in
// tests/engine/analysis/paraxial_rays_test.cpp).
TEST(Analyze, FollowsTheParaxialRaysFromSurfaceToSurface) {
    const Json surfaces = analysis({"tessar", "--fields", "24"})["paraxial"]["surfaces"];
    ASSERT_EQ(surfaces.size(), 8U);
    const Json& last = surfaces[7];
    EXPECT_EQ(last["surface"], 8);
    EXPECT_NEAR(last["marginal_ray_height_mm"].get<double>(), 14.627617159472427, 1e-10);
    EXPECT_NEAR(last["marginal_ray_slope"].get<double>(), -0.18323287175259023, 1e-10);
    EXPECT_NEAR(last["chief_ray_height_mm"].get<double>(), 11.734793844646871, 1e-10);
    EXPECT_NEAR(last["chief_ray_slope"].get<double>(), 0.4108009180565909, 1e-10);
    EXPECT_NEAR(surfaces[0]["marginal_ray_incidence"].get<double>(), 0.4264824248005844, 1e-10);
    EXPECT_NEAR(surfaces[0]["chief_ray_incidence"].get<double>(), 0.3018679409957831, 1e-10);
    const std::string text = Workplace().run({"analyze", "tessar", "--fields", "24"}).out;
    for (const char* number : {"14.627617", "-0.183233", "11.734794", "0.410801"}) {
        EXPECT_NE(text.find(number), std::string::npos) << number;
    }
}

// An unknown glass that stands beside its figures is traced by them, and the analysis says so.
TEST(Analyze, SaysWhichGlassIsTracedByItsFiguresAlone) {
    const Workplace place;
    place.file("known.toml", kSinglet);
    place.file("unknown.toml", with(kSinglet, "\"BK7\"", "\"XBK77\", n_d = 1.517, V_d = 64.2"));
    EXPECT_EQ(place.json({"analyze", "known.toml"})["findings"], Json::array());
    const Json findings = place.json({"analyze", "unknown.toml"})["findings"];
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0]["code"], "glass-unknown");
    EXPECT_EQ(findings[0]["severity"], "warning");
    EXPECT_EQ(findings[0]["surface"], 1);
    Json checked = Json::parse(place.run({"check", "unknown.toml", "--json", "-"}).out)["lenses"][0]["findings"];
    for (Json& finding : checked) {
        finding.erase("section");  // a report's alone
    }
    EXPECT_NE(std::find(checked.begin(), checked.end(), findings[0]), checked.end()) << "in check's own words";
    const std::string text = place.run({"analyze", "unknown.toml"}).out;
    for (const char* word : {"XBK77", "surface 1", "n_d = 1.517 and V_d = 64.2"}) {
        EXPECT_NE(text.find(word), std::string::npos) << text;
    }
    EXPECT_EQ(place.json({"analyze", "unknown.toml", "--index", "XBK77=1.5"})["findings"], Json::array());
    // As do the commands that trace it, on standard error too.
    place.file("rays.csv", "id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\na,0,0,-10,0,0,1,550\n");
    place.file("scene.toml", with(small_scene(), "\"tessar\"", "\"unknown.toml\""));
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"trace", "unknown.toml", "--rays", "rays.csv"},
          {"render", "scene.toml", "-o", "scene.exr"}}) {
        EXPECT_EQ(place.json(command)["findings"], findings) << command[0];
        const std::string said = place.run(command).err;
        EXPECT_NE(said.find("warning, surface 1: no catalogue has the glass XBK77"), std::string::npos) << said;
    }
    EXPECT_EQ(place.json({"trace", "known.toml", "--rays", "rays.csv"})["findings"], Json::array());
}

TEST(Analyze, BeyondTheFieldThereIsNothing) {
    const Json json = analysis({"petzval", "--fields", "85", "--wavelengths", "587.5618"});
    const Json& row = json["fields"][0];
    EXPECT_EQ(row["status"], "missed");
    EXPECT_TRUE(row["chief_ray_height_mm"].is_null());
    EXPECT_TRUE(row["spot_rms_um"].is_null());
}

// A fisheye of 220°: fields at and beyond 90° are ordinary, but for what paraxial rays say.
TEST(Analyze, AFisheyeGoesBeyondNinetyDegrees) {
    const Json json = analysis({"fisheye-220", "--fields", "0,90,105", "--wavelengths", "587.5618"});
    EXPECT_TRUE(json["seidel"].is_null());
    EXPECT_TRUE(json["paraxial"]["lagrange_invariant_mm"].is_null());
    EXPECT_TRUE(json["paraxial"]["surfaces"][0]["chief_ray_slope"].is_null());
    EXPECT_TRUE(json["paraxial"]["surfaces"][0]["marginal_ray_slope"].is_number());
    for (const Json& row : json["fields"]) {
        EXPECT_EQ(row["status"], "ok");
        EXPECT_GT(row["relative_illumination"].get<double>(), 0.1);
    }
    EXPECT_LT(json["fields"][1]["chief_ray_height_mm"].get<double>(),
              json["fields"][2]["chief_ray_height_mm"].get<double>());
}

// The Tessar focused by its image plane: 1/f = 1/s + 1/s' from its principal points gives the paraxial image.
TEST(Analyze, ANearObjectIsInFocusWhereItsImageIs) {
    const Json json = analysis({"tessar", "--focus", "2000", "--best-focus", "paraxial", "--fields", "0"});
    const Json& paraxial = json["paraxial"];
    const double s = 2000.0 + paraxial["front_principal_z_mm"].get<double>();
    const double f = paraxial["efl_mm"].get<double>();
    const double image = f * s / (s - f) + paraxial["rear_principal_z_mm"].get<double>();
    EXPECT_NEAR(paraxial["image_distance_mm"].get<double>(), image, 1e-9);
    EXPECT_NEAR(paraxial["magnification"].get<double>(), -f / (s - f), 1e-12);
    EXPECT_NEAR(json["fields"][0]["tangential_focus_mm"].get<double>(), 0.0, 1e-9);
}

// The whole lens as its own focusing group: it moves out until the image is where the table has that of infinity, 0.25
// µm before the sensor. The object keeps its distance from where the table's first vertex was.
TEST(Analyze, FocusingGroupsMoveToTheObject) {
    const Workplace place;
    const Outcome copied = place.run({"convert", "tessar", "tessar.toml"});
    ASSERT_EQ(copied.status, 0) << copied.err;
    place.file("focusing.toml", place.content("tessar.toml") + "\n[[focus]]\nsurfaces = [1, 8]\n");
    const Json near =
        place.json({"analyze", "focusing.toml", "--focus", "1000", "--fields", "0", "--wavelengths", "587.5618"});
    const Json far = analysis({"tessar", "--fields", "0", "--wavelengths", "587.5618"});
    const auto defocus = [](const Json& json) {
        return json["paraxial"]["image_distance_mm"].get<double>() - json["paraxial"]["image_plane_mm"].get<double>();
    };
    EXPECT_NEAR(defocus(near), defocus(far), 1e-9);
    EXPECT_NEAR(near["fields"][0]["tangential_focus_mm"].get<double>(), defocus(near), 1e-9);
    EXPECT_GT(near["paraxial"]["image_plane_mm"].get<double>(), far["paraxial"]["image_plane_mm"].get<double>() + 10.0);
}

// In front of a fisheye, whose pupil wanders, more than one chief ray may come from a point.
TEST(Analyze, ANearObjectBeforeAFisheyeHasChiefRaysAllOverTheField) {
    const Json json = analysis({"fisheye-220", "--focus", "1", "--fields", "0,0.1,5,20,40,50,70"});
    double last = -1.0;
    for (std::size_t i = 0; i < json["fields"].size(); i += 3) {
        EXPECT_EQ(json["fields"][i]["status"], "ok");
        const double height = json["fields"][i]["chief_ray_height_mm"].get<double>();
        EXPECT_GT(height, last);
        last = height;
    }
}

// Undercorrected at full aperture: each criterion draws the image plane towards the lens, and improves on the others'
// figure of merit.
TEST(Analyze, BestFocusIsBestByItsOwnCriterion) {
    const auto at_focus = [](const std::string& criterion) {
        return analysis({"tessar", "--fields", "0", "--wavelengths", "587.5618", "--f-number", "4", "--best-focus",
                         criterion})["fields"][0];
    };
    const Json paraxial = at_focus("paraxial");
    const Json spot = at_focus("spot");
    const Json wavefront = at_focus("wavefront");
    EXPECT_LT(spot["spot_rms_um"].get<double>(), paraxial["spot_rms_um"].get<double>());
    EXPECT_LE(spot["spot_rms_um"].get<double>(), wavefront["spot_rms_um"].get<double>());
    EXPECT_LT(wavefront["wavefront_rms_waves"].get<double>(), spot["wavefront_rms_waves"].get<double>());
}

TEST(Analyze, PlotsAreWholeAndTheSameForAnyNumberOfThreads) {
    const Workplace place;
    for (const char* threads : {"1", "2"}) {
        const Outcome outcome =
            place.run({"analyze", "tessar", "--f-number", "11", "--fields", "0,20", "--wavelengths", "587.5618",
                       "--plots", std::string("plots-") + threads, "--threads", threads});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    }
    for (const char* name :
         {"section.svg", "ray_fans.svg", "field_curves.svg", "longitudinal_aberration.svg", "lateral_colour.svg",
          "spots.svg", "illumination.svg", "wavefront.svg", "psf.svg", "mtf.svg", "mtf_geometric.svg",
          "mtf_over_field.svg", "curves.json", "psf_0deg.exr", "psf_20deg.exr"}) {
        const std::string one = place.content(std::string("plots-1/") + name);
        EXPECT_FALSE(one.empty()) << name;
        EXPECT_EQ(one, place.content(std::string("plots-2/") + name)) << name;
    }
    const Json curves = Json::parse(place.content("plots-1/curves.json"));
    EXPECT_GT(curves["psfs"][0]["strehl"].get<double>(), 0.0);
    EXPECT_LE(curves["psfs"][0]["strehl"].get<double>(), 1.0);
    for (const Json& field : curves["mtf"]) {
        for (std::size_t i = 0; i < field["tangential"].size(); ++i) {
            EXPECT_LE(field["tangential"][i][1].get<double>(), 1.0 + 1e-12);
        }
    }
}

TEST(Analyze, RefusesWhatMakesNoSense) {
    const Workplace place;
    place.file("not-a-folder", "x");
    const std::vector<std::vector<std::string>> hopeless = {
        {"--fields", "200"},         {"--fields", "nan"},       {"--fields", "-200"},
        {"--wavelengths", "0"},      {"--wavelengths", "100"},  {"--focus", "0"},
        {"--focus", "near"},         {"--f-number", "0.5"},     {"--image-distance", "nan"},
        {"--image-distance", "inf"}, {"--rings", "0"},          {"--zoom", "2"},
        {"--best-focus", "sharp"},   {"--best-focus", "mtf"},   {"--focus-frequency", "10"},
        {"--plots", "not-a-folder"}, {"--index", "NOGLASS=1.5"}};
    for (const std::vector<std::string>& words : hopeless) {
        SCOPED_TRACE(words[0] + " " + words[1]);
        const Outcome outcome = place.run({"analyze", "tessar", words[0], words[1]});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_EQ(outcome.out, "");
        const auto names = [&](const std::string& word) { return outcome.err.find(word) != std::string::npos; };
        EXPECT_TRUE(names(words[0]) || names(words[1])) << outcome.err;
    }
    EXPECT_EQ(place.names(), std::vector<std::string>{"not-a-folder"});
}

}  // namespace lensproof::analyze_command_test
