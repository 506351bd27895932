#include "engine/scene/chart/chart.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "engine/scene/chart/aruco.h"
#include "engine/scene/chart/chart_file.h"
#include "tests/complaint.h"

namespace lensproof::scene::chart_test {

constexpr double kPi = std::numbers::pi;

Chart chart_of(const std::string& text) {
    TomlTable table = TomlTable::parse(text, "chart.toml");
    return read_chart(table);
}

const char* const kCharts[] = {
    "kind = 'checkerboard'\nsquares = [7, 5]\nsquare_mm = 30",
    "kind = 'disc-grid'\ndiscs = [7, 5]\npitch_mm = 30\ndiameter_mm = 17",
    "kind = 'charuco'\nsquares = [7, 5]\nsquare_mm = 30\nmarker_mm = 22\ndictionary = 'DICT_4X4_50'",
    "kind = 'siemens-star'\nsectors = 72\nradius_mm = 70",
    "kind = 'slanted-edges'\nsquares = [5, 3]\npitch_mm = 40\nsquare_mm = 25",
    "kind = 'point-grid'\npoints = [7, 5]\npitch_mm = 30\ndot_mm = 3",
    "kind = 'astigmatism-crosses'\ncrosses = [7, 5]\npitch_mm = 30\nlength_mm = 20\nline_mm = 1.5",
    "kind = 'colour-checker'\npatch_mm = 30\ngap_mm = 4",
    "kind = 'straight-lines'\nlines = [7, 5]\npitch_mm = 30\nline_mm = 2",
};

/// The fraction of black in the pattern's own rectangle, by `side`² points in the cells of a grid that lies askew to
/// it.
double black_fraction(const Chart& chart, int side = 1201) {
    const Vec2d size = pattern_size_mm(chart);
    int black = 0;
    for (int i = 0; i < side; ++i) {
        for (int k = 0; k < side; ++k) {
            black += is_black(chart, ((i + 0.5) / side - 0.5) * size.x, ((k + 0.5) / side - 0.5) * size.y) ? 1 : 0;
        }
    }
    return static_cast<double>(black) / side / side;
}

// Areas: what each pattern blackens of its rectangle, counted, against the shapes' own. An edge is counted to half a
// step of the points; the longest edges, 72 of the star, are some 30 times the chart's height: 30 / 1201 / 2, of which
// chance leaves a few per cent.
TEST(SceneChart, PatternsBlackenTheirShapesAreas) {
    const double expected[] = {
        18.0 / 35.0,
        kPi / 4 * 17 * 17 / 900,
        -1.0,  // by its markers, below
        kPi / 4 / 2,
        25.0 * 25.0 / 1600.0,
        1.0 - kPi / 4 * 9 / 900,
        (2 * 20 * 1.5 - 1.5 * 1.5) / 900,
        1.0 - 24 * 900.0 / (208 * 140),
        (2 * 30 * 2.0 - 2.0 * 2.0) / 900,
    };
    for (std::size_t i = 0; i < std::size(kCharts); ++i) {
        if (expected[i] >= 0.0) {
            EXPECT_NEAR(black_fraction(chart_of(kCharts[i])), expected[i], 1.5e-3) << kCharts[i];
        }
    }
}

TEST(SceneChart, ManyPlacesAtOnceAreAsTheyAreByThemselves) {
    constexpr std::size_t kPlaces = 1000;
    std::vector<double> x(kPlaces);
    std::vector<double> y(kPlaces);
    for (std::size_t i = 0; i < kPlaces; ++i) {
        x[i] = 0.4 * static_cast<double>(i % 37) * static_cast<double>(i % 29) - 150.0;
        y[i] = 0.3 * static_cast<double>(i % 41) * static_cast<double>(i % 23) - 110.0;
    }
    std::vector<double> found(kPlaces);
    for (const char* text : kCharts) {
        const Chart chart = chart_of(text);
        reflectances(chart, x, y, found);
        for (std::size_t i = 0; i < kPlaces; ++i) {
            ASSERT_EQ(found[i], reflectance(chart, x[i], y[i])) << text << ": " << x[i] << ", " << y[i];
        }
    }
}

// A board's black: its black squares, and of each marker the border and its zeros.
TEST(SceneChart, ACharucoBoardShowsItsMarkers) {
    const Chart chart = chart_of(kCharts[2]);
    const auto markers = aruco_dictionary("DICT_4X4_50").markers;
    double cells = 0.0;
    for (int i = 0; i < 17; ++i) {
        cells += 20 + 16 - std::popcount(markers[static_cast<std::size_t>(i)]);
    }
    const double cell_mm = 22.0 / 6.0;
    EXPECT_NEAR(black_fraction(chart), (18 * 900 + cells * cell_mm * cell_mm) / (35 * 900), 1e-3);
    // Marker 0 of DICT_4X4_50 is 1011 0101 0011 0010; it stands in the second square of the first row.
    const char* const rows[] = {"000000", "010110", "001010", "000110", "000100", "000000"};
    const double left = -3.5 * 30 + 30 + 4;
    const double top = -2.5 * 30 + 4;
    for (int row = 0; row < 6; ++row) {
        for (int column = 0; column < 6; ++column) {
            EXPECT_EQ(is_black(chart, left + (column + 0.5) * cell_mm, top + (row + 0.5) * cell_mm),
                      rows[row][column] == '0')
                << row << " " << column;
        }
    }
    EXPECT_FALSE(is_black(chart, left - 2.0, top - 2.0));
    EXPECT_TRUE(is_black(chart, left - 6.0, top));
}

// Garrido-Jurado et al. 2014: markers of a dictionary, turned however, keep a distance; OpenCV states for each how many
// wrong bits it can correct, less than half the distance. A typing error in the table would leave a marker too near to
// another only by chance, but one in two hundred markers would show the wrong pattern to OpenCV: the table was read off
// pictures.
TEST(SceneChart, ArucoMarkersKeepTheirDistance) {
    const auto turned = [](std::uint64_t bits, int n) {
        std::uint64_t result = 0;
        for (int row = 0; row < n; ++row) {
            for (int column = 0; column < n; ++column) {
                const int from = n * n - 1 - (column * n + n - 1 - row);
                result = result << 1 | (bits >> from & 1);
            }
        }
        return result;
    };
    const std::pair<const char*, int> correctable[] = {
        {"DICT_4X4_50", 1},  {"DICT_4X4_250", 1}, {"DICT_5X5_50", 3},
        {"DICT_5X5_250", 2}, {"DICT_6X6_50", 6},  {"DICT_6X6_250", 5},
    };
    for (const auto& [name, bits] : correctable) {
        const ArucoDictionary dictionary = aruco_dictionary(name);
        ASSERT_EQ(fmt::format("DICT_{0}X{0}_{1}", dictionary.cells, dictionary.markers.size()), name);
        int least = 64;
        for (std::size_t i = 0; i < dictionary.markers.size(); ++i) {
            std::uint64_t marker = dictionary.markers[i];
            for (int turn = 0; turn < 4; ++turn) {
                for (std::size_t k = 0; k <= i; ++k) {
                    if (k != i || turn != 0) {
                        least = std::min(least, std::popcount(marker ^ dictionary.markers[k]));
                    }
                }
                marker = turned(marker, dictionary.cells);
            }
        }
        EXPECT_EQ((least - 1) / 2, bits) << name;
    }
}

// A star's line pairs: a walk on any circle about its centre meets as many edges as there are sectors.
TEST(SceneChart, AStarHasItsSectorsOnEveryCircle) {
    const Chart chart = chart_of(kCharts[3]);
    for (const double radius : {0.01, 1.0, 69.9}) {
        int edges = 0;
        const auto black = [&](int i) {
            const double angle = (i + 0.5) / 7200 * 2 * kPi;
            return is_black(chart, radius * std::cos(angle), radius * std::sin(angle));
        };
        for (int i = 0; i < 7200; ++i) {
            edges += black(i) != black((i + 1) % 7200) ? 1 : 0;
        }
        EXPECT_EQ(edges, 72);
    }
    EXPECT_TRUE(is_black(chart, 50.0, 1.0));
    EXPECT_FALSE(is_black(chart, 50.0, -1.0));
    EXPECT_FALSE(is_black(chart, 70.1, 1.0));
}

// The corner of a square turned by 5° lies where the turn carries it.
TEST(SceneChart, SlantedSquaresAreTurnedByTheirAngle) {
    const Chart chart = chart_of(kCharts[4]);
    const double angle = 5.0 * kPi / 180.0;
    for (const Vec2d& centre : feature_points(chart)) {
        for (const double inside : {0.999, 1.001}) {
            const double x = 12.5 * inside;
            const double y = -12.5 * inside;
            EXPECT_EQ(is_black(chart, centre.x + std::cos(angle) * x - std::sin(angle) * y,
                               centre.y + std::sin(angle) * x + std::cos(angle) * y),
                      inside < 1.0);
        }
    }
}

// A cross's lines point to the chart's centre and past it at right angles.
TEST(SceneChart, CrossesAreRadialAndTangential) {
    const Chart chart = chart_of(kCharts[6]);
    for (const Vec2d& centre : feature_points(chart)) {
        const double radius = std::hypot(centre.x, centre.y);
        const Vec2d r = radius > 0.0 ? Vec2d{centre.x / radius, centre.y / radius} : Vec2d{1.0, 0.0};
        for (const double along : {-9.9, -5.0, 5.0, 9.9}) {
            EXPECT_TRUE(is_black(chart, centre.x + along * r.x, centre.y + along * r.y));
            EXPECT_TRUE(is_black(chart, centre.x - along * r.y, centre.y + along * r.x));
            const double aside = 0.71 * along;
            EXPECT_FALSE(is_black(chart, centre.x + aside * (r.x - r.y), centre.y + aside * (r.y + r.x)));
        }
        EXPECT_FALSE(is_black(chart, centre.x + 10.1 * r.x, centre.y + 10.1 * r.y));
    }
}

TEST(SceneChart, PatchesAreCountedRowByRow) {
    const Chart chart = chart_of(kCharts[7]);
    const auto& checker = std::get<ColourChecker>(chart.pattern);
    const std::vector<Vec2d> centres = feature_points(chart);
    ASSERT_EQ(centres.size(), 24U);
    for (std::size_t i = 0; i < centres.size(); ++i) {
        EXPECT_EQ(patch_at(checker, centres[i].x, centres[i].y), static_cast<int>(i));
        EXPECT_EQ(patch_at(checker, centres[i].x + 14.9, centres[i].y - 14.9), static_cast<int>(i));
        EXPECT_EQ(patch_at(checker, centres[i].x + 15.1, centres[i].y), std::nullopt);
        EXPECT_TRUE(is_black(chart, centres[i].x + 15.1, centres[i].y));
    }
    EXPECT_EQ(pattern_size_mm(chart), (Vec2d{208.0, 140.0}));
}

TEST(SceneChart, KindsSurviveTheirFiles) {
    const char* const names[] = {"checkerboard",        "disc-grid",      "charuco",
                                 "siemens-star",        "slanted-edges",  "point-grid",
                                 "astigmatism-crosses", "colour-checker", "straight-lines"};
    for (std::size_t i = 0; i < std::size(kCharts); ++i) {
        const Chart chart = chart_of(kCharts[i]);
        EXPECT_EQ(kind_name(chart), names[i]);
        const Vec2d size = pattern_size_mm(chart);
        EXPECT_FALSE(is_black(chart, 0.501 * size.x, 0.1)) << names[i];
        EXPECT_FALSE(is_black(chart, 0.1, -0.501 * size.y)) << names[i];
        const GridSize grid = feature_grid(chart);
        EXPECT_EQ(feature_points(chart).size(), static_cast<std::size_t>(grid.columns) * grid.rows);
    }
}

TEST(SceneChart, WhatDoesNotFitIsRefusedByKey) {
    const auto refusal = [](const std::string& text) { return complaint_about([&] { chart_of(text); }); };
    const auto expect = [&](const std::string& text, const std::string& said) {
        EXPECT_NE(refusal(text).find(said), std::string::npos) << refusal(text);
    };
    const std::string charuco = "kind = 'charuco'\nsquares = [7, 5]\nsquare_mm = 30\n";
    expect(charuco + "marker_mm = 30\ndictionary = 'DICT_4X4_50'", "chart.toml:4: marker_mm: is 30");
    expect(charuco + "marker_mm = 20\ndictionary = 'DICT_7X7_50'", "dictionary: is \"DICT_7X7_50\"");
    expect("kind = 'charuco'\nsquares = [20, 10]\nsquare_mm = 30\nmarker_mm = 20\ndictionary = 'DICT_4X4_50'",
           "100 white squares, more than the 50 markers");
    expect("kind = 'siemens-star'\nsectors = 71\nradius_mm = 70", "sectors: is 71, expected an even number");
    expect("kind = 'slanted-edges'\nsquares = [5, 3]\npitch_mm = 40\nsquare_mm = 37", "square_mm: is 37");
    expect("kind = 'point-grid'\npoints = [5, 3]\npitch_mm = 40\ndot_mm = 40", "dot_mm: is 40");
    expect("kind = 'astigmatism-crosses'\ncrosses = [7, 5]\npitch_mm = 30\nlength_mm = 22\nline_mm = 1", "length_mm");
    expect("kind = 'colour-checker'\npatch_mm = 0\ngap_mm = 4", "patch_mm: is 0");
    expect("kind = 'colour-checker'\npatch_mm = 3\ngap_mm = 4\ncolour = 2", "colour: is not a key");
    expect("kind = 'chess'", "kind: is \"chess\"");
}

}  // namespace lensproof::scene::chart_test
