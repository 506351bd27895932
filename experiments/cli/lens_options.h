// experiments/cli/lens_options.h — what commands that analyse a lens take on the command line, and the lens as it is
// analysed.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "engine/optics/prescription.h"
#include "experiments/cli/command_line.h"

namespace lensproof::cli {

struct LensOptions {
    std::string lens;
    std::string zoom;
    std::vector<std::string> indices;
    std::vector<std::string> glass_catalogues;
    std::vector<std::string> coatings;
    std::vector<double> wavelengths_nm;
    std::optional<double> reference_wavelength_nm;
    std::vector<double> fields_deg;
    std::string focus;
    std::optional<double> f_number;
    std::optional<double> image_distance_mm;
    int rings = analysis::AnalysisSettings{}.rings;
    std::string best_focus;
    std::optional<double> focus_frequency;
};

/// Adds LENS and the options above; they outlive the program.
void add_lens_options(Command& command, LensOptions& options);

/// A lens with what it is analysed for: zoomed, stopped down, focused, its sensor in place.
struct AnalysedLens {
    optics::Prescription prescription;  // at the zoom position, whose name its own then holds
    optics::Lens lens;
    analysis::AnalysisSettings settings;
};

/// Throws InputError for what cannot be read or used.
AnalysedLens read_analysed_lens(const LensOptions& options);

/// The same from the command line's words: LENS and the options above, as `analyze` takes them.
AnalysedLens read_analysed_lens(const std::vector<std::string>& arguments);

}  // namespace lensproof::cli
