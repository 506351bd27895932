#include "engine/render/raw/raw_image.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

namespace lensproof::render {

namespace {

// Of what OpenCV makes up at a picture's rim nothing is then seen. Even, so that the pattern's phase stays.
constexpr int kBorder = 2;

struct Bayer {
    const char* pattern;
    cv::ColorConversionCodes bilinear;
    cv::ColorConversionCodes edge_aware;
};

// OpenCV's older names say the colours of pixels (1, 1) and (2, 1); these say those of the first two rows.
constexpr std::array<Bayer, 4> kPatterns{{{"RGGB", cv::COLOR_BayerRGGB2BGR, cv::COLOR_BayerRGGB2BGR_EA},
                                          {"BGGR", cv::COLOR_BayerBGGR2BGR, cv::COLOR_BayerBGGR2BGR_EA},
                                          {"GRBG", cv::COLOR_BayerGRBG2BGR, cv::COLOR_BayerGRBG2BGR_EA},
                                          {"GBRG", cv::COLOR_BayerGBRG2BGR, cv::COLOR_BayerGBRG2BGR_EA}}};

const Bayer* find_pattern(const std::string& pattern) {
    const auto* const found = std::ranges::find(kPatterns, pattern, &Bayer::pattern);
    return found == kPatterns.end() ? nullptr : found;
}

/// What every raw value becomes: (value · scale − black) / (white − black) / neutral.
struct Levels {
    explicit Levels(const RawImage& raw, double scale)
        : black(scale * raw.black_level),
          range(scale * (raw.white_level - raw.black_level)),
          neutral{raw.neutral.x, raw.neutral.y, raw.neutral.z} {}

    [[nodiscard]] float linear(double value, int channel) const {
        return static_cast<float>((value - black) / range / neutral[static_cast<std::size_t>(channel)]);
    }

    double black;
    double range;
    std::array<double, 3> neutral;
};

/// R, G, B at each pixel, in units of 1/`scale` DN.
cv::Mat demosaiced(const RawImage& raw, const Bayer& bayer, int scale) {
    cv::Mat values(raw.mosaic.height, raw.mosaic.width, CV_16UC1);
    std::ranges::transform(raw.mosaic.values, values.begin<std::uint16_t>(),
                           [scale](std::uint16_t value) { return static_cast<std::uint16_t>(value * scale); });
    cv::Mat framed;
    cv::copyMakeBorder(values, framed, kBorder, kBorder, kBorder, kBorder, cv::BORDER_REFLECT_101);
    cv::Mat colours;
    cv::demosaicing(framed, colours, raw.demosaicing == Demosaicing::edge_aware ? bayer.edge_aware : bayer.bilinear);
    return colours(cv::Rect(kBorder, kBorder, values.cols, values.rows));
}

}  // namespace

int mosaic_channel(const std::string& pattern, int x, int y) {
    const char colour = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
    return colour == 'R' ? 0 : colour == 'G' ? 1 : 2;
}

formats::Image develop(const RawImage& raw) {
    const formats::IntegerImage& mosaic = raw.mosaic;
    formats::Image image =
        formats::make_image(mosaic.width, mosaic.height,
                            mosaic.channels == 1 && raw.pattern.empty() ? std::vector<std::string>{"Y"}
                                                                        : std::vector<std::string>{"R", "G", "B"});
    image.metadata = mosaic.metadata;
    if (raw.pattern.empty()) {
        const Levels levels(raw, 1.0);
        for (std::size_t i = 0; i < mosaic.values.size(); ++i) {
            image.pixels[i] = levels.linear(mosaic.values[i], static_cast<int>(i) % mosaic.channels);
        }
        return image;
    }
    const Bayer* bayer = find_pattern(raw.pattern);
    if (bayer == nullptr || mosaic.width < 2 || mosaic.height < 2) {
        throw std::invalid_argument("a mosaic needs a Bayer pattern and two pixels each way");
    }
    // Means are rounded to integers: of as many bits as there are.
    const int scale = 1 << (16 - raw.bits);
    const cv::Mat colours = demosaiced(raw, *bayer, scale);
    const Levels levels(raw, scale);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto& blue_green_red = colours.at<cv::Vec3w>(y, x);
            for (int channel = 0; channel < 3; ++channel) {
                image.at(x, y, channel) = levels.linear(blue_green_red[2 - channel], channel);
            }
        }
    }
    return image;
}

void write_raw(const RawImage& raw, const std::filesystem::path& file) {
    formats::write_png(raw.mosaic, file);
}

}  // namespace lensproof::render
