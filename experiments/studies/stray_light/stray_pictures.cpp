#include "experiments/studies/stray_light/stray_pictures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/findings/shown_picture.h"
#include "experiments/studies/stray_light/light_chart.h"

namespace lensproof::studies {

namespace {

constexpr int kShownWidth = 1200;    // px, of a variant's picture
constexpr int kSheetWidth = 1800;    // and of all together
constexpr std::size_t kListed = 20;  // ghosts in a chart

double brightening(const StrayScene& scene, const std::string& pass) {
    const auto found = scene.brightening_ev.find(pass);
    return found == scene.brightening_ev.end() ? 0.0 : found->second;
}

formats::Image brightened(formats::Image image, double ev) {
    const auto gain = static_cast<float>(std::exp2(ev));
    std::ranges::transform(image.pixels, image.pixels.begin(), [&](float value) { return gain * value; });
    return image;
}

/// The part of a picture that the scene's table wants to be shown.
formats::Image shown_part(const StrayScene& scene, formats::Image image) {
    if (scene.crop.empty()) {
        return image;
    }
    const auto place = [](double fraction, int size) { return static_cast<int>(std::lround(fraction * size)); };
    const int left = place(scene.crop[0], image.width);
    const int top = place(scene.crop[1], image.height);
    formats::Image part = formats::make_image(std::max(1, place(scene.crop[2], image.width) - left),
                                              std::max(1, place(scene.crop[3], image.height) - top), image.channels);
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(part.width) * part.channel_count();
    for (int y = 0; y < part.height; ++y) {
        const int from = std::min(top + y, image.height - 1);
        std::copy_n(&image.at(std::min(left, image.width - part.width), from, 0), row, &part.at(0, y, 0));
    }
    return part;
}

std::string caption_of(const std::string& pass, double ev) {
    return ev == 0.0 ? pass : fmt::format("{}, {:+g} EV", pass, ev);
}

/// Pictures in rows of `columns`, with a white line between them; those that are smaller than others have white beside
/// them.
formats::Image contact_sheet(const std::vector<formats::Image>& pictures, int columns) {
    constexpr int kLine = 4;  // px
    const int width = std::ranges::max_element(pictures, {}, &formats::Image::width)->width;
    const int height = std::ranges::max_element(pictures, {}, &formats::Image::height)->height;
    const int count = static_cast<int>(pictures.size());
    const int across = std::min(columns, count);
    const int rows = (count + across - 1) / across;
    formats::Image sheet = formats::make_image(across * (width + kLine) - kLine, rows * (height + kLine) - kLine,
                                               pictures.front().channels);
    std::ranges::fill(sheet.pixels, 1.0F);
    for (int i = 0; i < count; ++i) {
        const formats::Image& picture = pictures[static_cast<std::size_t>(i)];
        const int left = (i % across) * (width + kLine);
        const int top = (i / across) * (height + kLine);
        const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(picture.width) * picture.channel_count();
        for (int y = 0; y < picture.height; ++y) {
            std::copy_n(picture.pixels.begin() + y * row, row, &sheet.at(left, top + y, 0));
        }
    }
    return sheet;
}

/// The variants' names, row by row.
std::string sheet_words(const StrayScene& scene) {
    std::string words;
    for (std::size_t i = 0; i < scene.variants.size(); ++i) {
        words += i == 0 ? "" : i % static_cast<std::size_t>(scene.columns) == 0 ? "; " : ", ";
        words += scene.variants[i].label;
    }
    return words;
}

std::vector<findings::Picture> contact_sheets(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    std::vector<findings::Picture> sheets;
    const auto add = [&](const std::string& pass, double ev, const auto& image_of) {
        std::vector<formats::Image> images;
        std::ranges::transform(variants, std::back_inserter(images),
                               [&](const VariantFindings& variant) { return shown_part(scene, image_of(variant)); });
        sheets.push_back(findings::shown_picture(fmt::format("{}/{}.jpg", scene.name, pass),
                                                 fmt::format("{}: {}", caption_of(pass, ev), sheet_words(scene)),
                                                 contact_sheet(images, scene.columns), kSheetWidth));
    };
    add(kPicture, 0.0, [](const VariantFindings& variant) { return picture_of(variant.passes); });
    for (std::size_t i = 0; scene.passes.size() > 1 && i < scene.passes.size(); ++i) {
        const double ev = brightening(scene, scene.passes[i]);
        add(scene.passes[i], ev, [&](const VariantFindings& variant) { return brightened(variant.passes[i].rgb, ev); });
    }
    return sheets;
}

/// Energies of the ghosts, in the order that the first variant has them in.
findings::Picture ghost_chart(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    const std::size_t count = std::min(kListed, variants.front().ghosts.size());
    draw::PlotChart chart{
        .title = "Ghosts of two reflections, one by one",
        .caption = fmt::format("A distant light {:g}° from the axis, 550 nm", *scene.ghosts_deg),
        .x = {.label = fmt::format("Ghost, the strongest of {} first", scene.variants.front().label)},
        .y = {.label = "Energy over that of the entrance pupil", .scale = draw::AxisScale::logarithmic}};
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) {
        names.push_back(fmt::format("{}: {}", i + 1, fmt::join(variants.front().ghosts[i].surfaces, ",")));
    }
    chart.note = fmt::format("Surfaces in the order of reflection: {}", fmt::join(names, "; "));
    for (std::size_t v = 0; v < variants.size(); ++v) {
        draw::ChartCurve curve{.label = scene.variants[v].label,
                               .points = {},
                               .colour = draw::series_colour(v),
                               .line = draw::CurveLine::none,
                               .marker = static_cast<draw::CurveMarker>(1 + v % 5)};
        for (std::size_t i = 0; i < count; ++i) {
            const auto same =
                std::ranges::find(variants[v].ghosts, variants.front().ghosts[i].surfaces, &GhostEnergy::surfaces);
            if (same != variants[v].ghosts.end()) {
                curve.points.push_back({static_cast<double>(i + 1), same->energy.value});
            }
        }
        chart.curves.push_back(std::move(curve));
    }
    return findings::drawn_picture(scene.name + "/ghosts.svg", "Each ghost by itself",
                                   draw::chart_svg(chart, {.width = 860.0, .height = 480.0}));
}

/// The error of the sum of passes and of each over the time that they took.
findings::Picture growth_chart(const StrayScene& scene, const StrayVariant& variant,
                               const std::vector<PictureGrowth>& growth) {
    draw::PlotChart chart{.title = "How the picture grows",
                          .caption = fmt::format("1 to {} samples a pixel and pass", growth.back().samples),
                          .x = {.label = "Time", .unit = "s", .scale = draw::AxisScale::logarithmic},
                          .y = {.label = "Error over white, rms", .scale = draw::AxisScale::logarithmic}};
    draw::ChartCurve all{
        .label = "sum of the passes", .colour = draw::series_colour(0), .marker = draw::CurveMarker::dot, .width = 2.4};
    draw::ChartCurve law{.label = "time to −1/2", .colour = "#5f6672", .line = draw::CurveLine::dashed};
    for (const PictureGrowth& point : growth) {
        all.points.push_back({point.seconds, point.error});
        law.points.push_back({point.seconds, growth.front().error * std::sqrt(growth.front().seconds / point.seconds)});
    }
    chart.curves = {law, all};
    for (std::size_t pass = 0; pass < scene.passes.size(); ++pass) {
        draw::ChartCurve curve{
            .label = scene.passes[pass], .colour = draw::series_colour(1 + pass), .marker = draw::CurveMarker::ring};
        for (const PictureGrowth& point : growth) {
            curve.points.push_back({point.pass_seconds[pass], point.pass_errors[pass]});
        }
        chart.curves.push_back(std::move(curve));
    }
    return findings::drawn_picture(fmt::format("{}-{}/growth.svg", scene.name, variant.name), "Error over time",
                                   draw::chart_svg(chart, {.width = 760.0, .height = 520.0}));
}

}  // namespace

std::vector<findings::Picture> pictures_of_all(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    std::vector<findings::Picture> pictures;
    if (variants.size() > 1) {
        pictures = contact_sheets(scene, variants);
    }
    if (scene.ghosts_deg && !variants.front().ghosts.empty()) {
        pictures.push_back(ghost_chart(scene, variants));
    }
    if (std::optional<findings::Picture> light = light_chart(scene, variants)) {
        pictures.push_back(*std::move(light));
    }
    if (scene.chart) {
        std::ranges::move(chart_drawings(*scene.chart, scene.name, features_of(scene, variants)),
                          std::back_inserter(pictures));
    }
    return pictures;
}

std::vector<findings::Picture> pictures_of(const StrayScene& scene, const StrayVariant& variant,
                                           const VariantFindings& found) {
    const std::string folder = fmt::format("{}-{}", scene.name, variant.name);
    std::vector<findings::Picture> pictures = {
        findings::shown_picture(folder + "/picture.jpg", scene.passes.size() > 1 ? "all together" : variant.label,
                                shown_part(scene, picture_of(found.passes)), kShownWidth)};
    for (std::size_t i = 0; found.passes.size() > 1 && i < found.passes.size(); ++i) {
        const PassPicture& pass = found.passes[i];
        const double ev = brightening(scene, pass.pass);
        pictures.push_back(findings::shown_picture(fmt::format("{}/{}.jpg", folder, pass.pass),
                                                   caption_of(pass.pass, ev),
                                                   shown_part(scene, brightened(pass.rgb, ev)), kShownWidth));
    }
    if (!found.growth.empty()) {
        pictures.push_back(growth_chart(scene, variant, found.growth));
    }
    return pictures;
}

}  // namespace lensproof::studies
