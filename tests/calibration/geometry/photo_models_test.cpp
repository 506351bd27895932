// Lens models on real photographs' corners. Each test says what it needs and skips without.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "calibration/detection/working_copy.h"
#include "calibration/geometry/cross_validation.h"
#include "calibration/geometry/model_choice.h"
#include "engine/formats/image/image.h"
#include "tests/places.h"
#include "tests/trials.h"

namespace lensproof::calibration::photo_models_test {

const std::filesystem::path kPhotos = shared_data() / "photos";

std::string unzipped(const std::filesystem::path& file) {
    const std::string command = "gzip -dc '" + file.string() + "'";
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    std::string text;
    char part[4096];
    for (std::size_t n = 0; pipe && (n = std::fread(part, 1, sizeof part, pipe.get())) > 0;) {
        text.append(part, n);
    }
    return text;
}

// frame, row, column, x, y, weight; a weight of 0 or less marks an outlier of the source's. Every second of the 186
// views, or all.
std::vector<ChartView> samyang_views() {
    std::istringstream lines(unzipped(kPhotos / "samyang12_corners" / "corners_186boards_10x10_spacing77mm.csv.gz"));
    std::map<int, ChartView> views;
    for (std::string line; std::getline(lines, line);) {
        int frame = 0;
        int row = 0;
        int column = 0;
        double x = 0.0;
        double y = 0.0;
        double weight = 0.0;
        char comma = 0;
        std::istringstream values(line);
        if (line[0] == '#' ||
            !(values >> frame >> comma >> row >> comma >> column >> comma >> x >> comma >> y >> comma >> weight)) {
            continue;
        }
        if (weight > 0.0) {
            ChartView& view = views[frame];
            view.name = "frame " + std::to_string(frame);
            view.chart_mm.push_back({77.0 * column, 77.0 * row});
            view.image_px.push_back({x, y});
        }
    }
    std::vector<ChartView> result;
    for (auto& [frame, view] : views) {
        if (view.image_px.size() >= 10 && frame % trials(1, 2) == 0) {
            result.push_back(std::move(view));
        }
    }
    return result;
}

// Samyang 12 mm f/2.8 fisheye, 6016 × 4016. The eight coefficients of OpenCV's rational model are known to fit it worse
// than a splined model (rms 0.55 against 0.43 px, mrcal's documentation); the choice must find that and say it. With
// all 186 views, 18 600 corners, every model is held: the chosen one's two terms predict as the eight coefficients do
// (0.864 and 0.861 px; four terms 0.848, the spline 0.845 px), but its corners are known to 0.19 px, theirs to 1.90 px.
TEST(CalibrationPhotoModels, TheChosenModelBeatsEightCoefficientsOnTheSamyang) {
    const auto views = samyang_views();
    if (views.empty()) {
        GTEST_SKIP() << "needs ../shared/photos/samyang12_corners and gzip";
    }
    GeometryOptions options;
    options.fit_board_shape = true;  // a printed board of 770 mm
    const ChosenGeometry chosen = choose_model(views, 6016, 4016, options);
    const ModelCandidate& taken = chosen.choice.candidates[static_cast<std::size_t>(chosen.choice.chosen)];
    for (const ModelCandidate& c : chosen.choice.candidates) {
        if (c.kind == ModelKind::brown_conrady_rational && c.refused.empty()) {
            EXPECT_LT(taken.expected_error_px.value(), 0.2 * c.expected_error_px.value_or(1e3));
            EXPECT_LT(taken.corner_px.value(), 0.2 * c.corner_px.value_or(1e3));
        }
    }
    EXPECT_NE(chosen.choice.why.find("brown-conrady-rational"), std::string::npos);
    for (const ModelCandidate& c : chosen.choice.candidates) {
        fmt::print("{}: held out {:.3f} px, corners {:.2f} px, expected {:.2f} px\n", c.name, c.held_out_rms_px,
                   c.corner_px.value_or(std::nan("")), c.expected_error_px.value_or(std::nan("")));
    }
    GeometryOptions flat = chosen.options;
    flat.fit_board_shape = false;
    fmt::print("bent by {:.3f} ± {:.3f} mm; {:.2f} px rms, {:.2f} px as if it were flat\n",
               chosen.fit.board->height_mm[0], standard_error_mm(*chosen.fit.board, 0), chosen.fit.rms_px,
               fit_geometry(views, 6016, 4016, flat).rms_px);
    // The board's bend is no accident of the fit: 0.75 mm over 770, 190 of its standard errors.
    EXPECT_GT(std::abs(chosen.fit.board->height_mm[0]), 10.0 * standard_error_mm(*chosen.fit.board, 0));
}

// The fisheye board (MANIFEST.md: Kannala-Brandt, fx 336.58, fy 336.24, c (543.24, 377.58), k .00299 −.00964 .00301
// −.00104, rms 0.90 px with some bad views). Fitted with a vertical focal length of its own, as the manifest's, every
// coefficient is within 3 standard errors by views: the residuals of a view are alike here, and noise alone would put
// the centre 4.7 of its standard errors from the manifest's. The manifest's fit is of the same photos, so that no error
// of its own is added. Views that were not fitted are predicted at least as well as the manifest's fit reproduces its
// own.
TEST(CalibrationPhotoModels, TheFisheyeBoardAgreesWithItsManifest) {
    const auto folder = kPhotos / "fisheye_board";
    const scene::Chart board{.pattern = scene::Checkerboard{9, 7, 32.5}};
    std::vector<ChartView> views;
    for (int number = 1; number <= 15; ++number) {
        const auto file = folder / ("Fisheye1_" + std::to_string(number) + ".jpg");
        if (!std::filesystem::exists(file)) {
            GTEST_SKIP() << "needs ../shared/photos/fisheye_board";
        }
        const formats::Image image = formats::read_image(file);
        const Detection detection = detect(image, board);
        if (!detection.found()) {
            continue;
        }
        const ChartPoints points = refine(image, reference_channel(image), detection.points, board);
        const std::vector<Vec2d> features = scene::feature_points(board);
        ChartView view{.name = file.filename().string(), .chart_mm = {}, .image_px = {}};
        for (std::size_t i = 0; i < features.size(); ++i) {
            if (points.found[i]) {
                view.chart_mm.push_back(features[i]);
                view.image_px.push_back(points.image_px[i]);
            }
        }
        if (view.image_px.size() >= 10) {
            views.push_back(std::move(view));
        }
    }
    ASSERT_GE(views.size(), 5u);
    GeometryOptions options;
    options.model = ModelKind::kannala_brandt;
    options.fit_stretch = true;
    const GeometryFit fit = fit_geometry(views, 1032, 778, options);
    const std::vector<double> manifest{336.58,   543.24,  377.58,   0.00299,
                                       -0.00964, 0.00301, -0.00104, 336.24 / 336.58 - 1.0};
    for (std::size_t i = 0; i < manifest.size(); ++i) {
        EXPECT_NEAR(parameters(fit.model)[i], manifest[i], 3.0 * fit.view_standard_error[i])
            << parameter_names(fit.model)[i];
    }
    for (const FittedView& view : fit.views) {  // no view is dropped, and of its 48 corners one at most was not found
        EXPECT_GE(std::count_if(view.residuals.begin(), view.residuals.end(), [](const auto& r) { return r.used; }),
                  47);
    }
    EXPECT_EQ(views.size(), 15u);
    EXPECT_LT(cross_validate(views, 1032, 778, options, fit).held_out_rms_px, 0.90);
}

}  // namespace lensproof::calibration::photo_models_test
