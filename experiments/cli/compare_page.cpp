#include "experiments/cli/compare_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "engine/base/order_statistics.h"
#include "experiments/cli/compare_maps.h"
#include "experiments/cli/picture_measures.h"
#include "experiments/draw/report/html_text.h"
#include "experiments/draw/report/report.h"
#include "experiments/findings/shown_picture.h"
#include "experiments/runner/provenance.h"
#include "experiments/runner/report_content.h"

namespace lensproof::cli {

namespace {

using calibration::Estimate;

constexpr const char* kSubject = "pictures";

/// What brings a picture of any scale to where an eye wants it: 99 of 100 values to 0.8 at most.
double shown_gain(const PageSubject& a) {
    std::vector<float> values = a.image.pixels;
    const auto bright = static_cast<double>(quantile(values, 0.99));
    return a.is_high_range && bright > 0.0 ? 0.8 / bright : 1.0;
}

std::string laid(formats::Image image, double gain) {
    for (float& value : image.pixels) {
        value = static_cast<float>(gain * static_cast<double>(value));
    }
    return findings::laid_picture(image);
}

std::string with_error(const Estimate& estimate) {
    return std::isfinite(estimate.value) ? draw::measurement_text(estimate.value, estimate.standard_error)
           : std::isinf(estimate.value)  ? "infinite: they are equal"
                                         : "none";
}

/// The files' names, with their folders' where they are the same.
std::pair<std::string, std::string> short_names(const std::filesystem::path& a, const std::filesystem::path& b) {
    if (a.filename() != b.filename()) {
        return {a.filename().string(), b.filename().string()};
    }
    const auto with_folder = [](const std::filesystem::path& file) {
        return (file.parent_path().filename() / file.filename()).string();
    };
    return {with_folder(a), with_folder(b)};
}

std::vector<findings::Fact> facts(const calibration::PictureComparison& found, const formats::Image& picture,
                                  double gain, const std::vector<DrawnMap>& maps, const PictureOptions& options) {
    std::vector<findings::Fact> facts;
    for (const Measure& measure : measures(found, options)) {
        facts.push_back({measure.title, with_error(measure.estimate)});
    }
    const calibration::Registration& registration = found.registration;
    facts.push_back({"registration",
                     fmt::format("{} ({})", calibration::warp_model_name(registration.model), registration.reason)});
    for (const auto& [name, estimate] : registration.parameters) {
        facts.push_back({name, with_error(estimate)});
    }
    if (std::isfinite(registration.residual_px)) {
        facts.push_back({"residual of the registration", fmt::format("{:.2g} px", registration.residual_px)});
    }
    facts.push_back({"exposure", found.exposure.reason});
    for (std::size_t c = 0; c < found.exposure.gains.size(); ++c) {
        facts.push_back({"gain of B’s " + picture.channels[c], with_error(found.exposure.gains[c])});
    }
    if (gain != 1.0) {
        facts.push_back({"shown", fmt::format("{:.4g} times as bright", gain)});
    }
    for (const DrawnMap& map : maps) {
        facts.push_back({"colours of “" + map.quantity + "”",
                         fmt::format("from {:.3g} to {:.3g}{}", map.lowest, map.highest,
                                     map.quantity == "difference" ? ": luminance, B less A, without its noise" : "")});
    }
    return facts;
}

findings::Picture layered(const PageSubject& a, const calibration::PictureComparison& found, double gain,
                          const std::vector<DrawnMap>& maps, const std::string& caption) {
    findings::Picture picture{.name = "a.jpg",
                              .caption = caption,
                              .width = a.image.width,
                              .height = a.image.height,
                              .bytes = laid(a.image, gain),
                              .label = "A"};
    picture.layers = {{.name = "b.jpg", .label = "B", .bytes = laid(*found.b_over_a, gain)}};
    for (const DrawnMap& map : maps) {
        picture.layers.push_back({.name = map.quantity + ".jpg",
                                  .label = map.quantity,
                                  .kind = findings::LayerKind::difference,
                                  .bytes = findings::laid_picture(map.picture)});
    }
    return picture;
}

/// What a page says of a curve of radial_difference.h.
struct CurveWords {
    std::string curve;
    std::string title;
    std::string unit;
};

CurveWords words_of(const std::string& curve) {
    static const std::array kWords = {CurveWords{"brightness_ev", "Brightness, B against A", "EV"},
                                      CurveWords{"red_over_green_ev", "Red over green, B against A", "EV"},
                                      CurveWords{"blue_over_green_ev", "Blue over green, B against A", "EV"},
                                      CurveWords{"ciede2000", "CIEDE2000", ""}};
    const auto* const found = std::ranges::find(kWords, curve, &CurveWords::curve);
    return found != kWords.end() ? *found : CurveWords{curve, curve, ""};
}

std::vector<findings::Plot> plots(const calibration::PictureComparison& found) {
    std::vector<findings::Plot> plots;
    for (const auto& [name, curve] : found.curves) {
        calibration::Curve whole = curve;
        whole.covered_image_height = whole.image_height.empty() ? 0.0 : whole.image_height.back();
        const CurveWords words = words_of(name);
        plots.push_back(
            {.id = name,
             .title = words.title,
             .subtitle = "over the distance from the frame's middle",
             .y_label = "difference",
             .y_unit = words.unit,
             .series = {{.label = "B against A", .subject = kSubject, .style = "difference", .curve = whole}}});
    }
    return plots;
}

std::string command_of(const std::string& a, const std::string& b, const PictureOptions& options) {
    std::string command = fmt::format(
        "lensproof compare {} {} --registration {} --exposure {} --pixels-per-degree {:g}", runner::portable_path(a),
        runner::portable_path(b), options.registration, options.exposure, options.pixels_per_degree);
    for (const std::string& edge : options.edges) {
        command += " --edge " + edge;
    }
    for (const std::string& spot : options.spots) {
        command += " --spot " + spot;
    }
    for (const auto& [name, limit] : options.limits()) {
        command += limit > 0.0 ? fmt::format(" {} {:g}", name, limit) : "";
    }
    return command + " --report " + options.report_file;
}

}  // namespace

std::string comparison_page(const PageSubject& a, const std::string& b, const calibration::PictureComparison& found,
                            const ComparedPlaces& places, const PictureOptions& options) {
    const double gain = shown_gain(a);
    const std::vector<DrawnMap> maps = drawn_maps(found);
    const auto& [name_a, name_b] = short_names(a.file, b);
    findings::Findings page{.subjects_title = "Pictures", .plots = plots(found)};
    for (const Measure& measure : measures(found, options)) {
        if (measure.limit > 0.0) {
            page.checks.push_back(measure.check());
            page.checks.back().group = "B over A";
            page.checks.back().subject = kSubject;
        }
    }
    page.subjects.push_back({.id = kSubject,
                             .kind = "B over A",
                             .label = fmt::format("{} and {}", name_a, name_b),
                             .facts = facts(found, a.image, gain, maps, options),
                             .pictures = {layered(a, found, gain, maps, fmt::format("A: {}, B: {}", name_a, name_b))}});
    findings::Subject& subject = page.subjects.front();
    std::ranges::move(place_facts(places, a.image), std::back_inserter(subject.facts));
    std::ranges::move(place_pictures(places), std::back_inserter(subject.pictures));
    page.inputs = {a.file, b};
    page.not_shown = {
        "What the registration and the exposure's gains can express has been taken out of the pictures before anything "
        "was "
        "told of them: their parameters are among the numbers.",
        "Noise is in all numbers but the map of the difference; a limit that holds for two noisy pictures may be one "
        "of "
        "their noise."};
    const std::string summary =
        fmt::format("SSIM {}, FLIP {}, CIEDE2000 {} on average, after B was brought over A ({}) and to its exposure.{}",
                    with_error(found.ssim), with_error(found.flip), with_error(found.ciede2000_mean),
                    calibration::warp_model_name(found.registration.model),
                    page.checks.empty() ? " No limit was given, so that nothing is judged." : "");
    Json report = runner::report_json({.title = page.subjects.front().label,
                                       .summary = summary,
                                       .settings = {{"registration", options.registration},
                                                    {"exposure", options.exposure},
                                                    {"pixels_per_degree", options.pixels_per_degree}},
                                       .reproduce = command_of(a.file, b, options)},
                                      page);
    if (page.checks.empty()) {
        report["verdict"] = findings::verdict_name(findings::Verdict::inconclusive);
    }
    return draw::report_html(report, runner::report_pictures(page));
}

}  // namespace lensproof::cli
