// A prescription written in another form and read back is the same lens: every ray, skew ones and wide ones too, meets
// every surface at the same point to 1e-9 mm. Where the form cannot say what bends or stops a ray, the writer warns,
// and of the right thing.
//
// Numbers are written with the digits that read back to the same double, so the tracer does the very same steps; what
// is left of 1e-9 mm is for forms that say a thing in other words (half diameters, half the rotation).
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "engine/base/infinity.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/prescription_file.h"
#include "tests/engine/formats/prescription/same_rays.h"
#include "tests/test_folder.h"

namespace lensproof::convert_test {

const std::vector<std::string> kForms = {".toml", ".csv", ".zmx", ".dat"};

class Conversion : public testing::Test {
  protected:
    /// Writes the lens in a form and reads it back. `warnings`: the codes of what the form could not say of its rays.
    optics::Prescription there_and_back(const optics::Prescription& lens, const std::string& form,
                                        std::set<std::string>& warnings) {
        const std::filesystem::path file = folder_.path() / ("lens" + form);
        for (const optics::Finding& lost : formats::write_prescription(lens, file)) {
            if (lost.severity != optics::Severity::info) {
                warnings.insert(lost.code);
                EXPECT_FALSE(lost.message.empty());
            }
        }
        return formats::read_prescription(file);
    }

    /// Asserts that the form warns of just `expected`, and that without a warning no ray moves.
    void expect_form_keeps(const optics::Prescription& lens, const std::string& form,
                           const std::set<std::string>& expected) {
        SCOPED_TRACE(lens.name + " as " + form);
        std::set<std::string> warnings;
        const optics::Prescription back = there_and_back(lens, form, warnings);
        EXPECT_EQ(warnings, expected);
        ASSERT_EQ(back.surfaces.size(), lens.surfaces.size());
        // These do not bend rays, at one wavelength and at the position that is written: the rest must still agree.
        std::set<std::string> bending = warnings;
        for (const char* code : {"lost-coating", "lost-zoom", "lost-focus-groups"}) {
            bending.erase(code);
        }
        const bool one_colour = bending.erase("lost-dispersion") > 0;
        if (!bending.empty()) {
            return;
        }
        for (std::size_t position = 0; position < std::max<std::size_t>(1, back.zoom.size()); ++position) {
            SCOPED_TRACE(position);
            formats::expect_same_rays(optics::at_zoom_position(lens, position),
                                      optics::at_zoom_position(back, position),
                                      one_colour ? std::vector{spectral::kLineD} : formats::kColours);
        }
    }

    TestFolder folder_;
};

/// A doublet with a stop before it, of constant indices: what every form can say.
optics::Prescription plain() {
    optics::Prescription lens;
    lens.name = "plain";
    lens.source = "made for this test";
    lens.file = "plain.toml";
    lens.surfaces = {{.thickness_mm = 4.3, .semi_diameter_mm = 6.0, .is_stop = true},
                     {.radius_mm = 61.3 / 3.0, .thickness_mm = 5.1, .semi_diameter_mm = 9.0, .medium = {.n_d = 1.5168}},
                     {.radius_mm = -44.4, .thickness_mm = 1.7, .semi_diameter_mm = 9.0, .medium = {.n_d = 1.6727}},
                     {.radius_mm = -129.7, .thickness_mm = 57.9, .semi_diameter_mm = 9.0}};
    return lens;
}

TEST_F(Conversion, KeepsEveryRayOfALensThatEveryFormCanSay) {
    for (const std::string& form : kForms) {
        expect_form_keeps(plain(), form, {});
    }
    optics::Prescription dispersive = plain();
    dispersive.surfaces[1].medium.V_d = 64.17;
    dispersive.surfaces[2].medium.V_d = 32.21;
    expect_form_keeps(dispersive, ".toml", {});
    expect_form_keeps(dispersive, ".csv", {});
    expect_form_keeps(dispersive, ".zmx", {});
    expect_form_keeps(dispersive, ".dat", {"lost-dispersion"});
}

TEST_F(Conversion, KeepsEveryRayOfEveryLensThatShips) {
    for (const std::string& name : formats::shipped_lens_names()) {
        optics::Prescription lens = formats::read_prescription(formats::find_lens_file(name));
        std::set<std::string> csv;
        std::set<std::string> pbrt;
        std::set<std::string> zmx;
        double before = 1.0;
        for (const optics::PrescribedSurface& row : lens.surfaces) {
            const bool is_air = row.medium.is_air();
            const double after = is_air ? 1.0 : 2.0;  // of any glass
            if (!is_air && (!row.medium.glass.empty() || row.medium.V_d)) {
                pbrt.insert("lost-dispersion");
            }
            if (row.is_flat() && !(row.is_stop && before == 1.0 && after == 1.0)) {
                pbrt.insert("lost-flat");
            }
            if (row.is_stop && !(row.is_flat() && before == after)) {
                pbrt.insert("lost-stop");
            }
            if (row.conic != 0.0 || row.is_asphere()) {
                pbrt.insert("lost-asphere");
            }
            if (row.radius_x_mm) {
                csv.insert("lost-toroid");
            }
            if (!row.coating.empty()) {
                csv.insert("lost-coating");
                zmx.insert("lost-coating");
            }
            before = after;
        }
        if (!lens.zoom.empty()) {
            csv.insert("lost-zoom");
        }
        if (!lens.focus_groups.empty()) {
            csv.insert("lost-focus-groups");
        }
        if (lens.stop_shape.index() != 0) {
            csv.insert("lost-stop-shape");
        }
        if (!lens.catalogues.empty() || !lens.preferred_makers.empty()) {
            csv.insert("lost-catalogues");
        }
        pbrt.insert(csv.begin(), csv.end());
        expect_form_keeps(lens, ".toml", {});
        expect_form_keeps(lens, ".csv", csv);
        expect_form_keeps(lens, ".zmx", zmx);
        if (!pbrt.contains("lost-stop")) {  // which is a row more
            expect_form_keeps(lens, ".dat", pbrt);
        }
    }
}

TEST_F(Conversion, KeepsConicsAndAspheresWhereThereAreColumns) {
    optics::Prescription lens = plain();
    lens.surfaces[1].conic = -0.73;
    lens.surfaces[3].asphere = {1e-5, -3.3e-6, 2.1e-8, 0.0, 1e-13};
    for (const optics::AsphereTerms& odd :
         {optics::AsphereTerms{}, {1e-4, -2e-5, 3e-7}, {0.0, -2e-5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-21}}) {
        lens.surfaces[3].odd_asphere = odd;
        expect_form_keeps(lens, ".toml", {});
        expect_form_keeps(lens, ".csv", {});
        expect_form_keeps(lens, ".zmx", {});
        expect_form_keeps(lens, ".dat", {"lost-asphere"});
    }
}

TEST_F(Conversion, WarnsOfWhatTablesCannotSay) {
    const auto expect = [&](const std::string& what, const optics::Prescription& lens) {
        expect_form_keeps(lens, ".toml", {});
        expect_form_keeps(lens, ".csv", {what});
        expect_form_keeps(lens, ".dat", {what});
    };
    optics::Prescription toroid = plain();
    toroid.surfaces[1].radius_x_mm = 25.0;
    expect("lost-toroid", toroid);
    optics::Prescription tilted = plain();
    tilted.surfaces[2].misalignment = {{0.1, -0.05}, {0.4, 0.2, -3.0}};
    expect("lost-misalignment", tilted);
    optics::Prescription grouped = plain();
    grouped.groups = {{.first = 2, .last = 4, .misalignment = {{0.0, 0.2}, {0.5, 0.0, 0.0}}, .pivot_mm = 2.0}};
    expect("lost-misalignment", grouped);
    optics::Prescription coated = plain();
    coated.coatings["single"] = optics::LayerStack{{{.index = {{550.0, 1.38}}, .thickness_nm = 99.6}}};
    coated.surfaces[1].coating = "single";
    expect("lost-coating", coated);
    optics::Prescription bladed = plain();
    bladed.stop_shape = optics::PolygonStop{.blades = 5, .curvature = 0.3, .rotation_deg = 11.0};
    expect("lost-stop-shape", bladed);
    optics::Prescription zoom = plain();
    zoom.zoom = {{.name = "wide", .gaps_mm = {{1, 2.0}, {4, 60.0}}, .stop_semi_diameter_mm = 5.0},
                 {.name = "tele", .gaps_mm = {{1, 8.0}, {4, 50.0}}}};
    expect("lost-zoom", zoom);
    for (const std::string& form : kForms) {
        optics::Prescription tele = optics::at_zoom_position(zoom, 1);
        tele.name = "tele";
        expect_form_keeps(tele, form, {});
    }
}

TEST_F(Conversion, WarnsOfAPlaneThatPbrtTakesForTheStop) {
    optics::Prescription lens = plain();
    lens.surfaces[3].radius_mm = kInfinity;
    expect_form_keeps(lens, ".csv", {});
    expect_form_keeps(lens, ".dat", {"lost-flat"});
    // What is written in its place departs from the plane by h² / 2R, 0.4 µm at the rim of 9 mm and R = 10⁵ mm.
    std::set<std::string> warnings;
    const optics::Lens back = optics::make_lens(there_and_back(lens, ".dat", warnings), formats::shipped_glasses());
    const optics::Lens here = optics::make_lens(lens, formats::shipped_glasses());
    int points = 0;
    const double apart = formats::furthest_apart(here, back, spectral::kLineD, points);
    EXPECT_GT(apart, 1e-9);
    EXPECT_LT(apart, 0.1);
}

TEST_F(Conversion, WarnsOfAStopThatLiesOnGlass) {
    optics::Prescription lens = plain();
    lens.surfaces.erase(lens.surfaces.begin());
    lens.surfaces[1].is_stop = true;
    expect_form_keeps(lens, ".toml", {});
    expect_form_keeps(lens, ".csv", {});
    std::set<std::string> warnings;
    const optics::Prescription back = there_and_back(lens, ".dat", warnings);
    EXPECT_EQ(warnings, std::set<std::string>{"lost-stop"});
    EXPECT_EQ(std::ranges::count_if(back.surfaces, &optics::PrescribedSurface::is_stop), 1);
}

TEST_F(Conversion, KeepsRimsAndBarrelsAsClearApertures) {
    optics::Prescription lens = plain();
    lens.surfaces[1].barrel_mm = 7.5;  // narrows this surface and the next
    lens.surfaces[3].semi_diameter_mm = std::nullopt;
    lens.surfaces[3].rim_mm = 8.0;
    for (const std::string& form : kForms) {
        expect_form_keeps(lens, form, {});
    }
}

}  // namespace lensproof::convert_test
