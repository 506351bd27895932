// calibration/detection/numbering.h — how sure it is which of a chart's points is which.
#pragma once
#include <string>

namespace lensproof::calibration {

/// What a picture leaves open. Points keep their places relative to one another; a camera model does not mind, the
/// chart's pose is the turned, or moved, chart's.
enum class Numbering {
    certain,        // markers, or the colours of the squares, say it
    half_turn,      // the chart looks the same after a half turn; rows are taken to run to the right
    quarter_turn,   // and after a quarter turn
    whole_pitches,  // columns or rows are missing, and which cannot be seen: taken for the middle ones
};

/// The key in files: "certain", "half-turn", "quarter-turn" or "whole-pitches".
std::string numbering_key(Numbering numbering);

/// In words, for the account of a picture; empty where it is certain.
std::string numbering_in_words(Numbering numbering);

}  // namespace lensproof::calibration
