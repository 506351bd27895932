// experiments/cli/compare_pictures.h — `lensproof compare A B` of two pictures.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "calibration/comparison/flip.h"
#include "experiments/cli/command.h"

namespace lensproof::cli {

/// What the command takes for pictures. Limits: 0 is none.
struct PictureOptions {
    std::string registration = "auto";
    std::string exposure = "match";
    std::vector<std::string> edges;
    std::vector<std::string> spots;
    std::string maps_folder;
    std::string report_file;
    double pixels_per_degree = calibration::kFlipPixelsPerDegree;
    double rms_limit = 0.0;
    double psnr_limit_db = 0.0;
    double ssim_limit = 0.0;
    double flip_limit = 0.0;
    double ciede2000_limit = 0.0;
    double ciede2000_p99_limit = 0.0;

    /// Whether there is to be something to look at.
    [[nodiscard]] bool is_shown() const { return !maps_folder.empty() || !report_file.empty(); }

    /// Whether anything is to be measured at places of both.
    [[nodiscard]] bool has_places() const { return !edges.empty() || !spots.empty(); }

    /// By the options' names.
    [[nodiscard]] std::vector<std::pair<const char*, double>> limits() const;
};

void add_picture_options(Command& command, PictureOptions& options);

/// Compares the pictures of two files, prints and writes what it finds; returns the exit status.
int compare_pictures(const std::string& a, const std::string& b, const PictureOptions& options,
                     const CommonOptions& common);

}  // namespace lensproof::cli
