// experiments/studies/cameras/measured_camera.h — a camera that was measured, simulated or photographed, as findings.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/measure/measure.h"
#include "calibration/profile/profile.h"
#include "engine/base/toml.h"
#include "engine/formats/image/image.h"
#include "experiments/findings/study.h"
#include "experiments/studies/cameras/closed_loop.h"
#include "experiments/studies/cameras/residual_findings.h"

namespace lensproof::studies {

/// Takes the key `name`, which becomes files' names, and enters it among the file's cameras; refuses one that stands
/// there.
std::string read_camera_name(TomlTable& table, findings::ExperimentFile& file);

/// Takes the key `model`; nothing where the key is missing or "auto": what fits best.
std::optional<calibration::ModelKind> read_model(TomlTable& table);

/// Takes the key `only`, a list of parts; where it is missing all.
calibration::WantedParts read_parts(TomlTable& table);

/// The parts and the model as part of what a step follows from.
Json stated_parts(const calibration::WantedParts& parts);
Json stated_model(const std::optional<calibration::ModelKind>& model);

struct MeasuredCamera {
    findings::Subject subject;  // with facts of its own, and its pictures
    calibration::Profile profile;
    std::optional<calibration::Profile> traced;  // the lens's own rays, for a simulation
    std::vector<FarPoint> far_points{};
    std::vector<calibration::Profile> references{};  // what others say of its lens, each by its name
};

/// The profile that `measure` makes of the input, and its self-test where the settings ask for one: a step each, which
/// follow from `stated`.
calibration::Profile measured_in_steps(const findings::RunSettings& settings, const findings::StepInput& stated,
                                       const calibration::MeasureInput& input,
                                       calibration::Profile (*measure)(const calibration::MeasureInput&));

/// These steps of the camera `name`, before they are asked for.
std::vector<findings::PlannedStep> steps_of_measurement(const std::string& name, const findings::StepInput& stated,
                                                        const findings::RunSettings& settings);

/// What was found in the picture, and why it was left out.
void add_view(findings::Picture& picture, const calibration::ProfileView& view);

/// What the measurement says of itself.
void add_profile_facts(MeasuredCamera& camera);

/// The camera as a subject, in its curves, as a map of its certainty, and as a profile; against its own rays, within
/// `limits`, where it has such.
findings::Findings camera_findings(MeasuredCamera camera, const ClosedLoopLimits& limits = {});

/// Every plot that cameras have in common, in the report's order; those of which this one has no curve are empty. Where
/// the lens was traced: the traced curve beside the measured one, and measured minus traced within `limits`.
std::vector<findings::Plot> camera_plots(const MeasuredCamera& camera, const ClosedLoopLimits& limits);

/// Where in its frame the measurement knows the projection (1 σ, far points), and from which points. The profile has to
/// have a geometry with an uncertainty map.
findings::Map certainty_map(const calibration::Profile& profile, const std::string& label);

/// What the measurement itself gets wrong in that curve, rms; nothing where it is not known.
std::optional<double> rms_floor(const calibration::Profile& profile, const std::string& curve);

}  // namespace lensproof::studies
