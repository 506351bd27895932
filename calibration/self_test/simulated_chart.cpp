#include "calibration/self_test/simulated_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <random>

#include "engine/base/infinity.h"
#include "engine/base/parallel.h"
#include "engine/formats/image/jpeg.h"

namespace lensproof::calibration {
namespace {

constexpr int kSubpixels = 4;               // along a pixel's side: the grid that the blur acts on
constexpr int kPlaces = 4;                  // looked at in each
constexpr int kKnot_px = 2;                 // between exact points of the map to the chart
constexpr int kBandRows = 64;               // of pixels, made at a time
constexpr double kBlurReach = 4.0;          // standard deviations
constexpr double kFarthestRadius_px = 1e5;  // from the principal point
constexpr int kBoardRounds = 6;             // each gains what slope and obliquity leave of the height: 0.1 and less

// A polynomial says nothing beyond the points that it was fitted to: there the surface goes straight on.
double height_mm(const BoardShape& board, const Vec2d& chart_mm) {
    const auto held = [](double value, double middle, double half) {
        return std::clamp(value, middle - half, middle + half);
    };
    const auto at = [&](double x, double y) { return board_height(board.frame, board.height_mm.data(), x, y); };
    const BoardFrame& frame = board.frame;
    const double x = held(chart_mm.x, frame.centre_mm.x, frame.half_size_mm.x);
    const double y = held(chart_mm.y, frame.centre_mm.y, frame.half_size_mm.y);
    double height = at(x, y);
    constexpr double kStep = 1e-4;  // of half the frame: the slope to a relative 1e-4
    if (x != chart_mm.x) {
        const double step = kStep * frame.half_size_mm.x;
        height += (at(x + step, y) - at(x - step, y)) / (2.0 * step) * (chart_mm.x - x);
    }
    if (y != chart_mm.y) {
        const double step = kStep * frame.half_size_mm.y;
        height += (at(x, y + step) - at(x, y - step)) / (2.0 * step) * (chart_mm.y - y);
    }
    return height;
}

// Where a direction meets the chart.
std::optional<Vec2d> chart_point(const Vec3d& direction, const Pose& pose, const std::optional<BoardShape>& board) {
    const Vec3d origin = pose.translation_mm;
    const Vec3d x_axis = to_camera(pose, {1.0, 0.0}) - origin;
    const Vec3d y_axis = to_camera(pose, {0.0, 1.0}) - origin;
    const Vec3d normal = cross(x_axis, y_axis);
    const double towards = dot(direction, normal);
    const auto meets = [&](double height_mm) -> std::optional<Vec2d> {
        const double distance = towards != 0.0 ? (dot(origin, normal) + height_mm) / towards : -1.0;
        if (!(distance > 0.0)) {
            return std::nullopt;
        }
        const Vec3d offset = distance * direction - origin;
        return Vec2d{dot(offset, x_axis), dot(offset, y_axis)};
    };
    std::optional<Vec2d> place = meets(0.0);
    for (int i = 0; board && place && i < kBoardRounds; ++i) {
        place = meets(height_mm(*board, *place));
    }
    return place;
}

// A channel's light along the radius, looked up, because it is asked for every pixel: straight between 4096 places a
// half-diagonal, which is off by 1e-8 of the second derivative.
class RadialLight {
  public:
    /// Up to `farthest` px.
    RadialLight(const SimulatedChannel& channel, double white, double half_diagonal, double farthest)
        : steps_per_px_(kSteps / half_diagonal) {
        const int count = static_cast<int>(std::ceil(farthest * steps_per_px_)) + 2;
        light_.reserve(static_cast<std::size_t>(count));
        for (int i = 0; i < count; ++i) {
            light_.push_back(white * channel.vignetting(i / kSteps));
        }
    }

    /// Beyond the farthest radius as there.
    [[nodiscard]] double at(double radius_px) const {
        const double place = std::min(radius_px * steps_per_px_, static_cast<double>(light_.size() - 2));
        const auto before = static_cast<std::size_t>(place);
        return std::lerp(light_[before], light_[before + 1], place - static_cast<double>(before));
    }

  private:
    static constexpr double kSteps = 4096.0;

    double steps_per_px_;
    std::vector<double> light_;
};

struct Frame {
    const SimulatedCamera& camera;
    double half_diagonal;
    Vec2d centre;
    FieldAngles angles;
    std::vector<RadialLight> lights;  // of each channel that is made

    [[nodiscard]] double light(int channel, int x, int y) const {
        const double dx = x - centre.x;
        const double dy = y - centre.y;
        return lights[static_cast<std::size_t>(channel)].at(std::sqrt(dx * dx + dy * dy));
    }
};

// Of a grey picture all channels but the first are copies.
int made_channels(const SimulatedCamera& camera) {
    return camera.is_grey ? 1 : static_cast<int>(camera.channels.size());
}

Frame frame_of(const SimulatedCamera& camera) {
    // A principal point may lie anywhere, a stretched picture reach farther, and a band's knots beyond the frame.
    const Vec2d centre = centre_px(camera.model);
    const double corner =
        std::hypot(std::max(centre.x, camera.width_px - centre.x), std::max(centre.y, camera.height_px - centre.y));
    const double farthest = corner / std::min(1.0, 1.0 + stretch_y(camera.model)) + 16.0 * camera.blur_px + 64.0;
    Frame frame{.camera = camera,
                .half_diagonal = 0.5 * std::hypot(camera.width_px, camera.height_px),
                .centre = centre,
                .angles = FieldAngles(camera.model, std::min(farthest, kFarthestRadius_px)),
                .lights = {}};
    for (int c = 0; c < made_channels(camera); ++c) {
        frame.lights.emplace_back(camera.channels[c], camera.white, frame.half_diagonal,
                                  std::min(corner, kFarthestRadius_px));
    }
    return frame;
}

// Directions are mapped knot by knot; in a cell of four knots bilinearly.
class ChartMap {
  public:
    ChartMap(const Frame& frame, const SimulatedChannel& channel, const Pose& pose, int first_x, int first_y,
             int columns, int rows)
        : first_x_(first_x), first_y_(first_y), columns_(columns / kKnot_px + 2), rows_(rows / kKnot_px + 2) {
        knots_.reserve(static_cast<std::size_t>(columns_) * rows_);
        const SimulatedCamera& camera = frame.camera;
        for (int j = 0; j < rows_; ++j) {
            for (int i = 0; i < columns_; ++i) {
                const Vec2d pixel{first_x + kKnot_px * i - 0.5, first_y + kKnot_px * j - 0.5};
                const auto direction =
                    unproject(camera.model, without_shift(pixel, frame, channel.radial_shift_px), frame.angles);
                knots_.push_back(direction ? chart_point(*direction, pose, camera.board) : std::nullopt);
            }
        }
    }

    struct Cell {
        const std::optional<Vec2d>*top, *bottom;  // two knots each
        float even_tone;                          // of the whole cell; NaN where it has an edge, or one is near

        [[nodiscard]] bool is_complete() const { return top[0] && top[1] && bottom[0] && bottom[1]; }
        /// At (u, v) of the cell, each from 0 to 1.
        [[nodiscard]] Vec2d at(double u, double v) const {
            const auto mix = [&](double a, double b, double c, double d) {
                return std::lerp(std::lerp(a, b, u), std::lerp(c, d, u), v);
            };
            return {mix(top[0]->x, top[1]->x, bottom[0]->x, bottom[1]->x),
                    mix(top[0]->y, top[1]->y, bottom[0]->y, bottom[1]->y)};
        }
    };
    /// The cell that pixel (x, y) lies in.
    [[nodiscard]] Cell cell(int x, int y) const {
        return cell_at((x - first_x_) / kKnot_px, (y - first_y_) / kKnot_px);
    }

    /// Marks the cells that no edge is near: three by three cells around are of one tone at all knots and middles,
    /// which no part of the chart slips through: none is narrower than both diagonals of a cell.
    void find_even_cells(const scene::Chart& chart) {
        const double narrowest = scene::traits(chart).narrowest_mm;
        cv::Mat even = cv::Mat::zeros(rows_, columns_, CV_8U);  // by a cell's top left knot
        for (int j = 0; j + 1 < rows_; ++j) {
            for (int i = 0; i + 1 < columns_; ++i) {
                even.at<unsigned char>(j, i) = is_one_tone(cell_at(i, j), chart, narrowest) ? 1 : 0;
            }
        }
        cv::erode(even, even, cv::Mat::ones(3, 3, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
        for (int j = 0; j + 1 < rows_; ++j) {
            for (int i = 0; i + 1 < columns_; ++i) {
                if (even.at<unsigned char>(j, i) != 0) {
                    const Vec2d& knot = *cell_at(i, j).top[0];
                    even_tones_.at<float>(j, i) = static_cast<float>(scene::reflectance(chart, knot.x, knot.y));
                }
            }
        }
    }

    /// The tone of all cells of the pixels from `first` to `last`, inclusive; none where they differ or have edges.
    [[nodiscard]] std::optional<float> only_tone(const cv::Point& first, const cv::Point& last) const {
        const float tone = cell(first.x, first.y).even_tone;
        for (int y = first.y; y <= last.y; y += kKnot_px) {
            for (int x = first.x; x <= last.x; x += kKnot_px) {
                if (cell(x, y).even_tone != tone) {  // NaN differs from itself
                    return std::nullopt;
                }
            }
        }
        return tone;
    }

  private:
    [[nodiscard]] Cell cell_at(int i, int j) const {
        const std::size_t first = static_cast<std::size_t>(j) * columns_ + i;
        return {&knots_[first], &knots_[first + static_cast<std::size_t>(columns_)], even_tones_.at<float>(j, i)};
    }

    static bool is_one_tone(const Cell& cell, const scene::Chart& chart, double narrowest_mm) {
        if (!cell.is_complete()) {
            return false;
        }
        const double diagonal_mm = std::hypot(cell.bottom[1]->x - cell.top[0]->x, cell.bottom[1]->y - cell.top[0]->y) +
                                   std::hypot(cell.bottom[0]->x - cell.top[1]->x, cell.bottom[0]->y - cell.top[1]->y);
        if (!(diagonal_mm <= narrowest_mm)) {  // both diagonals: over five pixels
            return false;
        }
        const double tone = scene::reflectance(chart, cell.top[0]->x, cell.top[0]->y);
        const Vec2d middle = cell.at(0.5, 0.5);
        return scene::reflectance(chart, cell.top[1]->x, cell.top[1]->y) == tone &&
               scene::reflectance(chart, cell.bottom[0]->x, cell.bottom[0]->y) == tone &&
               scene::reflectance(chart, cell.bottom[1]->x, cell.bottom[1]->y) == tone &&
               scene::reflectance(chart, middle.x, middle.y) == tone;
    }

    // The pixel of the camera model whose light a shift by `shift_px` brings to `pixel`.
    static Vec2d without_shift(const Vec2d& pixel, const Frame& frame, const std::function<double(double)>& shift_px) {
        const double x = pixel.x - frame.centre.x;
        const double y = pixel.y - frame.centre.y;
        const double radius = std::hypot(x, y);
        double unshifted = radius;
        double before = kNaN;
        for (int i = 0; i < 8 && unshifted != before; ++i) {  // shifts change slowly, so each round gains two digits
            before = unshifted;
            unshifted = radius - shift_px(unshifted / frame.half_diagonal);
        }
        const double scale = radius > 0.0 ? unshifted / radius : 1.0;
        return {frame.centre.x + scale * x, frame.centre.y + scale * y};
    }

    int first_x_;
    int first_y_;
    int columns_;
    int rows_;
    std::vector<std::optional<Vec2d>> knots_;
    cv::Mat even_tones_ = cv::Mat(rows_, columns_, CV_32F, cv::Scalar(kNaN));  // by a cell's top left knot
};

// A number in [0, 1) that looks random, of a pixel.
double jitter(int x, int y, std::uint32_t salt) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U ^ salt;
    h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
    h = (h ^ (h >> 12)) * 0x297A2D39U;
    return static_cast<double>(h ^ (h >> 15)) / 4294967296.0;
}

void fill(cv::Mat& plane, int i, int j, float value) {
    for (int b = 0; b < kSubpixels; ++b) {
        std::fill_n(plane.ptr<float>(j + b) + i, kSubpixels, value);
    }
}

// The chart's reflectance in each sub-pixel of pixel (x, y), by kSubpixels² values written into `plane` from (i, j).
void look(cv::Mat& plane, int i, int j, const ChartMap& map, int x, int y, const scene::Chart& chart) {
    const ChartMap::Cell cell = map.cell(x, y);
    if (!cell.is_complete()) {
        fill(plane, i, j, 0.0F);
        return;
    }
    if (!std::isnan(cell.even_tone)) {
        fill(plane, i, j, cell.even_tone);
        return;
    }
    constexpr std::array<int, kPlaces> kOrder = {2, 0, 3, 1};
    constexpr int kStrata = kSubpixels * kPlaces;  // in a sub-pixel, along x and along y
    const double jitter_x = jitter(x, y, 0U);
    const double jitter_y = jitter(x, y, 0x27D4EB2FU);
    const int in_cell_x = (x + kKnot_px * kBandRows) % kKnot_px;
    const int in_cell_y = (y + kKnot_px * kBandRows) % kKnot_px;
    for (int b = 0; b < kSubpixels; ++b) {
        for (int a = 0; a < kSubpixels; ++a) {
            double sum = 0.0;
            for (int k = 0; k < kPlaces; ++k) {
                const double u = (a + (k * kSubpixels + b + jitter_x) / kStrata) / kSubpixels;
                const double v = (b + (kOrder[k] * kSubpixels + a + jitter_y) / kStrata) / kSubpixels;
                const Vec2d place = cell.at((in_cell_x + u) / kKnot_px, (in_cell_y + v) / kKnot_px);
                sum += scene::reflectance(chart, place.x, place.y);
            }
            plane.at<float>(j + b, i + a) = static_cast<float>(sum / kPlaces);
        }
    }
}

// The light in the middle of a pixel's cell, which over its 2 px is as good as even, over that of the chart's middle.
double chart_light(const ChartMap::Cell& cell, const Vec2d& gradient_per_mm) {
    if (!cell.is_complete()) {
        return 1.0;
    }
    const Vec2d place = cell.at(0.5, 0.5);
    return std::exp(gradient_per_mm.x * place.x + gradient_per_mm.y * place.y);
}

// By hand, because it is done for every pixel and a matrix's own product takes longer to begin than to do.
void shade(cv::Mat& plane, int i, int j, double light) {
    for (int b = 0; b < kSubpixels; ++b) {
        float* row = plane.ptr<float>(j + b) + i;
        for (int a = 0; a < kSubpixels; ++a) {
            row[a] *= static_cast<float>(light);
        }
    }
}

// One channel of a part of the picture: what is to be painted, with the map of it and of `margin` pixels around.
struct Part {
    cv::Rect pixels;
    int margin;
    const ChartMap& map;
    const Frame& frame;
    const scene::Chart& chart;

    [[nodiscard]] bool is_uneven() const {
        const Vec2d& gradient = frame.camera.light_gradient_per_mm;
        return gradient.x != 0.0 || gradient.y != 0.0;
    }
};

// What each sub-pixel along a line, from the first that the blur reaches, gives to a pixel: the blur's Gaussian, and
// the mean over the pixel's own.
std::vector<float> blur_and_box(double blur_px) {
    const double sigma = blur_px * kSubpixels;
    const int reach = static_cast<int>(std::ceil(kBlurReach * sigma));
    const cv::Mat gaussian =
        blur_px > 0.0 ? cv::getGaussianKernel(2 * reach + 1, sigma, CV_64F) : cv::Mat::ones(1, 1, CV_64F);
    std::vector<float> weights(gaussian.total() + kSubpixels - 1);
    for (std::size_t i = 0; i < gaussian.total(); ++i) {
        for (std::size_t j = 0; j < kSubpixels; ++j) {
            weights[i + j] += static_cast<float>(gaussian.at<double>(static_cast<int>(i)) / kSubpixels);
        }
    }
    return weights;
}

// The part's pixels from the sub-pixels of them and of the margin around: first down the columns, for all of a row at
// once, then along what is left. Only what arrives in a pixel is summed, a sixth of what a blur of all sub-pixels sums.
cv::Mat pixels_of(const cv::Mat& fine, const std::vector<float>& weights, const Part& part) {
    const int count = static_cast<int>(weights.size());
    const int before = part.margin * kSubpixels - (count - kSubpixels) / 2;  // sub-pixels that no pixel's sum reaches
    std::vector<float> line(static_cast<std::size_t>(fine.cols));
    cv::Mat pixels(part.pixels.height, part.pixels.width, CV_32F);
    for (int y = 0; y < pixels.rows; ++y) {
        std::ranges::fill(line, 0.0F);
        for (int k = 0; k < count; ++k) {
            const float* row = fine.ptr<float>(before + y * kSubpixels + k);
            for (std::size_t i = 0; i < line.size(); ++i) {
                line[i] += weights[static_cast<std::size_t>(k)] * row[i];
            }
        }
        const float* first = line.data() + before;
        for (int x = 0; x < pixels.cols; ++x, first += kSubpixels) {
            pixels.at<float>(y, x) = std::inner_product(weights.begin(), weights.end(), first, 0.0F);
        }
    }
    return pixels;
}

// The reflectance of each pixel, by the light on the chart, blurred.
cv::Mat blurred(const Part& part) {
    const int columns = part.pixels.width + 2 * part.margin;
    const int rows = part.pixels.height + 2 * part.margin;
    cv::Mat fine(rows * kSubpixels, columns * kSubpixels, CV_32F);
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const cv::Point at(x + part.pixels.x - part.margin, y + part.pixels.y - part.margin);
            look(fine, x * kSubpixels, y * kSubpixels, part.map, at.x, at.y, part.chart);
            if (part.is_uneven()) {
                shade(fine, x * kSubpixels, y * kSubpixels,
                      chart_light(part.map.cell(at.x, at.y), part.frame.camera.light_gradient_per_mm));
            }
        }
    }
    return pixels_of(fine, blur_and_box(part.frame.camera.blur_px), part);
}

// The same where no edge is near: blur changes nothing, nor does it the light, which is smooth.
cv::Mat of_one_tone(const Part& part, float tone) {
    cv::Mat pixels(part.pixels.height, part.pixels.width, CV_32F, cv::Scalar(tone));
    for (int y = 0; part.is_uneven() && y < pixels.rows; ++y) {
        for (int x = 0; x < pixels.cols; ++x) {
            pixels.at<float>(y, x) *= static_cast<float>(chart_light(
                part.map.cell(part.pixels.x + x, part.pixels.y + y), part.frame.camera.light_gradient_per_mm));
        }
    }
    return pixels;
}

// Rows [first, last) of one channel.
void paint_band(formats::Image& image, int channel, int first, int last, const Frame& frame, const Pose& pose,
                const scene::Chart& chart) {
    const SimulatedCamera& camera = frame.camera;
    // Whole cells of knots, so that every pixel's cell begins at an even place.
    const int margin = kKnot_px * (1 + static_cast<int>(std::ceil(kBlurReach * camera.blur_px / kKnot_px)));
    ChartMap map(frame, camera.channels[channel], pose, -margin, first - margin, camera.width_px + 2 * margin,
                 last - first + 2 * margin);
    map.find_even_cells(chart);
    for (int left = 0; left < camera.width_px; left += kBandRows) {
        const Part part{.pixels = {left, first, std::min(kBandRows, camera.width_px - left), last - first},
                        .margin = margin,
                        .map = map,
                        .frame = frame,
                        .chart = chart};
        const cv::Point reach(margin, margin);
        const auto tone = map.only_tone(part.pixels.tl() - reach, part.pixels.br() - cv::Point(1, 1) + reach);
        const cv::Mat pixels = tone ? of_one_tone(part, *tone) : blurred(part);
        for (int y = 0; y < pixels.rows; ++y) {
            for (int x = 0; x < pixels.cols; ++x) {
                image.at(left + x, first + y, channel) =
                    static_cast<float>(pixels.at<float>(y, x) * frame.light(channel, left + x, first + y));
            }
        }
    }
}

void copy_first_channel(formats::Image& image) {
    const auto count = static_cast<std::size_t>(image.channel_count());
    for (std::size_t i = 0; i < image.pixels.size(); i += count) {
        std::fill_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(i + 1), count - 1, image.pixels[i]);
    }
}

void add_noise(formats::Image& image, int row, const SimulatedCamera& camera, std::uint32_t seed) {
    std::seed_seq sequence{seed, static_cast<std::uint32_t>(row)};
    std::mt19937 engine(sequence);
    const auto uniform = [&] { return (static_cast<double>(engine()) + 0.5) / 4294967296.0; };
    for (int x = 0; x < image.width; ++x) {
        for (int c = 0; c < made_channels(camera); ++c) {
            float& value = image.at(x, row, c);
            const double variance =
                camera.read_noise * camera.read_noise + camera.shot_noise * camera.shot_noise * value;
            // Box and Muller 1958; std::normal_distribution differs between libraries.
            const double normal = std::sqrt(-2.0 * std::log(uniform())) * std::cos(2.0 * std::numbers::pi * uniform());
            value += static_cast<float>(std::sqrt(std::max(variance, 0.0)) * normal);
        }
    }
}

formats::Image empty_picture(const SimulatedCamera& camera) {
    std::vector<std::string> names;
    names.reserve(camera.channels.size());
    for (const SimulatedChannel& channel : camera.channels) {
        names.push_back(channel.name);
    }
    return formats::make_image(camera.width_px, camera.height_px, std::move(names));
}

formats::Image with_noise_and_compression(formats::Image image, const SimulatedCamera& camera, std::uint32_t seed) {
    if (camera.read_noise > 0.0 || camera.shot_noise > 0.0) {
        parallel_for(image.height, camera.threads, [&](int row) { add_noise(image, row, camera, seed); });
    }
    if (camera.is_grey) {
        copy_first_channel(image);
    }
    return camera.jpeg_quality ? formats::after_jpeg(image, *camera.jpeg_quality) : image;
}

}  // namespace

std::optional<Vec2d> chart_point(const CameraModel& model, const Pose& pose, const Vec2d& pixel,
                                 const std::optional<BoardShape>& board) {
    const auto direction = unproject(model, pixel);
    return direction ? chart_point(*direction, pose, board) : std::nullopt;
}

formats::Image simulate_chart(const SimulatedCamera& camera, const Pose& pose, const scene::Chart& chart,
                              std::uint32_t seed) {
    formats::Image image = empty_picture(camera);
    const Frame frame = frame_of(camera);
    const int bands = (camera.height_px + kBandRows - 1) / kBandRows;
    const int channels = made_channels(camera);
    parallel_for(bands * channels, camera.threads, [&](int i) {
        const int first = i / channels * kBandRows;
        paint_band(image, i % channels, first, std::min(first + kBandRows, camera.height_px), frame, pose, chart);
    });
    return with_noise_and_compression(std::move(image), camera, seed);
}

formats::Image simulate_flat_field(const SimulatedCamera& camera, std::uint32_t seed) {
    formats::Image image = empty_picture(camera);
    const Frame frame = frame_of(camera);
    parallel_for(camera.height_px, camera.threads, [&](int y) {
        for (int x = 0; x < camera.width_px; ++x) {
            for (int c = 0; c < made_channels(camera); ++c) {
                image.at(x, y, c) = static_cast<float>(frame.light(c, x, y));
            }
        }
    });
    return with_noise_and_compression(std::move(image), camera, seed);
}

}  // namespace lensproof::calibration
