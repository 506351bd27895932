// experiments/runner/against.h — what changed since an earlier report.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "engine/base/json.h"

namespace lensproof::runner {

/// An earlier report as it was written: its JSON, and its pictures beside it.
struct EarlierReport {
    std::filesystem::path file;
    Json json;
};

/// `place`: report.json, or the folder that it lies in. Throws InputError for what is no report.
EarlierReport read_earlier_report(const std::filesystem::path& place);

/// Verdict by verdict, number by number, picture by picture, as the report's JSON has it under "against"
/// (experiments/draw/report/report.h). Things of one name are compared: elements of lists by their id, name or label,
/// where they have one, else by their place. `pictures`: the report's, by their names; those that differ in a byte and
/// are PNGs of one size also by the rms of their pixels' difference, over white.
///
/// To be called before the report is written, which may take the earlier one's place.
Json compared_with(const EarlierReport& earlier, const Json& report,
                   const std::map<std::string, std::string>& pictures);

/// The same as a table for people.
std::string against_text(const Json& against);

}  // namespace lensproof::runner
