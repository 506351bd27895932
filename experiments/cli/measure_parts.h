// experiments/cli/measure_parts.h — the parts of the command `measure`.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/photos/photo_survey.h"
#include "calibration/profile/profile.h"
#include "engine/scene/chart/chart.h"
#include "experiments/cli/command.h"

namespace lensproof::cli {

/// The command line as it was given.
struct MeasureOptions {
    CommonOptions common;
    std::vector<std::string> images;
    std::vector<std::string> flat_fields;
    std::string chart;
    std::string model = "auto";
    std::string output;
    std::string lens = calibration::kUnknown;
    std::string camera = calibration::kUnknown;
    std::string kind = "photo";
    std::string transfer;
    double pixel_pitch_um = 0.0;
    double focal_length_mm = 0.0;
    bool fix_centre = false;
    bool no_self_test = false;
    std::vector<std::string> only;   // none: all parts
    std::vector<std::string> edges;  // rectangles, or one "auto"
    bool lines = false;
    std::string directions;  // a CSV table
    std::string plots_folder;
    bool each = false;
    std::vector<double> focus_positions_mm;
    bool fit_board_shape = false;
    std::string aspect = "square";
    std::vector<std::string> bands;
    double reference_band_nm = 550.0;
    std::string mosaic;
    std::vector<double> image_centre_px;
};

/// Folders stand for the pictures in them. Throws InputError for a name that is not there.
std::vector<std::filesystem::path> pictures_named(const std::vector<std::string>& names);

/// The chart of a file that has one. Throws InputError for a kind that is not measured.
scene::Chart chart_to_find(const std::string& file);

/// What the options say of these pictures. `chart`: to be found in them, if they ask for one. Throws InputError for an
/// unusable one.
calibration::MeasureInput measure_input(const MeasureOptions& options, const calibration::ProfileSource& source,
                                        const scene::Chart& chart, const std::string& name,
                                        const std::vector<std::filesystem::path>& pictures);

/// The profile, with the self-test that the options ask for, behind a progress bar.
calibration::Profile measure_pictures(const MeasureOptions& options, calibration::MeasureInput input);

/// `--each`: every picture by itself, and a line for each. Returns the exit status. Throws InputError where none can be
/// measured.
int measure_each(const MeasureOptions& options, const calibration::ProfileSource& source, const scene::Chart& chart,
                 const std::vector<std::filesystem::path>& pictures);

/// `--bands`: one scene in narrow bands.
calibration::Profile run_bands(const MeasureOptions& options, const calibration::ProfileSource& source);

/// Writes into `folder`, which is made where it is missing: a CSV of the edges, for each channel a map of the sharpness
/// over the frame, and each picture with its edges marked; where there are none, says so on standard error.
void write_measure_plots(const std::filesystem::path& folder, const calibration::Profile& profile,
                         const calibration::MeasureInput& input);

/// What `write_measure_plots` writes of straight lines of a scene: the curves of the distortion, and each picture with
/// its lines marked.
void write_line_plots(const std::filesystem::path& folder, const calibration::Profile& profile,
                      const calibration::MeasureInput& input);

/// What straight lines of a scene told, as text on standard output.
void print_lines(const calibration::Profile& profile);

/// The profile as text on standard output.
void print_profile(const calibration::Profile& profile);

}  // namespace lensproof::cli
