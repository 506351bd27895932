#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/detection/detect.h"
#include "calibration/detection/line_points.h"
#include "calibration/detection/refine.h"
#include "calibration/detection/working_copy.h"
#include "calibration/light/light_samples.h"
#include "calibration/measure/measure.h"
#include "calibration/measure/measure_sharpness.h"
#include "calibration/self_test/self_test.h"
#include "calibration/self_test/simulated_chart.h"
#include "engine/base/angle.h"
#include "engine/formats/image/image.h"
#include "engine/formats/image/jpeg.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/chief_ray.h"
#include "engine/scene/chart/chart.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

constexpr double kWavelengthNm = 550.0;

void time_chief_ray_construction(benchmark::State& state, const std::string& name) {
    const optics::Lens lens = formats::load_lens(name);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(optics::ChiefRays(lens, kWavelengthNm));
    }
}

void time_chief_ray_aiming(benchmark::State& state, const std::string& name) {
    const optics::ChiefRays rays(formats::load_lens(name), kWavelengthNm);
    const double field = 0.7 * rays.largest_field();
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(rays.at_field(field));
    }
}

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kPixelsPerMm = 1.4;
constexpr double kTurn = 0.03;  // slope, so that edges do not run along pixel rows

Vec2d to_pixel(const Vec2d& mm) {
    return {0.5 * kWidth + kPixelsPerMm * (mm.x - kTurn * mm.y), 0.5 * kHeight + kPixelsPerMm * (mm.y + kTurn * mm.x)};
}

/// The chart seen straight on, slightly turned, with edges a pixel wide (4 × 4 samples a pixel).
formats::Image painted(const scene::Chart& chart) {
    constexpr int kSub = 4;
    const double norm = kPixelsPerMm * (1.0 + kTurn * kTurn);
    formats::Image image = formats::make_image(kWidth, kHeight, {"Y"});
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            double sum = 0.0;
            for (int row = 0; row < kSub; ++row) {
                for (int column = 0; column < kSub; ++column) {
                    const double x = u + (column + 0.5) / kSub - 0.5 - 0.5 * kWidth;
                    const double y = v + (row + 0.5) / kSub - 0.5 - 0.5 * kHeight;
                    sum += scene::reflectance(chart, (x + kTurn * y) / norm, (y - kTurn * x) / norm);
                }
            }
            image.at(u, v, 0) = static_cast<float>(sum / (kSub * kSub));
        }
    }
    return image;
}

void time_refinement(benchmark::State& state, const scene::Chart& chart) {
    const formats::Image image = painted(chart);
    calibration::ChartPoints approximate;
    for (const Vec2d& point : scene::feature_points(chart)) {
        const Vec2d exact = to_pixel(point);
        approximate.image_px.push_back({exact.x + 0.4, exact.y - 0.3});  // as far off as a detector is
        approximate.found.push_back(true);
    }
    int found = 0;
    while (state.KeepRunning()) {
        found = calibration::count_found(calibration::refine(image, 0, approximate, chart));
        benchmark::DoNotOptimize(found);
    }
    if (found != static_cast<int>(approximate.found.size())) {
        state.SkipWithError("not every point was found");
    }
    state.counters["points/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(approximate.found.size()),
                           benchmark::Counter::kIsRate);
}

// Where the time of a camera's photos goes: eight views of six megapixels, in colours, as a camera's JPEG has them. All
// steps grow with the pixels but refinement and the fits.
const scene::Chart kPhotographed{
    .pattern = scene::Checkerboard{14, 9, 25.0}, .white_reflectance = 0.85, .black_reflectance = 0.05};

calibration::SimulatedCamera camera_of_photos() {
    const auto falling = [](double height) { return 1.0 - 0.35 * height * height; };
    return {.model = calibration::BrownConrady{{3050.0, 1505.0, 992.0, -0.08, 0.03, 0.0, 3e-4, -2e-4}},
            .width_px = 3000,
            .height_px = 2000,
            .channels = {{.name = "R",
                          .radial_shift_px = [](double height) { return -0.5 * height * height; },
                          .vignetting = falling},
                         {.name = "G", .vignetting = falling},
                         {.name = "B",
                          .radial_shift_px = [](double height) { return 0.6 * height * height * height; },
                          .vignetting = falling}},
            .white = 0.7,
            .blur_px = 0.8,
            .read_noise = 0.002,
            .shot_noise = 0.004,
            .jpeg_quality = 93,
            .threads = 1};
}

/// All of the chart is in the frame: what is cut off is looked for in every way there is, which takes several times as
/// long.
calibration::Pose pose_of_photo(int i) {
    const double turn = 2.0 * kPi * i / 8.0;
    return {{0.35 * std::cos(turn), 0.35 * std::sin(turn), 0.02 * i}, {10.0 * (i % 3 - 1), 8.0 * (i % 2), 560.0}};
}

const formats::Image& photo(int i) {
    static std::array<std::optional<formats::Image>, 8> kept;
    auto& image = kept[static_cast<std::size_t>(i)];
    if (!image) {
        image = simulate_chart(camera_of_photos(), pose_of_photo(i), kPhotographed, static_cast<std::uint32_t>(i));
    }
    return *image;
}

calibration::MeasureInput photos(bool with_sharpness) {
    calibration::MeasureInput input;
    input.name = "photos";
    input.chart = kPhotographed;
    input.parts.sharpness = with_sharpness;
    input.threads = 1;
    for (int i = 0; i < 8; ++i) {
        input.pictures.push_back(
            {"photo" + std::to_string(i), calibration::PictureRole::chart, [i] { return photo(i); }});
    }
    return input;
}

/// `step` on the first photo, with its points where it asks for them.
template <class Step>
void time_step(benchmark::State& state, const Step& step) {
    const formats::Image& image = photo(0);
    const calibration::ChartPoints found = calibration::detect(image, kPhotographed).points;
    const calibration::ChartPoints points = refine(image, 1, found, kPhotographed);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(step(image, points));
    }
    state.counters["ns/pixel"] =
        benchmark::Counter(1e-9 * static_cast<double>(state.iterations()) * image.width * image.height,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// The last one that was measured, for who needs one and not its time.
std::optional<calibration::Profile>& kept_profile() {
    static std::optional<calibration::Profile> kept;
    return kept;
}

void time_measuring(benchmark::State& state) {
    const calibration::MeasureInput input = photos(true);
    for (int i = 0; i < 8; ++i) {
        benchmark::DoNotOptimize(&photo(i));
    }
    while (state.KeepRunning()) {
        kept_profile() = measure(input);
    }
}

void time_self_test(benchmark::State& state) {
    const calibration::MeasureInput input = photos(true);
    const calibration::Profile profile = kept_profile() ? *kept_profile() : measure(input);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(self_test(input, profile));
    }
}

void register_photo_benchmarks() {
    const auto add = [](const std::string& name, const auto& step) {
        benchmark::RegisterBenchmark(("photos/6MP/" + name).c_str(), [step](benchmark::State& state) {
            time_step(state, step);
        })->Unit(benchmark::kMillisecond);
    };
    using calibration::ChartPoints;
    using formats::Image;
    add("jpeg", [](const Image& image, const ChartPoints&) { return formats::after_jpeg(image, 93); });
    add("working_copy", [](const Image& image, const ChartPoints&) { return calibration::detector_copy(image); });
    add("detect", [](const Image& image, const ChartPoints&) { return calibration::detect(image, kPhotographed); });
    add("refine",
        [](const Image& image, const ChartPoints& points) { return refine(image, 1, points, kPhotographed); });
    add("lines",
        [](const Image& image, const ChartPoints& points) { return line_points(image, 1, points, kPhotographed); });
    add("light", [](const Image& image, const ChartPoints& points) {
        return chart_white_samples(image, 1, points, kPhotographed);
    });
    add("edges", [](const Image& image, const ChartPoints& points) {
        calibration::SharpnessObservations seen;
        observe_chart_edges(seen, image, 1, "photo", points, kPhotographed);
        return seen.edges.size();
    });
    add("simulate", [](const Image&, const ChartPoints&) {
        return simulate_chart(camera_of_photos(), pose_of_photo(0), kPhotographed, 0);
    });
    benchmark::RegisterBenchmark("photos/8x6MP/measure", time_measuring)->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark("photos/8x6MP/self_test", time_self_test)->Unit(benchmark::kMillisecond);
}

// OpenCV's 13 photos of its left camera (Debian's opencv-doc), decoded before; where they are, else nothing.
std::vector<formats::Image> left_photos() {
    std::vector<formats::Image> photos;
    for (const int i : {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14}) {
        const std::filesystem::path file = "/usr/share/doc/opencv-doc/examples/data/left" +
                                           std::string(i < 10 ? "0" : "") + std::to_string(i) + ".jpg";
        if (!std::filesystem::exists(file)) {
            return {};
        }
        photos.push_back(formats::read_image(file));
    }
    return photos;
}

calibration::MeasureInput input_of(const std::vector<formats::Image>& photos) {
    calibration::MeasureInput input;
    input.name = "left";
    input.chart = {.pattern = scene::Checkerboard{10, 7, 30.0}};
    input.threads = 1;
    for (const formats::Image& photo : photos) {
        input.pictures.push_back({"left" + std::to_string(input.pictures.size()), calibration::PictureRole::chart,
                                  [&photo] { return photo; }});
    }
    return input;
}

void calibrate_by_opencv(const std::vector<formats::Image>& photos) {
    std::vector<cv::Point3f> board(54);
    for (int k = 0; k < 54; ++k) {
        const int row = k / 9;
        board[static_cast<std::size_t>(k)] = {30.0F * static_cast<float>(k % 9), 30.0F * static_cast<float>(row), 0.0F};
    }
    std::vector<std::vector<cv::Point2f>> seen;
    for (const formats::Image& photo : photos) {
        std::vector<cv::Point2f> corners;
        if (cv::findChessboardCornersSB(calibration::detector_copy(photo), {9, 6}, corners,
                                        cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY)) {
            seen.push_back(corners);
        }
    }
    cv::Mat camera;
    cv::Mat distortion;
    benchmark::DoNotOptimize(cv::calibrateCamera(std::vector(seen.size(), board), seen, {640, 480}, camera, distortion,
                                                 cv::noArray(), cv::noArray()));
}

void register_left_photo_benchmarks() {
    const auto add = [](const std::string& name, const auto& measuring) {
        benchmark::RegisterBenchmark(("photos/left/" + name).c_str(),
                                     [measuring](benchmark::State& state) {
                                         const std::vector<formats::Image> photos = left_photos();
                                         if (photos.empty()) {
                                             state.SkipWithError("needs the package opencv-doc");
                                             return;
                                         }
                                         while (state.KeepRunning()) {
                                             measuring(photos);
                                         }
                                     })
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime();
    };
    add("measure", [](const std::vector<formats::Image>& photos) {
        const calibration::MeasureInput input = input_of(photos);
        benchmark::DoNotOptimize(self_test(input, measure(input)));
    });
    add("measure_without_self_test",
        [](const std::vector<formats::Image>& photos) { benchmark::DoNotOptimize(measure(input_of(photos))); });
    add("opencv", calibrate_by_opencv);
}

}  // namespace

void register_measure_benchmarks() {
    for (const std::string lens : {"tessar", "petzval", "muller-fisheye"}) {
        benchmark::RegisterBenchmark(("chief_rays/" + lens + "/construct").c_str(),
                                     [lens](benchmark::State& state) { time_chief_ray_construction(state, lens); });
        benchmark::RegisterBenchmark(("chief_rays/" + lens + "/at_field").c_str(),
                                     [lens](benchmark::State& state) { time_chief_ray_aiming(state, lens); });
    }
    const scene::Chart board{.pattern = scene::Checkerboard{10, 7, 40.0}};
    const scene::Chart discs{.pattern = scene::DiscGrid{9, 6, 40.0, 20.0}};
    for (const scene::Chart& chart : {board, discs}) {
        benchmark::RegisterBenchmark(("refine/" + scene::kind_name(chart)).c_str(), [chart](benchmark::State& state) {
            time_refinement(state, chart);
        })->Unit(benchmark::kMillisecond);
    }
    register_photo_benchmarks();
    register_left_photo_benchmarks();
}

}  // namespace lensproof
