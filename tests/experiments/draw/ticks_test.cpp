#include "experiments/draw/ticks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace lensproof::draw::ticks_test {

/// The number a label stands for.
double read(const std::string& label) {
    const bool is_negative = label.starts_with("\u2212");
    return (is_negative ? -1.0 : 1.0) * std::stod(is_negative ? label.substr(3) : label);
}

const std::vector<AxisRange> kRanges = {{0.0, 1.0},       {0.0, 0.3},         {-1.0, 1.0},       {-3.7e-9, 8.1e-9},
                                        {1e6, 1e6 + 0.5}, {-250.0, -13.0},    {0.0, 1e15},       {-1e-15, 1e-15},
                                        {99.9, 100.1},    {0.1, 0.7},         {-0.05, 123456.0}, {1e-30, 7e-30},
                                        {-1e200, 1e200},  {299.999, 300.001}, {0.0, 7.0}};

// Whatever the range: the step is 1, 2 or 5 times a power of ten, marks are within
// the range and none is missing at either end.
TEST(Ticks, LinearMarksAreOneTwoFiveAndFillTheRange) {
    for (const AxisRange range : kRanges) {
        for (const int most : {2, 3, 5, 8, 12}) {
            const Ticks ticks = linear_ticks(range.low, range.high, most);
            ASSERT_LE(ticks.major.size(), static_cast<std::size_t>(most));
            ASSERT_FALSE(ticks.major.empty()) << range.low << " " << most;
            ASSERT_EQ(ticks.labels.size(), ticks.major.size());
            EXPECT_GE(ticks.major.front(), range.low);
            EXPECT_LE(ticks.major.back(), range.high);
            if (ticks.major.size() < 2) {
                continue;
            }
            const double step =
                (ticks.major.back() - ticks.major.front()) / (static_cast<double>(ticks.major.size()) - 1.0);
            const double mantissa = step / std::pow(10.0, std::floor(std::log10(step * 1.001)));
            // A step between numbers a million times larger keeps ten of its digits.
            EXPECT_TRUE(std::ranges::any_of(std::vector{1.0, 2.0, 5.0}, [&](double nice) {
                return std::abs(mantissa - nice) < 1e-6;
            })) << step;
            EXPECT_LT(ticks.major.front() - range.low, step);
            EXPECT_LT(range.high - ticks.major.back(), step);
        }
    }
}

TEST(Ticks, AMarkIsTheNumberThatItsLabelSays) {
    for (const AxisRange range : kRanges) {
        const Ticks ticks = linear_ticks(range.low, range.high, 7);
        std::set<std::string> seen;
        for (std::size_t i = 0; i < ticks.major.size(); ++i) {
            EXPECT_TRUE(seen.insert(ticks.labels[i]).second) << ticks.labels[i];
            const double said = read(ticks.labels[i]) * std::pow(10.0, ticks.exponent);
            // Exactly, but for the power of ten that is rounded itself where the label has one.
            EXPECT_NEAR(ticks.major[i], said, ticks.exponent == 0 ? 0.0 : 4e-16 * std::abs(said));
        }
    }
    EXPECT_EQ(linear_ticks(0.0, 0.3, 4).labels, (std::vector<std::string>{"0.0", "0.1", "0.2", "0.3"}));
    EXPECT_EQ(linear_ticks(-2e-6, 2e-6, 5).labels, (std::vector<std::string>{"\u22122", "\u22121", "0", "1", "2"}));
    EXPECT_EQ(linear_ticks(-2e-6, 2e-6, 5).exponent, -6);
}

TEST(Ticks, MinorMarksStandBetweenMajorOnes) {
    for (const AxisRange range : kRanges) {
        const Ticks ticks = linear_ticks(range.low, range.high, 6);
        for (const double minor : ticks.minor) {
            EXPECT_TRUE(minor >= range.low && minor <= range.high);
            EXPECT_EQ(std::ranges::count(ticks.major, minor), 0);
        }
    }
    EXPECT_EQ(linear_ticks(0.0, 4.0, 3).minor, (std::vector<double>{0.5, 1.0, 1.5, 2.5, 3.0, 3.5}));
}

TEST(Ticks, DecadesOfALogarithmicAxis) {
    const Ticks few = log_ticks(0.01, 100.0, 8);
    EXPECT_EQ(few.labels, (std::vector<std::string>{"0.01", "0.1", "1", "10", "100"}));
    EXPECT_EQ(few.major, (std::vector<double>{0.01, 0.1, 1.0, 10.0, 100.0}));
    EXPECT_EQ(few.minor.size(), 4U * 8U);
    // 18 decades with room for 7 numbers: every third, the others small.
    const Ticks many = log_ticks(1e-3, 1e15, 7);
    EXPECT_EQ(many.labels, (std::vector<std::string>{"10⁻³", "10⁰", "10³", "10⁶", "10⁹", "10¹²", "10¹⁵"}));
    EXPECT_EQ(many.minor.size(), 12U);
    // Less than two decades: 1, 2, 5; and hardly any range at all: as on a linear axis.
    EXPECT_EQ(log_ticks(2.0, 60.0, 8).labels, (std::vector<std::string>{"2", "5", "10", "20", "50"}));
    EXPECT_EQ(log_ticks(1.0, 8.0, 8).labels, (std::vector<std::string>{"1", "2", "5"}));
    EXPECT_GE(log_ticks(1.02, 1.09, 8).major.size(), 3U);
}

TEST(Ticks, RoundedRangesHoldWhatTheyRound) {
    for (const AxisRange range : kRanges) {
        const AxisRange round = rounded_outwards(range, 6);
        EXPECT_LE(round.low, range.low);
        EXPECT_GE(round.high, range.high);
        EXPECT_LE(round.high - round.low, 1.5 * (range.high - range.low));
    }
    EXPECT_EQ(rounded_outwards({0.0, 1.0}, 6).high, 1.0);
    EXPECT_EQ(log_rounded_outwards({3e-5, 0.2}).low, 1e-5);
    EXPECT_EQ(log_rounded_outwards({3e-5, 0.2}).high, 1.0);
    EXPECT_EQ(log_rounded_outwards({0.1, 10.0}).high, 10.0);
    EXPECT_EQ(log_rounded_outwards({3.0, 4.0}).low, 2.0);
    EXPECT_EQ(log_rounded_outwards({3.0, 4.0}).high, 5.0);
}

TEST(Ticks, NumbersReadAsInPrint) {
    EXPECT_EQ(decimal_text(-0.04, 1), "0.0");
    EXPECT_EQ(decimal_text(-1.25, 2), "\u22121.25");
    EXPECT_EQ(power_of_ten_text(-12), "10⁻¹²");
    EXPECT_EQ(short_number(0.9996), "1");
    EXPECT_EQ(short_number(12.345), "12.3");
    EXPECT_EQ(short_number(1.5e-7), "1.5×10⁻⁷");
    EXPECT_EQ(short_number(-40000.0), "\u221240000");
    EXPECT_EQ(short_number(0.0), "0");
    EXPECT_EQ(short_number(NAN), "—");
}

}  // namespace lensproof::draw::ticks_test
