#include "experiments/draw/analysis_plots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "experiments/draw/analysis_drawings.h"
#include "tests/experiments/draw/svg_checks.h"

namespace lensproof::draw::analysis_plots_test {

/// A lens as the plots see it: aberrations of about `size` µm at each of the fields and wavelengths.
struct Case {
    PlotHeading heading{.lens = "Test <lens> & co", .conditions = "f/2.8, object at infinity"};
    std::vector<double> fields{0.0, 7.0, 14.0};
    std::vector<double> wavelengths{486.1327, 587.5618, 656.2725};
    double size = 10.0;
    bool has_light = true;
};

std::vector<analysis::WavelengthCurve> curves(const Case& c, double low, double high,
                                              const std::function<double(double)>& value) {
    std::vector<analysis::WavelengthCurve> made;
    for (const double wavelength : c.wavelengths) {
        analysis::WavelengthCurve curve{.wavelength_nm = wavelength};
        for (int i = 0; i <= 16; ++i) {
            const double t = low + (high - low) * i / 16.0;
            curve.points.push_back({t, c.size * (value(t) + 1e-3 * (wavelength - 587.0) * t)});
        }
        made.push_back(std::move(curve));
    }
    return c.has_light ? made : std::vector<analysis::WavelengthCurve>{};
}

double cubic(double t) {
    return t * t * t;
}

std::string fans(const Case& c) {
    std::vector<analysis::FieldFans> fields;
    for (const double field : c.fields) {
        fields.push_back({field, curves(c, -1.0, 1.0, cubic), curves(c, -0.8, 0.6, cubic)});
    }
    return ray_fans_svg(c.heading, fields);
}

std::string field_curves(const Case& c) {
    std::vector<analysis::FieldCurve> made;
    for (const double wavelength : c.wavelengths) {
        analysis::FieldCurve curve{.wavelength_nm = wavelength};
        for (const double field : c.fields) {
            const double v = c.has_light ? 1e-3 * c.size * field : kNaN;
            curve.points.push_back({field, v, 0.5 * v, -v});
        }
        made.push_back(std::move(curve));
    }
    return field_curves_svg(c.heading, made, "f tan θ");
}

std::string longitudinal(const Case& c) {
    return longitudinal_aberration_svg(c.heading, curves(c, 0.0, 1.0, cubic));
}

std::string lateral(const Case& c) {
    std::vector<Vec2d> airy;
    for (const double field : c.fields) {
        airy.push_back({field, 2.0});
    }
    return lateral_colour_svg(c.heading, curves(c, c.fields.front(), c.fields.back(), [](double t) { return 0.1 * t; }),
                              airy);
}

std::string spots(const Case& c) {
    std::vector<analysis::FieldSpots> fields;
    for (const double field : c.fields) {
        analysis::FieldSpots row{.field_deg = field, .airy_radius_um = 2.0};
        for (int i = 0; i < 3; ++i) {
            row.spots.push_back({c.size, curves(c, -1.0, 1.0, cubic)});
        }
        fields.push_back(std::move(row));
    }
    return spots_svg(c.heading, {-0.1, 0.0, 0.1}, fields);
}

std::string illumination(const Case& c) {
    std::vector<analysis::FieldBrightness> points;
    for (const double field : c.fields) {
        const double v = c.has_light ? 1.0 / (1.0 + 0.01 * field) : kNaN;
        points.push_back({field, v * v, v});
    }
    return illumination_svg(c.heading, points);
}

analysis::SquareMap square(const Case& c) {
    constexpr std::size_t kSize = 8;
    analysis::SquareMap map{.size = kSize, .half_width = 1.0};
    for (std::size_t i = 0; i < kSize * kSize; ++i) {
        map.values.push_back(c.has_light && i % 7 != 0 ? c.size * static_cast<double>(i) / 64.0 : kNaN);
    }
    return map;
}

std::string wavefronts(const Case& c) {
    std::vector<analysis::FieldWavefront> fields;
    for (const double field : c.fields) {
        fields.push_back({field, c.wavelengths.front(), square(c), 0.1 * c.size, c.size});
    }
    return wavefront_svg(c.heading, fields);
}

std::string psfs(const Case& c) {
    std::vector<analysis::PsfMap> fields;
    for (const double field : c.fields) {
        fields.push_back({field, square(c), 0.8});
    }
    return psf_svg(c.heading, fields);
}

std::vector<Vec2d> falling(const Case& c, double to) {
    std::vector<Vec2d> points;
    for (int i = 0; i <= 10 && c.has_light; ++i) {
        points.push_back({to * i / 10.0, 1.0 - 0.08 * i});
    }
    return points;
}

std::string mtf(const Case& c) {
    std::vector<analysis::FieldMtf> fields;
    for (const double field : c.fields) {
        fields.push_back({field, falling(c, 100.0), falling(c, 90.0)});
    }
    return mtf_svg(c.heading, fields, falling(c, 100.0));
}

std::string mtf_field(const Case& c) {
    return mtf_field_svg(c.heading, {{10.0, falling(c, c.fields.back()), {}}, {30.0, falling(c, c.fields.back()), {}}});
}

const std::map<std::string, std::function<std::string(const Case&)>> kPlots = {
    {"fans", fans},   {"field curves", field_curves}, {"longitudinal", longitudinal}, {"lateral", lateral},
    {"spots", spots}, {"illumination", illumination}, {"wavefront", wavefronts},      {"psf", psfs},
    {"mtf", mtf},     {"mtf field", mtf_field},
};

TEST(AnalysisPlots, EveryPlotIsSoundForEveryLens) {
    const std::map<std::string, Case> cases = {
        {"ordinary", {}},
        {"one field", {.fields = {5.0}}},
        {"only the axis", {.fields = {0.0}}},
        {"one wavelength", {.wavelengths = {550.0}}},
        {"infrared", {.wavelengths = {852.0, 1014.0, 1550.0}}},
        {"ten fields of a fisheye", {.fields = {0, 12, 24, 36, 48, 60, 72, 84, 97, 110}}},
        {"fields downwards", {.fields = {20.0, 10.0, 0.0}}},
        {"perfect", {.size = 0.0}},
        {"rounding", {.size = 1e-13}},
        {"huge", {.size = 1e9}},
        {"beyond all measure", {.size = 1e290}},
        {"no number", {.size = kNaN}},
        {"dark", {.has_light = false}},
        {"no wavelength", {.wavelengths = {}, .has_light = false}},
    };
    for (const auto& [plot_name, plot] : kPlots) {
        for (const auto& [case_name, lens] : cases) {
            if (plot_name == "wavefront" && lens.wavelengths.empty()) {
                continue;
            }
            const std::string svg = plot(lens);
            EXPECT_TRUE(is_sound(svg)) << plot_name << ", " << case_name;
            EXPECT_EQ(svg, plot(lens));
            EXPECT_NE(svg.find("Test &lt;lens&gt; &amp; co"), std::string::npos);
        }
    }
}

TEST(AnalysisPlots, AFieldWithoutLightSaysSo) {
    const Case dark{.has_light = false};
    for (const auto& [name, plot] : kPlots) {
        EXPECT_NE(plot(dark).find("no light"), std::string::npos) << name;
        EXPECT_EQ(plot({}).find("no light"), std::string::npos) << name;
    }
}

// Where light arrives and a plot is missing all the same, it says why.
TEST(AnalysisPlots, AMissingPlotSaysWhy) {
    const std::string why = "too steep for the grid";
    analysis::FieldWavefront wavefront;
    wavefront.remark = why;
    analysis::PsfMap psf;
    psf.remark = why;
    analysis::FieldMtf modulation;
    modulation.remark = why;
    for (const std::string& svg :
         {wavefront_svg({}, {wavefront}), psf_svg({}, {psf}), mtf_svg({}, {modulation}, {{0.0, 1.0}, {100.0, 0.5}})}) {
        EXPECT_NE(svg.find(why), std::string::npos);
        EXPECT_EQ(svg.find("no light"), std::string::npos);
        EXPECT_TRUE(is_sound(svg));
    }
}

TEST(AnalysisPlots, NothingAtAllIsDrawnToo) {
    const PlotHeading none;
    for (const std::string& svg :
         {ray_fans_svg(none, {}), field_curves_svg(none, {}, ""), longitudinal_aberration_svg(none, {}),
          lateral_colour_svg(none, {}, {}), spots_svg(none, {}, {}), illumination_svg(none, {}),
          wavefront_svg(none, {}), psf_svg(none, {}), mtf_svg(none, {}, {}), mtf_field_svg(none, {})}) {
        EXPECT_TRUE(is_sound(svg));
    }
}

// The distance of two dots over the length of the scale bar is that of the rays over what the bar says.
TEST(AnalysisPlots, SpotsAreToTheScaleOfTheBar) {
    const analysis::FieldSpots field{.field_deg = 0.0, .spots = {{5.0, {{587.6, {{-30.0, 0.0}, {40.0, 0.0}}}}}}};
    const std::string svg = spots_svg({}, {0.0}, {field});
    double left = 0.0;
    double right = 0.0;
    double bar_left = 0.0;
    double bar_right = 0.0;
    double y = 0.0;
    ASSERT_EQ(std::sscanf(path_data(svg, "scale-bar").at(0).c_str(), "M%lf %lf %lf", &bar_left, &y, &bar_right), 3);
    // The dots of the spot come after that of the legend.
    const std::string dots = path_data(svg, "marks").back();
    ASSERT_EQ(std::sscanf(dots.c_str(), "M%lf", &left), 1);
    ASSERT_EQ(std::sscanf(dots.c_str() + dots.rfind('M'), "M%lf", &right), 1);
    double bar_um = 0.0;
    for (const Word& word : words(svg)) {
        if (word.text.find("µm; circle") != std::string::npos) {
            bar_um = std::stod(word.text);
        }
    }
    ASSERT_GT(bar_um, 0.0);
    // Two decimals of a px on lengths of some tens.
    EXPECT_NEAR((right - left) / (bar_right - bar_left), 70.0 / bar_um, 1e-3);
}

TEST(AnalysisPlots, FilesAreWrittenIntoANewFolder) {
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "lensproof_plots" / "tessar";
    std::filesystem::remove_all(folder);
    write_plots(folder, {{"mtf.svg", mtf({})}, {"psf.svg", psfs({})}});
    EXPECT_EQ(read_file(folder / "mtf.svg"), mtf({}));
    EXPECT_TRUE(std::filesystem::exists(folder / "psf.svg"));
    EXPECT_THROW(write_plots(folder / "mtf.svg", {}), InputError);
    std::filesystem::remove_all(folder.parent_path());
}

// Degrees times π/180 and back, or nine tenths of a field, end in digits that no one typed.
TEST(AnalysisPlots, FileNamesHoldRoundedNumbers) {
    const auto name = [](double field_deg) { return psf_file_name({.field_deg = field_deg}); };
    EXPECT_EQ(name(24.000000000000004), "psf_24deg.exr");
    EXPECT_EQ(name(1.8000000000000003), "psf_1.8deg.exr");
    EXPECT_EQ(name(77.95), "psf_77.95deg.exr");
    EXPECT_EQ(name(-20.0), "psf_-20deg.exr");
}

}  // namespace lensproof::draw::analysis_plots_test
