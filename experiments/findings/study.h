// experiments/findings/study.h — what a study is: a table of an experiment's file, carried out to findings.
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "engine/base/cache.h"
#include "engine/base/toml.h"
#include "engine/device/shared_device.h"
#include "experiments/findings/findings.h"
#include "experiments/findings/steps.h"

namespace lensproof::findings {

/// How finely a run looks. A draft is to be looked at in minutes: pictures of scenes have half the width and the height
/// and a sixteenth of the samples of each pixel, but one at least. What is measured without a picture is the same.
enum class Quality { full, draft };
inline constexpr int kDraftShrinks = 2;
inline constexpr int kDraftSamplesOver = 16;

struct RunSettings {
    std::uint64_t seed = 0;
    Quality quality = Quality::full;
    int threads = 0;                                 // 0: as many as the machine has
    Cache cache{};                                   // for what is found by tracing lenses
    std::shared_ptr<device::SharedDevice> device{};  // that traces rays for pictures, or null
    bool self_test = true;  // each measurement says its own floor (calibration/self_test/self_test.h)
    Steps steps{};          // what takes long is done as one of these
};

/// Carries a study out. The same settings give the same findings, whatever the number of threads; `before` are those of
/// the studies that stand before it in the list (experiments/runner/experiment.cpp).
using CarryOut =
    std::function<Findings(const RunSettings& settings, const RunProgress& progress, const Findings& before)>;

/// What is asked of one table of an experiment's file.
struct Study {
    std::string name;  // `run --only NAME`; another kind's may have the same
    CarryOut carry_out;
    /// Its steps, in their order, as far as they are known before any of them is finished; empty: none is.
    std::function<std::vector<PlannedStep>(const RunSettings& settings)> steps{};
};

/// An experiment's file while its studies read it.
struct ExperimentFile {
    TomlTable top;
    std::set<std::string> cameras{};                           // those that are to be measured, for others to refer to
    std::map<std::string, std::filesystem::path> manifests{};  // of those that were photographed
    std::set<std::string> subjects{};  // the ids of what will be reported, as far as the file says them

    /// The tables of a kind, where `vary` makes many of one each of them (varied.h); one by itself, [key], is one.
    std::vector<TomlTable> tables(const std::string& key);
    /// Takes an id that `key` makes: files are named by it, and curves and checks refer to it. Throws InputError where
    /// another table has it.
    void add_subject(const TomlTable& table, const std::string& key, const std::string& id);
};

/// Takes the tables of a kind from the file: a study of each; none where there are none. Throws InputError naming file,
/// line and key, and where something that a study needs is missing.
using StudyReader = std::vector<Study> (*)(ExperimentFile& file);

/// The table's `name`, of letters, digits, - and _: files are called by it.
std::string read_name(TomlTable& table);

/// The same where a study is of the program itself, so that one is enough and needs no name: `kind` then.
std::string name_or(TomlTable& table, const std::string& kind);

/// What such a study found, told apart from another's by its name, unless that is its kind's: ids of checks, subjects
/// and rows, and pictures' files, begin with it, labels and groups have it.
Findings told_apart(Findings found, const std::string& name, const std::string& kind);

/// What a number is held to, as a table states it by at_most, at_least or between = [low, high].
struct Bound {
    Expectation expectation = Expectation::at_most;
    double limit = 0.0;
    double target = 0.0;
};

/// The table's; `bounds` are those of the numbers themselves.
Bound read_bound(TomlTable& table, const Bounds& bounds = kAnyNumber);

/// The names that the table lists under `key`, each of which is among `known`; none where it has no such key.
std::vector<std::string> names_of(TomlTable& table, const std::string& key, const std::vector<std::string>& known);

/// Whether a list asks for this one; an empty list asks for all.
template <class T>
bool is_wanted(const std::vector<T>& wanted, const T& one) {
    return wanted.empty() || std::ranges::find(wanted, one) != wanted.end();
}

}  // namespace lensproof::findings
