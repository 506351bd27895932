#include "calibration/detection/numbering.h"

namespace lensproof::calibration {

std::string numbering_key(Numbering numbering) {
    switch (numbering) {
        case Numbering::half_turn:
            return "half-turn";
        case Numbering::quarter_turn:
            return "quarter-turn";
        case Numbering::whole_pitches:
            return "whole-pitches";
        case Numbering::certain:
            break;
    }
    return "certain";
}

std::string numbering_in_words(Numbering numbering) {
    switch (numbering) {
        case Numbering::half_turn:
            return "the chart looks the same after a half turn: its rows are taken to run to the right";
        case Numbering::quarter_turn:
            return "the chart looks the same after a quarter turn: its rows are taken to run to the right";
        case Numbering::whole_pitches:
            return "columns or rows of the chart are missing, and which cannot be seen: its pose may be off by whole "
                   "pitches, and by a half turn";
        case Numbering::certain:
            break;
    }
    return "";
}

}  // namespace lensproof::calibration
