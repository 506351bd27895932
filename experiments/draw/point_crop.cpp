#include "experiments/draw/point_crop.h"

#include <algorithm>
#include <cmath>

#include "experiments/draw/svg.h"

namespace lensproof::draw {

namespace {

constexpr int kCropMiddle = kCropSide / 2;
constexpr double kCropPixel = 6.0;  // of the drawing
constexpr double kBetweenCrops = 8.0;
constexpr double kCropText = 11.0;
constexpr double kMarkCasing = 3.4;
constexpr double kMarkLine = 1.5;

void draw_mark(Svg& svg, SvgPoint at, bool is_expected) {
    constexpr const char* kFound = "#ff9055";
    constexpr const char* kExpected = "#6bbcf2";
    for (const auto& [colour, width] :
         {std::pair{"#000", kMarkCasing}, std::pair{is_expected ? kExpected : kFound, kMarkLine}}) {
        const SvgStyle style{.stroke = colour, .width = width};
        if (is_expected) {
            svg.circle(at, 7.0, style);
            continue;
        }
        svg.line({at.x - 9.0, at.y}, {at.x + 9.0, at.y}, style);
        svg.line({at.x, at.y - 9.0}, {at.x, at.y + 9.0}, style);
    }
}

}  // namespace

PointCrop::PointCrop(std::string label_, const formats::Image& picture, int channel, const Vec2d& at_px)
    : label(std::move(label_)),
      grey(formats::make_image(kCropSide, kCropSide, {"Y"})),
      corner_px{std::round(at_px.x) - kCropMiddle, std::round(at_px.y) - kCropMiddle} {
    float darkest = HUGE_VALF;
    float brightest = -HUGE_VALF;
    for (int y = 0; y < kCropSide; ++y) {
        for (int x = 0; x < kCropSide; ++x) {
            const int from_x = static_cast<int>(corner_px.x) + x;
            const int from_y = static_cast<int>(corner_px.y) + y;
            const bool is_inside = from_x >= 0 && from_x < picture.width && from_y >= 0 && from_y < picture.height;
            grey.at(x, y, 0) = is_inside ? picture.at(from_x, from_y, channel) : -HUGE_VALF;
            if (is_inside) {
                darkest = std::min(darkest, grey.at(x, y, 0));
                brightest = std::max(brightest, grey.at(x, y, 0));
            }
        }
    }
    const float range = std::max(brightest - darkest, 1e-9F);
    for (float& value : grey.pixels) {
        value = std::max(0.0F, (value - darkest) / range);
    }
}

std::string point_crops_svg(const std::vector<PointCrop>& crops, const std::vector<CropMark>& marks) {
    constexpr double kSide = kCropPixel * kCropSide;
    Svg svg;
    double left = 0.0;
    for (const PointCrop& crop : crops) {
        const PageBox box{left, kCropText + 6.0, kSide, kSide};
        svg.text({left, kCropText}, crop.label, {.size = kCropText});
        svg.open_viewport("crop", box);
        svg.picture(box, formats::encode_png(crop.grey), crop.label);
        for (const CropMark& mark : marks) {
            const Vec2d in_crop = mark.at_px - crop.corner_px + Vec2d{0.5, 0.5};
            draw_mark(svg, {box.x + kCropPixel * in_crop.x, box.y + kCropPixel * in_crop.y}, mark.is_expected);
        }
        svg.close_viewport();
        left += kSide + kBetweenCrops;
    }
    double x = 9.0;
    const double y = kCropText + kSide + 22.0;
    for (const CropMark& mark : marks) {
        draw_mark(svg, {x, y}, mark.is_expected);
        svg.text({x + 14.0, y + 4.0}, mark.label, {.size = kCropText});
        x += 40.0 + svg_text_width(mark.label, kCropText);
    }
    return svg.document(std::max(left - kBetweenCrops, x), y + 14.0);
}

}  // namespace lensproof::draw
