// What the names of glasses mean.
#include "engine/optics/glass_name.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "engine/base/nearest_name.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics::glass_name_test {

std::string meaning(std::string_view name, const std::vector<std::string>& preferred = {}) {
    const GlassMatch match = formats::shipped_glasses().resolve(name, preferred);
    return match.glass ? match.glass->catalogue + " " + match.glass->name : "";
}

bool suggests(std::string_view name, const std::string& glass) {
    const GlassMatch match = formats::shipped_glasses().resolve(name);
    return !match.glass && std::ranges::any_of(match.suggestions, [&](const auto& s) { return s.name == glass; });
}

TEST(GlassName, IsUnderstoodAsLensPeopleWriteIt) {
    const std::pair<const char*, const char*> table[] = {
        {"LAK9", "SCHOTT LAK9"},         {"lak9", "SCHOTT LAK9"},
        {"N-LAK9", "SCHOTT N-LAK9"},     {"NLAK9", "SCHOTT N-LAK9"},
        {"n lak9", "SCHOTT N-LAK9"},     {" N-LAK9 ", "SCHOTT N-LAK9"},
        {"SCHOTT LAK9", "SCHOTT LAK9"},  {"LAK9 (SCHOTT)", "SCHOTT LAK9"},
        {"LAK9_SCHOTT", "SCHOTT LAK9"},  {"Schott: N-BK7", "SCHOTT N-BK7"},
        {"NBK7_SCHOTT", "SCHOTT N-BK7"}, {"S-LAL9", "OHARA S-LAL9"},
        {"SLAL9_OHARA", "OHARA S-LAL9"}, {"ohara s-lal 9", "OHARA S-LAL9"},
        {"FCD1", "HOYA FCD1"},           {"BK7", "SCHOTT BK7"},
        {"BK 7", "SCHOTT BK7"},          {"SF7", "HIKARI SF7"},
        {"SF7_NIKON", "HIKARI SF7"},     {"SK18A", "SCHOTT SK18A"},
        {"LAK9_HIKARI", "HIKARI LAK9"},  {"LLF7", "SCHOTT LLF7"},
        {"SK16", "SCHOTT SK16"},         {"H-K9L", "CDGM H-K9L"},
        {"SILICA", "MATERIALS SILICA"},  {"F_SILICA", "MATERIALS F_SILICA"},
        {"ACRYLIC", "MATERIALS ACRYLIC"}};
    for (const auto& [name, expected] : table) {
        EXPECT_EQ(meaning(name), expected) << name;
    }
}

TEST(GlassName, NeverBecomesAnotherGlassSilently) {
    for (const char* name : {"", " ", "-", "UNOBTAINIUM", "N-LLF7", "N-SF12", "OHARA BK7", "LAK9_HOYA", "Q-LAK9", "BK",
                             "517642", "SCHOTT", "N-BK7N", "\xff\xfe", "_SCHOTT", "SCHOTT SCHOTT"}) {
        EXPECT_EQ(meaning(name), "") << name;
    }
    EXPECT_TRUE(suggests("N-LLF7", "LLF7"));
    EXPECT_TRUE(suggests("LAK34", "N-LAK34"));
    EXPECT_TRUE(suggests("P-SF65", "P-SF68"));
    EXPECT_TRUE(suggests("OHARA BK7", "BK7"));
    EXPECT_TRUE(suggests("N-BK8", "BK8"));
    EXPECT_TRUE(suggests("S-BLS7", "S-BSL7"));
    EXPECT_TRUE(suggests("517642", "N-BK7"));
    EXPECT_TRUE(formats::shipped_glasses().resolve("UNOBTAINIUM").suggestions.empty());
}

TEST(GlassName, InSeveralCataloguesGoesToThePreferredOneAndSaysSo) {
    const GlassMatch match = formats::shipped_glasses().resolve("LAK9");
    EXPECT_EQ(match.how, GlassMatch::How::exact);
    EXPECT_EQ(match.also_in, std::vector<std::string>{"HIKARI"});
    EXPECT_EQ(meaning("LAK9", {"OHARA", "HIKARI"}), "HIKARI LAK9");
    EXPECT_EQ(meaning("LAK9", {"OHARA"}), "SCHOTT LAK9");
    EXPECT_EQ(formats::shipped_glasses().resolve("NLAK9").how, GlassMatch::How::spelled_differently);
    EXPECT_TRUE(formats::shipped_glasses().resolve("N-BK7").also_in.empty());
}

TEST(GlassName, OfAGlassThatTheUserBroughtComesFirst) {
    GlassCatalogue catalogue = formats::shipped_glasses();
    Glass mine;
    mine.name = "BK7";
    mine.catalogue = "MINE";
    mine.formula = ConstantIndex{1.5};
    catalogue.add({mine});
    const GlassMatch match = catalogue.resolve("bk7");
    EXPECT_EQ(match.glass->catalogue, "MINE");
    EXPECT_EQ(match.also_in, std::vector<std::string>{"SCHOTT"});
    EXPECT_EQ(catalogue.resolve("BK7_MINE").glass->catalogue, "MINE");
    EXPECT_EQ(catalogue.resolve("BK7_SCHOTT").glass->catalogue, "SCHOTT");
}

// Every glass answers to its own name, and with hyphens and case aside it is still that glass.
TEST(GlassName, EveryShippedNameMeansItsGlass) {
    for (const Glass& glass : formats::shipped_glasses().glasses()) {
        const GlassMatch match = formats::shipped_glasses().resolve(glass.name + "_" + glass.catalogue);
        ASSERT_TRUE(match.glass) << glass.name;
        EXPECT_EQ(match.glass->name, glass.name);
        EXPECT_EQ(match.glass->catalogue, glass.catalogue);
    }
}

TEST(GlassName, NearestGlassesHaveNearFigures) {
    const std::vector<Glass> nearest = formats::shipped_glasses().nearest(1.62041, 60.32, 3);
    ASSERT_EQ(nearest.size(), 3U);
    for (const Glass& glass : nearest) {
        EXPECT_NEAR(refractive_index(glass.formula, spectral::kLineD), 1.62041, 1e-3) << glass.name;
    }
    EXPECT_EQ(formats::shipped_glasses().nearest(1.5, 60.0, 100000).size(),
              formats::shipped_glasses().glasses().size());
}

TEST(GlassCode, GivesIndexAndAbbeNumber) {
    const std::tuple<const char*, double, double> table[] = {
        {"517642", 1.517, 64.2},     {"517642.251", 1.517, 64.2},      {"517.642", 1.517, 64.2},
        {"1.517:64.2", 1.517, 64.2}, {"516800.641700", 1.5168, 64.17}, {"001291", 2.001, 29.1},
        {"104170", 2.104, 17.0},     {"439950", 1.439, 95.0},          {" 620603 ", 1.620, 60.3}};
    for (const auto& [text, n_d, V_d] : table) {
        const std::optional<GlassCode> code = parse_glass_code(text);
        ASSERT_TRUE(code) << text;
        EXPECT_NEAR(code->n_d, n_d, 1e-12) << text;
        EXPECT_NEAR(code->V_d, V_d, 1e-12) << text;
    }
    for (const char* text : {"", "51764", "5176420", "51764x", "517642.", ".642", "517.64x", "1.517:", ":", "nan:nan",
                             "9.9:50", "-17642", "517000", "BK7", "517642.25100000000000000000"}) {
        EXPECT_FALSE(parse_glass_code(text)) << text;
    }
}

TEST(GlassName, SpellingDistanceCountsSlipsOfTheFinger) {
    EXPECT_EQ(spelling_distance("NBK7", "NBK7"), 0);
    EXPECT_EQ(spelling_distance("NBK7", "NBK8"), 1);
    EXPECT_EQ(spelling_distance("NBK7", "NKB7"), 1);
    EXPECT_EQ(spelling_distance("LAK9", "NLAK9"), 1);
    EXPECT_EQ(spelling_distance("", "SF6"), 3);
    EXPECT_EQ(spelling_distance("SF11", "SF57"), 2);
}

}  // namespace lensproof::optics::glass_name_test
