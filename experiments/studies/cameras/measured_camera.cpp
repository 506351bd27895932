#include "experiments/studies/cameras/measured_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "calibration/geometry/projection_uncertainty.h"
#include "calibration/self_test/self_test.h"

namespace lensproof::studies {

namespace {

std::vector<calibration::PlacedResidual> residuals_of(const calibration::Profile& profile) {
    std::vector<calibration::PlacedResidual> residuals;
    for (const calibration::ProfileView& view : profile.views) {
        for (const calibration::ProfilePoint& point : view.points) {
            if (point.used) {
                residuals.push_back({point.image_px, point.residual_px});
            }
        }
    }
    return residuals;
}

/// "0.004 px at the best place, at most 0.012 px inside the points' hull (71 % of the frame), 0.3 px in a corner".
std::string in_words(const calibration::Profile& profile) {
    const calibration::UncertaintyMap& map = *profile.geometry->uncertainty;
    double best = std::numeric_limits<double>::infinity();
    double covered = 0.0;
    double anywhere = 0.0;
    std::size_t inside = 0;
    std::size_t imaged = 0;
    for (std::size_t i = 0; i < map.far_px.size(); ++i) {
        inside += map.covered[i] ? 1 : 0;
        if (map.far_px[i]) {
            ++imaged;
            best = std::min(best, *map.far_px[i]);
            anywhere = std::max(anywhere, *map.far_px[i]);
            covered = map.covered[i] ? std::max(covered, *map.far_px[i]) : covered;
        }
    }
    if (imaged == 0) {
        return "nothing in the frame is imaged by the model";
    }
    const auto px = [](double value) {
        return value < 100.0 ? fmt::format("{:.2g} px", value) : fmt::format("{:.0f} px", value);
    };
    return fmt::format(
        "A far point is imaged to {} (1 σ) at the best place, to {} inside the hull of the points "
        "({:.0f} % of the frame), and to {} at the worst place of the frame. {}",
        px(best), px(covered), 100.0 * static_cast<double>(inside) / static_cast<double>(map.covered.size()),
        px(anywhere),
        map.models_px.empty() ? "Noise alone: what the model cannot express is not in it."
                              : "Noise, and how far models that predict the pictures as well differ.");
}

}  // namespace

std::string read_camera_name(TomlTable& table, findings::ExperimentFile& file) {
    std::string name = findings::read_name(table);
    if (!file.cameras.insert(name).second) {
        table.fail("name", "stands in the file twice");
    }
    file.add_subject(table, "name", name);
    return name;
}

std::optional<calibration::ModelKind> read_model(TomlTable& table) {
    if (!table.has("model")) {
        return std::nullopt;
    }
    std::vector<std::string> names = calibration::model_kind_names();
    names.emplace_back("auto");
    return calibration::model_kind(table.choice("model", names));
}

calibration::WantedParts read_parts(TomlTable& table) {
    return table.has("only") ? calibration::parts_named(findings::names_of(table, "only", calibration::known_parts()))
                             : calibration::WantedParts();
}

Json stated_parts(const calibration::WantedParts& parts) {
    return {
        {"vignetting", parts.vignetting}, {"chromatic_shift", parts.chromatic_shift}, {"sharpness", parts.sharpness}};
}

Json stated_model(const std::optional<calibration::ModelKind>& model) {
    return model ? Json(calibration::kind_name(calibration::empty_model(*model))) : Json();
}

static constexpr const char* kMeasuredStep = "measured";
static constexpr const char* kSelfTestStep = "self-test";

std::vector<findings::PlannedStep> steps_of_measurement(const std::string& name, const findings::StepInput& stated,
                                                        const findings::RunSettings& settings) {
    std::vector<findings::PlannedStep> steps = {{kMeasuredStep, name + ", measuring", stated, 3.0}};
    if (settings.self_test) {
        steps.push_back({kSelfTestStep, name + ", self-test", stated, 3.0});
    }
    return steps;
}

calibration::Profile measured_in_steps(const findings::RunSettings& settings, const findings::StepInput& stated,
                                       const calibration::MeasureInput& input,
                                       calibration::Profile (*measure)(const calibration::MeasureInput&)) {
    calibration::Profile profile = settings.steps.step(kMeasuredStep, stated, [&] { return measure(input); });
    if (!settings.self_test) {
        return profile;
    }
    return settings.steps.step(kSelfTestStep, stated, [&] {
        calibration::add_self_test(profile, input);
        return profile;
    });
}

/// "0.1207 px, held out 0.1241 px, corners ± 0.21 px: chosen"
static std::string candidate_words(const calibration::ModelCandidate& tried, bool is_chosen) {
    if (!tried.refused.empty()) {
        return tried.refused;
    }
    return fmt::format("{:.4f} px, held out {:.4f} px{}{}", tried.rms_px, tried.held_out_rms_px,
                       tried.corner_px ? fmt::format(", corners ± {:.2g} px", *tried.corner_px) : "",
                       is_chosen ? ": chosen" : "");
}

void add_view(findings::Picture& picture, const calibration::ProfileView& view) {
    picture.points.emplace();
    for (const calibration::ProfilePoint& point : view.points) {
        picture.points->push_back({point.image_px.x, point.image_px.y, point.residual_px.x, point.residual_px.y});
    }
    if (!view.found) {
        picture.caption += fmt::format(" (left out: {})", view.reason);
    }
}

void add_profile_facts(MeasuredCamera& camera) {
    const calibration::Profile& profile = camera.profile;
    std::vector<findings::Fact>& facts = camera.subject.facts;
    for (const std::string& warning : profile.warnings) {
        facts.push_back({"warning", warning});
    }
    if (profile.geometry) {
        const calibration::ProfileGeometry& geometry = *profile.geometry;
        facts.push_back({"camera model", calibration::kind_name(geometry.model)});
        if (profile.pixel_pitch_um) {
            facts.push_back({"focal length",
                             fmt::format("{:.4f} ± {:.4f} mm",
                                         calibration::focal_length_px(geometry.model) * *profile.pixel_pitch_um / 1e3,
                                         geometry.standard_error(0) * *profile.pixel_pitch_um / 1e3)});
        }
        if (geometry.choice) {
            for (std::size_t i = 0; i < geometry.choice->candidates.size(); ++i) {
                const calibration::ModelCandidate& tried = geometry.choice->candidates[i];
                facts.push_back({"model tried: " + tried.name,
                                 candidate_words(tried, static_cast<int>(i) == geometry.choice->chosen)});
            }
            facts.push_back({"chosen, because", geometry.choice->why});
        }
        facts.push_back({"reprojection rms", fmt::format("{:.4f} px", geometry.reprojection_rms_px)});
        facts.push_back({"points, views", fmt::format("{}, {}", geometry.points_used, geometry.views_used)});
        facts.push_back({"covered image height", fmt::format("{:.3f}", geometry.covered_image_height)});
    }
    if (profile.self_test) {
        facts.push_back({"floor of the measurement", calibration::describe_floor(*profile.self_test)});
    }
    for (const auto& [what, why] : profile.not_measured) {
        facts.push_back({what + " not measured", why});
    }
}

findings::Findings camera_findings(MeasuredCamera camera, const ClosedLoopLimits& limits) {
    findings::Findings found{.counts_checks = true, .subjects_title = findings::kUsualSubjects};
    if (const auto& geometry = camera.profile.geometry) {
        camera.subject.focal_length_px = {calibration::focal_length_px(geometry->model), geometry->standard_error(0)};
        if (geometry->uncertainty) {
            found.maps = {certainty_map(camera.profile, camera.subject.label)};
        }
    }
    found.plots = camera_plots(camera, limits);
    if (const auto& geometry = camera.profile.geometry) {
        add_residuals(found, camera.subject, residuals_of(camera.profile),
                      {.width_px = camera.profile.width_px,
                       .height_px = camera.profile.height_px,
                       .centre_px = calibration::centre_px(geometry->model)},
                      "measured − model");
        add_worst(camera.subject, std::move(camera.far_points));
    }
    found.subjects = {std::move(camera.subject)};
    found.profiles = {std::move(camera.profile)};
    return found;
}

findings::Map certainty_map(const calibration::Profile& profile, const std::string& label) {
    const calibration::UncertaintyMap& knots = *profile.geometry->uncertainty;
    std::vector<Vec2d> points;
    for (const calibration::PlacedResidual& residual : residuals_of(profile)) {
        points.push_back(residual.at_px);
    }
    draw::FrameMap frame{.title = fmt::format("{}, {}", profile.name, label),
                         .heading = "How sure the projection is",
                         .label = "projection uncertainty, 1 σ",
                         .unit = "px",
                         .width_px = profile.width_px,
                         .height_px = profile.height_px,
                         .columns = knots.columns,
                         .rows = knots.rows,
                         .covered = knots.covered,
                         .points = points,
                         .hull = calibration::convex_hull(points)};
    std::ranges::transform(knots.far_px, std::back_inserter(frame.values), [](const std::optional<double>& px) {
        return px.value_or(std::numeric_limits<double>::quiet_NaN());
    });
    return {.name = profile.name + "/certainty.svg",
            .subject = profile.name,
            .caption = in_words(profile),
            .frame = std::move(frame)};
}

std::optional<double> rms_floor(const calibration::Profile& profile, const std::string& curve) {
    const calibration::CurveFloor* floor =
        profile.self_test ? calibration::floor_of(*profile.self_test, curve) : nullptr;
    return floor != nullptr ? std::optional(floor->rms) : std::nullopt;
}

}  // namespace lensproof::studies
