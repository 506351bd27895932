// The coatings that ship: each reads, says where it comes from and that it is assumed, and reflects what such coatings
// do; and how lenses and users name them.
#include "engine/formats/prescription/shipped_coatings.h"

#include <gtest/gtest.h>

#include "engine/base/write_file.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::formats::shipped_coatings_test {

/// Reflectance on glass of index 1.5185 (N-BK7 at 550 nm) at normal incidence, from the glass or from air.
double reflectance(const std::string& name, double nm, bool from_glass = false) {
    const optics::GlassCatalogue& glasses = shipped_glasses();
    const optics::Glass air = optics::constant_glass("air", 1.0);
    const optics::Glass glass = *glasses.resolve("SCHOTT N-BK7").glass;
    const double n = optics::refractive_index(glass.formula, nm);
    const optics::LensCoating films =
        optics::resolved_coating(shipped_coating(name).coating, glasses, air, glass, name);
    return optics::coating_reflectance(optics::coating_at(films, nm, name), 1.0, n, 1.0, !from_glass);
}

double largest_between(const std::string& name, double from_nm, double to_nm) {
    double largest = 0.0;
    for (double nm = from_nm; nm <= to_nm; nm += 2.0) {
        largest = std::max(largest, reflectance(name, nm));
    }
    return largest;
}

TEST(ShippedCoatings, SayWhatTheyAre) {
    EXPECT_GE(shipped_coating_names().size(), 4U);
    for (const std::string& name : shipped_coating_names()) {
        const NamedCoating coating = shipped_coating(name);
        EXPECT_EQ(coating.id, name);
        EXPECT_TRUE(says(coating.source, "Macleod"));
        EXPECT_TRUE(says(coating.notes, "Assumed for any lens"));
        EXPECT_TRUE(std::get<optics::LayerStack>(coating.coating).from_air);
        for (const double nm : {360.0, 550.0, 830.0}) {  // all that a colour needs
            EXPECT_LT(reflectance(name, nm), 0.3) << name << " " << nm;
        }
    }
}

// The closed form of one quarter wave; a V's zero; a half wave that is not there at its wavelength, which leaves two
// quarter waves, r = (n_L² n_s − n_M²) / (n_L² n_s + n_M²) (Macleod, ch. 4); and what "broadband" means. Indices as the
// films' sources state them at 550 nm, to the digits that are written here; 0.2 % in an index is 5e-4 in r.
TEST(ShippedCoatings, ReflectWhatTheirKindDoes) {
    constexpr double kMgF2 = 1.37851;
    constexpr double kAl2O3 = 1.62979;
    constexpr double kGlass = 1.51852;
    const auto squared = [](double x) { return x * x; };
    EXPECT_NEAR(reflectance("mgf2", 550.0), squared((kMgF2 * kMgF2 - kGlass) / (kMgF2 * kMgF2 + kGlass)), 1e-6);
    EXPECT_LT(reflectance("v-coat", 550.0), 1e-7);
    EXPECT_GT(reflectance("v-coat", 450.0), 0.005);
    EXPECT_GT(reflectance("v-coat", 650.0), 0.005);
    const double middle = kMgF2 * kMgF2 * kGlass / (kAl2O3 * kAl2O3);
    EXPECT_NEAR(reflectance("quarter-half-quarter", 550.0), squared((1.0 - middle) / (1.0 + middle)), 1e-5);
    EXPECT_LT(largest_between("quarter-half-quarter", 430.0, 680.0), 0.009);
    EXPECT_LT(largest_between("broadband", 420.0, 680.0), 0.0075);
}

// Layers stand from air on, whichever side the air is; so light meets the same coating on both faces of a lens. On the
// rear face, as on the front one, the wrong order would reflect 20 %.
TEST(ShippedCoatings, LieWithTheirFirstLayerToTheAir) {
    const TestFolder folder;
    const auto traced = [&](const std::string& coating) {
        const std::filesystem::path file = folder.path() / "plate.toml";
        write_file(file, R"(name = "plate"
source = "test"
surfaces = [
  { thickness_mm = 5.0, glass = "SCHOTT N-BK7", semi_diameter_mm = 10.0, coating = ")" +
                             coating + R"(" },
  { thickness_mm = 1.0, semi_diameter_mm = 10.0, coating = ")" +
                             coating + R"(" },
  { stop = true, thickness_mm = 5.0, semi_diameter_mm = 10.0 },
])");
        const optics::TraceLens<double> lens = optics::at_wavelength<double>(load_lens(file.string()), 550.0);
        return optics::trace(lens, Ray<double>{{0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}}).transmittance;
    };
    for (const std::string& name : shipped_coating_names()) {
        const double each = 1.0 - reflectance(name, 550.0);
        EXPECT_NEAR(traced(name), each * each, 1e-3) << name;  // less what the films take up
        EXPECT_LE(traced(name), each * each + 1e-14) << name;
    }
}

TEST(ShippedCoatings, AreNamedByLenses) {
    const std::string text = R"(name = "x"
source = "y"
surfaces = [
  { radius_mm = 40.0, thickness_mm = 5.0, n_d = 1.6, semi_diameter_mm = 10.0, coating = "broadband" },
  { stop = true, thickness_mm = 40.0, semi_diameter_mm = 6.0 },
])";
    const optics::Prescription lens = parse_toml_prescription(text, "x.toml");
    EXPECT_EQ(lens.coatings.at("broadband"), shipped_coating("broadband").coating);
    // Written out in full, and read back to the same.
    EXPECT_EQ(parse_toml_prescription(to_toml(lens).text, "y.toml").coatings, lens.coatings);
    std::string misspelt = text;
    misspelt.replace(misspelt.find("broadband"), 9, "braodband");
    const std::string complaint = complaint_about([&] { parse_toml_prescription(misspelt, "x.toml"); });
    EXPECT_TRUE(says(complaint, "x.toml:3"));
    EXPECT_TRUE(says(complaint, "\"braodband\""));
    EXPECT_TRUE(says(complaint, "did you mean \"broadband\"?"));
}

TEST(ShippedCoatings, AreWishedForByUsers) {
    const optics::Prescription tessar = read_prescription(find_lens_file("tessar"));
    const auto worn = [&](const std::vector<std::string>& wishes) {
        std::string all;
        for (const optics::PrescribedSurface& row : with_coatings(tessar, wishes).surfaces) {
            all += row.coating.empty() ? "-" : row.coating.substr(0, 1);
        }
        return all;
    };
    EXPECT_EQ(worn({}), "--------");
    EXPECT_EQ(worn({"mgf2"}), "m-m-mmmm");  // not the stop, nor the cemented face
    EXPECT_EQ(worn({"mgf2", "3=none,1=broadband"}), "b---mmmm");
    EXPECT_EQ(worn({"7=v-coat"}), "------v-");
    EXPECT_EQ(worn({"mgf2,none"}), "--------");
    for (const auto& [wish, words] : {std::pair{"mgf3", "did you mean \"mgf2\"?"},
                                      {"9=mgf2", "from 1 to 8"},
                                      {"x=mgf2", "from 1 to 8"},
                                      {"", "known are"},
                                      {"=", "known are"}}) {
        const std::string complaint = complaint_about([&, text = wish] {
            with_coatings(tessar, {std::string(text), "1="});
        });
        EXPECT_TRUE(says(complaint, words)) << wish;
    }
}

// Every key of a layer, and each way to misuse one.
TEST(CoatingToml, ReadsComplexLayersAndTables) {
    const auto read = [](const std::string& layers) {
        return parse_toml_prescription(
            "name = \"x\"\nsource = \"y\"\nsurfaces = [{ stop = true, thickness_mm = 1.0, "
            "semi_diameter_mm = 1.0, coating = \"c\" }]\n[coatings.c]\n" +
                layers + "\n",
            "x.toml");
    };
    const auto films = [&](const std::string& layers) {
        const optics::Prescription lens = read(layers);
        return optics::resolved_coating(lens.coatings.at("c"), shipped_glasses(), optics::constant_glass("air", 1.0),
                                        optics::constant_glass("air", 1.0), "x.toml: coating c");
    };
    const optics::LensCoating coating = films(
        "layers = [{ n = 0.13, k = 3.3, thickness_nm = 20.0 }, { n = [[400, 2.2], [700, 2.1]], k = [[450, 1e-3], [650, "
        "0]], quarter_wave_nm = 550.0 }, { material = \"MGF2\", quarter_wave_nm = 550.0 }]");
    const optics::TraceCoating<double> at = optics::coating_at(coating, 550.0, "c");
    ASSERT_EQ(at.layers.size(), 3U);
    EXPECT_EQ(at.layers[0].index, 0.13);
    EXPECT_EQ(at.layers[0].extinction, 3.3);
    EXPECT_EQ(at.layers[0].thickness, 20.0 / 550.0);
    EXPECT_NEAR(at.layers[1].extinction, 5e-4, 1e-15);
    EXPECT_NEAR(at.layers[1].index * at.layers[1].thickness, 0.25, 1e-15);
    EXPECT_NEAR(at.layers[2].index, 1.37851, 1e-5);  // M. J. Dodge's formula
    EXPECT_NEAR(at.layers[2].index * at.layers[2].thickness, 0.25, 1e-15);
    EXPECT_TRUE(says(complaint_about([&] { optics::coating_at(coating, 440.0, "my lens"); }),
                     "my lens: 440 nm is outside the range of a coating's layer of 2 indices, 450 to 650 nm"));
    for (const auto& [layers, words] :
         {std::pair{"layers = [{ material = \"MGF3\", thickness_nm = 9.0 }]", "\"MGF3\""},
          {"layers = [{ material = \"MGF2\", quarter_wave_nm = 100.0 }]", "100 nm is outside the range"},
          {"layers = [{ material = \"MGF2\", n = 1.4, thickness_nm = 9.0 }]", "x.toml:5: coatings.c.layers[1].n"},
          {"layers = [{ n = 1.4, k = -1.0, thickness_nm = 9.0 }]", "k"},
          {"layers = [{ n = 0.0, thickness_nm = 9.0 }]", "n"},
          {"layers = [{ n = 1.4, thickness_nm = 0.0 }]", "thickness_nm"},
          {"layers = [{ n = 1.4, quarter_wave_nm = nan }]", "quarter_wave_nm"},
          {"layers = [{ n = [[700, 2.0], [400, 2.0]], thickness_nm = 9.0 }]", "rising"},
          {"layers = [{ n = 1.4, thickness_nm = 9.0, kappa = 1.0 }]", "kappa"},
          {"layers = []", "expected layers"},
          {"reflectance = 0.01\nfrom_air = true", "from_air"}}) {
        EXPECT_TRUE(says(complaint_about([&, text = layers] { films(text); }), words)) << layers;
    }
}

}  // namespace lensproof::formats::shipped_coatings_test
