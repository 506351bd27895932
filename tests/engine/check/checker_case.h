// tests/engine/check/checker_case.h — what tests of the checker share: a report's findings, and a defect planted in a
// good lens.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "engine/check/checker.h"
#include "engine/formats/glass/shipped_glasses.h"

namespace lensproof::check {

inline CheckReport checked(const optics::Prescription& prescription, const optics::StatedData& claims = {},
                           const CheckSettings& settings = {}) {
    return check_prescription(prescription, claims, formats::shipped_glasses(), settings);
}

/// The first finding of that code, at that surface where one is given; else null.
inline const optics::Finding* find(const CheckReport& report, const std::string& code, int surface = -1) {
    const auto found = std::ranges::find_if(report.findings, [&](const optics::Finding& finding) {
        return finding.code == code && (surface < 0 || finding.surface == surface);
    });
    return found == report.findings.end() ? nullptr : &*found;
}

/// All that a report says, for a test's message.
inline std::string said(const CheckReport& report) {
    std::string all;
    for (const optics::Finding& finding : report.findings) {
        all += finding.code + " at " + std::to_string(finding.surface) + ": " + finding.message + "\n";
    }
    return all;
}

/// What must be said once a defect is planted. A value that is NaN is not compared.
struct Expected {
    const char* code;
    optics::Severity severity;
    int surface = 0;  // 0: the lens
    double value = kNaN;
    double tolerance = 1e-9;
    double limit = kNaN;
};

/// That `good` has no finding of the code, and that `plant` brings one about.
inline void expect_planted(optics::Prescription good, const std::function<void(optics::Prescription&)>& plant,
                           const Expected& expected) {
    SCOPED_TRACE(expected.code);
    const CheckReport before = checked(good);
    EXPECT_EQ(find(before, expected.code), nullptr) << "the good lens has it:\n" << said(before);
    plant(good);
    const CheckReport after = checked(good);
    const optics::Finding* finding = find(after, expected.code);
    ASSERT_NE(finding, nullptr) << said(after);
    EXPECT_EQ(finding->severity, expected.severity) << finding->message;
    EXPECT_EQ(finding->surface, expected.surface) << finding->message;
    EXPECT_FALSE(finding->message.empty());
    if (!std::isnan(expected.value)) {
        EXPECT_NEAR(finding->value, expected.value, expected.tolerance) << finding->message;
    }
    if (!std::isnan(expected.limit)) {
        EXPECT_NEAR(finding->limit, expected.limit, 1e-9) << finding->message;
    }
}

/// A half ball of n = 1.5 and R = 10 mm whose flat side is in front and is the stop. Each formula for it is closed:
/// f = R / (n − 1) = 20 mm, counted from the vertex behind, as the back focus is.
inline optics::Prescription half_ball(double stop_semi_diameter = 1.0) {
    optics::Prescription lens;
    lens.surfaces.resize(2);
    lens.surfaces[0] = {
        .thickness_mm = 10.0, .semi_diameter_mm = stop_semi_diameter, .medium = {.n_d = 1.5}, .is_stop = true};
    lens.surfaces[1] = {.radius_mm = -10.0, .thickness_mm = 20.0, .semi_diameter_mm = 9.5};
    return lens;
}

/// A whole one, with the stop in its middle: f = n R / (2 (n − 1)) = 15 mm, counted from its centre, through which
/// every chief ray passes undeviated.
inline optics::Prescription ball(double rim) {
    optics::Prescription lens;
    lens.surfaces.resize(3);
    lens.surfaces[0] = {.radius_mm = 10.0, .thickness_mm = 10.0, .semi_diameter_mm = rim};
    lens.surfaces[1] = {.thickness_mm = 10.0, .semi_diameter_mm = 1.0, .is_stop = true};
    lens.surfaces[2] = {.radius_mm = -10.0, .thickness_mm = 5.0, .semi_diameter_mm = rim};
    lens.surfaces[0].medium.n_d = lens.surfaces[1].medium.n_d = 1.5;
    return lens;
}

}  // namespace lensproof::check
