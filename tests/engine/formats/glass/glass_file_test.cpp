// Catalogues that users bring: Zemax .agf, refractiveindex.info pages, the project's own tables.
#include "engine/formats/glass/glass_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"
#include "engine/spectral/wavelengths.h"
#include "tests/complaint.h"

namespace lensproof::formats::glass_file_test {

// SCHOTT's own record of N-BK7 (catalogue of 2017-01-20), shortened.
constexpr const char* kBk7 =
    "CC SCHOTT\r\n"
    "NM N-BK7 2 517642.251 1.5168 64.17 0 1 1\r\n"
    "GC step 0.5 available\r\n"
    "ED 7.1 8.3 2.51 -0.0009 0\r\n"
    "CD 1.03961212E+000 6.00069867E-003 2.31792344E-001 2.00179144E-002 1.01046945E+000 1.03560653E+002 0 0 0 0\r\n"
    "TD 1.86E-006 1.31E-008 -1.37E-011 4.34E-007 6.27E-010 1.70E-001 2.0E+001\r\n"
    "OD 1 2 0 1 2.3 2.3\r\n"
    "LD 3.0E-001 2.5E+000\r\n"
    "IT 4.0E-001 9.97E-001 1.0E+001\r\n"
    "IT 4.0E-001 9.92E-001 2.5E+001\r\n"
    "IT 3.65E-001 9.71E-001 2.5E+001\r\n";

std::string utf16(const std::string& text, bool big_endian, bool mark) {
    std::string bytes;
    const auto add = [&](unsigned code) {
        const char high = static_cast<char>(code >> 8);
        const char low = static_cast<char>(code & 0xFF);
        bytes += big_endian ? high : low;
        bytes += big_endian ? low : high;
    };
    if (mark) {
        add(0xFEFF);
    }
    for (const unsigned char letter : text) {
        add(letter);
    }
    return bytes;
}

/// One glass with formula `number` and coefficients `cd`, in a range around 1 µm.
double agf_index(int number, const std::string& cd, double um) {
    const std::string text = fmt::format("NM TEST {} 0 1 0 0 0 0\nMD 82 0.2\nBD 0\nCD {}\nLD 0.9 2.1\n", number, cd);
    const GlassFile file = parse_agf(text, "t.agf");
    EXPECT_TRUE(file.notes.empty()) << file.notes.front();
    return optics::refractive_index(file.glasses.at(0).formula, 1e3 * um);
}

double rii_index(int number, const std::string& coefficients, double um) {
    const std::string text = fmt::format(
        "DATA:\n  - type: formula {}\n    wavelength_range: 0.9 2.1\n    coefficients: {}\n", number, coefficients);
    return optics::refractive_index(parse_rii(text, "t.yml").glasses.at(0).formula, 1e3 * um);
}

std::string complaint(GlassFile (*parse)(const std::string&, const std::filesystem::path&), const std::string& text) {
    return complaint_about([&] { parse(text, "t"); });
}

TEST(Agf, ReadsAGlassWithAllThatIsKnownOfIt) {
    const GlassFile file = parse_agf(kBk7, "folder/schott.agf");
    EXPECT_TRUE(file.notes.empty());
    ASSERT_EQ(file.glasses.size(), 1U);
    const optics::Glass& glass = file.glasses.front();
    EXPECT_EQ(glass.name, "N-BK7");
    EXPECT_EQ(glass.catalogue, "SCHOTT");
    EXPECT_EQ(glass.status, "current");
    EXPECT_EQ(glass.note, "step 0.5 available");
    EXPECT_NEAR(optics::refractive_index(glass.formula, spectral::kLineD), *glass.stated_n_d, 1e-5);
    EXPECT_NEAR(optics::abbe_number(glass.formula), *glass.stated_V_d, 0.01);
    EXPECT_EQ(glass.min_wavelength_nm, 300.0);
    EXPECT_EQ(glass.thermal->e1, 6.27e-10);
    ASSERT_EQ(glass.internal_transmittance.size(), 2U) << "the thicker of two";
    EXPECT_EQ(glass.internal_transmittance[0].wavelength_nm, 365.0);
    EXPECT_EQ(glass.internal_transmittance[1].thickness_mm, 25.0);
}

TEST(Agf, ComesInManyEncodingsAndLineEnds) {
    const GlassFile plain = parse_agf(kBk7, "t.agf");
    std::string unix_lines = kBk7;
    std::erase(unix_lines, '\r');
    std::string mac_lines = kBk7;
    std::erase(mac_lines, '\n');
    std::string wrapped = kBk7;  // as NIKON's file has it
    wrapped.replace(wrapped.find(" 1.01046945E"), 1, "\r\n");
    std::string latin1 = kBk7;
    latin1.replace(latin1.find("step 0.5"), 8,
                   "\xB1"
                   "0.5");
    for (const std::string& text :
         {unix_lines, mac_lines, wrapped, latin1, "\xEF\xBB\xBF" + unix_lines, utf16(kBk7, false, true),
          utf16(kBk7, true, true), utf16(kBk7, false, false), utf16(kBk7, true, false)}) {
        const GlassFile file = parse_agf(text, "t.agf");
        ASSERT_EQ(file.glasses.size(), 1U);
        EXPECT_EQ(file.glasses[0].name, "N-BK7");
        EXPECT_EQ(file.glasses[0].formula, plain.glasses[0].formula);
        EXPECT_EQ(file.glasses[0].internal_transmittance.size(), 2U);
    }
}

// The formulas of the OpticStudio user guide, written out at λ = 1 µm, where every power is 1, and at 2 µm, where a
// wrong exponent shows. A few ulp.
TEST(Agf, HasEveryFormula) {
    const double l = 1.0 / (4.0 - 0.028);
    struct Row {
        int number;
        const char* cd;
        double at_1_um;
        double squared_at_2_um;
    };
    const Row rows[] = {
        {1, "2.2 -0.01 0.02 0.003 0.0004 0.00005", std::sqrt(2.2 - 0.01 + 0.02 + 0.003 + 0.0004 + 0.00005),
         2.2 - 0.04 + 0.02 / 4 + 0.003 / 16 + 0.0004 / 64 + 0.00005 / 256},
        {2, "1 0.01 0.2 0.02 1.1 100", std::sqrt(1 + 1 / 0.99 + 0.2 / 0.98 - 1.1 / 99),
         1 + 4 / 3.99 + 0.8 / 3.98 - 4.4 / 96},
        {3, "1.5 0.01 0.002 -0.003 0.0004 -0.00005",
         1.5 + 0.01 / 0.972 + 0.002 / (0.972 * 0.972) - 0.003 + 0.0004 - 0.00005,
         std::pow(1.5 + 0.01 * l + 0.002 * l * l - 0.012 + 0.0064 - 0.0032, 2)},
        {4, "0.1 1.2 0.1 -0.5 8", std::sqrt(1 + 0.1 + 1.2 / 0.99 + 0.5 / 63), 1 + 0.1 + 4.8 / 3.99 + 0.5 / 60},
        {5, "1.5 0.02 0.003", 1.523, std::pow(1.5 + 0.01 + 0.003 / (8 * std::sqrt(2.0)), 2)},
        {6, "1 0.01 0.2 0.02 1.1 100 0.3 0.04", std::sqrt(1 + 1 / 0.99 + 0.2 / 0.98 - 1.1 / 99 + 0.3 / 0.96),
         1 + 4 / 3.99 + 0.8 / 3.98 - 4.4 / 96 + 1.2 / 3.96},
        {7, "2.2 0.03 0.01 0.002", std::sqrt(2.2 + 0.03 / 0.99 - 0.002), 2.2 + 0.03 / 3.99 - 0.008},
        {8, "1.2 1.03 0.01 0.002", std::sqrt(1.2 + 1.03 / 0.99 - 0.002), 1.2 + 4.12 / 3.99 - 0.008},
        {9, "1.2 1.03 0.01 0.5 80", std::sqrt(1.2 + 1.03 / 0.99 - 0.5 / 79), 1.2 + 4.12 / 3.99 - 2.0 / 76},
        {10, "2.2 -0.01 0.02 0.003 0.0004 0.00005 0.001 0.002",
         std::sqrt(2.2 - 0.01 + 0.02 + 0.003 + 0.0004 + 0.00005 + 0.001 + 0.002),
         2.2 - 0.04 + 0.02 / 4 + 0.003 / 16 + 0.0004 / 64 + 0.00005 / 256 + 0.001 / 1024 + 0.002 / 4096},
        {11, "1 0.01 0.2 0.02 1.1 100 0.3 0.04 0.1 0.05",
         std::sqrt(1 + 1 / 0.99 + 0.2 / 0.98 - 1.1 / 99 + 0.3 / 0.96 + 0.1 / 0.95),
         1 + 4 / 3.99 + 0.8 / 3.98 - 4.4 / 96 + 1.2 / 3.96 + 0.4 / 3.95},
        {12, "2.2 -0.01 0.02 0.003 0.0004 0.00005 0.001 0.0002",
         std::sqrt(2.2 - 0.01 + 0.02 + 0.003 + 0.0004 + 0.00005 + 0.001 + 0.0002),
         2.2 - 0.04 + 0.02 / 4 + 0.003 / 16 + 0.0004 / 64 + 0.00005 / 256 + 0.016 + 0.0128},
        {13, "2.2 -0.01 0.001 0.02 0.003 0.0004 0.00005 0.005 0.006",
         std::sqrt(2.2 - 0.01 + 0.001 + 0.02 + 0.003 + 0.0004 + 0.00005 + 0.005 + 0.006),
         2.2 - 0.04 + 0.016 + 0.02 / 4 + 0.003 / 16 + 0.0004 / 64 + 0.00005 / 256 + 0.005 / 1024 + 0.006 / 4096}};
    for (const Row& row : rows) {
        EXPECT_NEAR(agf_index(row.number, row.cd, 1.0), row.at_1_um, 1e-14) << row.number;
        EXPECT_NEAR(agf_index(row.number, row.cd, 2.0), std::sqrt(row.squared_at_2_um), 1e-14) << row.number;
    }
}

// Makers' glasses, with the n_d and V_d that their catalogues state, in the forms that the makers use.
TEST(Agf, HasMakersGlasses) {
    const GlassFile file = parse_agf(
        "NM FC5 1 487704 1.48749 70.44 0 0 4\n"
        "CD 2.1894054 -9.9044908E-3 8.640337E-3 2.2263067E-4 -1.2291942E-5 5.9386349E-7\nLD 0.36501 1.5296\n"
        "NM J-BK7 13 1 1.516800 63.880667 0 2 1\n"
        "CD 2.27109726 -9.47304881E-3 -8.9187152E-5 1.09352525E-2\n1.36527555E-4 1.68617824E-6 5.85391298E-8 0 0\n0\n"
        "LD 0.365015 2.05809\n"
        "NM S-LAL9 2 691548 1.691002 54.822578 0 0 -1\n"
        "CD 1.16195687 0.0159659509 0.644860099 0.000505502467 1.25062221 93.8284169\nLD 0.29 2.4\n",
        "t.agf");
    ASSERT_EQ(file.glasses.size(), 3U);
    for (const optics::Glass& glass : file.glasses) {
        EXPECT_NEAR(optics::refractive_index(glass.formula, spectral::kLineD), *glass.stated_n_d, 1e-5) << glass.name;
        EXPECT_NEAR(optics::abbe_number(glass.formula), *glass.stated_V_d, 0.01) << glass.name;
    }
    EXPECT_EQ(file.glasses[1].status, "obsolete");
}

TEST(Agf, NamesWhatItLeavesOut) {
    const GlassFile file = parse_agf(
        "NM GOOD 2 0 1.5 60 0 0\nCD 1.2 0.01\nLD 0.4 0.7\nXX what\nIT 0.5 1.7 10\nIT 0.5\n"
        "NM FUTURE 14 0 1.5 60\nCD 1\nLD 0.4 0.7\n"
        "NM RANGELESS 2 0 1.5 60\nCD 1.2 0.01\n"
        "NM IMAGINARY 2 0 1.5 60\nCD -5 0.01\nLD 0.4 0.7\n"
        "NM HUGE 1e300 0 1.5 60\nLD 0.4 0.7\n",
        "t.agf");
    ASSERT_EQ(file.glasses.size(), 1U);
    EXPECT_EQ(file.glasses[0].name, "GOOD");
    ASSERT_EQ(file.notes.size(), 6U);
    EXPECT_TRUE(says(file.notes[0], "t.agf:4: XX"));
    EXPECT_TRUE(says(file.notes[2], "t.agf:7: glass FUTURE: formula is 14"));
    EXPECT_TRUE(says(file.notes[4], "IMAGINARY: its index"));
}

TEST(Agf, WhatIsNoCatalogueIsAnInputError) {
    EXPECT_TRUE(says(complaint(parse_agf, ""), "t: holds no NM"));
    EXPECT_TRUE(says(complaint(parse_agf, "CD 1 2\n"), "t:1: CD stands before"));
    EXPECT_TRUE(says(complaint(parse_agf, "NM A 2 0 1.5 60\nCD 1 x\n"), "t:2: a coefficient"));
    for (const char* text : {"NM", "NM A", "NM A 2 0 nan 60", "NM A 2 0 1.5 60\nCD nan", "NM A 2 0 1.5 60\nLD 0.4",
                             "NM A 2 0 1.5 60\nTD 1e999", "NM A 2 0 1.5 60\nIT 1 2 \xff"}) {
        EXPECT_FALSE(complaint(parse_agf, text).empty()) << text;
    }
    const std::string bk7 = kBk7;
    for (std::size_t length = 0; length < bk7.size(); length += 7) {  // truncated anywhere: no crash
        complaint(parse_agf, bk7.substr(0, length));
        complaint(parse_agf, utf16(bk7, length % 2 == 0, true).substr(0, length));
    }
    EXPECT_FALSE(complaint(parse_agf, std::string(1 << 20, '\0')).empty());
    EXPECT_FALSE(complaint(parse_agf, "NM A 2 0 1.5 60\nCD " + std::string(4'000'000, '1')).empty());
    EXPECT_FALSE(complaint(parse_agf, std::string((std::size_t{9} << 20), 'N')).empty());
}

constexpr const char* kRiiBk7 =
    "REFERENCES: \"<a href=\\\"x\\\">SCHOTT Zemax catalog</a>\"\n"
    "COMMENTS: \"step 0.5 available\"\n"
    "DATA:\n"
    "  - type: formula 2 \n"
    "    wavelength_range: 0.3 2.5\n"
    "    coefficients: 0 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n"
    "  - type: tabulated k\n"
    "    data: |\n"
    "        0.365 3.4191E-08\n"
    "        0.400 1.0227E-08\n"
    "SPECS:\n"
    "    temperature: 20.0 °C\n"
    "    thermal_dispersion:\n"
    "      - type: \"Schott formula\"\n"
    "        coefficients: 1.86e-06 1.31e-08 -1.37e-11 4.34e-07 6.27e-10 0.17\n"
    "    nd: 1.5168\n"
    "    Vd: 64.17\n"
    "    glass_status: standard\n";

TEST(Rii, ReadsAPage) {
    const GlassFile file = parse_rii(kRiiBk7, "glass/N-BK7.yml");
    ASSERT_EQ(file.glasses.size(), 1U);
    const optics::Glass& glass = file.glasses[0];
    EXPECT_EQ(glass.name, "N-BK7");
    EXPECT_EQ(glass.source, "SCHOTT Zemax catalog");
    EXPECT_EQ(glass.status, "current");
    EXPECT_NEAR(optics::refractive_index(glass.formula, spectral::kLineD), *glass.stated_n_d, 1e-5);
    EXPECT_NEAR(optics::abbe_number(glass.formula), *glass.stated_V_d, 0.01);
    EXPECT_EQ(glass.formula, parse_agf(kBk7, "t.agf").glasses[0].formula);
    EXPECT_EQ(glass.thermal->d0, 1.86e-6);
    // The sheet of N-BK7: 0.992 and 0.971 through 25 mm.
    EXPECT_NEAR(optics::internal_transmittance(glass, 400.0, 25.0).value(), 0.992, 5e-4);
    EXPECT_NEAR(optics::internal_transmittance(glass, 365.0, 25.0).value(), 0.971, 5e-4);
}

TEST(Rii, HasEveryFormula) {
    const double l = 1.0 / (4.0 - 0.028);
    const double retro = 0.2 + 0.1 * 4 / (4 - 0.04) - 0.004;
    struct Row {
        int number;
        const char* coefficients;
        double at_2_um;
    };
    for (const Row& row :
         {Row{1, "0.1 1.2 0.1 0.3 9", std::sqrt(1.1 + 4.8 / 3.99 - 1.2 / 77)},
          Row{2, "0.1 1.2 0.01 0.3 81", std::sqrt(1.1 + 4.8 / 3.99 - 1.2 / 77)},
          Row{3, "2.2 -0.01 2 0.02 -2 0.003 -4", std::sqrt(2.2 - 0.04 + 0.005 + 0.003 / 16)},
          Row{4, "2.2 0.3 2 0.1 2 0.4 0 3 2 0.01 -2 0.002 2",
              std::sqrt(2.2 + 1.2 / 3.99 + 0.4 / (4 - 9.0) + 0.0025 + 0.008)},
          Row{4, "2.67 0.03 0 0.2 2 0 0 0 1 -0.004 2", std::sqrt(2.67 + 0.03 / 3.96 - 0.016)},
          Row{5, "1.5 0.02 -2 0.003 -4", 1.5 + 0.005 + 0.003 / 16},
          Row{6, "0.1 1.49 25 0.53 18", 1.1 + 1.49 / 24.75 + 0.53 / 17.75},
          Row{7, "1.5 0.01 0.002 -0.003 0.0004 -0.00005", 1.5 + 0.01 * l + 0.002 * l * l - 0.012 + 0.0064 - 0.0032},
          Row{8, "0.2 0.1 0.04 -0.001", std::sqrt((1 + 2 * retro) / (1 - retro))},
          Row{9, "2.5 0.024 0.03 0.02 1.52 0.8771",
              std::sqrt(2.5 + 0.024 / 3.97 + 0.02 * 0.48 / (0.48 * 0.48 + 0.8771))}}) {
        EXPECT_NEAR(rii_index(row.number, row.coefficients, 2.0), row.at_2_um, 1e-14) << row.number;
    }
    // Ciddor's standard air in the database's gas form, at 633 nm: his table 1 scaled to 15 °C and 101 325 Pa.
    const optics::Glass air = parse_rii(
                                  "DATA:\n  - type: formula 6\n    wavelength_range: 0.23 1.690\n"
                                  "    coefficients: 0 0.05792105 238.0185 0.00167917 57.362\n",
                                  "air.yml")
                                  .glasses[0];
    EXPECT_NEAR(optics::refractive_index(air.formula, 633.0), 1.0 + 26824.4e-8 * 1.01325 * 293.15 / 288.15, 5e-8);
}

// N-BK7 from its formula at the 13 lines of a maker's sheet: the curve between them errs as the header says.
TEST(Rii, InterpolatesATable) {
    const optics::DispersionFormula exact = parse_rii(kRiiBk7, "t.yml").glasses[0].formula;
    std::string text = "DATA:\n  - type: tabulated n\n    data: |\n";
    for (const spectral::SpectralLine& line : spectral::spectral_lines()) {
        text += fmt::format("        {} {:.10f}\n", 1e-3 * line.wavelength_nm,
                            optics::refractive_index(exact, line.wavelength_nm));
    }
    const optics::Glass glass = parse_rii(text, "t.yml").glasses[0];
    double worst = 0.0;
    double worst_visible = 0.0;
    for (double nm = spectral::kLineI; nm <= spectral::kLineT; nm += 1.0) {
        const double error =
            std::abs(optics::refractive_index(glass.formula, nm) - optics::refractive_index(exact, nm));
        worst = std::max(worst, error);
        worst_visible =
            nm >= spectral::kLineH && nm <= spectral::kLineR ? std::max(worst_visible, error) : worst_visible;
    }
    EXPECT_LT(worst, 4e-5);
    EXPECT_LT(worst_visible, 3e-6);
    EXPECT_NEAR(optics::refractive_index(glass.formula, spectral::kLineE),
                optics::refractive_index(exact, spectral::kLineE), 1e-10)
        << "at a row";
    EXPECT_EQ(optics::refractive_index(glass.formula, 100.0), optics::refractive_index(glass.formula, spectral::kLineI))
        << "beyond the end";
    // A step stays a step: no value outside those of its ends.
    const optics::Glass step = parse_rii(
                                   "DATA:\n  - type: tabulated n\n    data: |\n        1 1.5\n        2 1.5\n"
                                   "        3 1.7\n        4 1.7\n",
                                   "t.yml")
                                   .glasses[0];
    for (double nm = 1000.0; nm <= 4000.0; nm += 50.0) {
        EXPECT_GE(optics::refractive_index(step.formula, nm), 1.5 - 1e-15);
        EXPECT_LE(optics::refractive_index(step.formula, nm), 1.7 + 1e-15);
    }
}

TEST(Rii, WhatIsNoPageIsAnInputError) {
    const std::string data = "DATA:\n  - type: ";
    const std::pair<std::string, const char*> cases[] = {
        {"", "no list DATA"},
        {"[1, 2]", "no list DATA"},
        {"DATA: 3", "no list DATA"},
        {"DATA: [3]", "no map"},
        {"a: b: c", "not YAML"},
        {"\x01\x02", "t"},
        {data + "formula 10\n", "no refractive index"},
        {data + "formula 2\n", "0 coefficients"},
        {data + "formula 2\n    coefficients: 0 nan 1\n", "finite"},
        {data + "formula 2\n    coefficients: [0, 1, 2]\n", "0 coefficients"},
        {data + "formula 2\n    coefficients: 0 1 0.01\n", "wavelength_range"},
        {data + "formula 2\n    coefficients: 0 1 0.01\n    wavelength_range: 2 1\n", "range"},
        {data + "formula 2\n    coefficients: 0 -9 0.01\n    wavelength_range: 1 2\n", "index"},
        {data + "tabulated n\n    data: 1 2 3\n", "rows of 2"},
        {data + "tabulated n\n    data: 1 2 1 3\n", "one row"},
        {data + "tabulated n\n    data: 0 2 1 3\n", "positive"},
        {data + "tabulated n\n    data: 1 1.5\n", "one row"},
        {data + "tabulated n\n", "0 numbers"},
    };
    for (const auto& [text, word] : cases) {
        EXPECT_TRUE(says(complaint(parse_rii, text), word)) << text;
    }
    const std::string page = kRiiBk7;
    for (std::size_t length = 0; length < page.size(); length += 5) {
        complaint(parse_rii, page.substr(0, length));
    }
}

TEST(Rii, DeepAndSelfSimilarYamlIsRefusedShortly) {
    EXPECT_FALSE(complaint(parse_rii, std::string(200'000, '[')).empty());
    EXPECT_FALSE(complaint(parse_rii, "DATA: " + std::string(100'000, '{')).empty());
    std::string deep = "a:\n";
    for (int i = 1; i < 2000; ++i) {
        deep += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
    }
    EXPECT_FALSE(complaint(parse_rii, deep).empty());
    std::string laughs = "a0: &a0 [x, x]\n";
    for (int i = 1; i < 40; ++i) {
        laughs += fmt::format("a{}: &a{} [*a{}, *a{}]\n", i, i, i - 1, i - 1);
    }
    EXPECT_FALSE(complaint(parse_rii, laughs + "DATA: *a39\n").empty());
    EXPECT_FALSE(complaint(parse_rii, "DATA: &d [*d]\n").empty());
    EXPECT_TRUE(says(complaint(parse_rii, std::string(5 << 20, ' ')), "bytes"));
}

TEST(GlassTable, ReadsEveryFormulaAndMinds) {
    const std::string head = "glass,formula,coefficients,min_nm,max_nm\n";
    const GlassFile file =
        parse_glass_table(head +
                              "A,constant,1.5,400,700\nB,cauchy,1.5 0 0.004 -2,400,700\n"
                              "C,table,400 1.53 500 1.52 700 1.51,400,700\nD,power-series,2.25 0,400,700\n",
                          "mine.csv");
    ASSERT_EQ(file.glasses.size(), 4U);
    EXPECT_EQ(file.glasses[0].catalogue, "mine");
    EXPECT_EQ(optics::refractive_index(file.glasses[1].formula, 1000.0), 1.504);
    EXPECT_EQ(optics::refractive_index(file.glasses[2].formula, 500.0), 1.52);
    EXPECT_EQ(optics::refractive_index(file.glasses[3].formula, 500.0), 1.5);
    for (const char* row : {"A,constant,,400,700", "A,constant,nan,400,700", "A,sellmeier,1,400,700",
                            ",constant,1,400,700", "A,magic,1,400,700", "A,constant,1.5,700,400",
                            "A,constant,1.5,0,400", "A,schott,1 2,400,700", "A,table,400 1.5 300 1.5,400,700",
                            "A,sellmeier,-9 0.01,400,700", "A,constant,1.5,400,700\nA,constant,1.5,400,700"}) {
        const std::string said = complaint_about([&] { parse_glass_table(head + row + "\n", "t.csv"); });
        EXPECT_TRUE(said.starts_with("t.csv:")) << row << ": " << said;
    }
    EXPECT_THROW(read_glass_file("no-such.agf"), InputError);
    EXPECT_THROW(read_glass_file("no-such.txt"), InputError);
}

}  // namespace lensproof::formats::glass_file_test
