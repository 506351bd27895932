#include "experiments/studies/cameras/photos.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibration/photos/photo_survey.h"
#include "engine/base/confined.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "experiments/findings/shown_picture.h"
#include "experiments/studies/cameras/measured_camera.h"
#include "experiments/studies/cameras/photo_set.h"
#include "experiments/studies/cameras/reference_curves.h"

namespace lensproof::studies {

namespace {

/// What is known about a photographed camera from elsewhere.
struct PhotoExpectations {
    std::optional<double> focal_length_px;
    double focal_length_within_percent = 0.0;
    std::string focal_length_source;
    std::optional<double> reprojection_rms_px;
};

struct Photos {
    std::string name;
    std::filesystem::path manifest;
    PhotoSet set;
    std::optional<calibration::ModelKind> model;
    calibration::WantedParts parts;
    PhotoExpectations expected;
    std::vector<ReferenceSource> references;
};

Photos read_photos_table(TomlTable& table, findings::ExperimentFile& file) {
    Photos photos;
    photos.name = read_camera_name(table, file);
    photos.manifest = referred_file(table.file(), table.text("manifest"));
    photos.model = read_model(table);
    photos.parts = read_parts(table);
    photos.references = read_references(table);
    if (auto expected = table.optional_table("expected")) {
        if (expected->has("focal_length_px")) {
            photos.expected.focal_length_px = expected->number("focal_length_px", kPositive);
            photos.expected.focal_length_within_percent = expected->number("focal_length_within_percent", kPositive);
            photos.expected.focal_length_source = expected->text("focal_length_source");
        }
        photos.expected.reprojection_rms_px = expected->optional_number("reprojection_rms_px", kPositive);
        expected->finish();
    }
    table.finish();
    photos.set = read_photo_set(photos.manifest);
    file.manifests[photos.name] = photos.manifest;
    return photos;
}

/// A photo as a report shows it; one that cannot be read is named and not shown.
struct ShownPhoto {
    int width = 0;
    int height = 0;
    std::string jpeg;
};

void fields(JsonArchive& json, ShownPhoto& photo) {
    json.field("width", photo.width).field("height", photo.height).packed("jpeg", photo.jpeg);
}

/// That of each of so many photos, which together have twelve megapixels for a report to stay small.
int shown_width(std::size_t photos) {
    constexpr double kPixels = 12e6;
    constexpr double kAspect = 1.5;
    return std::max(
        findings::kShownWidth,
        static_cast<int>(std::sqrt(kAspect * kPixels / static_cast<double>(std::max<std::size_t>(1, photos)))));
}

ShownPhoto shown_photo(const calibration::Picture& picture, int widest) {
    try {
        const formats::Image image = picture.load();
        return {.width = image.width,
                .height = image.height,
                .jpeg = findings::shown_picture(".jpg", "", image, widest).bytes};
    } catch (const InputError&) {
        return {};
    }
}

/// What was left out and why, what is to be known of the others, and signs of corrections.
void add_account(MeasuredCamera& camera) {
    const calibration::Profile& profile = camera.profile;
    std::vector<findings::Fact>& facts = camera.subject.facts;
    const auto used =
        std::ranges::count_if(profile.pictures, [](const calibration::PictureAccount& p) { return p.used; });
    facts.push_back({"pictures used", fmt::format("{} of {}", used, profile.pictures.size())});
    int turned = 0;
    for (const calibration::PictureAccount& picture : profile.pictures) {
        turned += picture.orientation != 1 ? 1 : 0;
        if (!picture.used || !picture.reason.empty()) {
            const std::string file = std::filesystem::path(picture.image).filename().string();
            facts.push_back({file + (picture.used ? "" : ", left out"), picture.reason});
        }
    }
    if (turned > 0) {
        facts.push_back(
            {"EXIF orientation", fmt::format("of {} pictures, not applied: the sensor's rows count", turned)});
    }
    for (const std::string& suspicion : profile.source.suspicions) {
        facts.push_back({"correction suspected", suspicion});
    }
}

constexpr const char* kPhotoStep = "photo";
constexpr const char* kFarPointsStep = "far points";

/// What decides beside its bytes whether a picture is read.
Json reading() {
    return {{"largest_picture_mib", formats::largest_picture_mib()}, {"untrusted", files_are_distrusted()}};
}

/// Reads the photos' headers.
calibration::MeasureInput surveyed(const Photos& photos, const findings::RunSettings& settings) {
    const PhotoSet& set = photos.set;
    calibration::MeasureInput input{.name = photos.name,
                                    .pictures = {},
                                    .chart = set.chart,
                                    .model = photos.model,
                                    .geometry = {},
                                    .source = {.kind = "photo", .images = {}, .camera = set.camera, .lens = set.lens},
                                    .pixel_pitch_um = set.pixel_pitch_um,
                                    .parts = photos.parts,
                                    .threads = settings.threads};
    const std::vector<std::filesystem::path> none;
    calibration::take_survey(
        input, calibration::survey_photos(set.photos, photos.parts.vignetting ? set.flat_fields : none, std::nullopt));
    for (std::size_t i = 0; i < set.focus_positions_mm.size(); ++i) {
        input.focus_position_mm[set.photos[i].string()] = set.focus_positions_mm[i];
    }
    return input;
}

findings::StepInput photo_input(const calibration::Picture& picture, int widest) {
    Json settings = reading();
    settings["widest"] = widest;
    return {.settings = std::move(settings), .files = {picture.name}};
}

/// Of all that is measured in the pictures.
findings::StepInput measured_input(const Photos& photos, const calibration::MeasureInput& input) {
    findings::StepInput all{.settings = {{"name", photos.name},
                                         {"model", stated_model(photos.model)},
                                         {"only", stated_parts(photos.parts)},
                                         {"reading", reading()}},
                            .files = {photos.manifest}};
    for (const calibration::Picture& picture : input.pictures) {
        all.settings["pictures"].push_back(picture.name);
        all.files.emplace_back(picture.name);
    }
    return all;
}

std::string words_of(const Photos& photos, const calibration::Picture& picture) {
    return fmt::format("{}, {}", photos.name, std::filesystem::path(picture.name).filename().string());
}

std::vector<findings::PlannedStep> steps_of(const Photos& photos, const findings::RunSettings& settings) {
    const calibration::MeasureInput input = surveyed(photos, settings);
    std::vector<findings::PlannedStep> steps;
    const int widest = shown_width(input.pictures.size());
    for (const calibration::Picture& picture : input.pictures) {
        steps.push_back({kPhotoStep, words_of(photos, picture), photo_input(picture, widest), 0.2});
    }
    const findings::StepInput all = measured_input(photos, input);
    std::ranges::move(steps_of_measurement(photos.name, all, settings), std::back_inserter(steps));
    steps.push_back({kFarPointsStep, photos.name + ", points that are far off", all, 0.2});
    return steps;
}

/// As the camera noted it; 0 where it did not.
double f_number_of(const calibration::Profile& profile) {
    const auto& notes = profile.source.notes;
    return notes && notes->f_number ? *notes->f_number : 0.0;
}

MeasuredCamera measure_photos(const Photos& photos, const findings::RunSettings& settings,
                              const findings::RunProgress& progress) {
    const PhotoSet& set = photos.set;
    MeasuredCamera camera{
        .subject = {.id = photos.name, .kind = "photos", .label = set.name}, .profile = {}, .traced = {}};
    std::vector<findings::Picture>& pictures = camera.subject.pictures;
    const calibration::MeasureInput input = surveyed(photos, settings);
    const int widest = shown_width(input.pictures.size());
    for (const calibration::Picture& picture : input.pictures) {
        const std::filesystem::path file = picture.name;
        progress(words_of(photos, picture), 0.0);
        const ShownPhoto shown =
            settings.steps.step(kPhotoStep, photo_input(picture, widest), [&] { return shown_photo(picture, widest); });
        pictures.push_back(
            {.name = fmt::format("{}/{:02}-{}.jpg", photos.name, pictures.size() + 1, file.stem().string()),
             .caption = file.filename().string(),
             .width = shown.width,
             .height = shown.height,
             .bytes = shown.jpeg});
    }
    progress(photos.name + ", measuring", 0.0);
    const findings::StepInput all = measured_input(photos, input);
    camera.profile = measured_in_steps(settings, all, input, calibration::measure_surveyed);
    add_references(photos.references, camera, f_number_of(camera.profile));
    camera.far_points =
        settings.steps.step(kFarPointsStep, all, [&] { return far_points(camera.profile, input.pictures); });
    for (std::size_t i = 0, view = 0; i < pictures.size(); ++i) {
        if (input.pictures[i].role == calibration::PictureRole::chart) {
            add_view(pictures[i], camera.profile.views.at(view++));
        }
    }
    const calibration::ProfileSource& source = camera.profile.source;
    camera.subject.facts = {
        {"camera", source.camera}, {"lens", source.lens}, {"licence", set.licence}, {"from", set.source}};
    add_account(camera);
    add_profile_facts(camera);
    return camera;
}

std::vector<findings::Check> photo_checks(const MeasuredCamera& camera, const PhotoExpectations& expected) {
    const findings::Subject& subject = camera.subject;
    const calibration::Profile& profile = camera.profile;
    std::vector<findings::Check> checks;
    if (!profile.geometry) {
        return checks;
    }
    const calibration::ProfileGeometry& geometry = *profile.geometry;
    const std::optional<calibration::SelfTest>& test = profile.self_test;
    const std::string group = subject.label + ": against independent calibrations";
    if (expected.focal_length_px) {
        checks.push_back({.id = subject.id + "-focal-length",
                          .group = group,
                          .subject = subject.id,
                          .label = "focal length",
                          .value = calibration::focal_length_px(geometry.model),
                          .sigma = geometry.standard_error(0),
                          .unit = "px",
                          .limit = *expected.focal_length_px * expected.focal_length_within_percent / 100.0,
                          .expectation = findings::Expectation::within,
                          .target = *expected.focal_length_px,
                          .explanation = fmt::format("Within {} % of {} px: {}.", expected.focal_length_within_percent,
                                                     *expected.focal_length_px, expected.focal_length_source),
                          .floor = test ? test->focal_length_px : std::nullopt});
    }
    if (expected.reprojection_rms_px) {
        checks.push_back(
            {.id = subject.id + "-reprojection-rms",
             .group = group,
             .subject = subject.id,
             .label = "reprojection error, rms",
             .value = geometry.reprojection_rms_px,
             // An rms of 2N residuals is known to 1 / √(4N) of itself.
             .sigma = geometry.reprojection_rms_px / std::sqrt(4.0 * geometry.points_used),
             .unit = "px",
             .limit = *expected.reprojection_rms_px,
             .explanation = fmt::format("Over {} corners in {} photos.", geometry.points_used, geometry.views_used),
             .floor = test ? test->reprojection_rms_px : std::nullopt});
    }
    return checks;
}

}  // namespace

std::vector<findings::Study> read_photos(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("photos")) {
        const Photos photos = read_photos_table(table, file);
        const auto carry_out = [photos](const findings::RunSettings& settings, const findings::RunProgress& progress,
                                        const findings::Findings&) {
            MeasuredCamera camera = measure_photos(photos, settings, progress);
            findings::Findings found{.checks = photo_checks(camera, photos.expected)};
            findings::append(found, camera_findings(std::move(camera)));
            found.not_shown = {
                "Photos show one copy of a lens at one focus, aperture and temperature.",
                "The chart is taken to be flat and as large as stated; a bent or misprinted one goes into the lens's "
                "numbers, as far as their residuals do not show it.",
                "Beyond the outermost points nothing was measured: curves there are the model's, faded and hatched."};
            found.inputs.push_back(photos.manifest);
            std::ranges::move(files_of(photos.references), std::back_inserter(found.inputs));
            std::ranges::copy(photos.set.photos, std::back_inserter(found.inputs));
            std::ranges::copy(photos.set.flat_fields, std::back_inserter(found.inputs));
            return found;
        };
        studies.push_back({photos.name, carry_out,
                           [photos](const findings::RunSettings& settings) { return steps_of(photos, settings); }});
    }
    return studies;
}

}  // namespace lensproof::studies
