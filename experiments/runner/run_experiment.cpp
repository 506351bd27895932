#include "experiments/runner/run_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibration/measure/measure.h"
#include "calibration/photos/photo_survey.h"
#include "calibration/self_test/self_test.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/image/image.h"
#include "engine/formats/image/photo.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/studies/closed_loop.h"
#include "experiments/studies/lens_profile.h"

namespace lensproof::runner {

namespace {

constexpr int kShownWidth = 480;  // px, at most: a report holds many pictures

/// The picture's colours (or grey) alone.
formats::Image colours_only(const formats::Image& image) {
    std::vector<std::string> kept;
    for (const char* name : {"R", "G", "B"}) {
        if (formats::find_channel(image, name) >= 0) {
            kept.emplace_back(name);
        }
    }
    if (kept.empty()) {
        kept = {image.channels.front()};
    }
    formats::Image colours = formats::make_image(image.width, image.height, kept);
    for (int c = 0; c < colours.channel_count(); ++c) {
        const int from = formats::find_channel(image, kept[c]);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                colours.at(x, y, c) = image.at(x, y, from);
            }
        }
    }
    return colours;
}

/// A smaller copy for the report: means of whole blocks of pixels.
formats::Image shrunk(const formats::Image& image) {
    const int factor = std::max(1, (image.width + kShownWidth - 1) / kShownWidth);
    formats::Image small =
        formats::make_image(std::max(1, image.width / factor), std::max(1, image.height / factor), image.channels);
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            for (int c = 0; c < image.channel_count(); ++c) {
                float sum = 0.0F;
                for (int dy = 0; dy < factor; ++dy) {
                    for (int dx = 0; dx < factor; ++dx) {
                        sum += image.at(x * factor + dx, y * factor + dy, c);
                    }
                }
                small.at(x, y, c) = sum / static_cast<float>(factor * factor);
            }
        }
    }
    return small;
}

ShownPicture shown(const std::string& name, const std::string& caption, const formats::Image& image, int view) {
    return {.name = name,
            .caption = caption,
            .width = image.width,
            .height = image.height,
            .png = formats::encode_png(shrunk(image)),
            .view = view};
}

std::string describe(const scene::Placement& placement) {
    std::string text = fmt::format("chart at {:g} m", placement.distance_mm / 1000.0);
    if (placement.towards_right_deg != 0.0 || placement.towards_down_deg != 0.0) {
        text += fmt::format(", {:g}° right and {:g}° down", placement.towards_right_deg, placement.towards_down_deg);
    }
    const auto& tilt = placement.tilt_deg;
    if (tilt[0] != 0.0 || tilt[1] != 0.0 || tilt[2] != 0.0) {
        text += fmt::format(", tilted {:g}°, {:g}°, {:g}°", tilt[0], tilt[1], tilt[2]);
    }
    return text;
}

void add_profile_facts(Subject& subject) {
    const calibration::Profile& profile = subject.profile;
    if (profile.geometry) {
        const calibration::ProfileGeometry& geometry = *profile.geometry;
        subject.facts.push_back({"camera model", calibration::kind_name(geometry.model)});
        if (profile.pixel_pitch_um) {
            subject.facts.push_back(
                {"focal length",
                 fmt::format("{:.4f} ± {:.4f} mm",
                             calibration::focal_length_px(geometry.model) * *profile.pixel_pitch_um / 1e3,
                             geometry.standard_error(0) * *profile.pixel_pitch_um / 1e3)});
        }
        subject.facts.push_back({"reprojection rms", fmt::format("{:.4f} px", geometry.reprojection_rms_px)});
        subject.facts.push_back({"points, views", fmt::format("{}, {}", geometry.points_used, geometry.views_used)});
        subject.facts.push_back({"covered image height", fmt::format("{:.3f}", geometry.covered_image_height)});
    }
    if (profile.self_test) {
        subject.facts.push_back({"floor of the measurement", calibration::describe_floor(*profile.self_test)});
    }
    for (const auto& [what, why] : profile.not_measured) {
        subject.facts.push_back({what + " not measured", why});
    }
}

class SimulationRun {
  public:
    SimulationRun(const Simulation& simulation, const RunSettings& settings, const RunProgress& progress)
        : simulation_(simulation),
          settings_(settings),
          progress_(progress),
          camera_(simulation.scene.camera, simulation.scene.light, simulation.scene.spectral, settings.cache) {}

    Subject run() {
        Subject subject{.name = simulation_.name, .label = camera_.lens().name, .simulated = true};
        std::vector<calibration::Picture> pictures;
        const std::size_t count = simulation_.views.size();
        for (std::size_t i = 0; i < count; ++i) {
            const std::string name = fmt::format("{}/view-{}.png", simulation_.name, i + 1);
            formats::Image image =
                render(simulation_.scene.chart, simulation_.views[i], simulation_.scene.samples_per_pixel,
                       fmt::format("{}, view {} of {}", simulation_.name, i + 1, count));
            subject.pictures.push_back(shown(name, describe(simulation_.views[i]), image, static_cast<int>(i)));
            pictures.push_back({.name = name,
                                .role = calibration::PictureRole::chart,
                                .load = [image = std::move(image)] { return image; }});
        }
        if (simulation_.flat_field) {
            const std::string name = simulation_.name + "/flat-field.png";
            const scene::Chart white{.pattern = scene::FlatField{}};
            formats::Image image = render(white, scene::Placement{.distance_mm = 1000.0},
                                          simulation_.flat_field_samples_per_pixel, simulation_.name + ", flat field");
            subject.pictures.push_back(shown(name, "flat field", image, -1));
            pictures.push_back({.name = name,
                                .role = calibration::PictureRole::flat_field,
                                .load = [image = std::move(image)] { return image; }});
        }
        progress_(simulation_.name + ", measuring", 0.0);
        const calibration::MeasureInput input{
            .name = simulation_.name,
            .pictures = std::move(pictures),
            .chart = simulation_.scene.chart,
            .model = simulation_.model,
            .geometry = {.fit_tangential = false},  // a centred lens
            .source = {.kind = "render", .images = {}, .camera = "simulated", .lens = subject.label},
            .pixel_pitch_um = 1e3 * camera_.sensor().pixel_pitch_mm};
        subject.profile = calibration::measure(input);
        if (settings_.self_test) {
            calibration::add_self_test(subject.profile, input);
        }
        progress_(simulation_.name + ", tracing", 0.0);
        subject.traced = studies::lens_profile(camera_);
        add_facts(subject);
        return subject;
    }

  private:
    formats::Image render(const scene::Chart& chart, const scene::Placement& placement, int samples_per_pixel,
                          const std::string& step) {
        const render::RenderSettings settings{
            .samples_per_pixel = samples_per_pixel,
            .seed = settings_.seed + views_rendered_++,  // views do not share their noise
            .threads = settings_.threads};
        return colours_only(camera_.render(chart, placement, settings, [&](double done) { progress_(step, done); }));
    }

    void add_facts(Subject& subject) const {
        const render::Camera& camera = simulation_.scene.camera;
        const optics::ParaxialData data =
            optics::paraxial_data(optics::at_wavelength<double>(camera_.lens(), spectral::kLineD));
        subject.facts.push_back({"prescription", camera_.lens().source});
        subject.facts.push_back({"effective focal length (d)", fmt::format("{:.4f} mm", data.efl)});
        subject.facts.push_back({"f-number", fmt::format("f/{:g}", camera.f_number)});
        subject.facts.push_back({"focused at", std::isinf(camera.focus_distance_mm)
                                                   ? std::string("infinity")
                                                   : fmt::format("{:g} m", camera.focus_distance_mm / 1e3)});
        subject.facts.push_back({"sensor", fmt::format("{} × {} px of {:g} µm", camera.sensor.width,
                                                       camera.sensor.height, 1e3 * camera.sensor.pixel_pitch_mm)});
        subject.facts.push_back(
            {"sensor response, light", camera.response + ", " + simulation_.scene.light.illuminant});
        add_profile_facts(subject);
        if (!camera_.spectral().clamp_note.empty()) {
            subject.facts.push_back({"note", camera_.spectral().clamp_note});
        }
    }

    const Simulation& simulation_;
    const RunSettings& settings_;
    const RunProgress& progress_;
    render::ChartCamera camera_;
    std::uint64_t views_rendered_ = 0;
};

/// A picture that cannot be read is named and not shown.
ShownPicture shown_photo(const calibration::Picture& picture, const std::string& name, int view) {
    const std::string caption = std::filesystem::path(picture.name).filename().string();
    try {
        return shown(name, caption, picture.load(), view);
    } catch (const InputError&) {
        return {.name = name, .caption = caption, .view = view};
    }
}

/// What was left out and why, what is to be known of the others, and signs of corrections.
void add_account(Subject& subject) {
    const calibration::Profile& profile = subject.profile;
    const auto used =
        std::ranges::count_if(profile.pictures, [](const calibration::PictureAccount& p) { return p.used; });
    subject.facts.push_back({"pictures used", fmt::format("{} of {}", used, profile.pictures.size())});
    int turned = 0;
    for (const calibration::PictureAccount& picture : profile.pictures) {
        turned += picture.orientation != 1 ? 1 : 0;
        if (!picture.used || !picture.reason.empty()) {
            const std::string file = std::filesystem::path(picture.image).filename().string();
            subject.facts.push_back({file + (picture.used ? "" : ", left out"), picture.reason});
        }
    }
    if (turned > 0) {
        subject.facts.push_back(
            {"EXIF orientation", fmt::format("of {} pictures, not applied: the sensor's rows count", turned)});
    }
    for (const std::string& suspicion : profile.source.suspicions) {
        subject.facts.push_back({"correction suspected", suspicion});
    }
}

Subject run_photos(const PhotoSubject& photos, const studies::PhotoSet& set, bool self_test,
                   const RunProgress& progress) {
    Subject subject{.name = photos.name, .label = set.name, .simulated = false};
    calibration::MeasureInput input{.name = photos.name,
                                    .pictures = {},
                                    .chart = set.chart,
                                    .model = photos.model,
                                    .geometry = {},
                                    .source = {.kind = "photo", .images = {}, .camera = set.camera, .lens = set.lens},
                                    .pixel_pitch_um = set.pixel_pitch_um};
    calibration::take_survey(input, calibration::survey_photos(set.photos, set.flat_fields, std::nullopt));
    for (std::size_t i = 0; i < set.focus_positions_mm.size(); ++i) {
        input.focus_position_mm[set.photos[i].string()] = set.focus_positions_mm[i];
    }
    int view = 0;
    for (const calibration::Picture& picture : input.pictures) {
        const std::filesystem::path file = picture.name;
        progress(fmt::format("{}, {}", photos.name, file.filename().string()), 0.0);
        const int own_view = picture.role == calibration::PictureRole::chart ? view++ : -1;
        subject.pictures.push_back(shown_photo(
            picture, fmt::format("{}/{:02}-{}.png", photos.name, subject.pictures.size() + 1, file.stem().string()),
            own_view));
    }
    progress(photos.name + ", measuring", 0.0);
    subject.profile = calibration::measure_surveyed(input);
    if (self_test) {
        calibration::add_self_test(subject.profile, input);
    }
    const calibration::ProfileSource& source = subject.profile.source;
    subject.facts = {{"camera", source.camera}, {"lens", source.lens}, {"licence", set.licence}, {"from", set.source}};
    add_account(subject);
    add_profile_facts(subject);
    return subject;
}

std::vector<Check> photo_checks(const Subject& subject, const PhotoExpectations& expected) {
    std::vector<Check> checks;
    if (!subject.profile.geometry) {
        return checks;
    }
    const calibration::ProfileGeometry& geometry = *subject.profile.geometry;
    const std::optional<calibration::SelfTest>& test = subject.profile.self_test;
    const std::string group = subject.label + ": against independent calibrations";
    if (expected.focal_length_px) {
        checks.push_back({.id = subject.name + "-focal-length",
                          .group = group,
                          .subject = subject.name,
                          .label = "focal length",
                          .value = calibration::focal_length_px(geometry.model),
                          .sigma = geometry.standard_error(0),
                          .unit = "px",
                          .limit = *expected.focal_length_px * expected.focal_length_within_percent / 100.0,
                          .expectation = Expectation::within,
                          .target = *expected.focal_length_px,
                          .explanation = fmt::format("Within {} % of {} px: {}.", expected.focal_length_within_percent,
                                                     *expected.focal_length_px, expected.focal_length_source),
                          .floor = test ? test->focal_length_px : std::nullopt});
    }
    if (expected.reprojection_rms_px) {
        checks.push_back(
            {.id = subject.name + "-reprojection-rms",
             .group = group,
             .subject = subject.name,
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

/// Of a difference of two measurements: both have their own error, and neither knows of the other's.
std::optional<double> floor_of_difference(const Subject& of, const Subject& with, const std::string& curve) {
    const calibration::CurveFloor* one = calibration::floor_of(of.profile.self_test, curve);
    const calibration::CurveFloor* other = calibration::floor_of(with.profile.self_test, curve);
    return one != nullptr && other != nullptr ? std::optional(std::hypot(one->rms, other->rms)) : std::nullopt;
}

const Subject& find_subject(const std::vector<Subject>& subjects, const std::string& name) {
    return *std::ranges::find(subjects, name, &Subject::name);
}

/// What a curve shows, in words.
std::string curve_title(const std::string& curve) {
    if (curve == "radial_px") {
        return "image position";
    }
    std::string title = curve.substr(0, curve.rfind('_'));
    std::ranges::replace(title, '_', ' ');
    return title;
}

ComparisonResult compare_subjects(const Comparison& comparison, const std::vector<Subject>& subjects,
                                  std::vector<Check>& checks) {
    const Subject& of = find_subject(subjects, comparison.of);
    const Subject& with = find_subject(subjects, comparison.with);
    ComparisonResult result{.comparison = comparison,
                            .difference = comparison.curve == "radial_px"
                                              ? calibration::radial_difference_px(of.profile, with.profile)
                                              : calibration::difference(of.profile, with.profile, comparison.curve),
                            .floor = floor_of_difference(of, with, comparison.curve)};
    if (!comparison.limit) {
        return result;
    }
    Check check{
        .id = fmt::format("{}-{}-{}", comparison.of, comparison.with, comparison.curve),
        .group = "Simulated lenses against the photographed one",
        .subject = comparison.of,
        .label = fmt::format("{} against {}: {}, rms", comparison.of, comparison.with, curve_title(comparison.curve)),
        .value = std::nan(""),
        .unit = comparison.curve.ends_with("_percent") ? "%"
                : comparison.curve.ends_with("_ev")    ? "EV"
                                                       : "px",
        .limit = *comparison.limit,
        .expectation = comparison.expectation,
        .explanation = "The curve was not measured in both.",
        .floor = result.floor};
    if (result.difference) {
        check.value = result.difference->rms;
        check.sigma = result.difference->rms_sigma;
        check.explanation =
            fmt::format("Over image heights from 0 to {:.2f} of the half-diagonal, where both are covered. {}",
                        result.difference->curve.covered_image_height,
                        comparison.expectation == Expectation::differs
                            ? "A negative control: these are different lenses, and have to be told apart."
                            : "");
    }
    checks.push_back(check);
    return result;
}

void append(std::vector<Check>& checks, const std::vector<Check>& more) {
    checks.insert(checks.end(), more.begin(), more.end());
}

}  // namespace

ExperimentResult run_experiment(const Experiment& experiment, const RunSettings& settings,
                                const RunProgress& progress) {
    ExperimentResult result;
    result.inputs.push_back(experiment.file);
    if (!experiment.simulations.empty()) {
        std::ranges::copy(formats::shipped_glass_files(), std::back_inserter(result.inputs));
    }
    // Whatever is missing is found before the long part begins.
    std::vector<studies::PhotoSet> sets;
    for (const PhotoSubject& photos : experiment.photos) {
        sets.push_back(studies::read_photo_set(photos.manifest));
    }
    std::vector<SimulationRun> runs;
    for (const Simulation& simulation : experiment.simulations) {
        runs.emplace_back(simulation, settings, progress);
        result.inputs.push_back(formats::find_lens_file(simulation.scene.camera.lens));
    }
    for (std::size_t i = 0; i < runs.size(); ++i) {
        Subject subject = runs[i].run();
        append(result.checks, studies::closed_loop_checks(subject.name, subject.label, subject.profile, *subject.traced,
                                                          experiment.simulations[i].limits));
        result.subjects.push_back(std::move(subject));
    }
    for (std::size_t i = 0; i < sets.size(); ++i) {
        Subject subject = run_photos(experiment.photos[i], sets[i], settings.self_test, progress);
        append(result.checks, photo_checks(subject, experiment.photos[i].expected));
        result.subjects.push_back(std::move(subject));
        result.inputs.push_back(experiment.photos[i].manifest);
        result.inputs.insert(result.inputs.end(), sets[i].photos.begin(), sets[i].photos.end());
        result.inputs.insert(result.inputs.end(), sets[i].flat_fields.begin(), sets[i].flat_fields.end());
    }
    for (const Comparison& comparison : experiment.comparisons) {
        result.comparisons.push_back(compare_subjects(comparison, result.subjects, result.checks));
    }
    return result;
}

}  // namespace lensproof::runner
