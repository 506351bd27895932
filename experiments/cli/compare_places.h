// experiments/cli/compare_places.h — `compare A B --edge … --spot …`: sharpness and patches of light at the same
// places.
#pragma once
#include <optional>
#include <vector>

#include "calibration/comparison/picture_comparison.h"
#include "calibration/comparison/same_places.h"
#include "experiments/cli/compare_pictures.h"
#include "experiments/findings/findings.h"

namespace lensproof::cli {

struct ComparedPlaces {
    std::optional<calibration::SharpnessComparison> sharpness;
    std::vector<calibration::SpotPair> spots;
};

/// What the options ask for, in the pictures of the files as they are. Throws InputError naming an option's place where
/// it cannot be measured.
ComparedPlaces compare_places(const formats::Image& a, const formats::Image& b,
                              const calibration::PictureComparison& found, const calibration::ClippedFrom& clipped,
                              const PictureOptions& options, const std::string& files);

/// `mtf`: {"channel", "edges", "refused", "mtf50_ratio", "step_cycles_per_px", "a", "b", "difference", "pairs":
/// [{"centre_px", "normal_deg", "mtf50_a", "mtf50_b"}]}; `spots`: [{"box", "a": {…}, "b": {…}, "shift_x_px",
/// "shift_y_px", "diameter_ratio", "light_ev", "colour_ev": {CHANNEL: …}}]. Numbers with errors are {"value",
/// "standard_error"}.
void add_places_json(const ComparedPlaces& places, const formats::Image& picture, Json& json);
void print_places(const ComparedPlaces& places, const formats::Image& picture);

/// For the page: what is told of them, and a drawing of the mean MTFs.
std::vector<findings::Fact> place_facts(const ComparedPlaces& places, const formats::Image& picture);
std::vector<findings::Picture> place_pictures(const ComparedPlaces& places);

Json estimate_json(const calibration::Estimate& estimate);

}  // namespace lensproof::cli
