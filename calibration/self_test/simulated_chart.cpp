#include "calibration/self_test/simulated_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "calibration/self_test/blur_filter.h"
#include "calibration/self_test/chart_map.h"
#include "calibration/self_test/chart_point.h"
#include "engine/base/infinity.h"
#include "engine/base/parallel.h"
#include "engine/formats/image/jpeg.h"

namespace lensproof::calibration {
namespace {

constexpr int kSubpixels = BlurFilter::kSubpixels;
constexpr int kPlaces = 4;                  // looked at in each
constexpr int kBand_px = 64;                // rows that are made at a time, and columns of them
constexpr int kPatch_px = 16;               // sides of what is filtered where an edge is near
constexpr double kFarthestRadius_px = 1e5;  // from the principal point

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

// The pixel of the camera model whose light a shift by `shift_px` brings to `pixel`.
Vec2d without_shift(const Vec2d& pixel, const Frame& frame, const std::function<double(double)>& shift_px) {
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

ChartMap map_of(const Frame& frame, const SimulatedChannel& channel, const Pose& pose, const scene::Chart& chart,
                const cv::Rect& pixels) {
    const auto exact = [&](const Vec2d& pixel) -> std::optional<Vec2d> {
        const auto direction =
            unproject(frame.camera.model, without_shift(pixel, frame, channel.radial_shift_px), frame.angles);
        return direction ? chart_point(*direction, pose, frame.camera.board) : std::nullopt;
    };
    return {exact, chart, pixels};
}

// A number in [0, 1) that looks random, of a pixel.
double jitter(int x, int y, std::uint32_t salt) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U ^ salt;
    h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
    h = (h ^ (h >> 12)) * 0x297A2D39U;
    return static_cast<double>(h ^ (h >> 15)) / 4294967296.0;
}

// The chart's reflectance in each sub-pixel of pixel (x, y), by kSubpixels² values written into `plane` from (i, j).
void look(cv::Mat& plane, int i, int j, const ChartMap& map, int x, int y, const scene::Chart& chart) {
    const float even_tone = map.even_tone(x, y);
    const ChartMap::Pixel pixel = std::isnan(even_tone) ? map.pixel(x, y) : ChartMap::Pixel{};
    if (!std::isnan(even_tone) || !pixel.is_complete()) {
        for (int b = 0; b < kSubpixels; ++b) {
            std::fill_n(plane.ptr<float>(j + b) + i, kSubpixels, pixel.is_complete() ? even_tone : 0.0F);
        }
        return;
    }
    constexpr std::array<int, kPlaces> kOrder = {2, 0, 3, 1};
    constexpr double kStrata = kSubpixels * kPlaces;  // in a sub-pixel, along x and along y
    const double jitter_x = jitter(x, y, 0U);
    const double jitter_y = jitter(x, y, 0x27D4EB2FU);
    for (int b = 0; b < kSubpixels; ++b) {
        for (int a = 0; a < kSubpixels; ++a) {
            double sum = 0.0;
            for (int k = 0; k < kPlaces; ++k) {
                const double u = (a + (k * kSubpixels + b + jitter_x) / kStrata) / kSubpixels;
                const double v = (b + (kOrder[k] * kSubpixels + a + jitter_y) / kStrata) / kSubpixels;
                const Vec2d place = pixel.at(u, v);
                sum += scene::reflectance(chart, place.x, place.y);
            }
            plane.at<float>(j + b, i + a) = static_cast<float>(sum / kPlaces);
        }
    }
}

// One channel of a band of the picture.
struct Band {
    int margin;  // pixels around what is painted that the blur may bring light from
    const ChartMap& map;
    const Frame& frame;
    const scene::Chart& chart;
    const BlurFilter& filter;

    [[nodiscard]] cv::Rect with_margin(const cv::Rect& pixels) const {
        return {pixels.x - margin, pixels.y - margin, pixels.width + 2 * margin, pixels.height + 2 * margin};
    }
};

// The reflectance of all sub-pixels.
cv::Mat fine_picture(const Band& band, const cv::Rect& pixels) {
    cv::Mat fine(pixels.height * kSubpixels, pixels.width * kSubpixels, CV_32F);
    for (int y = 0; y < pixels.height; ++y) {
        for (int x = 0; x < pixels.width; ++x) {
            look(fine, x * kSubpixels, y * kSubpixels, band.map, pixels.x + x, pixels.y + y, band.chart);
        }
    }
    return fine;
}

// The light on the chart at a pixel, over that of the chart's middle. Far beyond the chart, where nobody knows it, it
// stays within e² of that.
double chart_light(const Band& band, int x, int y) {
    const ChartMap::Pixel pixel = band.map.pixel(x, y);
    const Vec2d place = pixel.is_complete() ? pixel.at(0.5, 0.5) : Vec2d{};
    const Vec2d& gradient_per_mm = band.frame.camera.light_gradient_per_mm;
    return std::exp(std::clamp(gradient_per_mm.x * place.x + gradient_per_mm.y * place.y, -2.0, 2.0));
}

// Light that changes over the chart, by as little over a patch that it is as good as bilinear there: of g a patch, off
// by g²/8. Blur, too, is too short to know of it.
void shade(cv::Mat pixels, const cv::Rect& where, const Band& band) {
    if (band.frame.camera.light_gradient_per_mm == Vec2d{}) {
        return;
    }
    const cv::Point last = where.br() - cv::Point(1, 1);
    const double top[2] = {chart_light(band, where.x, where.y), chart_light(band, last.x, where.y)};
    const double bottom[2] = {chart_light(band, where.x, last.y), chart_light(band, last.x, last.y)};
    for (int y = 0; y < pixels.rows; ++y) {
        const double v = static_cast<double>(y) / std::max(1, pixels.rows - 1);
        const double left = top[0] + v * (bottom[0] - top[0]);
        const double step = (top[1] + v * (bottom[1] - top[1]) - left) / std::max(1, pixels.cols - 1);
        for (int x = 0; x < pixels.cols; ++x) {
            pixels.at<float>(y, x) *= static_cast<float>(left + x * step);
        }
    }
}

// The reflectance of each pixel, by the light on the chart, blurred: patch by patch, and patches without an edge, where
// blur changes nothing, as one tone.
cv::Mat painted(const Band& band, const cv::Rect& part) {
    cv::Mat pixels(part.height, part.width, CV_32F);
    cv::Mat fine;  // of the part and the margin around, once it is needed
    for (int y = 0; y < part.height; y += kPatch_px) {
        for (int x = 0; x < part.width; x += kPatch_px) {
            const cv::Rect patch(x, y, std::min(kPatch_px, part.width - x), std::min(kPatch_px, part.height - y));
            const cv::Rect where = patch + part.tl();
            if (const auto tone = band.map.only_tone(band.with_margin(where))) {
                pixels(patch).setTo(*tone);
            } else {
                if (fine.empty()) {
                    fine = fine_picture(band, band.with_margin(part));
                }
                band.filter.apply(fine, kSubpixels * (patch.tl() + cv::Point(band.margin, band.margin)), pixels(patch));
            }
            shade(pixels(patch), where, band);
        }
    }
    return pixels;
}

// Rows [first, last) of one channel.
void paint_band(formats::Image& image, int channel, int first, int last, const Frame& frame, const Pose& pose,
                const scene::Chart& chart) {
    const SimulatedCamera& camera = frame.camera;
    const BlurFilter filter(camera.blur_px);
    // Whole cells of knots, so that every pixel's cell begins at an even place.
    const int margin = ChartMap::kKnot_px * (1 + (filter.reach_px() + ChartMap::kKnot_px - 1) / ChartMap::kKnot_px);
    const ChartMap map = map_of(frame, camera.channels[channel], pose, chart,
                                {-margin, first - margin, camera.width_px + 2 * margin, last - first + 2 * margin});
    const Band band{.margin = margin, .map = map, .frame = frame, .chart = chart, .filter = filter};
    for (int left = 0; left < camera.width_px; left += kBand_px) {
        const cv::Rect part(left, first, std::min(kBand_px, camera.width_px - left), last - first);
        const cv::Mat pixels = painted(band, part);
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

// Of mean 0 and variance 1, in pairs (Box and Muller 1958); std::normal_distribution differs between libraries.
class NormalNumbers {
  public:
    explicit NormalNumbers(std::seed_seq& seed) : engine_(seed) {}

    double operator()() {
        if (is_left_) {
            is_left_ = false;
            return left_;
        }
        const auto uniform = [&] { return (static_cast<double>(engine_()) + 0.5) / 4294967296.0; };
        const double radius = std::sqrt(-2.0 * std::log(uniform()));
        const double angle = 2.0 * std::numbers::pi * uniform();
        left_ = radius * std::sin(angle);
        is_left_ = true;
        return radius * std::cos(angle);
    }

  private:
    std::mt19937 engine_;
    double left_ = 0.0;
    bool is_left_ = false;
};

void add_noise(formats::Image& image, int row, const SimulatedCamera& camera, std::uint32_t seed) {
    std::seed_seq sequence{seed, static_cast<std::uint32_t>(row)};
    NormalNumbers normal(sequence);
    for (int x = 0; x < image.width; ++x) {
        for (int c = 0; c < made_channels(camera); ++c) {
            float& value = image.at(x, row, c);
            const double variance =
                camera.read_noise * camera.read_noise + camera.shot_noise * camera.shot_noise * value;
            value += static_cast<float>(std::sqrt(std::max(variance, 0.0)) * normal());
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

formats::Image simulate_chart(const SimulatedCamera& camera, const Pose& pose, const scene::Chart& chart,
                              std::uint32_t seed) {
    formats::Image image = empty_picture(camera);
    const Frame frame = frame_of(camera);
    const int bands = (camera.height_px + kBand_px - 1) / kBand_px;
    const int channels = made_channels(camera);
    parallel_for(bands * channels, camera.threads, [&](int i) {
        const int first = i / channels * kBand_px;
        paint_band(image, i % channels, first, std::min(first + kBand_px, camera.height_px), frame, pose, chart);
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
