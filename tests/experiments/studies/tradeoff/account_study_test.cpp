// tests/experiments/studies/tradeoff/account_study_test.cpp — plans held to account: what counts as kept, and what a
// file may say.
#include "experiments/studies/tradeoff/account_study.h"

#include <gtest/gtest.h>

#include "engine/base/write_file.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::studies::account_study_test {

// An error of 0.6 ± 0.1 may be one of 0.5: it is not sure that it is too much. One of 0.8 ± 0.1 is not.
TEST(PlannedAccount, AnErrorThatMayBeWithinKeeps) {
    const Tolerance tolerance{.px = 0.5};
    PlannedOutcome outcome;
    outcome.measured.px = {0.6, 0.1};
    EXPECT_TRUE(keeps_tolerance(outcome, tolerance));
    outcome.measured.px = {0.8, 0.1};
    EXPECT_FALSE(keeps_tolerance(outcome, tolerance));
    outcome.measured = {.px = {}, .ev = {9.0, 0.0}, .ciede2000 = {}};
    EXPECT_TRUE(keeps_tolerance(outcome, tolerance));  // nothing is asked of it
}

TEST(PlannedAccount, AFileThatSaysTooLittleIsRefused) {
    const TestFolder folder;
    write_file(folder.path() / "empty.toml", "");
    const auto complaint = [&](const std::string& table) {
        const std::filesystem::path file = folder.path() / "planned.toml";
        write_file(file, "title = \"t\"\n[[planned]]\nname = \"p\"\nscene = \"empty.toml\"\n" + table);
        return complaint_about([&] {
            findings::ExperimentFile experiment{.top = TomlTable::read(file)};
            read_planned(experiment);
        });
    };
    EXPECT_TRUE(says(complaint(""), "tolerance"));
    EXPECT_TRUE(says(complaint("tolerance = \"1\"\n"), "has no unit"));
    EXPECT_TRUE(says(complaint("tolerance = \"1px\"\n"), "cases"));
    EXPECT_TRUE(says(complaint("tolerance = \"1px\"\ncases = [{ name = \"a\" }]\n"), "camera"));
}

}  // namespace lensproof::studies::account_study_test
