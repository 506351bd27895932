// experiments/cli/compare_report.h — what a comparison found, held against its limits, in words and as JSON.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "experiments/cli/command.h"
#include "experiments/findings/verdict.h"

namespace lensproof::cli {

/// One number of a comparison: a difference that is to stay below a limit.
struct ComparedRow {
    findings::Check check;
    bool limited = false;
    std::string key_suffix;  // of JSON keys of numbers in the check's unit
};

/// Puts the rows into `json` as `differences`, with verdicts where there are limits, and prints them. Returns the exit
/// status. A row without a finite number is left out; throws InputError, naming `a` and `b`, where it has a limit.
int report_rows(const std::vector<ComparedRow>& rows, const std::string& a, const std::string& b,
                const CommonOptions& common, Json& json);

}  // namespace lensproof::cli
