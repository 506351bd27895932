#include "experiments/cli/compare_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calibration/comparison/colour_planes.h"
#include "calibration/comparison/picture_comparison.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/photo.h"
#include "engine/formats/image/picture_file.h"
#include "experiments/cli/compare_maps.h"
#include "experiments/cli/compare_page.h"
#include "experiments/cli/compare_places.h"
#include "experiments/cli/compare_report.h"
#include "experiments/cli/picture_measures.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

using calibration::Estimate;
using calibration::PictureComparison;

constexpr double kClippedLight = 0.99;  // of full scale

/// A picture in linear light, and what its file's form says of it.
struct ReadPicture {
    formats::Image image;
    bool is_high_range = false;
    double clipped_from = kClippedLight;
};

/// Raw files: the sensor's own colours, in its frame. All others as they are to be seen.
ReadPicture read_picture(const std::string& file) {
    using formats::PictureForm;
    const std::optional<PictureForm> form = formats::picture_form(file);
    const bool is_raw = form == PictureForm::raw;
    ReadPicture result{.image = is_raw ? formats::read_photo(file, std::nullopt) : formats::read_image(file),
                       .is_high_range = form == PictureForm::exr || form == PictureForm::hdr};
    if (result.is_high_range) {
        result.clipped_from = std::numeric_limits<double>::infinity();
    }
    return result;
}

void check_finite(const formats::Image& image, const std::string& file) {
    const auto found = std::ranges::find_if_not(image.pixels, [](float value) { return std::isfinite(value); });
    if (found != image.pixels.end()) {
        const auto index = static_cast<std::size_t>(found - image.pixels.begin());
        const std::size_t pixel = index / image.channels.size();
        throw InputError(fmt::format("{}: channel {} of pixel ({}, {}) is {}, expected a finite number", file,
                                     image.channels[index % image.channels.size()], pixel % image.width,
                                     pixel / image.width, *found));
    }
}

void check_alike(const formats::Image& a, const std::string& file_a, const formats::Image& b,
                 const std::string& file_b) {
    if (a.width != b.width || a.height != b.height || a.channels != b.channels) {
        throw InputError(
            fmt::format("{} is {} × {} with {} channels and {} is {} × {} with {}: expected pictures alike", file_a,
                        a.width, a.height, a.channel_count(), file_b, b.width, b.height, b.channel_count()));
    }
    check_finite(a, file_a);
    check_finite(b, file_b);
}

/// The channels' differences between the pictures as they are.
std::vector<ComparedRow> channel_rows(const formats::Image& a, const formats::Image& b, double limit) {
    std::vector<ComparedRow> rows;
    for (int c = 0; c < a.channel_count(); ++c) {
        double squares = 0.0;
        double fourths = 0.0;
        for (std::size_t i = static_cast<std::size_t>(c); i < a.pixels.size(); i += a.channels.size()) {
            const double square = std::pow(static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]), 2);
            squares += square;
            fourths += square * square;
        }
        const double n = static_cast<double>(a.width) * a.height;
        const double mean = squares / n;
        ComparedRow row;
        row.limited = limit > 0.0;
        row.check.label = "channel " + a.channels[static_cast<std::size_t>(c)];
        row.check.value = std::sqrt(mean);
        // The mean square's standard error over pixels, carried to its root.
        row.check.sigma =
            mean > 0.0 ? std::sqrt(std::max(0.0, fourths / n - mean * mean) / n) / (2.0 * std::sqrt(mean)) : 0.0;
        row.check.limit = limit;
        rows.push_back(row);
    }
    return rows;
}

calibration::ComparisonWishes wishes_of(const PictureOptions& options, const ReadPicture& a, const ReadPicture& b,
                                        const CommonOptions& common) {
    calibration::ComparisonWishes wishes{.registers = options.registration != "none",
                                         .model = std::nullopt,
                                         .matches_exposure = options.exposure == "match",
                                         .clipped = {.a = a.clipped_from, .b = b.clipped_from},
                                         .is_high_range = a.is_high_range && b.is_high_range,
                                         .pixels_per_degree = options.pixels_per_degree,
                                         .makes_maps = options.is_shown(),
                                         .threads = common.threads};
    for (const auto model : {calibration::WarpModel::translation, calibration::WarpModel::similarity,
                             calibration::WarpModel::affine, calibration::WarpModel::homography}) {
        if (options.registration == calibration::warp_model_name(model)) {
            wishes.model = model;
        }
    }
    return wishes;
}

Json registration_json(const calibration::Registration& registration) {
    Json parameters = Json::object();
    for (const auto& [name, estimate] : registration.parameters) {
        parameters[name] = estimate_json(estimate);
    }
    return {{"model", calibration::warp_model_name(registration.model)},
            {"parameters", parameters},
            {"residual_px", registration.residual_px},
            {"overlap", registration.overlap},
            {"correlation", registration.correlation},
            {"reason", registration.reason}};
}

Json exposure_json(const calibration::ExposureMatch& exposure, const formats::Image& picture) {
    Json gains = Json::object();
    for (std::size_t c = 0; c < exposure.gains.size(); ++c) {
        gains[picture.channels[c]] = estimate_json(exposure.gains[c]);
    }
    return {{"model", exposure.is_matched ? "gain" : "none"}, {"gains", gains}, {"reason", exposure.reason}};
}

Json curves_json(const std::map<std::string, calibration::Curve>& curves) {
    Json json = Json::object();
    for (const auto& [name, curve] : curves) {
        json[name] = {{"image_height", curve.image_height},
                      {"difference", curve.value},
                      {"lower_95", curve.lower_95},
                      {"upper_95", curve.upper_95}};
    }
    return json;
}

/// Throws InputError where a number has a limit and is none.
void check_measures(const std::vector<Measure>& list, const std::string& files) {
    for (const Measure& measure : list) {
        if (measure.limit > 0.0 && !std::isfinite(measure.fault.value)) {
            throw InputError(fmt::format("{}: they have no {} to hold against its limit", files, measure.title));
        }
    }
}

/// Puts each into `json`, with its verdict where it has a limit; returns the exit status.
int report_measures(const std::vector<Measure>& list, const CommonOptions& common, Json& json) {
    int status = kDone;
    json["standard_errors"] = Json::object();
    json["checks"] = Json::list();
    for (const Measure& measure : list) {
        const auto& [value, error] = measure.estimate;
        json[measure.key] = value;
        json["standard_errors"][measure.key] = error;
        std::string verdict_text;
        if (measure.limit > 0.0) {
            const findings::Verdict judged = measure.check().verdict();
            const std::string verdict = findings::verdict_name(judged);
            status = judged == findings::Verdict::pass ? status : kCheckFailed;
            json["checks"].push_back(Json{{"quantity", measure.key}, {"limit", measure.limit}, {"verdict", verdict}});
            verdict_text = fmt::format("  limit {:g}: {}", measure.limit, verdict);
        }
        if (prints_text(common)) {
            print("{:32} {:.5g} ± {:.2g}{}\n", measure.title, value, error, verdict_text);
        }
    }
    return status;
}

void print_matches(const PictureComparison& found, const formats::Image& picture) {
    const calibration::Registration& registration = found.registration;
    print("registration: {} ({})\n", calibration::warp_model_name(registration.model), registration.reason);
    for (const auto& [name, estimate] : registration.parameters) {
        print("  {:30} {:.6g} ± {:.2g}\n", name, estimate.value, estimate.standard_error);
    }
    if (std::isfinite(registration.residual_px)) {
        print("  {:30} {:.2g}\n", "residual_px", registration.residual_px);
    }
    print("exposure: {} ({})\n", found.exposure.is_matched ? "gain" : "none", found.exposure.reason);
    for (std::size_t c = 0; c < found.exposure.gains.size(); ++c) {
        const auto& [gain, error] = found.exposure.gains[c];
        print("  {:30} {:.6g} ± {:.2g}\n", picture.channels[c], gain, error);
    }
}

/// That pictures are no R, G, B or grey ones, or do not overlap, is said where something was asked that needs it.
void check_comparable(const std::string& files, const std::string& why, const PictureOptions& options) {
    for (const auto& [name, limit] : options.limits()) {
        if (limit > 0.0 && std::string(name) != "--rms-limit") {
            throw InputError(fmt::format("{}: {}, so that nothing can be held against {}", files, why, name));
        }
    }
    if (options.has_places()) {
        throw InputError(fmt::format("{}: {}, so that there is nothing for {} to measure", files, why,
                                     options.edges.empty() ? "--spot" : "--edge"));
    }
    if (options.is_shown()) {
        throw InputError(fmt::format("{}: {}, so that there is nothing for {} to show", files, why,
                                     options.maps_folder.empty() ? "--report" : "--maps"));
    }
}

/// What is found of two pictures alike; nothing where they are no pictures to look at. `b` is used up. Throws
/// InputError where something was asked for that they do not have.
std::optional<PictureComparison> compared(const ReadPicture& a, ReadPicture& b, const std::string& files,
                                          const PictureOptions& options, const calibration::ComparisonWishes& wishes) {
    if (!calibration::is_shown(a.image)) {
        check_comparable(files, "they are neither R, G, B nor grey", options);
        return std::nullopt;
    }
    PictureComparison found = calibration::compare_pictures(a.image, std::move(b.image), wishes);
    if (found.registration.likeness != calibration::Likeness::unlike) {
        check_measures(measures(found, options), files);
        return found;
    }
    const std::string why = fmt::format("no overlap is found: {} (--registration none compares them as they are)",
                                        found.registration.reason);
    check_comparable(files, why, options);
    if (options.rms_limit == 0.0) {
        throw InputError(fmt::format("{}: {}", files, why));
    }
    print_message("lensproof: {}: {}\n", files, why);
    return found;
}

/// Puts what was found into `json`, prints it and draws the maps; returns the exit status.
int report_comparison(const PictureComparison& found, const formats::Image& picture, const PictureOptions& options,
                      const CommonOptions& common, Json& json) {
    json["registration"] = registration_json(found.registration);
    if (found.registration.likeness == calibration::Likeness::unlike) {
        return kDone;  // held against the limit of pictures as they are
    }
    json["exposure"] = exposure_json(found.exposure, picture);
    if (!options.maps_folder.empty()) {
        json["maps"] = write_maps(drawn_maps(found), options.maps_folder);
    }
    if (prints_text(common)) {
        print_matches(found, picture);
    }
    json["flip_range"] = found.flip_exposures ? "high" : "low";
    json["curves"] = curves_json(found.curves);
    return report_measures(measures(found, options), common, json);
}

}  // namespace

std::vector<std::pair<const char*, double>> PictureOptions::limits() const {
    return {{"--rms-limit", rms_limit},
            {"--psnr-limit", psnr_limit_db},
            {"--ssim-limit", ssim_limit},
            {"--flip-limit", flip_limit},
            {"--ciede2000-limit", ciede2000_limit},
            {"--ciede2000-p99-limit", ciede2000_p99_limit}};
}

void add_picture_options(Command& command, PictureOptions& options) {
    command
        .add_option("--registration", options.registration,
                    "How B is brought over A: auto (chosen), translation, similarity, affine, homography, or none")
        .check(one_of({"auto", "translation", "similarity", "affine", "homography", "none"}))
        .shows_default();
    command.add_option("--exposure", options.exposure, "B's channels' brightness: match (a gain each) or none")
        .check(one_of({"match", "none"}))
        .shows_default();
    command
        .add_option(
            "--edge", options.edges,
            "Sharpness of both at the same edges: a rectangle x,y,width,height (px of A) that holds one; whole; "
            "or auto for all that are found")
        .type_name("EDGE");
    command
        .add_option("--spot", options.spots,
                    "A box x,y,width,height (px of A) that holds a patch of light, as a lamp out of focus or a ghost")
        .type_name("BOX");
    command.add_option("--maps", options.maps_folder, "Folder for maps of two pictures' differences, PNG")
        .type_name("DIR");
    command.add_option("--report", options.report_file, "Page that lays two pictures over each other, HTML")
        .type_name("FILE");
    command.add_option("--pixels-per-degree", options.pixels_per_degree, "Of FLIP's display, as its viewer sees it")
        .check(in_range(5.0, 500.0))
        .shows_default();
    command.add_option("--rms-limit", options.rms_limit, "Limit of images' rms difference as they are, full scale 1")
        .check(kPositiveOption);
    command.add_option("--psnr-limit", options.psnr_limit_db, "Least PSNR, dB").check(kPositiveOption);
    command.add_option("--ssim-limit", options.ssim_limit, "Least SSIM").check(in_range(1e-6, 1.0));
    command.add_option("--flip-limit", options.flip_limit, "Limit of the mean FLIP").check(kPositiveOption);
    command.add_option("--ciede2000-limit", options.ciede2000_limit, "Limit of the mean CIEDE2000")
        .check(kPositiveOption);
    command
        .add_option("--ciede2000-p99-limit", options.ciede2000_p99_limit, "Limit of the 99th percentile of CIEDE2000")
        .check(kPositiveOption);
}

int compare_pictures(const std::string& a, const std::string& b, const PictureOptions& options,
                     const CommonOptions& common) {
    if (!options.maps_folder.empty()) {
        check_maps_folder(options.maps_folder);
    }
    if (!options.report_file.empty()) {
        check_output_name(options.report_file);
    }
    ReadPicture one = read_picture(a);
    ReadPicture other = read_picture(b);
    check_alike(one.image, a, other.image, b);
    const std::string files = fmt::format("{} and {}", a, b);
    const std::vector<ComparedRow> rows = channel_rows(one.image, other.image, options.rms_limit);
    const calibration::ComparisonWishes wishes = wishes_of(options, one, other, common);
    const formats::Image as_it_is = options.has_places() ? other.image : formats::Image{};
    const std::optional<PictureComparison> found = compared(one, other, files, options, wishes);
    const bool is_alike = found && found->registration.likeness != calibration::Likeness::unlike;
    const ComparedPlaces places =
        is_alike ? compare_places(one.image, as_it_is, *found, wishes.clipped, options, files) : ComparedPlaces{};
    Json json{{"a", a}, {"b", b}, {"findings", Json::list()}};
    int status = report_rows(rows, a, b, common, json);
    if (found) {
        status = std::max(status, report_comparison(*found, one.image, options, common, json));
        add_places_json(places, one.image, json);
        if (prints_text(common)) {
            print_places(places, one.image);
        }
    }
    if (found && found->b_over_a && !options.report_file.empty()) {
        write_file(options.report_file, comparison_page({a, one.image, one.is_high_range}, b, *found, places, options));
    }
    write_json_result(common, json);
    return status;
}

}  // namespace lensproof::cli
