// Studies of any kind in one file, and their findings in one report.
#include "experiments/runner/experiment.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <stdexcept>

#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "experiments/runner/report_content.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::runner::experiment_test {

using findings::Findings;

/// A study that finds what `find` does.
std::pair<std::string, findings::Study> study(const std::string& name,
                                              const std::function<Findings(const Findings& before)>& find) {
    return {"[[study]]",
            {name, [find](const findings::RunSettings&, const findings::RunProgress&, const Findings& before) {
                 return find(before);
             }}};
}

const auto kQuiet = [](const std::string&, double) {};

const std::string kPassage = "[[pupil_passage]]\nlens = \"tessar\"\nf_number = 4.0\n";

TEST(Experiment, HoldsStudiesOfAnyKind) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    const auto studies_of = [&](const std::string& tables) {
        write_file(file, "title = \"t\"\n" + tables);
        return read_experiment(file).studies.size();
    };
    EXPECT_EQ(studies_of(kPassage), 1U);
    EXPECT_EQ(studies_of("[stability]\nextremes = [\"field\"]\n[measurement_floor]\n" + kPassage +
                         "[[pupil_passage]]\nlens = \"tessar\"\nf_number = 8.0\n"),
              4U);
    EXPECT_THROW(studies_of("[stabilitty]\n" + kPassage), InputError);
    EXPECT_TRUE(
        says(complaint_about([&] { studies_of(""); }), "neither [[simulations]] nor [[photos]] nor [stability]"));
}

// A file may have one that is about the program itself, or several by their names; what they find has ids of its own.
TEST(Experiment, StudiesOfTheProgramAreToldApartByName) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    const auto read = [&](const std::string& tables) {
        write_file(file, "title = \"t\"\n" + tables);
        return read_experiment(file);
    };
    const std::string field = "[[stability]]\nextremes = [\"field\"]\n";
    const Findings found = run_experiment(read(field + field + "name = \"again\"\n"), {}, kQuiet);
    ASSERT_EQ(found.subjects.size(), 2U);
    EXPECT_EQ(found.subjects[0].id, "field");
    EXPECT_EQ(found.subjects[1].id, "again-field");
    EXPECT_EQ(found.subjects[1].pictures[0].name, "again-" + found.subjects[0].pictures[0].name);
    std::set<std::string> ids;
    for (const findings::Check& check : found.checks) {
        EXPECT_TRUE(ids.insert(check.id).second) << check.id;
    }
    ASSERT_EQ(found.tables.size(), 1U);
    EXPECT_EQ(found.tables[0].second[1]["id"].text(), "again-field");
    EXPECT_TRUE(says(complaint_about([&] { read(field + field); }), "makes a second subject \"field\""));
    const std::string floor = "[[measurement_floor]]\ntrials = 20\n";
    EXPECT_EQ(read(floor + floor + "name = \"again\"\n").studies[1].second.name, "again");
    EXPECT_TRUE(says(complaint_about([&] { read(floor + floor); }), "makes a second subject \"measurement_floor\""));
}

// A subject's id names files, and checks refer to it: no two tables may make the same.
TEST(Experiment, SubjectsHaveIdsOfTheirOwn) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    const auto complaint = [&](const std::string& tables) {
        write_file(file, "title = \"t\"\n" + tables);
        return complaint_about([&] { read_experiment(file); });
    };
    EXPECT_NE(complaint(kPassage + kPassage).find("lens: makes a second subject \"tessar-f4\""), std::string::npos)
        << complaint(kPassage + kPassage);
}

// A chapter holds what its studies found; of one that found nothing there is none.
TEST(Experiment, ChaptersHoldWhatStudiesFind) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    const auto read = [&](const std::string& tables) {
        write_file(file, "title = \"t\"\n" + tables);
        return read_experiment(file);
    };
    const std::string chapter = "[[chapters]]\ntitle = \"Paths\"\ntext = \"Why.\"\nholds = [\"tessar-f4\"]\n";
    const Experiment experiment = read(chapter + kPassage);
    ASSERT_EQ(experiment.chapters.size(), 1U);
    EXPECT_EQ(experiment.chapters[0].text, "Why.");
    EXPECT_TRUE(says(complaint_about([&] { read("[[chapters]]\ntitle = \"a\"\nholds = [\"b\"]\n" + kPassage); }),
                     "holds: names \"b\", expected studies of this file: tessar-f4"));
    Experiment made{.title = "t",
                    .studies = {study("one",
                                      [](const Findings&) {
                                          Findings found;
                                          found.subjects = {{.id = "one-a"}, {.id = "one-b"}};
                                          return found;
                                      }),
                                study("two", [](const Findings&) { return Findings{}; })}};
    made.chapters = {{.title = "First", .holds = {"one"}}, {.title = "Second", .holds = {"two"}}};
    const Findings found = run_experiment(made, {}, kQuiet);
    ASSERT_EQ(found.chapters.size(), 1U);
    EXPECT_EQ(found.chapters[0].title, "First");
    EXPECT_EQ(found.chapters[0].subjects, (std::vector<std::string>{"one-a", "one-b"}));
}

// Two cameras' curves go into one plot, with the tighter limit; each study's subjects and tables stand after those of
// the study before it, which it may look at.
TEST(Experiment, FindingsGoIntoOneReport) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    write_file(file, "");
    const auto camera = [](const std::string& name, double limit) {
        return Findings{.checks = {{.id = name, .value = 1.0, .limit = 2.0}},
                        .counts_checks = true,
                        .subjects_title = findings::kUsualSubjects,
                        .subjects = {{.id = name, .kind = "photos", .label = name}},
                        .plots = {{.id = "distortion", .limit = limit, .series = {{.label = name}}}}};
    };
    const Experiment experiment{.file = file,
                                .title = "T",
                                .summary = "S",
                                .studies = {study("a", [&](const Findings&) { return camera("a", 0.5); }),
                                            study("b",
                                                  [&](const Findings& before) {
                                                      EXPECT_EQ(before.subjects.size(), 1U);
                                                      return camera("b", 0.2);
                                                  }),
                                            study("extremes", [](const Findings&) {
                                                return Findings{
                                                    .subjects_title = "Extremes",
                                                    .subjects = {{.id = "field", .kind = "rays", .label = "Field"}},
                                                    .tables = {{"extremes", Json::list({1, 2})}}};
                                            })}};
    const Findings found = run_experiment(experiment, {}, [](const std::string&, double) {});
    const Json report = report_json(experiment, found, {});
    EXPECT_EQ(report["summary"], "S 2 of 2 checks hold.");
    EXPECT_EQ(report["subjects_title"], "Renders and photos, Extremes");
    EXPECT_EQ(report["subjects"].size(), 3U);
    ASSERT_EQ(report["plots"].size(), 1U);
    EXPECT_EQ(report["plots"][0]["series"].size(), 2U);
    EXPECT_EQ(report["plots"][0]["limit"], 0.2);
    EXPECT_EQ(report["extremes"].size(), 2U);
}

// What one study finds is there, whatever becomes of the others; the report says who failed and of what, and passes
// not.
TEST(Experiment, OneStudysFailureLosesNoOthersFindings) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    write_file(file, "");
    const auto finds = study("sound", [](const Findings&) {
        return Findings{.checks = {{.id = "c", .value = 1.0, .limit = 2.0}}, .tables = {{"sound", Json::list({1})}}};
    });
    const auto bad_input = study("misled", [](const Findings&) -> Findings { throw InputError("no such lens"); });
    const auto no_room = study("full", [](const Findings&) -> Findings { throw std::runtime_error("disk full"); });
    const Experiment experiment{.file = file,
                                .title = "T",
                                .summary = "S",
                                .studies = {bad_input, finds, no_room, study("again", [](const Findings&) {
                                                return Findings{.tables = {{"sound", Json::list({2})}}};
                                            })}};
    const Findings found = run_experiment(experiment, {}, kQuiet);
    EXPECT_EQ(found.checks.size(), 1U);
    ASSERT_EQ(found.failures.size(), 2U);
    EXPECT_TRUE(found.failures[0].is_of_input);
    EXPECT_FALSE(found.failures[1].is_of_input);
    const Json report = report_json(experiment, found, {});
    EXPECT_EQ(report["verdict"], "INCONCLUSIVE");
    EXPECT_EQ(report["failures"][0]["study"], "misled");
    EXPECT_EQ(report["failures"][0]["message"], "no such lens");
    EXPECT_EQ(report["failures"][0]["exit_status"], 2);
    EXPECT_EQ(report["failures"][1]["exit_status"], 3);
    EXPECT_EQ(report["sound"].size(), 2U) << "lists of one key are one list";

    const Experiment hopeless{.file = file, .title = "T", .summary = "S", .studies = {bad_input, no_room}};
    EXPECT_TRUE(says(complaint_about([&] { run_experiment(hopeless, {}, kQuiet); }), "e.toml: no such lens"));
}

TEST(Experiment, CarriesOutWhatIsAskedForAlone) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    const auto nothing = [](const Findings&) { return Findings{}; };
    const Experiment experiment{
        .file = file, .title = "T", .summary = "S", .studies = {study("a", nothing), study("b", nothing)}};
    EXPECT_EQ(with_only(experiment, {}).studies.size(), 2U);
    ASSERT_EQ(with_only(experiment, {"b"}).studies.size(), 1U);
    EXPECT_EQ(with_only(experiment, {"b"}).studies[0].second.name, "b");
    EXPECT_TRUE(says(complaint_about([&] { with_only(experiment, {"c"}); }), "names \"c\", expected a study of"));
}

}  // namespace lensproof::runner::experiment_test
