#include "experiments/studies/sweeps/sweep_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "experiments/studies/sweeps/sweep_charts.h"

namespace lensproof::studies {

namespace {

constexpr const char* kSweepStep = "sweep-value";
constexpr std::size_t kMostValues = 20'000;

/// The axes that a table states, those that change a lens first and those that it is looked at by last. All but lens
/// are optional.
std::vector<findings::Axis> read_axes(TomlTable& table) {
    std::vector<findings::Axis> axes = {findings::text_axis(table, "lens", formats::read_lens_names(table))};
    for (const char* key : {"zoom", "f_number", "focus_distance_mm", "image_shift_mm", "model", "frequency_per_mm",
                            "field_deg", "wavelength_nm"}) {
        if (table.has(key)) {
            const bool is_text = key == std::string("zoom") || key == std::string("model");
            axes.push_back(is_text ? findings::read_text_axis(table, key) : findings::read_number_axis(table, key));
        }
    }
    return axes;
}

/// All axes that have more than one number, the one with the most first.
std::vector<std::string> numbers_swept(const std::vector<findings::Axis>& axes) {
    std::vector<const findings::Axis*> swept;
    for (const findings::Axis& axis : axes) {
        if (axis.is_swept() && !axis.is_text()) {
            swept.push_back(&axis);
        }
    }
    std::ranges::stable_sort(swept, std::greater{}, &findings::Axis::size);
    std::vector<std::string> keys;
    std::ranges::transform(swept, std::back_inserter(keys), &findings::Axis::key);
    return keys;
}

/// What curves stand for where the file does not say: colours, else the shortest of what is left, of eight at most.
std::string usual_curves(const Sweep& sweep) {
    constexpr std::size_t kMostCurves = 8;
    const findings::Axis* best = nullptr;
    for (const findings::Axis& axis : sweep.axes) {
        if (!axis.is_swept() || axis.key == sweep.over || axis.size() > kMostCurves) {
            continue;
        }
        if (axis.key == "wavelength_nm") {
            return axis.key;
        }
        best = best == nullptr || axis.size() < best->size() ? &axis : best;
    }
    return best == nullptr ? "" : best->key;
}

void read_layout(TomlTable& table, Sweep& sweep) {
    const std::vector<std::string> numbers = numbers_swept(sweep.axes);
    if (numbers.empty()) {
        table.fail("", "sweeps over no number, expected a list or a range in one of its axes");
    }
    sweep.over = table.has("over") ? table.choice("over", numbers) : numbers.front();
    std::vector<std::string> others;
    for (const findings::Axis& axis : sweep.axes) {
        if (axis.is_swept() && axis.key != sweep.over) {
            others.push_back(axis.key);
        }
    }
    sweep.curves = table.has("curves") ? table.choice("curves", others) : usual_curves(sweep);
}

/// The places of the values that a check's `where` names in an axis.
std::vector<std::size_t> places_named(TomlTable& where, const findings::Axis& axis) {
    std::vector<std::size_t> places;
    const auto find = [&](const auto& values, const auto& wanted) {
        for (const auto& one : wanted) {
            const auto found = std::ranges::find(values, one);
            if (found == values.end()) {
                where.fail(axis.key, fmt::format("names {}, expected values of the sweep", one));
            }
            places.push_back(static_cast<std::size_t>(found - values.begin()));
        }
    };
    if (axis.is_text()) {
        find(axis.texts,
             where.is_text(axis.key) ? std::vector<std::string>{where.text(axis.key)} : where.texts(axis.key));
    } else {
        find(axis.numbers,
             where.is_number(axis.key) ? std::vector<double>{where.any_number(axis.key)} : where.any_numbers(axis.key));
    }
    return places;
}

SweepCheck read_check(TomlTable& table, const Sweep& sweep) {
    SweepCheck check{.quantity = table.choice("measure", sweep.quantities), .bound = {}, .where = {}, .where_text = {}};
    check.bound = findings::read_bound(table);
    if (std::optional<TomlTable> where = table.optional_table("where")) {
        for (const findings::Axis& axis : sweep.axes) {
            if (where->has(axis.key)) {
                check.where[axis.key] = places_named(*where, axis);
                std::vector<std::string> labels;
                for (const std::size_t place : check.where[axis.key]) {
                    labels.push_back(axis.label(place));
                }
                check.where_text += fmt::format("{}{}", check.where_text.empty() ? "" : ", ", fmt::join(labels, " / "));
            }
        }
        where->finish();
    }
    table.finish();
    return check;
}

bool is_where(const Sweep& sweep, const SweepCheck& check, std::size_t i) {
    const std::vector<std::size_t> place = findings::place_of(sweep.axes, i);
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        const auto wanted = check.where.find(sweep.axes[a].key);
        if (wanted != check.where.end() && std::ranges::count(wanted->second, place[a]) == 0) {
            return false;
        }
    }
    return true;
}

/// How bad a value is, the larger the worse; what does not exist is the worst.
double badness(const findings::Bound& bound, const std::optional<double>& value) {
    if (!value) {
        return std::numeric_limits<double>::infinity();
    }
    switch (bound.expectation) {
        case findings::Expectation::at_least:
            return -*value;
        case findings::Expectation::within:
            return std::abs(*value - bound.target);
        default:
            return *value;
    }
}

std::string combination_text(const Sweep& sweep, std::size_t i) {
    const std::vector<std::size_t> place = findings::place_of(sweep.axes, i);
    std::vector<std::string> labels;
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        labels.push_back(sweep.axes[a].label(place[a]));
    }
    return fmt::format("{}", fmt::join(labels, ", "));
}

std::string quantity_text(const SweepQuantity& quantity) {
    return fmt::format("{}{}{}", quantity.family, *quantity.label == '\0' ? "" : ", ", quantity.label);
}

findings::StepInput input_of(const Sweep& sweep, std::size_t i) {
    const std::vector<std::size_t> place = findings::place_of(sweep.axes, i);
    Json at = Json::object();
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        at[sweep.axes[a].key] = sweep.axes[a].json(place[a]);
    }
    return {.settings = {{"at", std::move(at)}, {"quantities", sweep.quantities}},
            .files = formats::files_of_lens(sweep_setting(sweep.axes, i).lens)};
}

SweepValue value_of(const Sweep& sweep, std::size_t i, SweptLens& lens, const findings::Steps& steps) {
    return steps.step(kSweepStep, input_of(sweep, i),
                      [&] { return lens.measure(sweep_setting(sweep.axes, i), sweep.quantities); });
}

/// Lenses that no step uses at the moment: one that is done next to another mostly wants it as that had it.
class IdleLenses {
  public:
    SweptLens take() {
        const std::scoped_lock lock(mutex_);
        SweptLens lens;
        if (!lenses_.empty()) {
            lens = std::move(lenses_.back());
            lenses_.pop_back();
        }
        return lens;
    }

    void give_back(SweptLens lens) {
        const std::scoped_lock lock(mutex_);
        lenses_.push_back(std::move(lens));
    }

  private:
    std::mutex mutex_;
    std::vector<SweptLens> lenses_;
};

std::vector<findings::PlannedStep> steps_of(const Sweep& sweep) {
    std::vector<findings::PlannedStep> steps;
    const auto lenses = std::make_shared<IdleLenses>();
    for (std::size_t i = 0; i < findings::combinations(sweep.axes); ++i) {
        constexpr double kUsualSeconds = 0.05;
        const auto carry_out = [&sweep, lenses, i](const findings::RunSettings& settings,
                                                   const findings::RunProgress&) {
            SweptLens lens = lenses->take();
            value_of(sweep, i, lens, settings.steps);
            lenses->give_back(std::move(lens));
        };
        steps.push_back({kSweepStep, combination_text(sweep, i), input_of(sweep, i), kUsualSeconds, carry_out});
    }
    return steps;
}

/// "0.12 … 0.95, the least at tessar, f/4, 20°"
std::string range_text(const Sweep& sweep, const std::vector<SweepValue>& values, const std::string& quantity) {
    std::optional<std::size_t> least;
    std::optional<std::size_t> most;
    std::size_t missing = 0;
    const auto at = [&](std::size_t i) { return *values[i].quantities.at(quantity); };
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!values[i].quantities.at(quantity)) {
            ++missing;
            continue;
        }
        least = !least || at(i) < at(*least) ? i : *least;
        most = !most || at(i) > at(*most) ? i : *most;
    }
    if (!least) {
        return "no value";
    }
    const std::string unit = sweep_quantity(quantity).unit;
    return fmt::format("{:.4g} ({}) … {:.4g} ({}){}{}{}", at(*least), combination_text(sweep, *least), at(*most),
                       combination_text(sweep, *most), unit.empty() ? "" : " ", unit,
                       missing == 0 ? "" : fmt::format("; {} of {} do not exist", missing, values.size()));
}

Json swept_json(const Sweep& sweep, const std::vector<SweepValue>& values) {
    Json json{{"name", sweep.name}, {"over", sweep.over}, {"curves", sweep.curves}, {"quantities", sweep.quantities}};
    for (const findings::Axis& axis : sweep.axes) {
        Json list = Json::list();
        for (std::size_t i = 0; i < axis.size(); ++i) {
            list.push_back(axis.json(i));
        }
        json["axes"].push_back({{"axis", axis.key}, {"values", std::move(list)}});
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::vector<std::size_t> place = findings::place_of(sweep.axes, i);
        Json row = Json::object();
        for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
            row[sweep.axes[a].key] = sweep.axes[a].json(place[a]);
        }
        for (const std::string& quantity : sweep.quantities) {
            row[quantity] = values[i].quantities.at(quantity);
        }
        json["values"].push_back(std::move(row));
    }
    return json;
}

}  // namespace

Sweep read_sweep(TomlTable& table, findings::ExperimentFile& file) {
    Sweep sweep{.name = findings::read_name(table), .title = {}, .axes = {}, .quantities = {}, .checks = {}};
    sweep.title = table.text_or("title", sweep.name);
    file.add_subject(table, "name", sweep.name);
    sweep.axes = read_axes(table);
    for (const findings::Axis& axis : sweep.axes) {
        if (axis.key == "model") {
            for (const std::string& model : axis.texts) {
                if (std::ranges::find(mtf_models(), model) == mtf_models().end()) {
                    table.fail("model",
                               fmt::format("names \"{}\", expected one of {}", model, fmt::join(mtf_models(), ", ")));
                }
            }
        }
        if (axis.key == "lens") {
            std::ranges::for_each(axis.texts, formats::find_lens_file);
        }
    }
    sweep.quantities = findings::names_of(table, "measure", sweep_quantity_keys());
    if (sweep.quantities.empty()) {
        table.fail("measure",
                   fmt::format("names nothing, expected some of {}", fmt::join(sweep_quantity_keys(), ", ")));
    }
    const bool has_mtf =
        std::ranges::any_of(sweep.quantities, [](const std::string& key) { return sweep_quantity(key).is_mtf; });
    if (has_mtf && findings::axis_named(sweep.axes, "frequency_per_mm") == nullptr) {
        table.fail("measure", "has an MTF, expected frequency_per_mm beside it");
    }
    if (const std::size_t count = findings::combinations(sweep.axes); count > kMostValues) {
        table.fail("", fmt::format("has {} values, expected {} at most", count, kMostValues));
    }
    read_layout(table, sweep);
    for (TomlTable& check : table.tables("checks")) {
        sweep.checks.push_back(read_check(check, sweep));
    }
    table.finish();
    return sweep;
}

std::vector<SweepValue> measure_sweep(const Sweep& sweep, const findings::RunSettings& settings,
                                      const findings::RunProgress& progress) {
    const std::size_t count = findings::combinations(sweep.axes);
    std::vector<SweepValue> values(count);
    parallel_for_workers(
        static_cast<int>(count), settings.threads,
        [&] {
            return [&, lens = SweptLens()](int at) mutable {
                const auto i = static_cast<std::size_t>(at);
                values[i] = value_of(sweep, i, lens, settings.steps);
            };
        },
        [&](int done) { progress(sweep.title, static_cast<double>(done) / static_cast<double>(count)); });
    if (std::ranges::none_of(values, &std::string::empty, &SweepValue::refused)) {
        throw InputError(fmt::format("sweep \"{}\": {}", sweep.name, values.front().refused));
    }
    return values;
}

std::vector<findings::Check> sweep_checks(const Sweep& sweep, const std::vector<SweepValue>& values) {
    std::vector<findings::Check> checks;
    for (const SweepCheck& check : sweep.checks) {
        std::optional<std::size_t> worst;
        std::size_t count = 0;
        const auto of = [&](std::size_t i) { return values[i].quantities.at(check.quantity); };
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (is_where(sweep, check, i)) {
                ++count;
                worst = !worst || badness(check.bound, of(i)) > badness(check.bound, of(*worst)) ? i : *worst;
            }
        }
        findings::Check& made = checks.emplace_back();
        made.id = fmt::format("{}-{}", sweep.name, checks.size());
        made.group = sweep.title;
        made.subject = sweep.name;
        made.label =
            quantity_text(sweep_quantity(check.quantity)) + (check.where_text.empty() ? "" : ": " + check.where_text);
        made.value = of(worst.value()).value_or(std::numeric_limits<double>::quiet_NaN());
        made.unit = sweep_quantity(check.quantity).unit;
        made.limit = check.bound.limit;
        made.expectation = check.bound.expectation;
        made.target = check.bound.target;
        made.explanation = fmt::format("The worst of {}: {}.", count, combination_text(sweep, *worst));
    }
    return checks;
}

findings::Findings sweep_findings(const Sweep& sweep, const std::vector<SweepValue>& values) {
    findings::Findings found{
        .checks = sweep_checks(sweep, values),
        .subjects_title = "Sweeps",
        .not_shown = {"Values are those of the prescription as it is stated, without tolerances of "
                      "manufacture, at the wavelengths and fields that were asked for."}};
    findings::Subject& subject = found.subjects.emplace_back();
    subject.id = sweep.name;
    subject.kind = "sweep";
    subject.label = sweep.title;
    for (const std::string& quantity : sweep.quantities) {
        subject.facts.push_back({quantity_text(sweep_quantity(quantity)), range_text(sweep, values, quantity)});
    }
    std::set<std::string> refused;
    for (const SweepValue& value : values) {
        if (!value.refused.empty() && refused.insert(value.refused).second) {
            subject.facts.push_back({"not measured", value.refused});
        }
    }
    subject.pictures = sweep_charts(sweep, values);
    found.tables = {{"swept", Json::list({swept_json(sweep, values)})}};
    for (const std::string& lens : findings::axis_named(sweep.axes, "lens")->texts) {
        std::ranges::move(formats::files_of_lens(lens), std::back_inserter(found.inputs));
    }
    return found;
}

std::vector<findings::Study> read_sweeps(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("sweeps")) {
        const Sweep sweep = read_sweep(table, file);
        const auto carry_out = [sweep](const findings::RunSettings& settings, const findings::RunProgress& progress,
                                       const findings::Findings&) {
            return sweep_findings(sweep, measure_sweep(sweep, settings, progress));
        };
        studies.push_back({sweep.name, carry_out, [sweep](const findings::RunSettings&) { return steps_of(sweep); }});
    }
    return studies;
}

}  // namespace lensproof::studies
