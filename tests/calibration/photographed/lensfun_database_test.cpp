// Entries of lensfun's database as they are read, against what the library itself does with them.
#include "calibration/photographed/lensfun_database.h"

#include <gtest/gtest.h>
#include <lensfun/lensfun.h>

#include <array>
#include <cmath>
#include <memory>

#include "tests/calibration/photographed/entry_file.h"
#include "tests/complaint.h"

namespace lensproof::calibration::lensfun_database_test {

using namespace synthetic;

constexpr const char* kTca =
    "<tca model=\"poly3\" focal=\"50\" vr=\"1.0004\" cr=\"-0.0003\" br=\"0.0002\" "
    "vb=\"0.9995\" cb=\"0.0004\" bb=\"-0.0001\"/>";
constexpr const char* kVignetting =
    "<vignetting model=\"pa\" focal=\"50\" aperture=\"4\" distance=\"1\" k1=\"-0.9\" k2=\"0\" k3=\"0\"/>"
    "<vignetting model=\"pa\" focal=\"50\" aperture=\"4\" distance=\"1000\" k1=\"-0.5\" k2=\"0.3\" k3=\"-0.1\"/>"
    "<vignetting model=\"pa\" focal=\"50\" aperture=\"8\" distance=\"1000\" k1=\"-0.3\" k2=\"0.1\" k3=\"0\"/>";

struct Entry {
    const char* name;
    const char* rest;
    const char* distortion;
};

const std::array kEntries = {
    Entry{"poly3", "<cropfactor>1.534</cropfactor>", "<distortion model=\"poly3\" focal=\"50\" k1=\"-0.013\"/>"},
    Entry{"poly5", "<cropfactor>1</cropfactor>",
          "<distortion model=\"poly5\" focal=\"50\" k1=\"-0.02\" k2=\"0.006\"/>"},
    Entry{"ptlens", "<cropfactor>1</cropfactor>",
          "<distortion model=\"ptlens\" focal=\"50\" a=\"0.011\" b=\"-0.032\" c=\"0.007\"/>"},
    Entry{"four thirds", "<cropfactor>2</cropfactor><aspect-ratio>4:3</aspect-ratio>",
          "<distortion model=\"ptlens\" focal=\"50\" a=\"0.011\" b=\"-0.032\" c=\"0.007\"/>"}};

std::string whole_database() {
    std::string entries;
    for (const Entry& entry : kEntries) {
        entries += lens_entry(entry.name, entry.rest, std::string(entry.distortion) + kTca + kVignetting);
    }
    return database_of(entries);
}

PhotographedLens found_in(const std::string& database, const LensfunQuery& query) {
    const TestFolder folder;
    return LensfunDatabase::read(written(folder, "db.xml", database)).find(query);
}

/// The library's own correction of a picture taken on the sensor that the entry was calibrated on, 3:2 or 4:3.
class Library {
  public:
    Library(const Entry& entry, const PhotographedLens& lens) : aspect_(lens.aspect_ratio), unit_mm_(lens.unit_mm()) {
        const std::string xml =
            database_of(lens_entry(entry.name, entry.rest, std::string(entry.distortion) + kTca + kVignetting));
        EXPECT_EQ(database_->Load("memory", xml.c_str(), xml.size()), LF_NO_ERROR);
        const lfLens* read = database_->GetLenses()[0];
        const int width = static_cast<int>(std::lround(kHeight * aspect_));
        modifier_ = std::make_unique<lfModifier>(read, read->CropFactor, width, kHeight);
        modifier_->Initialize(read, LF_PF_F32, 50.0F, 4.0F, 1000.0F, 1.0F, read->Type,
                              LF_MODIFY_DISTORTION | LF_MODIFY_TCA | LF_MODIFY_VIGNETTING, false);
        const double half_diagonal = 0.5 * std::hypot(width - 1.0, kHeight - 1.0);
        unit_px_ = half_diagonal / std::hypot(1.0, aspect_);
        centre_ = {0.5 * (width - 1.0), 0.5 * (kHeight - 1.0)};
    }

    /// Where it finds a point that belongs at `ideal_mm` along x, mm.
    [[nodiscard]] double radius(double ideal_mm) const {
        std::array<float, 2> out{};
        modifier_->ApplyGeometryDistortion(x_of(ideal_mm), static_cast<float>(centre_[1]), 1, 1, out.data());
        return (out[0] - centre_[0]) / unit_px_ * unit_mm_;
    }
    /// Of red and of blue, where green is at `green_mm`.
    [[nodiscard]] std::array<double, 2> channels(double green_mm) const {
        std::array<float, 6> out{};
        modifier_->ApplySubpixelDistortion(x_of(green_mm), static_cast<float>(centre_[1]), 1, 1, out.data());
        return {(out[0] - centre_[0]) / unit_px_ * unit_mm_, (out[4] - centre_[0]) / unit_px_ * unit_mm_};
    }
    /// What is left of light there, by what it is brightened by.
    [[nodiscard]] double brightness(double radius_mm) const {
        std::array<float, 3> colour{0.25F, 0.25F, 0.25F};
        modifier_->ApplyColorModification(colour.data(), x_of(radius_mm), static_cast<float>(centre_[1]), 1, 1,
                                          LF_CR_3(RED, GREEN, BLUE), sizeof colour);
        return 0.25 / colour[1];
    }

  private:
    [[nodiscard]] float x_of(double radius_mm) const {
        return static_cast<float>(centre_[0] + radius_mm / unit_mm_ * unit_px_);
    }

    static constexpr int kHeight = 2400;
    double aspect_;
    double unit_mm_;
    double unit_px_ = 1.0;
    std::array<double, 2> centre_{};
    std::unique_ptr<lfDatabase> database_ = std::make_unique<lfDatabase>();
    std::unique_ptr<lfModifier> modifier_;
};

// The library computes in floats: 7 digits of coordinates up to 3600 px through some ten operations, 4e-3 px, which are
// 2e-5 mm of 24 mm on 2400 px, times two for the way there and back.
constexpr double kFloat_mm = 4e-5;

TEST(LensfunDatabase, IsWhatTheLibraryAppliesToPictures) {
    for (const Entry& entry : kEntries) {
        const PhotographedLens lens = found_in(whole_database(), {.model = entry.name, .focal_length_mm = 50.0});
        SCOPED_TRACE(entry.name);
        ASSERT_EQ(lens.vignetting.size(), 2U);  // by aperture, the farther focus
        ASSERT_TRUE(lens.lateral_colour);
        const Library library(entry, lens);
        for (const double fraction : {0.1, 0.4, 0.7}) {  // of the half-diagonal: 0.8 is the end of the longer side
            const double at = fraction * lens.half_diagonal_mm();
            EXPECT_NEAR(photographed_radius(lens, at), library.radius(at), kFloat_mm);
            const auto [red, blue] = library.channels(at);
            EXPECT_NEAR(at + channel_shift(lens, lens.lateral_colour->red, at), red, kFloat_mm);
            EXPECT_NEAR(at + channel_shift(lens, lens.lateral_colour->blue, at), blue, kFloat_mm);
            EXPECT_NEAR(lens.vignetting.front().brightness(fraction), library.brightness(at), 1e-3);
        }
    }
}

TEST(LensfunDatabase, FindsByNameWhateverItsCapitals) {
    const std::string both =
        database_of(lens_entry("Lens 50mm f/2", "<cropfactor>1</cropfactor>", kEntries[0].distortion) +
                    lens_entry("Lens 50mm f/2", "<cropfactor>1.5</cropfactor>", kEntries[1].distortion) +
                    lens_entry("Zoom", "<cropfactor>1</cropfactor><type>equisolid</type>", ""));
    EXPECT_EQ(found_in(both, {.model = "lens 50MM F/2", .crop_factor = 1.5}).distortion_model, "poly5");
    EXPECT_EQ(found_in(both, {.model = "Maker Lens 50mm f/2", .crop_factor = 1.0}).distortion_model, "poly3");
    EXPECT_EQ(found_in(both, {.model = "zoom"}).projection, optics::Projection::equisolid);
    EXPECT_EQ(found_in(both, {.model = "zoom"}).distortion_model, "");
    const auto complaint = [&](const LensfunQuery& query) {
        return complaint_about([&] { static_cast<void>(found_in(both, query)); });
    };
    EXPECT_TRUE(says(complaint({.model = "Lens 50mm f/2"}), "2 entries"));
    EXPECT_TRUE(says(complaint({.model = "Lens 50mm f/2"}), "--crop-factor"));
    EXPECT_TRUE(says(complaint({.model = "Lens 50mm f/2", .crop_factor = 2.0}), "of crop factor 2; it has"));
    EXPECT_TRUE(says(complaint({.model = "Lens 50mm f/1"}), "the nearest names are \"Lens 50mm f/2\""));
}

// Between two focal lengths the library interpolates; beyond them the nearest holds.
TEST(LensfunDatabase, InterpolatesAZoomsDistortion) {
    const std::string zoom = database_of(lens_entry("Zoom", "<focal min=\"20\" max=\"40\"/><cropfactor>1</cropfactor>",
                                                    "<distortion model=\"poly3\" focal=\"20\" k1=\"-0.02\"/>"
                                                    "<distortion model=\"poly3\" focal=\"40\" k1=\"0.01\"/>"));
    const auto k1_at = [&](double focal_length_mm) {
        return found_in(zoom, {.model = "Zoom", .focal_length_mm = focal_length_mm}).distortion[2];
    };
    EXPECT_NEAR(k1_at(15.0), -0.02, 1e-8);
    EXPECT_NEAR(k1_at(60.0), 0.01, 1e-8);
    EXPECT_GT(k1_at(30.0), -0.015);
    EXPECT_LT(k1_at(30.0), 0.005);
}

TEST(LensfunDatabase, ReadsEntriesAsJson) {
    const TestFolder folder;
    written(folder, "a.json", R"({"entries": [
        {"maker": "Maker", "models": ["A & B", "Б"], "mounts": ["M"], "crop": 1.5, "aspect": null, "type": "fisheye",
         "dist": [{"model": "poly3", "focal": "16", "k1": "-0.01", "real-focal": "15.7"}], "tca": [], "vig": []},
        {"maker": "Maker", "models": ["A & B"], "mounts": ["M"], "crop": 1.5, "aspect": "4:3", "type": "equisolid",
         "dist": [], "tca": [], "vig": []}]})");
    const LensfunDatabase database = LensfunDatabase::read(folder.path());
    const PhotographedLens lens =
        database.find({.model = "A & B", .projection = optics::Projection::equidistant, .focal_length_mm = 16.0});
    EXPECT_NEAR(lens.distortion[2], -0.01, 1e-8);
    EXPECT_NEAR(lens.half_diagonal_mm(), std::hypot(12.0, 8.0), 1e-6);  // of 36 × 24 mm over 1.5
    EXPECT_EQ(database.find({.model = "Б", .focal_length_mm = 16.0}).model, "A & B");
    EXPECT_NEAR(database.find({.model = "A & B", .projection = optics::Projection::equisolid}).aspect_ratio, 4.0 / 3.0,
                1e-6);
}

TEST(LensfunDatabase, RefusesWhatIsNoDatabase) {
    const TestFolder folder;
    const auto complaint = [&](const std::string& name, const std::string& text) {
        const std::filesystem::path file = written(folder, name, text);
        return complaint_about([&] { static_cast<void>(LensfunDatabase::read(file).find({.model = "poly3"})); });
    };
    EXPECT_TRUE(says(complaint("cut.xml", whole_database().substr(0, 900)), "cut.xml: ends before"));
    EXPECT_TRUE(says(complaint("odd.xml", database_of("<lens><odd/></lens>")), "odd.xml: lensfun"));
    EXPECT_TRUE(says(complaint("none.xml", database_of("")), "none.xml: holds no lens"));
    EXPECT_TRUE(says(complaint("bad.json", "{\"entries\": [{}]}"), "bad.json: entries[0]"));
    const TestFolder empty;
    EXPECT_TRUE(
        says(complaint_about([&] { static_cast<void>(LensfunDatabase::read(empty.path())); }), "holds no file"));
    EXPECT_TRUE(
        says(complaint_about([] { static_cast<void>(LensfunDatabase::read("/nowhere.xml")); }), "/nowhere.xml"));
}

}  // namespace lensproof::calibration::lensfun_database_test
