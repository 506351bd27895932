#include "calibration/measure/measure_sharpness.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "calibration/measure/measure.h"
#include "calibration/self_test/simulated_chart.h"
#include "engine/base/input_error.h"
#include "tests/calibration/sharpness/sharpness_edge.h"
#include "tests/places.h"
#include "tests/test_folder.h"

namespace lensproof::calibration::measure_sharpness_test {

using namespace synthetic;
namespace fs = std::filesystem;

// A chart of slanted squares through a lens whose blur is the same everywhere: both curves are level, at the MTF50 of
// that Gaussian and the pixel's box, within the target of 2 % (each of 140 edges is known to about 2 %).
TEST(CalibrationMeasureSharpness, AnEvenBlurGivesLevelCurves) {
    const scene::Chart chart{.pattern = scene::SlantedEdges{7, 5, 60.0, 34.0, 6.0}};
    const Pose pose{{0.02, -0.03, 0.0}, {0.0, 0.0, 600.0}};
    SimulatedCamera camera{
        .model = perspective_camera(), .width_px = 640, .height_px = 480, .channels = {{.name = "G"}}};
    camera.blur_px = 0.8;
    camera.read_noise = 0.005;
    const formats::Image image = simulate_chart(camera, pose, chart, 7);
    SharpnessObservations seen;
    const ChartPoints points{.image_px = view_of(camera.model, pose, chart).image_px,
                             .found = std::vector<bool>(35, true)};
    observe_chart_edges(seen, image, 0, "chart", points, chart);
    Profile profile;
    profile.width_px = 640;
    profile.height_px = 480;
    profile.pixel_pitch_um = 5.0;
    add_sharpness(profile, seen, centre_px(camera.model));
    EXPECT_GT(profile.sharpness.at("G").size(), 100u);
    const double truth = true_frequency(gaussian_blur(0.8), 6.0, 0.5);
    for (const char* name : {"mtf50_tangential_G", "mtf50_sagittal_G"}) {
        for (const double height : {0.0, 0.3, 0.6}) {
            EXPECT_NEAR(sample(profile.curves.at(name), height)->value / truth, 1.0, 0.02) << name << height;
            EXPECT_NEAR(sample(profile.curves.at(std::string(name) + "_cycles_per_mm"), height)->value,
                        sample(profile.curves.at(name), height)->value * 200.0, 1e-9);
        }
    }
    const std::string text = to_json(profile).dump();
    EXPECT_EQ(to_json(parse_profile(text, "memory")).dump(), text);
}

MeasureInput only_edges(std::vector<Picture> pictures, std::vector<PixelRectangle> edges) {
    MeasureInput input;
    input.name = "edge";
    input.pictures = std::move(pictures);
    input.edges = std::move(edges);
    return input;
}

// Edges of a picture that nobody described: sharpness as it was made, and the shift of red that was put in, from how
// far the edges lie apart along their normals; one edge is placed to some 0.02 px at this noise, a hundred to a tenth.
TEST(CalibrationMeasureSharpness, EdgesThatAreFoundTellSharpnessAndShift) {
    SimulatedCamera camera{.model = BrownConrady{{820.0, 319.5, 239.5, 0, 0, 0, 0, 0}},
                           .width_px = 640,
                           .height_px = 480,
                           .channels = {{.name = "R"}, {.name = "G"}, {.name = "B"}}};
    camera.blur_px = 0.8;
    camera.read_noise = 0.004;
    camera.channels[0].radial_shift_px = [](double height) { return 1.2 * height - 0.5 * std::pow(height, 3); };
    const scene::Chart chart{.pattern = scene::SlantedEdges{7, 5, 60.0, 34.0, 6.0}};
    const Pose pose{{0.02, -0.03, 0.0}, {0.0, 0.0, 600.0}};
    const auto load = [=] { return simulate_chart(camera, pose, chart, 11); };
    const Profile profile = measure(only_edges({{"scene", PictureRole::edges, load}}, {}));
    EXPECT_EQ(profile.not_measured.at("geometry"), "there is no chart");
    const double truth = true_frequency(gaussian_blur(0.8), 6.0, 0.5);
    EXPECT_NEAR(sample(profile.curves.at("mtf50_tangential_G"), 0.4)->value / truth, 1.0, 0.02);
    const Curve& red = profile.curves.at("chromatic_shift_R_px");
    for (const double height : {0.2, 0.5, 0.7}) {
        EXPECT_NEAR(sample(red, height)->value, 1.2 * height - 0.5 * std::pow(height, 3), 0.02) << height;
    }
    EXPECT_NEAR(sample(profile.curves.at("chromatic_shift_B_px"), 0.5)->value, 0.0, 0.02);
    for (const ProfileEdge& listed : profile.sharpness.at("G")) {
        EXPECT_GT(listed.edge.length_px, 0.0);
        EXPECT_GT(listed.edge.width_px, 0.0);
    }
}

// The same chart printed in red on white: its edges are as sharp, but an edge between two colours may lie elsewhere in
// each channel by itself, so no chromatic shift is said.
TEST(CalibrationMeasureSharpness, ColouredEdgesTellNoChromaticShift) {
    SimulatedCamera camera{.model = perspective_camera(),
                           .width_px = 640,
                           .height_px = 480,
                           .channels = {{.name = "R"}, {.name = "G"}, {.name = "B"}}};
    camera.blur_px = 0.8;
    camera.read_noise = 0.004;
    const scene::Chart chart{.pattern = scene::SlantedEdges{7, 5, 60.0, 34.0, 6.0}};
    const Pose pose{{0.02, -0.03, 0.0}, {0.0, 0.0, 600.0}};
    const auto printed_in_red = [=] {
        formats::Image image = simulate_chart(camera, pose, chart, 11);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                image.at(x, y, 0) = 0.4F + 0.5F * image.at(x, y, 0);
            }
        }
        return image;
    };
    const Profile profile = measure(only_edges({{"scene", PictureRole::edges, printed_in_red}}, {}));
    EXPECT_GT(profile.sharpness.at("G").size(), 50u);
    EXPECT_GT(profile.sharpness.at("R").size(), 50u);
    EXPECT_FALSE(profile.curves.contains("chromatic_shift_R_px"));
    EXPECT_EQ(profile.not_measured.at("chromatic_shift"),
              "all edges that were found are between two colours, whose shift need not be the lens's");
}

TEST(CalibrationMeasureSharpness, NoEdgeInAnyPictureIsRefusedWithWhatWasSeen) {
    const auto blank = [] { return formats::make_image(64, 48, {"Y"}); };
    try {
        measure(only_edges({{"blank", PictureRole::edges, blank}}, {}));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(
            std::string(e.what()),
            "edge: no edge measured in any of 1 picture: blank: none of 0 edges can be measured: expected straight "
            "edges between even tones");
    }
}

TEST(CalibrationMeasureSharpness, APictureThatIsOnlyAnEdgeIsEnough) {
    const Blur blur = gaussian_blur(1.0);
    const EdgePicture edge{.normal_deg = 5.0};
    const auto load = [=] { return paint_edge(edge, blur); };
    const Profile profile = measure(only_edges({{"edge", PictureRole::edges, load}}, {PixelRectangle{}}));
    ASSERT_EQ(profile.sharpness.at("Y").size(), 1u);
    EXPECT_NEAR(profile.sharpness.at("Y")[0].edge.mtf50->cycles_per_px / true_frequency(blur, 5.0, 0.5), 1.0, 2e-3);
    EXPECT_TRUE(profile.not_measured.contains("sharpness_over_the_field"));
    try {
        measure(only_edges({{"edge", PictureRole::edges, load}}, {{0, 0, 20, 20}}));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("edge: the rectangle 0,0,20,20 in channel Y has no edge"),
                  std::string::npos);
    }
}

/// The picture in a file of a form that is not read, as a PNG.
fs::path as_png(const fs::path& file, const char* form, const TestFolder& folder) {
    const auto input = OIIO::ImageInput::create(form);
    OIIO::ImageSpec spec;
    EXPECT_TRUE(input && input->open(file.string(), spec));
    std::vector<unsigned char> bytes(static_cast<std::size_t>(spec.image_bytes()));
    EXPECT_TRUE(input->read_image(0, 0, 0, spec.nchannels, spec.format, bytes.data()));
    const std::string png = (folder.path() / "as.png").string();
    const auto output = OIIO::ImageOutput::create("png");
    EXPECT_TRUE(output && output->open(png, spec) && output->write_image(spec.format, bytes.data()) && output->close());
    return png;
}

// Sample edges of the sfrmat5 program, which come without its output. What can be held: the same pixels as TIFF and as
// BMP give the same answer, the channels agree to a few percent, and the edge's errors are below 2 %.
TEST(CalibrationMeasureSharpness, SampleEdgesOfAnotherProgramAgreeAmongThemselves) {
    const fs::path folder = shared_data() / "photos" / "slanted_edges" / "Example_Images";
    if (!fs::exists(folder)) {
        GTEST_SKIP() << folder << " is not there";
    }
    const auto profile_of = [](const fs::path& path) {
        return measure(only_edges({{path.filename(), PictureRole::edges, [path] { return formats::read_image(path); }}},
                                  {PixelRectangle{}}));
    };
    const TestFolder place;
    const Profile tiff = profile_of(folder / "Test_edge1.tif");
    const Profile bitmap = profile_of(as_png(folder / "Test_edge1.bmp", "bmp", place));
    const double green = tiff.sharpness.at("G")[0].edge.mtf50->cycles_per_px;
    for (const char* channel : {"R", "G", "B"}) {
        const MtfFrequency& mtf50 = *tiff.sharpness.at(channel)[0].edge.mtf50;
        EXPECT_EQ(mtf50.cycles_per_px, bitmap.sharpness.at(channel)[0].edge.mtf50->cycles_per_px);
        EXPECT_NEAR(mtf50.cycles_per_px / green, 1.0, 0.05);
        EXPECT_LT(mtf50.standard_error, 0.02 * mtf50.cycles_per_px);
    }
    const Profile grey = profile_of(folder / "Test_edge1_mono.tif");
    EXPECT_NEAR(grey.sharpness.at("Y")[0].edge.mtf50->cycles_per_px / green, 1.0, 0.08);
}

}  // namespace lensproof::calibration::measure_sharpness_test
