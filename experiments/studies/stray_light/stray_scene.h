// experiments/studies/stray_light/stray_scene.h — a scene of which stray light is looked at, as an experiment's file
// states it.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/render/scene_setup.h"
#include "experiments/findings/study.h"
#include "experiments/findings/varied.h"
#include "experiments/studies/stray_light/measured_chart.h"

namespace lensproof::studies {

/// The scene with something in it changed.
struct StrayVariant {
    std::string name;
    std::string label;
    render::SceneSetup setup;
    std::string stated;              // the whole scene, as both files state it
    std::vector<findings::Axis> at;  // what `vary` sets, each with one value
};

/// Those that the variant's scene names, the lens's too.
std::vector<std::filesystem::path> files_of(const StrayVariant& variant);

/// What a ratio of two lights is held to: of a pass's light, or of the ghosts that a surface has to do with.
struct StrayCheck {
    enum class Of { pass, ghosts_of_surface, ghosts_beside_surface };
    Of what = Of::pass;
    std::string pass;       // a pass, or kPicture
    std::string over_pass;  // likewise
    int surface = 0;        // from 1
    std::string variant;
    std::string over_variant;
    findings::Bound bound;
};

inline constexpr const char* kPicture = "picture";  // all passes together

/// One of the tables [[stray_light]] (experiments/README.md).
struct StrayScene {
    std::string name;
    std::string title;
    std::filesystem::path file;  // the scene's
    std::vector<std::string> passes;
    std::map<std::string, std::string> paths;      // of a pass that goes straight: its integrator; none: "camera"
    render::PixelFilter stray_filter;              // of passes that do not go straight
    std::map<std::string, int> samples_per_pixel;  // of a pass, in place of the scene's
    std::map<std::string, double> brightening_ev;  // of a pass's picture
    std::vector<StrayVariant> variants;
    int columns = 0;                   // of the variants side by side
    std::vector<double> crop;          // left, top, right, bottom of what is shown, fractions of the frame; empty: all
    std::optional<double> ghosts_deg;  // the field angle of a distant light whose ghosts are listed
    bool has_veiling_glare = false;
    bool has_audit = false;
    std::optional<MeasuredChart> chart;  // of which features are measured in the pictures
    bool has_streaks = false;            // are measured, of each variant's blades
    int growth_samples = 0;  // a pixel and pass, up to which the picture is watched as it grows; 0: it is not
    std::optional<double> noise_percent;  // of white, as it is printed, at most
    std::vector<StrayCheck> checks;
};

/// Throws InputError naming file, line and key, of the scene's file where it is that one's.
StrayScene read_stray_scene(TomlTable& table, findings::ExperimentFile& file);

}  // namespace lensproof::studies
