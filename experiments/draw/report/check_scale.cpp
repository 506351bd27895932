#include "experiments/draw/report/check_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/base/infinity.h"
#include "experiments/draw/report/html_text.h"

namespace lensproof::draw {
namespace {
constexpr double kZ95 = 1.959964;  // half of a 95 % interval in standard errors

/// The scale's two ends, where the check holds (from, to: a finite end is a limit), and where there is no difference.
struct Scale {
    double low;
    double high;
    std::vector<std::pair<double, double>> holds;
    double zero = 0.0;

    /// Percent of the width; what lies beyond an end is there.
    [[nodiscard]] double at(double x) const {
        return 100.0 * std::min(std::max(0.0, (x - low) / (high - low)), 1.0);  // in this order NaN is 0
    }
};

Scale scale_of(const Json& check, double limit) {
    const double target = as_number(check["target"]).value_or(0.0);
    const double value = as_number(check["value"]).value_or(0.0);
    const double low = target - limit;
    const double high = target + limit;
    const double reach = limit != 0.0 ? std::abs(limit) : value != 0.0 ? std::abs(value) : 1.0;
    const std::string expect = as_text(check["expect"]);
    if (expect == "within") return {target - 1.5 * reach, target + 1.5 * reach, {{low, high}}, target};
    if (expect == "differs") {
        return {target - 3.0 * reach, target + 3.0 * reach, {{-kInfinity, low}, {high, kInfinity}}, target};
    }
    if (expect == "at least") return {limit > 0.0 ? 0.0 : limit - reach, limit + 2.0 * reach, {{limit, kInfinity}}};
    return {limit > 0.0 ? 0.0 : limit - 2.0 * reach, limit + (limit > 0.0 ? 0.5 : 1.0) * reach, {{-kInfinity, limit}}};
}

std::string line(const char* kind, double from, double to, double top, double bottom) {
    return fmt::format(R"(<line class="{}" x1="{:.3f}%" x2="{:.3f}%" y1="{}" y2="{}"/>)", kind, from, to, top, bottom);
}

std::string rectangle(const char* kind, double from, double to, double top, double height) {
    return fmt::format(R"(<rect class="{}" x="{:.3f}%" width="{:.3f}%" y="{}" height="{}"/>)", kind, from,
                       std::max(to - from, 0.0), top, height);
}

/// The verdict's mark at the value, or an arrow where that is beyond the scale.
std::string mark(const Scale& scale, double value, const std::string& verdict) {
    const char* shape = value > scale.high  ? R"(<path d="M-9 -5.5L1 0L-9 5.5z" fill="currentColor"/>)"
                        : value < scale.low ? R"(<path d="M9 -5.5L-1 0L9 5.5z" fill="currentColor"/>)"
                                            : nullptr;
    return fmt::format(R"(<svg class="mark" x="{:.3f}%" y="11" overflow="visible">{}</svg>)", scale.at(value),
                       shape != nullptr
                           ? shape
                           : fmt::format(R"(<use href="#mark-{}" x="-6" y="-6" width="12" height="12"/>)", verdict));
}

}  // namespace

std::string check_scale_html(const Json& check) {
    constexpr double kMiddle = 11.0;
    const auto limit = as_number(check["limit"]);
    if (!limit) return "";
    const Scale scale = scale_of(check, *limit);
    const auto bar = [&](const char* kind, double x, double reach) {
        return line(kind, scale.at(x), scale.at(x), kMiddle - reach, kMiddle + reach);
    };
    std::string out = "<svg aria-hidden=\"true\">" +  // the row says all of it in words
                      line("track", 0.0, 100.0, kMiddle, kMiddle);
    for (const auto& [from, to] : scale.holds) out += rectangle("allowed", scale.at(from), scale.at(to), 4.0, 14.0);
    if (scale.zero > scale.low && scale.zero < scale.high) out += bar("zero", scale.zero, 4.0);
    for (const auto& [from, to] : scale.holds) {
        for (const double end : {from, to}) out += std::isfinite(end) ? bar("limit-line", end, 9.0) : "";
    }
    const double own = as_number(check["floor"]).value_or(0.0);
    if (own > 0.0) {  // from no difference on: what lies in it may be the method's
        const double from = scale.zero - (as_text(check["expect"]) == "within" ? own : 0.0);
        out += rectangle("own", scale.at(from), scale.at(scale.zero + own), 15.0, 3.0);
    }
    if (const auto value = as_number(check["value"])) {
        const double half = kZ95 * as_number(check["sigma"]).value_or(0.0);
        if (half > 0.0) {
            out += line("whisker", scale.at(*value - half), scale.at(*value + half), kMiddle, kMiddle);
            for (const double end : {*value - half, *value + half}) {
                if (end > scale.low && end < scale.high) out += bar("whisker", end, 3.5);
            }
        }
        out += mark(scale, *value, verdict_class(check));
    }
    return out + "</svg>";
}

}  // namespace lensproof::draw
