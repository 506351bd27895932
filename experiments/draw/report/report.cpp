#include "experiments/draw/report/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/base/markup.h"
#include "experiments/draw/report/check_scale.h"
#include "experiments/draw/report/curves.h"
#include "experiments/draw/report/html_text.h"

namespace lensproof::draw {
namespace {
constexpr char kTemplate[] = {
#include "report_template.inc"
};

// ---- Verdicts and checks ---------------------------------------------------------------------------------------

std::string verdict_html(const Json& object) {
    const std::string kind = verdict_class(object);
    const std::string word = text(object, "verdict");
    return "<span class=\"verdict " + kind + "\"><svg viewBox=\"0 0 16 16\" aria-hidden=\"true\"><use href=\"#mark-" +
           kind + "\"></use></svg>" + (word.empty() ? "INCONCLUSIVE" : word) + "</span>";
}

/// "12 of 14 checks pass, 1 fails, 1 is inconclusive."
std::string tally(const std::vector<const Json*>& checks) {
    std::size_t pass = 0;
    std::size_t fail = 0;
    for (const Json* check : checks) {
        const std::string kind = verdict_class(*check);
        pass += kind == "pass";
        fail += kind == "fail";
    }
    const std::size_t open = checks.size() - pass - fail;
    std::string out = std::to_string(pass) + " of " + std::to_string(checks.size()) + " pass";
    if (fail > 0) out += ", " + std::to_string(fail) + (fail == 1 ? " fails" : " fail");
    if (open > 0) out += ", " + std::to_string(open) + (open == 1 ? " is inconclusive" : " are inconclusive");
    return out;
}

std::string limit_html(const Json& check) {
    const auto limit = as_number(check["limit"]);
    if (!limit) return "—";
    const std::string unit = text(check, "unit");
    const std::string amount = with_unit(number_text(*limit), unit);
    const auto target = as_number(check["target"]);
    const std::string expect = as_text(check["expect"]);
    if (expect == "at most") return "≤\u00a0" + amount;
    if (expect == "at least") return "≥\u00a0" + amount;
    const std::string from =
        target ? " " + std::string(expect == "within" ? "of " : "from ") + with_unit(number_text(*target), unit) : "";
    if (expect == "within") return "within " + amount + (target ? from : " of 0");
    if (expect == "differs") return "differs by &gt;\u00a0" + amount + from;
    return escape_markup(expect) + " " + amount;
}

struct Group {
    std::string name;
    std::vector<const Json*> checks;
};

/// In the order in which a group is first named.
std::vector<Group> groups_of(const Json::List& checks) {
    std::vector<Group> groups;
    std::map<std::string, std::size_t> place_of;
    for (const Json& check : checks) {
        const std::string name = as_text(check["group"]);
        const auto [at, is_new] = place_of.try_emplace(name, groups.size());
        if (is_new) groups.push_back({name, {}});
        groups[at->second].checks.push_back(&check);
    }
    return groups;
}

std::string floor_cell(const Json& check) {
    const auto floor = as_number(check["floor"]);
    return "<td class=\"floor\">" + (floor ? with_unit(floor_text(*floor), text(check, "unit")) : "—") + "</td>";
}

/// `has_floors`: the table has the column.
std::string check_row(const Json& check, bool has_floors) {
    const double value = as_number(check["value"]).value_or(kNaN);
    const std::string measured = measurement_text(value, as_number(check["sigma"]));
    const std::string why = text(check, "explanation");
    const std::string kind = verdict_class(check);
    const bool hides_why = kind == "pass" && !why.empty();  // until the row has the focus
    return "<tr class=\"check " + kind + (hides_why ? "\" tabindex=\"0" : "") +
           "\"><th scope=\"row\"><span class=\"name\">" + text(check, "label") + "</span>" +
           (why.empty() ? "" : "<span class=\"why\">" + why + "</span>") + "</th><td class=\"value\">" +
           with_unit(measured, std::isfinite(value) ? text(check, "unit") : "") + "</td>" +
           (has_floors ? floor_cell(check) : "") + "<td class=\"scale\">" + check_scale_html(check) +
           "</td><td class=\"limit\">" + limit_html(check) + "</td><td class=\"result\">" + verdict_html(check) +
           "</td></tr>\n";
}

std::string checks_html(const Json& report) {
    const Json::List& checks = report["checks"].elements();
    if (checks.empty()) return "<p class=\"empty\">This report holds no checks.</p>\n";
    const bool has_floors = std::any_of(checks.begin(), checks.end(),
                                        [](const Json& check) { return as_number(check["floor"]).has_value(); });
    std::string out =
        "<table class=\"checks\"><caption class=\"unseen\">Every check, its result and its limit</caption>\n"
        "<thead><tr><th scope=\"col\">Check</th><th scope=\"col\">Measured, ± 1 σ</th>" +
        std::string(has_floors ? "<th scope=\"col\">Method’s own error</th>" : "") +
        "<th scope=\"col\" class=\"scale\">Against its limit</th>"
        "<th scope=\"col\">Limit</th><th scope=\"col\">Verdict</th></tr></thead>\n";
    for (const Group& group : groups_of(checks)) {
        const auto colour = subject_colour(report, (*group.checks.front())["subject"]);
        out += "<tbody><tr class=\"group\"><th scope=\"rowgroup\" colspan=\"" + std::string(has_floors ? "6" : "5") +
               "\">";
        if (colour) out += "<i class=\"swatch s" + std::to_string(*colour) + "\" aria-hidden=\"true\"></i>";
        out += escape_markup(group.name.empty() ? "Checks" : group.name) + " <small>" + tally(group.checks) +
               "</small></th></tr>\n";
        for (const Json* check : group.checks) out += check_row(*check, has_floors);
        out += "</tbody>\n";
    }
    return out +
           "</table>\n<p class=\"note\">Shaded: where the check holds. Heavy line: its limit. Whisker: the value's 95 "
           "% "
           "interval. Arrow: beyond the scale. " +
           (has_floors ? "Bar below: the method's own error, from measuring simulated pictures of the same views; a "
                         "difference inside it may be the method's. "
                       : "") +
           "</p>\n";
}

std::string tally_html(const Json& report) {
    std::vector<const Json*> checks;
    for (const Json& check : report["checks"]) checks.push_back(&check);
    return checks.empty() ? "" : "<p class=\"tally\">Of the checks, " + tally(checks) + ".</p>";
}

// ---- Subjects --------------------------------------------------------------------------------------------------

std::string fact_row(const std::string& label, const std::string& value) {
    return "<tr><th scope=\"row\">" + label + "</th><td>" + value + "</td></tr>\n";
}

std::string facts_html(const Json& subject) {
    std::string rows;
    for (const Json& fact : subject["facts"]) rows += fact_row(text(fact, "label"), text(fact, "value"));
    const Json& focal_length = subject["focal_length_px"];
    if (const auto value = as_number(focal_length["value"])) {
        rows += fact_row("Focal length, fitted",
                         with_unit(measurement_text(*value, as_number(focal_length["sigma"])), "px"));
    }
    return rows.empty() ? "" : "<table class=\"facts\"><tbody>\n" + rows + "</tbody></table>\n";
}

using Files = std::map<std::string, std::string>;

/// `alt`: of the picture.
std::string image_html(const Json& named, const std::string& alt, const Files& files) {
    const std::string name = as_text(named["name"]);
    const auto file = files.find(name);
    if (file == files.end()) return "<p class=\"missing\">not in this report: " + escape_markup(name) + "</p>";
    const char* type = name.ends_with(".svg") ? "svg+xml" : name.ends_with(".jpg") ? "jpeg" : "png";
    return "<img alt=\"" + (alt.empty() ? escape_markup(name) : alt) + "\" src=\"data:image/" + type + ";base64," +
           base64(file->second) + "\">";
}

/// Without a script they stand side by side; the script lays them over each other.
std::string layers_html(const Json& picture, const Files& files) {
    const auto layer = [&](const Json& named, const std::string& kind) {
        const std::string label = text(named, "label");
        return "<div class=\"layer\" data-kind=\"" + kind + "\">" +
               image_html(named, text(picture, "caption") + ": " + label, files) + "<span>" + label + "</span></div>";
    };
    std::string out = layer(picture, "picture");
    for (const Json& more : picture["layers"]) {
        out += layer(more, as_text(more["kind"]) == "difference" ? "difference" : "picture");
    }
    return out;
}

std::string picture_html(const Json& picture, const std::string& id, const Files& files) {
    const std::string caption = text(picture, "caption");
    const bool is_layered = !picture["layers"].elements().empty();
    return std::string("<figure class=\"picture") + (is_layered ? " layered" : "") + "\"" +
           (id.empty() ? "" : " id=\"" + id + "\"") + "><div class=\"stage\">" +
           (is_layered ? layers_html(picture, files) : image_html(picture, caption, files)) +
           "</div><figcaption><span class=\"caption\">" + caption + "</span></figcaption></figure>\n";
}

/// Where the measurements are sure, beside the curves that say how sure they are along the radius.
std::string maps_html(const Json& report, const Files& files) {
    std::string out;
    const Json::List& maps = report["maps"].elements();
    for (std::size_t i = 0; i < maps.size(); ++i) {
        out += picture_html(maps[i], "map-" + std::to_string(i), files);
    }
    return out.empty() ? "" : "<h3 class=\"maps-title\">Over the frame</h3>\n<div class=\"maps\">\n" + out + "</div>\n";
}

std::string subject_html(const Json& subject, std::size_t place, const Files& files) {
    const std::string number = std::to_string(place);
    std::string out = "<section class=\"subject s" + std::to_string(place % kSubjectColours) + "\" id=\"subject-" +
                      number + "\"><h3><i class=\"swatch\" aria-hidden=\"true\"></i>" + text(subject, "label") +
                      " <small>" + text(subject, "kind") + "</small></h3>\n" + facts_html(subject);
    const Json::List& pictures = subject["pictures"].elements();
    if (!pictures.empty()) out += "<div class=\"pictures\">\n";
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        out += picture_html(pictures[k], "picture-" + number + "-" + std::to_string(k), files);
    }
    if (!pictures.empty()) out += "</div>\n";
    const Json::List& worst = subject["worst"].elements();
    if (!worst.empty())
        out += "<div class=\"worst\"><h4>The points that are furthest off</h4>\n<div class=\"crops\">\n";
    for (const Json& crop : worst) out += picture_html(crop, "", files);
    return out + (worst.empty() ? "</section>\n" : "</div></div></section>\n");
}

/// A line for each check that is one of the subjects'.
std::string chapter_checks_html(const Json& report, const std::set<std::string>& subjects) {
    std::string out;
    for (const Json& check : report["checks"]) {
        if (!subjects.contains(as_text(check["subject"]))) continue;
        const double value = as_number(check["value"]).value_or(kNaN);
        out += "<li>" + verdict_html(check) + " " + text(check, "label") + ": " +
               with_unit(measurement_text(value, as_number(check["sigma"])),
                         std::isfinite(value) ? text(check, "unit") : "") +
               " <small>" + limit_html(check) + "</small></li>\n";
    }
    return out.empty() ? "" : "<ul class=\"held\">\n" + out + "</ul>\n";
}

std::string subjects_html(const Json& report, const Files& files) {
    const Json::List& subjects = report["subjects"].elements();
    if (subjects.empty()) return "<p class=\"empty\">This report shows no lens and no photo.</p>\n";
    std::string out;
    std::set<std::string> shown;
    for (const Json& chapter : report["chapters"]) {
        std::set<std::string> own;
        std::string within;
        for (const Json& id : chapter["subjects"]) {
            const auto at = std::find_if(subjects.begin(), subjects.end(),
                                         [&](const Json& subject) { return as_text(subject["id"]) == as_text(id); });
            if (at == subjects.end() || !shown.insert(as_text(id)).second) continue;
            own.insert(as_text(id));
            within += subject_html(*at, static_cast<std::size_t>(at - subjects.begin()), files);
        }
        if (own.empty()) continue;
        out += "<header class=\"chapter\"><h2>" + text(chapter, "title") + "</h2><p>" + text(chapter, "text") + "</p>" +
               chapter_checks_html(report, own) + "</header>\n" + within;
    }
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        const std::string id = as_text(subjects[i]["id"]);
        if (id.empty() || !shown.contains(id)) out += subject_html(subjects[i], i, files);
    }
    return out;
}

// ---- Provenance ------------------------------------------------------------------------------------------------

/// The columns are the first entry's keys.
std::string table_html(const Json& rows) {
    std::string out = "<table class=\"list\"><thead><tr>";
    for (const auto& [key, value] : rows[0].members()) out += "<th scope=\"col\">" + escape_markup(key) + "</th>";
    out += "</tr></thead><tbody>\n";
    for (const Json& row : rows) {
        out += "<tr>";
        for (const auto& [key, value] : rows[0].members()) out += "<td>" + text(row, key.c_str()) + "</td>";
        out += "</tr>\n";
    }
    return out + "</tbody></table>";
}

std::string joined(const Json& values, const char* separator) {
    std::string out;
    for (const Json& value : values) out += (out.empty() ? "" : separator) + escape_markup(as_text(value));
    return out;
}

/// A row for each setting: {"render": {"samples": 64}} is "render.samples 64".
std::string settings_rows(const Json& object, const std::string& prefix) {
    std::string out;
    for (const auto& [key, value] : object.members()) {
        const std::string name = prefix + key;
        if (value.is_object()) {
            out += settings_rows(value, name + ".");
        } else {
            out += fact_row(escape_markup(name), value.is_list() ? joined(value, ", ") : escape_markup(as_text(value)));
        }
    }
    return out;
}

std::string value_html(const Json& value) {
    if (value.is_object()) return "<table class=\"list\"><tbody>\n" + settings_rows(value, "") + "</tbody></table>";
    if (!value.is_list()) return escape_markup(as_text(value));
    if (!value.empty() && value[0].is_object()) return table_html(value);
    return joined(value, "<br>");
}

std::string provenance_html(const Json& report) {
    const Json& provenance = report["provenance"];
    if (!provenance.is_object() || provenance.empty()) {
        return "<p class=\"empty\">This report does not say where it comes from.</p>\n";
    }
    std::string out = "<dl class=\"provenance\">\n";
    for (const auto& [key, value] : provenance.members()) {
        std::string label = key;
        for (char& c : label) c = c == '_' ? ' ' : c;
        out += "<dt>" + escape_markup(label) + "</dt><dd>" + value_html(value) + "</dd>\n";
    }
    return out + "</dl>\n";
}

std::string reproduce_html(const Json& report) {
    const std::string command = text(report, "reproduce");
    if (command.empty()) return "<p class=\"empty\">This report names no command.</p>";
    return "<div class=\"command\"><pre><code id=\"command\">" + command + "</code></pre></div>";
}

// ---- Failures, and what changed ---------------------------------------------------------------------------------

std::string failures_html(const Json& report) {
    std::string rows;
    for (const Json& failure : report["failures"]) {
        rows += fact_row(text(failure, "study"), text(failure, "message"));
    }
    return rows.empty()
               ? ""
               : "<h3>Studies that came to no end</h3>\n<table class=\"facts\"><tbody>\n" + rows + "</tbody></table>\n";
}

std::string not_shown_html(const Json& report) {
    std::string items;
    for (const Json& sentence : report["not_shown"]) {
        items += "<li>" + escape_markup(as_text(sentence)) + "</li>\n";
    }
    return items.empty()
               ? ""
               : "<section id=\"not-shown\" aria-labelledby=\"h-not-shown\"><h2 id=\"h-not-shown\">What this does "
                 "not show</h2>\n<ul>\n" +
                     items + "</ul></section>\n";
}

std::string against_html(const Json& report) {
    const Json& against = report["against"];
    if (!against.is_object()) return "";
    std::string out = "<h3>Against " + text(against, "report") + "</h3>\n<p>" + text(against, "in_words") + "</p>\n";
    for (const char* key : {"verdicts", "numbers", "pictures"}) {
        if (!against[key].empty()) out += table_html(against[key]) + "\n";
    }
    return out;
}

// ---- The page --------------------------------------------------------------------------------------------------

/// Fills each {{name}} in one pass, so that a filled-in text is never looked at again. Unknown names stay.
std::string fill(std::string_view page, const std::map<std::string, std::string, std::less<>>& parts) {
    std::string out;
    while (true) {
        const std::size_t open = page.find("{{");
        const std::size_t close = open == page.npos ? page.npos : page.find("}}", open);
        if (close == page.npos) return out.append(page);
        out.append(page.substr(0, open));
        const auto part = parts.find(page.substr(open + 2, close - open - 2));
        out.append(part == parts.end() ? page.substr(open, close + 2 - open) : std::string_view(part->second));
        page.remove_prefix(close + 2);
    }
}

}  // namespace

std::string report_html(const Json& report, const std::map<std::string, std::string>& files) {
    const std::string title = text(report, "title");
    const std::string subjects = text(report, "subjects_title");
    // A report without the key has no curves to draw; one with none in its list says so.
    const char* curves_hidden = report.is_object() && report.contains("plots") ? "" : "hidden";
    return fill({kTemplate, sizeof kTemplate}, {{"title", title.empty() ? "lensproof report" : title},
                                                {"summary", text(report, "summary")},
                                                {"curves_hidden", curves_hidden},
                                                {"subjects_title", subjects.empty() ? "Renders and photos" : subjects},
                                                {"verdict", verdict_html(report)},
                                                {"tally", tally_html(report)},
                                                {"checks", checks_html(report)},
                                                {"failures", failures_html(report)},
                                                {"against", against_html(report)},
                                                {"curves", curves_html(report)},
                                                {"maps", maps_html(report, files)},
                                                {"subjects", subjects_html(report, files)},
                                                {"not_shown", not_shown_html(report)},
                                                {"provenance", provenance_html(report)},
                                                {"reproduce", reproduce_html(report)},
                                                {"data", json_for_script(report)}});
}

}  // namespace lensproof::draw
