#include "experiments/studies/twins/twins_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "calibration/photos/photo_survey.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/render/scene_setup.h"
#include "engine/spectral/sensor_response.h"
#include "experiments/studies/twins/render_twin.h"

namespace lensproof::studies {

namespace {

constexpr const char* kResidualPlot = "twins_radial_px";

TwinSettings read_twins_table(TomlTable& table, findings::ExperimentFile& file) {
    TwinSettings twins;
    twins.name = findings::read_name(table);
    file.add_subject(table, "name", twins.name);
    twins.photos = table.text("photos");
    const auto manifest = file.manifests.find(twins.photos);
    if (manifest == file.manifests.end()) {
        std::vector<std::string> known;
        for (const auto& [name, path] : file.manifests) {
            known.push_back(name);
        }
        table.fail("photos", fmt::format("is \"{}\", expected a [[photos]] of this file: {}", twins.photos,
                                         known.empty() ? "there is none" : fmt::format("{}", fmt::join(known, ", "))));
    }
    twins.manifest = manifest->second;
    twins.lens = formats::read_lens_name(table);
    constexpr Bounds kFNumber{.min = 0.1, .max = 1000.0};
    twins.f_number = table.optional_number("f_number", kFNumber);
    twins.focus_distance_mm = table.optional_number("focus_distance_mm", kPositive);
    twins.free = findings::names_of(table, "fit", {calibration::kFreeKinds.begin(), calibration::kFreeKinds.end()});
    twins.response = table.has("response") ? table.choice("response", spectral::known_sensors()) : "camera";
    twins.samples_per_pixel =
        table.integer_or("samples_per_pixel", twins.samples_per_pixel, 1, render::kMostSamplesPerPixel);
    twins.stated = {{"lens", twins.lens},
                    {"f_number", twins.f_number ? Json(*twins.f_number) : Json()},
                    {"focus_distance_mm", twins.focus_distance_mm ? Json(*twins.focus_distance_mm) : Json()},
                    {"fit", twins.free},
                    {"response", twins.response},
                    {"samples_per_pixel", twins.samples_per_pixel}};
    twins.limit_px = table.optional_number("limit_px", kPositive);
    table.finish();
    try {
        formats::load_lens(twins.lens);
    } catch (const InputError& error) {
        table.fail("lens", error.what());
    }
    return twins;
}

std::string percent(double fraction) {
    return fmt::format("{:.2g}", 100.0 * fraction);
}

findings::Picture shown(const TwinSettings& settings, const std::string& file, const Twin& twin) {
    const std::string stem = fmt::format("{}/{}", settings.name, std::filesystem::path(file).stem().string());
    findings::Picture picture{.name = stem + ".jpg",
                              .caption = std::filesystem::path(file).filename().string(),
                              .width = twin.width,
                              .height = twin.height,
                              .bytes = twin.photo,
                              .label = "photo"};
    if (twin.photo.empty()) {
        picture.caption += " (the chart was not found again in its twin)";
        return picture;
    }
    picture.layers = {{.name = stem + "-twin.jpg", .label = "twin", .bytes = twin.render},
                      {.name = stem + "-difference.jpg",
                       .label = "difference",
                       .kind = findings::LayerKind::difference,
                       .bytes = twin.difference}};
    const calibration::PixelAccount& by = twin.pixels;
    picture.caption +=
        fmt::format(": of {} % rms of the chart's contrast, light {}, place {}, sharpness {}, noise {}, unexplained {}",
                    percent(by.as_rendered), percent(by.light), percent(by.place), percent(by.sharpness),
                    percent(by.noise), percent(by.unexplained));
    picture.points.emplace();
    for (const calibration::TwinPoint& point : twin.points) {
        const Vec2d by_px = point.photo_px - point.twin_px;
        picture.points->push_back({point.photo_px.x, point.photo_px.y, by_px.x, by_px.y});
    }
    return picture;
}

Json picture_json(const std::string& file, const Twin& twin) {
    const calibration::PixelAccount& by = twin.pixels;
    return Json{{"image", file},
                {"points", static_cast<int>(twin.points.size())},
                {"as_rendered", by.as_rendered},
                {"light", by.light},
                {"place", by.place},
                {"sharpness", by.sharpness},
                {"noise", by.noise},
                {"unexplained", by.unexplained}};
}

std::string displacement_text(const calibration::TwinDisplacement& displacement) {
    return std::isnan(displacement.rms_px)
               ? "not to be told from the lens: fewer than three photos"
               : fmt::format("{:.3f} ± {:.3f} px", displacement.rms_px, displacement.standard_error_px);
}

Json number_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

struct TwinFindings {
    const TwinSettings& settings;
    const FittedTwin& fitted;
    const calibration::PointAccount& account;
    double half_diagonal_px;
    std::string label;

    [[nodiscard]] std::vector<findings::Fact> facts() const;
    [[nodiscard]] findings::Check check() const;
    [[nodiscard]] Json json(Json pictures) const;
};

std::vector<findings::Fact> TwinFindings::facts() const {
    const Vec2d& axis = fitted.camera.axis_from_middle_px;
    std::vector<findings::Fact> facts = {
        {"photos", settings.photos},
        {"prescription", fitted.camera.lens.source},
        {"rendered at", fmt::format("f/{:g}, {} samples a pixel", fitted.f_number, settings.samples_per_pixel)},
        {"pixel pitch", fmt::format("{:.4f} µm{}", 1e3 * fitted.camera.pixel_pitch_mm,
                                    fitted.is_pitch_known ? "" : ", chosen: the photos do not state it")},
        {"shown difference",
         fmt::format("photo − twin among the chart's points; red: the photo is brighter; full colour "
                     "at ± {:.0f} % of the chart's contrast",
                     100.0 * kShownDifference)},
        {"axis from the sensor's middle", fmt::format("{:.2f} px right, {:.2f} px down", axis.x, axis.y)}};
    if (!fitted.changes.empty()) {
        facts.push_back({"fitted, and decided by the photos", fmt::format("{}", fmt::join(fitted.changes, "; "))});
    }
    if (fitted.points_not_imaged > 0) {
        facts.push_back({"points that the lens does not image", fmt::format("{}", fitted.points_not_imaged)});
    }
    facts.push_back({"points, photos", fmt::format("{}, {}", account.points, account.views)});
    facts.push_back({"photo − twin, rms of a coordinate", fmt::format("{:.3f} px", account.displaced_px)});
    facts.push_back({"of it the lens", displacement_text(account.lens)});
    facts.push_back({"the chart", displacement_text(account.chart)});
    facts.push_back({"what repeats in neither",
                     fmt::format("{:.3f} px, of which the pictures' noise explains {}", account.rest_px,
                                 std::isnan(account.expected_px) ? "what is not known"
                                                                 : fmt::format("{:.3f}", account.expected_px))});
    return facts;
}

findings::Check TwinFindings::check() const {
    const double limit = settings.limit_px.value_or(kTwinLimitFraction * half_diagonal_px);
    return {.id = settings.name + "-lens",
            .group = label + ": photos against their twins",
            .subject = settings.name,
            .label = "what the lens displaces alike in every photo, rms of a coordinate",
            .value = account.lens.rms_px,
            .sigma = account.lens.standard_error_px,
            .unit = "px",
            .limit = limit,
            .explanation = fmt::format("Photo less twin over {} points in {} photos, without what the charts' places "
                                       "can take.{}",
                                       account.points, account.views,
                                       settings.limit_px ? "" : " Limit: 0.1 % of the half-diagonal.")};
}

Json TwinFindings::json(Json pictures) const {
    const auto& [lens, chart] = std::pair(account.lens, account.chart);
    return Json{{"name", settings.name},
                {"photos", settings.photos},
                {"lens", settings.lens},
                {"f_number", fitted.f_number},
                {"pixel_pitch_um", 1e3 * fitted.camera.pixel_pitch_mm},
                {"axis_px", Json::list({fitted.camera.axis_from_middle_px.x, fitted.camera.axis_from_middle_px.y})},
                {"changes", fitted.changes},
                {"displacements_px", Json{{"all", account.displaced_px},
                                          {"lens", lens.rms_px},
                                          {"lens_sigma", lens.standard_error_px},
                                          {"chart", number_or_null(chart.rms_px)},
                                          {"chart_sigma", chart.standard_error_px},
                                          {"rest", account.rest_px},
                                          {"expected", number_or_null(account.expected_px)}}},
                {"pictures", std::move(pictures)}};
}

const calibration::Profile& profile_of(const TwinSettings& settings, const findings::Findings& before) {
    const auto found = std::ranges::find(before.profiles, settings.photos, &calibration::Profile::name);
    if (found == before.profiles.end()) {
        throw InputError(fmt::format("twins \"{}\": {} gave no profile", settings.name, settings.photos));
    }
    return *found;
}

findings::Findings twins_of(const TwinSettings& settings, const findings::RunSettings& run,
                            const findings::RunProgress& progress, const calibration::Profile& profile, Json& table) {
    progress(settings.name + ", fitting the lens", 0.0);
    const FittedTwin fitted = fit_twin(settings, profile);
    const PhotoSet photos = read_photo_set(settings.manifest);
    const calibration::PhotoSurvey survey = calibration::survey_photos(photos.photos, {}, std::nullopt);
    std::optional<render::Camera> camera;  // made where a picture is to be
    findings::Subject subject{.id = settings.name, .kind = "twins", .label = fitted.camera.lens.name};
    std::vector<calibration::TwinPoint> points;
    std::vector<FarPoint> far_points;
    Json pictures = Json::list();
    const std::size_t count = fitted.seen.views.size();
    for (std::size_t view = 0; view < count; ++view) {
        const std::string& file = fitted.seen.views[view].image;
        const auto photo = std::ranges::find(survey.pictures, file, &calibration::Picture::name);
        if (photo == survey.pictures.end()) {
            throw InputError(fmt::format("twins \"{}\": {} is not among the photos", settings.name, file));
        }
        findings::StepInput input{
            .settings = {{"twins", settings.stated}, {"profile", to_json(profile)}, {"view", view}, {"seed", run.seed}},
            .files = formats::files_of_lens(settings.lens)};
        input.files.emplace_back(file);
        input.files.push_back(settings.manifest);
        const std::string step = fmt::format("{}, {} of {}", settings.name, view + 1, count);
        const Twin twin = run.steps.step("twin", input, [&] {
            if (!camera) {
                camera.emplace(camera_settings(settings, fitted), fitted.camera.lens, render::SpectralSampling{},
                               render::PixelFilter{}, run.cache);
            }
            return render_twin(settings, fitted, profile, photos, *photo, *camera, view, run,
                               [&](double done) { progress(step, done); });
        });
        subject.pictures.push_back(shown(settings, file, twin));
        pictures.push_back(picture_json(file, twin));
        std::ranges::copy(twin.points, std::back_inserter(points));
        std::ranges::copy(twin.far_points, std::back_inserter(far_points));
    }
    constexpr std::size_t kLeastPoints = 10;
    if (points.size() < kLeastPoints) {
        throw InputError(
            fmt::format("twins \"{}\": {} points are found in photos and twins, expected {} or more: {} is "
                        "not the lens, or the photos are too poor",
                        settings.name, points.size(), kLeastPoints, settings.lens));
    }
    const calibration::PointAccount account =
        calibration::account_of_points(points, profile.width_px, profile.height_px);
    const TwinFindings told{settings, fitted, account, calibration::half_diagonal_px(profile),
                            fmt::format("{}, {}", subject.label, settings.photos)};
    subject.facts = told.facts();
    table.push_back(told.json(std::move(pictures)));
    findings::Findings found{.checks = {told.check()}};
    found.not_shown = {
        "Chief rays alone decide where the chart stood: a lens that is off as a whole (focus, a homography's worth) "
        "goes "
        "into the charts' places.",
        "Blur and vignetting of the prescription are in the twin and are judged by eye and by the pixels' shares, not "
        "by a "
        "check.",
        "A chart that is not flat is rendered flat, and the light on it is even."};
    found.plots.push_back(
        {.id = kResidualPlot,
         .title = "Photos less their twins, along the radius",
         .subtitle = "what is the same in every photo, without what the charts' places can take",
         .y_label = "displacement",
         .y_unit = "px",
         .series = {
             {.label = told.label, .subject = settings.name, .style = "difference", .curve = account.radial_px}}});
    std::vector<calibration::PlacedResidual> residuals;
    residuals.reserve(points.size());
    for (const calibration::TwinPoint& point : points) {
        residuals.push_back({point.photo_px, point.photo_px - point.twin_px});
    }
    const Vec2d middle{0.5 * (profile.width_px - 1), 0.5 * (profile.height_px - 1)};
    add_residuals(found, subject, residuals,
                  {.width_px = profile.width_px,
                   .height_px = profile.height_px,
                   .centre_px = middle + fitted.camera.axis_from_middle_px},
                  "photo − twin");
    add_worst(subject, std::move(far_points));
    found.subjects.push_back(std::move(subject));
    found.inputs = {formats::find_lens_file(settings.lens)};
    return found;
}

}  // namespace

std::vector<findings::Study> read_twins(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("twins")) {
        TwinSettings twins = read_twins_table(table, file);
        std::string name = twins.name;
        studies.push_back({std::move(name), [twins = std::move(twins)](const findings::RunSettings& settings,
                                                                       const findings::RunProgress& progress,
                                                                       const findings::Findings& before) {
                               Json list = Json::list();
                               findings::Findings found =
                                   twins_of(twins, settings, progress, profile_of(twins, before), list);
                               found.tables.emplace_back("twins", std::move(list));
                               return found;
                           }});
    }
    return studies;
}

}  // namespace lensproof::studies
