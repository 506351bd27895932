// experiments/cli/compare_measured.h — `lensproof compare LENS --measured lensfun:"MODEL"`.
#pragma once
#include <optional>
#include <string>

#include "experiments/cli/command.h"

namespace lensproof::cli {

/// What a lens is compared with, and how.
struct MeasuredOptions {
    std::string measured;  // "lensfun:MODEL"
    std::optional<double> crop_factor;
    std::string lensfun_data;
    std::optional<double> wavelength_nm;
};

/// Adds --measured, which it returns, --crop-factor, --lensfun-data and --wavelength; `options` outlive the program.
Option add_measured_options(Command& command, MeasuredOptions& options);

/// Says what the comparison found; the exit status. Throws InputError for a lens or an entry that cannot be had.
int compare_measured(const std::string& lens, const MeasuredOptions& options, const CommonOptions& common);

}  // namespace lensproof::cli
