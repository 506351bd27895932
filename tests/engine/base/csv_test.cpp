#include "engine/base/csv.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "tests/complaint.h"

namespace lensproof::csv_test {

std::vector<CsvRow> all_rows(const std::string& text) {
    CsvTable table = CsvTable::parse(text, "t.csv");
    std::vector<CsvRow> rows;
    while (const std::optional<CsvRow> row = table.next()) {
        rows.push_back(*row);
    }
    return rows;
}

/// What is said about a table whose rows' column `a` is read as a number.
std::string complaint_about_a(const std::string& text) {
    return complaint_about([&] {
        for (const CsvRow& row : all_rows(text)) {
            static_cast<void>(row.number("a"));
        }
    });
}

TEST(Csv, SkipsWhatIsNoTable) {
    const std::vector<CsvRow> rows =
        all_rows("\xEF\xBB\xBF# source\r\n\r\na , b\r\n 1,x y \r\n   \r\n# aside\r\n+2e1,\t\r\n-3,z");
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[0].number("a"), 1.0);
    EXPECT_EQ(rows[0].text("b"), "x y");
    EXPECT_EQ(rows[1].number("a"), 20.0);
    EXPECT_TRUE(rows[1].is_empty("b"));
    EXPECT_EQ(rows[2].line(), 8);
    EXPECT_EQ(rows[2].where("a"), "t.csv:8: a");
}

// RFC 4180 but for line ends inside quotes.
TEST(Csv, QuotesHoldCommasAndQuotes) {
    const std::vector<CsvRow> rows = all_rows("a,\"b\"\n1, \"x, \"\"y\"\" z\" \n\"2\",\"\"\n3,5\" pipe\n");
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[0].text("b"), "x, \"y\" z");
    EXPECT_EQ(rows[1].number("a"), 2.0);
    EXPECT_TRUE(rows[1].is_empty("b"));
    EXPECT_EQ(rows[2].text("b"), "5\" pipe");
}

TEST(Csv, EmptyAndNonFiniteNumbersAreTakenWhereAskedFor) {
    const std::vector<CsvRow> rows = all_rows("a,b\ninf,\nnan,7\n-INF,x\n");
    EXPECT_EQ(rows[0].optional_number("b"), std::nullopt);
    EXPECT_EQ(rows[1].optional_number("b"), 7.0);
    EXPECT_EQ(rows[0].any_number("a"), HUGE_VAL);
    EXPECT_TRUE(std::isnan(rows[1].any_number("a")));
    EXPECT_EQ(rows[2].any_number("a"), -HUGE_VAL);
    EXPECT_THROW(static_cast<void>(rows[2].any_number("b")), InputError);
    EXPECT_THROW(static_cast<void>(rows[2].optional_number("b")), InputError);
    EXPECT_THROW(static_cast<void>(rows[2].text("c")), InputError);
}

TEST(Csv, ComplaintsNameLineColumnFoundAndExpected) {
    const std::string finite = ", expected a finite number";
    for (const char* cell : {"inf", "nan", "1e999", "1 2", "0x10", "1,", "two", "", "+-1", "1.5mm"}) {
        const std::string complaint = complaint_about_a(std::string("# c\na\n") + (*cell != 0 ? cell : "\"\"") + "\n");
        EXPECT_TRUE(complaint.starts_with("t.csv:3: ")) << complaint;
    }
    EXPECT_EQ(complaint_about_a("a\ntwo\n"), "t.csv:2: a is \"two\"" + finite);
    EXPECT_EQ(complaint_about_a("a\n\x1b[2J\xff\n"), "t.csv:2: a is \"\\u001b[2J\ufffd\"" + finite);
    EXPECT_EQ(complaint_about_a("a,b\n1\n"), "t.csv:2: 1 cells, expected 2 as in the header: a,b");
    EXPECT_EQ(complaint_about_a("a,b\n1,2,3\n"), "t.csv:2: 3 cells, expected 2 as in the header: a,b");
    EXPECT_EQ(complaint_about_a("a\n\"1\n"), "t.csv:2: a quote does not end with its cell");
    EXPECT_EQ(complaint_about_a("a\n\"1\" 2\n"), "t.csv:2: a quote does not end with its cell");
    EXPECT_EQ(complaint_about_a("b\n1\n"), "t.csv:1: the header is \"b\", expected a column a in it");
    EXPECT_EQ(complaint_about_a("a,b,a\n"), "t.csv:1: the header is \"a,b,a\": a stands there twice");
    EXPECT_EQ(complaint_about_a("a,,b\n"), "t.csv:1: the header is \"a,,b\": column 2 has no name");
    EXPECT_EQ(complaint_about_a("secret: of another, file\n1,2\n"),
              "t.csv:1: the header is \"secret:…\", expected a column a in it");
    EXPECT_EQ(complaint_about_a("# only\n\n"), "t.csv: is empty, expected a table with a header");
    EXPECT_EQ(complaint_about_a(""), "t.csv: is empty, expected a table with a header");
}

TEST(Csv, BoundsAreNamed) {
    const CsvRow row = all_rows("a\n-1\n").front();
    EXPECT_EQ(complaint_about([&] { return row.number("a", kPositive); }),
              "t.csv:2: a is \"-1\", expected a finite number above 0");
    EXPECT_EQ(complaint_about([&] { return row.number("a", kPositive, "a thickness in mm"); }),
              "t.csv:2: a is \"-1\", expected a thickness in mm");
}

TEST(Csv, ExpectedColumnsMayStandInAnyOrder) {
    const CsvTable table = CsvTable::parse("b,a,c\n", "t.csv");
    EXPECT_NO_THROW(table.expect_columns({"a", "b"}, {"c", "d"}));
    EXPECT_THROW(table.expect_columns({"a", "b"}), InputError);
    EXPECT_THROW(table.expect_columns({"a", "b", "d"}, {"c"}), InputError);
}

// What a table of nothing but commas or quotes must not do is fill the memory with cells.
TEST(Csv, EndlessLinesAreRefusedShortly) {
    const std::string commas(5'000'000, ',');
    EXPECT_LT(complaint_about_a(commas).size(), 400U);
    EXPECT_LT(complaint_about_a("a\n" + commas).size(), 400U);
    EXPECT_LT(complaint_about_a("a\n" + std::string(5'000'001, '"')).size(), 400U);
}

}  // namespace lensproof::csv_test
