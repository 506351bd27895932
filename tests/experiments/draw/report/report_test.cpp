// tests/experiments/draw/report/report_test.cpp — the report page: nothing in a report can become markup, and it stands
// without script.
#include "experiments/draw/report/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/base/infinity.h"
#include "engine/base/json.h"
#include "engine/base/markup.h"
#include "experiments/draw/report/html_text.h"

namespace lensproof::draw::report_test {
constexpr char kAttack[] = "</script><img src=x onerror=alert(1)>\"'&{{data}}";

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) ++n;
    return n;
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != text.npos;
}

std::string embedded_json(const std::string& page) {
    const std::string open = "<script type=\"application/json\" id=\"report\">";
    const std::size_t from = page.find(open) + open.size();
    return page.substr(from, page.find("</script>", from) - from);
}

Json parsed(const std::string& text) {
    return Json::parse(text, "report");
}

Json one_check(const Json& other) {
    Json check = {{"id", "distortion"}, {"group", "Tessar"},       {"label", "distortion, rms"},
                  {"value", 0.0421},    {"sigma", 0.0031},         {"unit", "px"},
                  {"limit", 0.1},       {"expect", "at most"},     {"target", nullptr},
                  {"verdict", "PASS"},  {"explanation", "because"}};
    for (const auto& [key, value] : other.members()) check[key] = value;
    return {{"schema", "lensproof-report/1"}, {"title", "T"}, {"verdict", "PASS"}, {"checks", {check}}};
}

// RFC 4648, section 10.
TEST(HtmlText, Base64GivesTheRfcsVectors) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foob"), "Zm9vYg==");
    EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64(std::string("\xff\xef\x00", 3)), "/+8A");  // section 4's alphabet, bytes above 127, and zero
}

TEST(HtmlText, EscapesWhatMeansSomethingToHtml) {
    EXPECT_EQ(escape_markup("<a href=\"x\" id='y'>&amp;"), "&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;amp;");
}

TEST(HtmlText, JsonInAScriptReadsBackTheSame) {
    const Json json = {{kAttack, kAttack}, {"comment", "<!--<script>"}, {"separator", "\u2028"}};
    const std::string text = json_for_script(json);
    EXPECT_EQ(text.find_first_of("<>&"), text.npos);
    EXPECT_EQ(parsed(text), json);
}

TEST(HtmlText, JsonTakesBadBytesAndNaN) {
    const Json json = {{"bytes", "\xff\xfe"}, {"number", kNaN}};
    EXPECT_EQ(parsed(json_for_script(json)), (Json{{"bytes", "\ufffd\ufffd"}, {"number", nullptr}}));
}

// The convention of the GUM, 7.2.6: two digits of the uncertainty, the value to the same place.
TEST(HtmlText, UncertaintySetsTheDigits) {
    EXPECT_EQ(measurement_text(0.04214, 0.00312), "0.0421 ± 0.0031");
    EXPECT_EQ(measurement_text(-3.14159, 0.0996), "\u22123.14 ± 0.10");
    EXPECT_EQ(measurement_text(2381.44, 12.3), "2381 ± 12");
    EXPECT_EQ(measurement_text(-0.0001, 0.01), "0.000 ± 0.010");
    EXPECT_EQ(measurement_text(5.0, std::nullopt), "5");
    EXPECT_EQ(measurement_text(5.0, 0.0), "5");
    EXPECT_EQ(measurement_text(5.0, std::nan("")), "5");
    EXPECT_EQ(measurement_text(std::nan(""), 0.1), "—");
    EXPECT_EQ(number_text(-1.5), "\u22121.5");
    EXPECT_EQ(number_text(-0.0), "0");
    EXPECT_EQ(number_text(0.1), "0.1");
}

TEST(Report, HostileTextStaysText) {
    const Json report = {{"title", kAttack},
                         {"summary", kAttack},
                         {"verdict", kAttack},
                         {"reproduce", kAttack},
                         {"checks",
                          {{{"id", kAttack},
                            {"group", kAttack},
                            {"label", kAttack},
                            {"value", 1},
                            {"unit", kAttack},
                            {"limit", 2},
                            {"expect", kAttack},
                            {"verdict", kAttack},
                            {"explanation", kAttack}}}},
                         {"subjects",
                          {{{"id", kAttack},
                            {"kind", kAttack},
                            {"label", kAttack},
                            {"facts", {{{"label", kAttack}, {"value", kAttack}}}},
                            {"pictures",
                             {{{"name", "missing" + std::string(kAttack)}, {"caption", kAttack}},
                              {{"name", kAttack}, {"caption", kAttack}}}}}}},
                         {"plots",
                          {{{"title", kAttack},
                            {"id", kAttack},
                            {"subtitle", kAttack},
                            {"x_label", kAttack},
                            {"y_label", kAttack},
                            {"x_unit", kAttack},
                            {"y_unit", kAttack},
                            {"limit", 1.0},
                            {"series",
                             {{{"label", kAttack},
                               {"subject", kAttack},
                               {"style", kAttack},
                               {"x", Json::list({0, 1, 2})},
                               {"y", Json::list({0, 1, 2})},
                               {"lower", Json::list({0, 0.5, 1})},
                               {"upper", Json::list({0.5, 1.5, 3})},
                               {"covered_to", 1.0},
                               {"floor", 0.1}}}}}}},
                         {"provenance",
                          {{kAttack, kAttack},
                           {"inputs", {{{"file", kAttack}, {kAttack, kAttack}}}},
                           {"settings", {{kAttack, {{kAttack, kAttack}}}}}}}};
    const std::string page = report_html(report, {{kAttack, "PNG"}});
    const std::string blank = report_html(Json::object(), {});
    EXPECT_FALSE(has(page, "<img src=x"));
    EXPECT_EQ(count(page, "</script>"), count(blank, "</script>"));
    EXPECT_EQ(count(page, "<script"), count(blank, "<script"));
    EXPECT_EQ(count(page, "<img "), 1u);  // the one picture that is there
    EXPECT_EQ(parsed(embedded_json(page)), report);
}

TEST(Report, PicturesTravelInside) {
    const Json report = {
        {"subjects",
         {{{"id", "a"},
           {"pictures", {{{"name", "a/1.png"}, {"caption", "one"}}, {{"name", "a/2.png"}, {"caption", "two"}}}}}}}};
    const std::string page = report_html(report, {{"a/1.png", "foobar"}, {"unused.png", "fooba"}});
    EXPECT_TRUE(has(page, "src=\"data:image/png;base64,Zm9vYmFy\""));
    EXPECT_FALSE(has(page, "Zm9vYmE="));
    EXPECT_TRUE(has(page, "not in this report: a/2.png"));
}

TEST(Report, LayersStandBesideTheirPicture) {
    const Json report = {{"subjects",
                          {{{"id", "a"},
                            {"pictures",
                             {{{"name", "a/1.jpg"},
                               {"caption", "one"},
                               {"label", "photo"},
                               {"layers",
                                {{{"name", "a/1-twin.png"}, {"label", "twin"}, {"kind", "picture"}},
                                 {{"name", "a/gone.png"}, {"label", "difference"}, {"kind", "difference"}}}}}}}}}}};
    const std::string page = report_html(report, {{"a/1.jpg", "foobar"}, {"a/1-twin.png", "foob"}});
    const auto photo = page.find(
        "<div class=\"layer\" data-kind=\"picture\"><img alt=\"one: photo\" "
        "src=\"data:image/jpeg;base64,Zm9vYmFy\"><span>photo</span>");
    const auto twin = page.find(
        "<div class=\"layer\" data-kind=\"picture\"><img alt=\"one: twin\" "
        "src=\"data:image/png;base64,Zm9vYg==\"><span>twin</span>");
    const auto difference = page.find("<div class=\"layer\" data-kind=\"difference\"><p class=\"missing\">");
    EXPECT_LT(photo, twin);
    EXPECT_LT(twin, difference);
    EXPECT_NE(difference, page.npos);
}

TEST(Report, ThePointsThatAreFurthestOffStandBelowThePictures) {
    const Json report = {
        {"subjects",
         {{{"id", "a"},
           {"pictures", {{{"name", "a/1.png"}, {"caption", "one"}}}},
           {"worst", {{{"name", "a/worst-01.svg"}, {"caption", "0.7 px"}}, {{"name", "a/worst-02.svg"}}}}}}}};
    const std::string page = report_html(report, {{"a/1.png", "foobar"}, {"a/worst-01.svg", "foob"}});
    const auto picture = page.find("id=\"picture-0-0\"");
    const auto worst = page.find("alt=\"0.7 px\" src=\"data:image/svg+xml;base64,Zm9vYg==\"");
    EXPECT_LT(picture, worst);
    EXPECT_NE(worst, page.npos);
    EXPECT_TRUE(has(page, "not in this report: a/worst-02.svg"));
}

TEST(Report, TheTableOfChecksNeedsNoScript) {
    const std::string page = report_html(one_check(Json::object()), {});
    EXPECT_TRUE(has(page, "<th scope=\"row\"><span class=\"name\">distortion, rms</span><span class=\"why\">because"));
    EXPECT_TRUE(has(page, "<td class=\"value\">0.0421 ± 0.0031\u00a0px</td>"));
    EXPECT_TRUE(has(page, "<td class=\"limit\">≤\u00a00.1\u00a0px</td>"));
    EXPECT_TRUE(has(page, "</svg>PASS</span></td></tr>"));
    EXPECT_TRUE(has(page, "1 of 1 pass"));
}

TEST(Report, TheCurvesNeedNoScript) {
    const Json plot = {{"id", "shift"},
                       {"title", "Shift"},
                       {"y_label", "difference"},
                       {"y_unit", "px"},
                       {"limit", 0.5},
                       {"series",
                        {{{"label", "lens"},
                          {"subject", "b"},
                          {"x", Json::list({0, 1, 2, 3, 4})},
                          {"y", Json::list({0, 0.1, nullptr, 0.3, 0.5})},
                          {"lower", Json::list({-0.1, 0, nullptr, 0.2, 0.4})},
                          {"upper", Json::list({0.1, 0.2, nullptr, 0.4, 0.6})},
                          {"floor", 0.01},
                          {"covered_to", 3.5}}}}};
    const std::string page = report_html({{"subjects", {{{"id", "a"}}, {{"id", "b"}}}}, {"plots", {plot}}}, {});
    const std::string chart = page.substr(page.find("<svg class=\"data\""));
    EXPECT_EQ(count(page, "<svg class=\"data\""), 2u);  // for a wide and a narrow column
    EXPECT_TRUE(has(chart, "<g class=\"series-0\">"));
    EXPECT_TRUE(has(chart, "stroke=\"var(--c1)\""));  // the second subject's
    EXPECT_TRUE(has(chart, "class=\"hatch\""));
    EXPECT_TRUE(has(page, "limit ±0.5\u00a0px"));
    EXPECT_TRUE(has(page, "data to 3.5"));
    EXPECT_TRUE(has(page, "<th scope=\"row\">1</th><td>0.10 ± 0.10</td>"));
    for (const char* x : {"1.5", "2", "2.5"}) {  // the gap
        EXPECT_TRUE(has(page, "<th scope=\"row\">" + std::string(x) + "</th><td>—</td>")) << x;
    }
    EXPECT_TRUE(has(page, "<th scope=\"row\">4</th><td>0.50 ± 0.10 (extrapolated)</td>"));
}

// Whatever the numbers are, the drawing's own are numbers.
TEST(Report, CurvesOfAnyNumbersAreDrawings) {
    const auto plot = [](const Json& x, const Json& y, const Json& limit) -> Json {
        return {{"limit", limit}, {"series", {{{"x", x}, {"y", y}, {"covered_to", 0.5}, {"floor", limit}}}}};
    };
    const Json one_to_three = Json::list({1, 2, 3});
    const Json nothing = Json::list({nullptr, nullptr, nullptr});
    const Json huge = Json::list({-1e300, 0, 1e300});
    const Json plots =
        Json::list({Json{{"series", Json::list()}}, plot(one_to_three, nothing, nullptr), plot(nothing, nothing, 1.0),
                    plot(one_to_three, huge, 1e308), plot(huge, one_to_three, 1e-308)});
    const std::string page = report_html({{"plots", plots}}, {});
    EXPECT_EQ(count(page, "<figure class=\"plot\""), plots.size());
    for (const std::string attribute : {"data-view=\"", "data-frame=\"", " d=\"", " points=\""}) {
        for (std::size_t at = page.find(attribute); at != page.npos; at = page.find(attribute, at + 1)) {
            const std::size_t from = at + attribute.size();
            EXPECT_EQ(page.substr(from, page.find('"', from) - from).find('n'), page.npos) << "nan or inf";
        }
    }
}

TEST(Report, TheMethodsOwnErrorStandsBesideTheValueWhereItIsKnown) {
    const std::string page = report_html(one_check({{"floor", 0.00561}}), {});
    EXPECT_TRUE(has(page, "<td class=\"floor\">0.0056\u00a0px</td>"));
    EXPECT_TRUE(has(page, "Method’s own error</th>"));
    EXPECT_TRUE(has(page, "colspan=\"6\""));
    const std::string without = report_html(one_check({{"floor", nullptr}}), {});
    EXPECT_FALSE(has(without, "<td class=\"floor\">"));
    EXPECT_FALSE(has(without, "own error</th>"));
    Json two = one_check({{"floor", 0.01}});
    two["checks"].push_back(one_check(Json::object())["checks"][0]);
    EXPECT_TRUE(has(report_html(two, {}), "<td class=\"floor\">—</td>"));
}

TEST(Report, EachExpectationIsSaidInWords) {
    const auto limit_of = [](const Json& extra) {
        const std::string page = report_html(one_check(extra), {});
        const std::string open = "<td class=\"limit\">";
        const std::size_t from = page.find(open) + open.size();
        return page.substr(from, page.find("</td>", from) - from);
    };
    EXPECT_EQ(limit_of({{"expect", "at least"}}), "≥\u00a00.1\u00a0px");
    EXPECT_EQ(limit_of({{"expect", "within"}, {"target", 7}}), "within 0.1\u00a0px of 7\u00a0px");
    EXPECT_EQ(limit_of({{"expect", "within"}}), "within 0.1\u00a0px of 0");
    EXPECT_EQ(limit_of({{"expect", "differs"}}), "differs by &gt;\u00a00.1\u00a0px");
    EXPECT_EQ(limit_of({{"expect", "differs"}, {"target", 7}}), "differs by &gt;\u00a00.1\u00a0px from 7\u00a0px");
    EXPECT_EQ(limit_of({{"limit", nullptr}}), "—");
}

TEST(Report, AnUnknownVerdictIsNoPass) {
    EXPECT_TRUE(has(report_html(one_check({{"verdict", "MAYBE"}}), {}), "0 of 1 pass, 1 is inconclusive"));
    EXPECT_TRUE(has(report_html(one_check({{"verdict", nullptr}}), {}), "</svg>INCONCLUSIVE</span></td>"));
}

TEST(Report, TakesReportsThatLackEverything) {
    for (const char* text : {"null", "[]", "{}", R"({"checks": null, "subjects": 3, "provenance": []})",
                             R"({"checks": [null, 1, {}], "subjects": [null, {"pictures": [null]}], "plots": [null]})",
                             R"({"provenance": {"inputs": [], "settings": {}, "a": [1, 2], "b": [{}, null]}})"}) {
        const std::string page = report_html(parsed(text), {});
        EXPECT_TRUE(page.starts_with("<!DOCTYPE html>")) << text;
        EXPECT_FALSE(has(page, "{{")) << text;
    }
}

TEST(Report, AsksNothingOfTheNetwork) {
    const std::string page = report_html(one_check(Json::object()), {});
    EXPECT_TRUE(has(page,
                    "content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
                    "img-src data:"));
    for (const char* escape :
         {"https:", "src=\"http", "url(http", "@import", "fetch(", "XMLHttpRequest", "WebSocket", "innerHTML"}) {
        EXPECT_FALSE(has(page, escape)) << escape;
    }
}

TEST(Report, TheSameReportGivesTheSameBytes) {
    EXPECT_EQ(report_html(one_check(Json::object()), {}), report_html(one_check(Json::object()), {}));
}

}  // namespace lensproof::draw::report_test
