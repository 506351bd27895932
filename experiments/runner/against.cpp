#include "experiments/runner/against.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"

namespace lensproof::runner {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kListed = 200;  // numbers; the others are counted

/// What an element of a list is called.
std::string name_in(const Json& list, std::size_t i) {
    const Json& element = list[i];
    for (const char* key : {"id", "name", "label", "title"}) {
        if (element.is_object() && element[key].is_text()) {
            return element[key].text();
        }
    }
    return fmt::format("{}", i + 1);
}

/// Every number below `json`, by where it stands: "plots[distortion].series[tessar].y[3]".
void collect_numbers(const Json& json, const std::string& where, std::map<std::string, double>& numbers) {
    if (json.is_number()) {
        numbers.emplace(where, json.number());
    }
    for (const auto& [key, value] : json.members()) {
        collect_numbers(value, where.empty() ? key : fmt::format("{}.{}", where, key), numbers);
    }
    for (std::size_t i = 0; i < json.elements().size(); ++i) {
        collect_numbers(json[i], fmt::format("{}[{}]", where, name_in(json, i)), numbers);
    }
}

std::map<std::string, double> numbers_of(const Json& report) {
    Json findings = Json::object();
    const std::set<std::string> besides = {"provenance", "against", "subjects"};
    for (const auto& [key, value] : report.members()) {
        if (!besides.contains(key)) {
            findings[key] = value;
        }
    }
    std::map<std::string, double> numbers;
    collect_numbers(findings, "", numbers);
    return numbers;
}

std::map<std::string, std::string> verdicts_of(const Json& report) {
    std::map<std::string, std::string> verdicts;
    for (const Json& check : report["checks"]) {
        if (check["id"].is_text() && check["verdict"].is_text()) {
            verdicts[check["id"].text()] = check["verdict"].text();
        }
    }
    return verdicts;
}

/// Rows of what is in either and not the same in both: calls differ(name, of `before`, of `now`), nullptr where it is
/// not there.
template <class T, class Differ>
void each_name(const std::map<std::string, T>& before, const std::map<std::string, T>& now, const Differ& differ) {
    for (const auto& [name, value] : before) {
        const auto other = now.find(name);
        differ(name, &value, other == now.end() ? nullptr : &other->second);
    }
    for (const auto& [name, value] : now) {
        if (!before.contains(name)) {
            differ(name, static_cast<const T*>(nullptr), &value);
        }
    }
}

template <class T>
Json or_null(const T* value) {
    return value == nullptr ? Json() : Json(*value);
}

/// Of pixels, over white; nothing for pictures of different sizes, or what cannot be read.
std::optional<double> rms_percent(const fs::path& before, const std::string& now) {
    const fs::path scratch = fs::temp_directory_path() / fmt::format("lensproof-against-{}.png", ::getpid());
    std::optional<double> rms;
    try {
        write_file(scratch, now);
        const formats::Image a = formats::read_image(before);
        const formats::Image b = formats::read_image(scratch);
        if (a.width == b.width && a.height == b.height && a.channels == b.channels) {
            double squares = 0.0;
            for (std::size_t i = 0; i < a.pixels.size(); ++i) {
                squares += std::pow(static_cast<double>(a.pixels[i]) - b.pixels[i], 2.0);
            }
            rms = 100.0 * std::sqrt(squares / static_cast<double>(a.pixels.size()));
        }
    } catch (const InputError&) {  // NOLINT(bugprone-empty-catch): they differ, and by how much is not known
    }
    std::error_code ignored;
    fs::remove(scratch, ignored);
    return rms;
}

/// The names that a report's pictures have.
void picture_names(const Json& json, std::set<std::string>& names) {
    for (const char* key : {"pictures", "layers", "worst"}) {
        for (const Json& picture : json[key]) {
            if (picture["name"].is_text()) {
                names.insert(picture["name"].text());
            }
            picture_names(picture, names);
        }
    }
}

Json compared_pictures(const EarlierReport& earlier, const std::map<std::string, std::string>& pictures) {
    std::set<std::string> before;
    for (const Json& subject : earlier.json["subjects"]) {
        picture_names(subject, before);
    }
    for (const Json& map : earlier.json["maps"]) {
        before.insert(map["name"].is_text() ? map["name"].text() : "");
    }
    Json rows = Json::list();
    const auto add = [&](const std::string& name, const char* change, const std::optional<double>& rms) {
        rows.push_back({{"picture", name}, {"change", change}, {"rms_percent", rms}});
    };
    for (const auto& [name, bytes] : pictures) {
        const fs::path file = earlier.file.parent_path() / "images" / name;
        if (!before.contains(name) || !fs::is_regular_file(file)) {
            add(name, "new", std::nullopt);
        } else if (read_file(file) != bytes) {
            add(name, "changed", name.ends_with(".svg") ? std::nullopt : rms_percent(file, bytes));
        }
    }
    for (const std::string& name : before) {
        if (!name.empty() && !pictures.contains(name)) {
            add(name, "gone", std::nullopt);
        }
    }
    return rows;
}

std::string number_text(const Json& number) {
    return number.is_number() ? fmt::format("{:.6g}", number.number()) : "—";
}

}  // namespace

EarlierReport read_earlier_report(const fs::path& place) {
    EarlierReport earlier{.file = is_folder(place) ? place / "report.json" : place, .json = {}};
    earlier.json = Json::parse(read_file(earlier.file), earlier.file.string());
    if (earlier.json["schema"] != Json("lensproof-report/1")) {
        throw InputError(
            fmt::format("{}: is no report, expected \"schema\": \"lensproof-report/1\"", earlier.file.string()));
    }
    return earlier;
}

Json compared_with(const EarlierReport& earlier, const Json& report,
                   const std::map<std::string, std::string>& pictures) {
    Json verdicts = Json::list();
    each_name(verdicts_of(earlier.json), verdicts_of(report),
              [&](const std::string& check, const std::string* before, const std::string* now) {
                  if (before == nullptr || now == nullptr || *before != *now) {
                      verdicts.push_back({{"check", check}, {"before", or_null(before)}, {"now", or_null(now)}});
                  }
              });
    Json numbers = Json::list();
    std::size_t compared = 0;
    std::size_t changed = 0;
    each_name(numbers_of(earlier.json), numbers_of(report),
              [&](const std::string& number, const double* before, const double* now) {
                  ++compared;
                  if (before != nullptr && now != nullptr && *before == *now) {
                      return;
                  }
                  if (++changed <= kListed) {
                      numbers.push_back({{"number", number}, {"before", or_null(before)}, {"now", or_null(now)}});
                  }
              });
    Json changed_pictures = compared_pictures(earlier, pictures);
    const std::string words =
        fmt::format("{} of {} verdicts, {} of {} numbers and {} of {} pictures changed.", verdicts.size(),
                    report["checks"].size(), changed, compared, changed_pictures.size(), pictures.size());
    return {{"report", earlier.file.string()},
            {"in_words", words},
            {"verdicts", std::move(verdicts)},
            {"numbers", std::move(numbers)},
            {"pictures", std::move(changed_pictures)},
            {"changed_numbers", changed},
            {"compared_numbers", compared}};
}

std::string against_text(const Json& against) {
    std::string text = fmt::format("Against {}: {}\n", against["report"].text(), against["in_words"].text());
    const auto word = [](const Json& verdict) { return verdict.is_text() ? verdict.text() : std::string("—"); };
    for (const Json& row : against["verdicts"]) {
        text += fmt::format("  {:13} → {:13} {}\n", word(row["before"]), word(row["now"]), row["check"].text());
    }
    for (const Json& row : against["numbers"]) {
        text += fmt::format("  {:>13} → {:<13} {}\n", number_text(row["before"]), number_text(row["now"]),
                            row["number"].text());
    }
    const std::size_t unlisted =
        static_cast<std::size_t>(against["changed_numbers"].number()) - against["numbers"].size();
    if (unlisted > 0) {
        text += fmt::format("  and {} numbers more\n", unlisted);
    }
    for (const Json& row : against["pictures"]) {
        text += fmt::format("  {:>13}   {:13} {}\n", row["change"].text(),
                            row["rms_percent"].is_number() ? number_text(row["rms_percent"]) + " % rms" : "",
                            row["picture"].text());
    }
    return text;
}

}  // namespace lensproof::runner
