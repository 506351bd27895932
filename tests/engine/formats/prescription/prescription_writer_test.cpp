// What is written says the same when it is read back, or says that it does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/lens.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::formats::prescription_writer_test {

/// A prescription that uses everything there is.
optics::Prescription everything() {
    optics::Prescription lens;
    lens.file = "folder/a.toml";
    lens.name = "Quotes \" and \\ and a tab\t, µ and \x01\x7f";
    lens.source = "line\nbreak";
    lens.notes = "Two lines,\nthe second with \"\"\"three quotes\"\"\" \\ and \"one at the end\"";
    lens.projection = optics::Projection::equisolid;
    lens.surroundings = optics::Surroundings::vacuum;
    lens.object_distance_mm = 1234.5;
    lens.wavelengths_nm = {587.5618, 486.1327};
    lens.catalogues = {"folder/mine.agf", "folder/deep/other.yml", "beside.agf"};
    lens.preferred_makers = {"SCHOTT", "OHARA"};
    lens.stated = {.efl_mm = 100.0,
                   .bfl_mm = -3.0,
                   .f_number = 2.8,
                   .half_field_deg = 20.0,
                   .image_circle_mm = 43.3,
                   .total_track_mm = 1e-7,
                   .entrance_pupil_diameter_mm = 1.0 / 3.0,
                   .source = "claims"};
    lens.aperture = {optics::ApertureKind::object_numerical_aperture, 0.1};
    lens.fields = {.kind = optics::FieldKind::object_height,
                   .points = {{}, {-1.5, 1.0 / 3.0}},
                   .vignetting = {{}, {.decentre = {0.0, -0.1}, .compression = {0.1, 0.2}}}};
    lens.stop_shape = optics::PolygonStop{.blades = 7, .curvature = 0.25, .rotation_deg = -12.5};
    lens.barrel = {.tube = {.albedo = 0.04, .gloss = 0.5, .roughness = 0.25},
                   .edges = {.albedo = 0.1 + 0.2, .gloss = 0.0, .roughness = 1.0},
                   .blades = {.albedo = 0.0, .gloss = 1.0, .roughness = 0.0}};
    lens.coatings["single layer"] = optics::LayerStack{
        .layers = {{.index = {{550.0, 1.38}}, .thickness_nm = 99.6},
                   {.index = {{400.0, 2.2}, {700.0, 2.1}}, .extinction = {{550.0, 1e-4}}, .quarter_wave_nm = 500.0},
                   {.material = "MGF2", .extinction = {{400.0, 2e-4}, {700.0, 0.0}}, .quarter_wave_nm = 550.0}},
        .from_air = true};
    lens.coatings["stated"] = std::vector<optics::WavelengthValue>{{400.0, 0.01}, {700.0, 0.02}};
    lens.coatings["same"] = std::vector<optics::WavelengthValue>{{550.0, 0.005}};

    optics::PrescribedSurface front;
    front.radius_mm = 0.1 + 0.2;
    front.conic = -1.5;
    front.asphere = {1e-300, -2.5e-6, 0.0, 1.0 / 7.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3e-21};
    front.odd_asphere = {0.0, 3e-5, 0.0, 1.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, -7e-20};
    front.radius_x_mm = -44.0;
    front.thickness_mm = 5e-5;
    front.semi_diameter_mm = 12.0;
    front.rim_mm = 13.0;
    front.barrel_mm = 14.0;
    front.medium = {.glass = "SCHOTT N-BK7", .n_d = 1.5168, .V_d = 64.17};
    front.coating = "single layer";
    front.misalignment = {{0.1, -0.2}, {1.0, 2.0, -3.0}};
    optics::PrescribedSurface table = {};
    table.radius_mm = std::nan("");
    table.thickness_mm = -2.0;
    table.medium.indices = {{435.8343, 1.53}, {587.5618, 1.52}, {656.2725, 1.51}};
    table.coating = "stated";
    optics::PrescribedSurface stop;
    stop.is_stop = true;
    stop.thickness_mm = kInfinity;
    optics::PrescribedSurface curved_stop;
    curved_stop.is_stop = true;
    curved_stop.radius_mm = -1e20;
    curved_stop.radius_x_mm = kInfinity;
    curved_stop.coating = "same";
    lens.surfaces = {front, table, stop, curved_stop, optics::PrescribedSurface{.radius_mm = -kInfinity}};

    lens.groups = {{.first = 1, .last = 2, .misalignment = {{0.5, 0.0}, {0.0, -1e-3, 0.0}}, .pivot_mm = 3.5}};
    lens.focus_groups = {{.first = 1, .last = 1, .travel = 1.0}, {.first = 2, .last = 4, .travel = -0.75}};
    lens.zoom = {
        {.name = "wide \"end\"",
         .gaps_mm = {{1, 2.5}, {4, kInfinity}},
         .stop_semi_diameter_mm = 7.5,
         .aperture = {optics::ApertureKind::f_number, 3.5},
         .stated = {.efl_mm = 24.0}},
        {.name = "tele", .gaps_mm = {{1, 20.0}, {4, 1.0}}, .stop_semi_diameter_mm = {}, .aperture = {}, .stated = {}}};
    return lens;
}

TEST(TomlWriter, ReadsBackToTheSamePrescription) {
    const optics::Prescription lens = everything();
    const WrittenPrescription written = to_toml(lens);
    EXPECT_TRUE(written.lost.empty());
    const optics::Prescription back = parse_toml_prescription(written.text, lens.file);
    EXPECT_EQ(back.name, lens.name);
    EXPECT_EQ(back.source, lens.source);
    EXPECT_EQ(back.notes, lens.notes);
    EXPECT_EQ(back.projection, lens.projection);
    EXPECT_EQ(back.stated, lens.stated);
    EXPECT_EQ(back.aperture, lens.aperture);
    EXPECT_EQ(back.fields, lens.fields);
    ASSERT_EQ(back.surfaces.size(), lens.surfaces.size());
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        optics::PrescribedSurface found = back.surfaces[i];
        optics::PrescribedSurface expected = lens.surfaces[i];
        EXPECT_EQ(std::isnan(found.radius_mm), std::isnan(expected.radius_mm));
        if (std::isnan(expected.radius_mm)) {  // which equals nothing
            found.radius_mm = expected.radius_mm = 1.0;
        }
        found.where = expected.where;
        EXPECT_TRUE(found == expected) << i + 1;
    }
    const auto& polygon = std::get<optics::PolygonStop>(back.stop_shape);
    EXPECT_EQ(polygon.blades, 7);
    EXPECT_EQ(polygon.curvature, 0.25);
    EXPECT_EQ(polygon.rotation_deg, -12.5);
    EXPECT_EQ(back.barrel, lens.barrel);
    EXPECT_EQ(back.coatings, lens.coatings);
    ASSERT_EQ(back.groups.size(), 1U);
    EXPECT_EQ(back.groups[0].last, 2);
    EXPECT_EQ(back.groups[0].misalignment, lens.groups[0].misalignment);
    EXPECT_EQ(back.groups[0].pivot_mm, 3.5);
    ASSERT_EQ(back.focus_groups.size(), 2U);
    EXPECT_EQ(back.focus_groups[1].first, 2);
    EXPECT_EQ(back.focus_groups[1].travel, -0.75);
    ASSERT_EQ(back.zoom.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(back.zoom[i].name, lens.zoom[i].name);
        EXPECT_EQ(back.zoom[i].gaps_mm, lens.zoom[i].gaps_mm);
        EXPECT_EQ(back.zoom[i].stop_semi_diameter_mm, lens.zoom[i].stop_semi_diameter_mm);
        EXPECT_EQ(back.zoom[i].aperture, lens.zoom[i].aperture);
        EXPECT_EQ(back.zoom[i].stated, lens.zoom[i].stated);
    }
    EXPECT_EQ(back.surroundings, lens.surroundings);
    EXPECT_EQ(back.object_distance_mm, lens.object_distance_mm);
    EXPECT_EQ(back.wavelengths_nm, lens.wavelengths_nm);
    ASSERT_EQ(back.catalogues.size(), lens.catalogues.size());
    for (std::size_t i = 0; i < lens.catalogues.size(); ++i) {
        EXPECT_EQ(back.catalogues[i].lexically_normal(), lens.catalogues[i]);
    }
    EXPECT_EQ(back.preferred_makers, lens.preferred_makers);
}

// Behind a mirror is what is in front of it, which is written once.
TEST(TomlWriter, WritesMirrors) {
    optics::Prescription lens{.name = "Mangin", .source = "made up", .surfaces = {}};
    lens.surfaces = {
        {.radius_mm = -150.0,
         .thickness_mm = 8.0,
         .semi_diameter_mm = 30.0,
         .medium = {.glass = "N-BK7", .n_d = {}, .V_d = {}, .indices = {}},
         .is_stop = true},
        {.radius_mm = -240.0, .thickness_mm = -8.0, .semi_diameter_mm = 31.0, .medium = {}, .is_mirror = true},
        {.radius_mm = -150.0, .thickness_mm = -160.0, .semi_diameter_mm = 30.0, .medium = {}}};
    optics::set_mirror_media(lens.surfaces);
    const auto expect_same = [&](const optics::Prescription& back) {
        ASSERT_EQ(back.surfaces.size(), 3U);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(back.surfaces[i].is_mirror, i == 1);
            EXPECT_EQ(back.surfaces[i].radius_mm, lens.surfaces[i].radius_mm);
            EXPECT_EQ(back.surfaces[i].thickness_mm, lens.surfaces[i].thickness_mm);
            EXPECT_EQ(back.surfaces[i].medium, lens.surfaces[i].medium);
        }
    };
    expect_same(parse_toml_prescription(to_toml(lens).text, "a.toml"));
    expect_same(parse_zmx(to_zmx(lens).text, "a.zmx"));
    EXPECT_TRUE(says(lensproof::complaint_about([&] { to_csv(lens); }), "which a plain table of radii cannot say"));
}

TEST(TomlWriter, KeepsATexturedStopAndReplacesWhatIsNotUtf8) {
    optics::Prescription lens = everything();
    lens.stop_shape = optics::TexturedStop{.image = "sto\\p.png"};
    lens.name = "M\xFCller";
    const optics::Prescription back = parse_toml_prescription(to_toml(lens).text, lens.file);
    EXPECT_EQ(std::get<optics::TexturedStop>(back.stop_shape).image, "sto\\p.png");
    EXPECT_EQ(back.name, "M\xEF\xBF\xBDller");
}

TEST(TomlWriter, LeavesOutWhatItsReaderRefusesAndSaysSo) {
    optics::Prescription lens = everything();
    lens.stated.f_number = 0.0;
    lens.stated.efl_mm = std::nan("");
    lens.surfaces[0].misalignment.tilt_deg[0] = kInfinity;
    lens.surfaces[0].medium.indices = {{587.5618, 1.5}};
    lens.surfaces[1].medium.indices[0].value = 0.0;
    lens.object_distance_mm = -1.0;
    const WrittenPrescription written = to_toml(lens);
    EXPECT_EQ(written.lost.size(), 6U);
    EXPECT_NO_THROW(parse_toml_prescription(written.text, lens.file));
}

TEST(TomlWriter, AlignsTheTable) {
    optics::Prescription lens;
    lens.name = "x";
    optics::PrescribedSurface front;
    front.radius_mm = 42.97;
    front.thickness_mm = 9.8;
    front.medium.glass = "LAK9";
    front.semi_diameter_mm = 19.2;
    optics::PrescribedSurface stop;
    stop.is_stop = true;
    stop.thickness_mm = 79.831;
    stop.semi_diameter_mm = 5.0;
    lens.surfaces = {front, stop};
    EXPECT_TRUE(says(to_toml(lens).text,
                     "surfaces = [\n"
                     "  { radius_mm = 42.97, thickness_mm =  9.800, glass = \"LAK9\", semi_diameter_mm = 19.2 },\n"
                     "  { stop = true,       thickness_mm = 79.831,                 semi_diameter_mm =  5.0 },\n]\n"));
}

TEST(CsvWriter, CarriesWhatItsColumnsHoldAndNamesTheRest) {
    const optics::Prescription lens = everything();
    const WrittenPrescription written = to_csv(lens);
    const optics::Prescription back = parse_csv_prescription(written.text, "a.csv");
    ASSERT_EQ(back.surfaces.size(), lens.surfaces.size());
    EXPECT_EQ(back.surfaces[0].radius_mm, lens.surfaces[0].radius_mm);
    EXPECT_EQ(back.surfaces[0].asphere, lens.surfaces[0].asphere);
    EXPECT_EQ(back.surfaces[0].conic, lens.surfaces[0].conic);
    EXPECT_EQ(back.surfaces[0].thickness_mm, 2.5) << "the first zoom position's";
    EXPECT_EQ(back.surfaces[0].medium.glass, "SCHOTT N-BK7");
    EXPECT_EQ(back.surfaces[0].medium.V_d, 64.17);
    EXPECT_TRUE(std::isnan(back.surfaces[1].radius_mm));
    EXPECT_EQ(back.surfaces[1].medium.indices, lens.surfaces[1].medium.indices);
    EXPECT_TRUE(back.surfaces[2].is_stop);
    EXPECT_EQ(back.surfaces[1].semi_diameter_mm, 14.0) << "the barrel before it";
    for (const char* code :
         {"lost-zoom", "lost-toroid", "lost-misalignment", "lost-coating", "lost-stop-shape", "lost-barrel",
          "lost-focus-groups", "lost-surroundings", "lost-catalogues", "lost-projection", "lost-stated",
          "lost-object-distance", "lost-fields", "lost-aperture"}) {
        EXPECT_NE(std::ranges::find(written.lost, code, &optics::Finding::code), written.lost.end()) << code;
    }
}

// A table holds no aperture and no fields: their openings go into its column.
TEST(CsvWriter, WritesTheOpeningsThatApertureAndFieldsMake) {
    optics::Prescription lens = read_prescription(find_lens_file("tessar"));
    for (optics::PrescribedSurface& row : lens.surfaces) {
        row.semi_diameter_mm.reset();
    }
    lens.aperture = {optics::ApertureKind::f_number, 8.0};
    lens.fields = {.kind = optics::FieldKind::angle, .points = {{}, {0.0, 20.0}}, .vignetting = {}};
    const optics::Prescription back = parse_csv_prescription(to_csv(lens).text, "a.csv");
    const optics::Lens expected = optics::make_lens(lens, shipped_glasses());
    const optics::Lens found = optics::make_lens(back, shipped_glasses());
    for (std::size_t i = 0; i < expected.surfaces.size(); ++i) {
        EXPECT_EQ(found.surfaces[i].semi_diameter, expected.surfaces[i].semi_diameter) << i;
    }
}

TEST(WritePrescription, NamesFilesFromTheNewPlace) {
    const TestFolder place;
    const std::filesystem::path& folder = place.path();
    std::filesystem::create_directories(folder / "deep");
    optics::Prescription lens = everything();
    lens.file = folder / "a.toml";
    lens.catalogues = {folder / "mine.agf"};
    lens.stop_shape = optics::TexturedStop{.image = "stop.png"};
    EXPECT_TRUE(write_prescription(lens, folder / "deep" / "b.toml").empty());
    const optics::Prescription back = read_prescription(folder / "deep" / "b.toml");
    EXPECT_EQ(std::get<optics::TexturedStop>(back.stop_shape).image, "../stop.png");
    EXPECT_EQ(back.catalogues.front().lexically_normal(), (folder / "mine.agf").lexically_normal());
}

TEST(WritePrescription, NamesTheFormsThatItCanWrite) {
    for (const char* name : {"a.json", "a.fx", "a", "a.doc"}) {
        EXPECT_TRUE(says(complaint_about([&] { write_prescription(everything(), name); }), ".toml, .csv, .zmx, .dat"));
    }
}

}  // namespace lensproof::formats::prescription_writer_test
