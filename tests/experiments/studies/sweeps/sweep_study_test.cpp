// [[sweeps]]: any quantity of any lens over any of its settings.
#include "experiments/studies/sweeps/sweep_study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::studies::sweep_study_test {

const auto kQuiet = [](const std::string&, double) {};

class SweepStudy : public testing::Test {
  protected:
    Sweep read(const std::string& table) {
        const std::filesystem::path file = folder_.path() / "sweep.toml";
        write_file(file, "title = \"t\"\n[[sweeps]]\nname = \"s\"\n" + table);
        findings::ExperimentFile experiment{.top = TomlTable::read(file)};
        std::vector<TomlTable> tables = experiment.top.tables("sweeps");
        return read_sweep(tables.at(0), experiment);
    }

    std::string complaint(const std::string& table) {
        return complaint_about([&] { read(table); });
    }

    TestFolder folder_;
};

// 2/π (acos s − s √(1 − s²)), s = λ N ν (Goodman, Introduction to Fourier Optics, 6.3). N is the paraxial f-number of
// the object at infinity; the beam's own, of a Tessar on its axis, is within 1 % of it from f/8 on, of which the MTF
// changes by less than half.
TEST_F(SweepStudy, OfAnMtfOnTheAxisIsDiffractionsOwn) {
    const Sweep sweep = read(R"(lens = "tessar"
f_number = { from = 8.0, to = 32.0, count = 3, spacing = "logarithmic" }
frequency_per_mm = [10.0, 30.0]
wavelength_nm = [486.1327, 656.2725]
model = "diffraction-limited"
measure = ["mtf_tangential", "mtf_sagittal"]
)");
    ASSERT_EQ(findings::combinations(sweep.axes), 12U);
    EXPECT_EQ(sweep.over, "f_number");
    EXPECT_EQ(sweep.curves, "wavelength_nm");
    const std::vector<SweepValue> values = measure_sweep(sweep, {.threads = 2}, kQuiet);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const SweepSetting at = sweep_setting(sweep.axes, i);
        const double s = 1e-6 * at.wavelength_nm.value() * at.f_number.value() * at.frequency_per_mm.value();
        const double expected = 2.0 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1.0 - s * s));
        EXPECT_NEAR(values[i].quantities.at("mtf_tangential").value(), expected, 0.005) << i;
        EXPECT_NEAR(values[i].quantities.at("mtf_sagittal").value(), expected, 0.005) << i;
    }
    EXPECT_NEAR(sweep_setting(sweep.axes, 4).f_number.value(), 16.0, 1e-12) << "equal ratios";
}

// The picture, seen from the entrance pupil, is as large as the exit pupil is far from it. A lens that is moved as a
// whole to focus at x from its front focal point moves by f² / x.
TEST_F(SweepStudy, FocusesAndSaysWhatALensCannotDo) {
    const Sweep sweep = read(R"(lens = ["tessar", "petzval"]
f_number = [2.5, 4.0]
focus_distance_mm = [inf, 1000.0]
field_deg = 5.0
measure = ["chief_ray_height_mm", "efl_mm"]
[[sweeps.checks]]
measure = "efl_mm"
where = { lens = "tessar", f_number = 4.0 }
between = [99.0, 101.0]
[[sweeps.checks]]
measure = "efl_mm"
at_least = 10.0
)");
    const std::vector<SweepValue> one = measure_sweep(sweep, {.threads = 1}, kQuiet);
    const std::vector<SweepValue> two = measure_sweep(sweep, {.threads = 2}, kQuiet);
    std::size_t refused = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].quantities, two[i].quantities);
        EXPECT_EQ(one[i].refused.empty(), one[i].quantities.at("efl_mm").has_value());
        refused += one[i].refused.empty() ? 0 : 1;
    }
    EXPECT_EQ(refused, 2U) << "a Tessar opens to f/2.8";
    const double far = one[2].quantities.at("chief_ray_height_mm").value();
    const double near = one[3].quantities.at("chief_ray_height_mm").value();
    const optics::ParaxialData data =
        optics::paraxial_data(optics::at_wavelength<double>(formats::load_lens("tessar"), spectral::kLineD));
    const double moved = data.efl * data.efl / (1000.0 + data.ffl);
    EXPECT_NEAR(near / far, 1.0 + moved / (data.bfl - data.exit_pupil_z), 1e-3) << "of a field of 5°";
    const std::vector<findings::Check> checks = sweep_checks(sweep, one);
    ASSERT_EQ(checks.size(), 2U);
    EXPECT_EQ(checks[0].verdict(), findings::Verdict::pass);
    EXPECT_EQ(checks[1].verdict(), findings::Verdict::inconclusive) << "some values do not exist";
    const findings::Findings found = sweep_findings(sweep, one);
    EXPECT_EQ(found.subjects.at(0).pictures.size(), 2U);
    EXPECT_EQ(found.subjects.at(0).facts.back().label, "not measured");
    EXPECT_EQ(found.tables.at(0).second[0]["values"].size(), 8U);
    EXPECT_EQ(found.tables.at(0).second[0]["values"][0]["focus_distance_mm"], "infinity");
}

TEST_F(SweepStudy, RefusesWhatItCannotRead) {
    const std::string mtf = "measure = [\"mtf_tangential\"]\n";
    const std::string efl = "measure = [\"efl_mm\"]\n";
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nfield_deg = [0.0, 1.0]\n" + mtf), "frequency_per_mm"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nmeasure = [\"mtff\"]\n"), "mtff"));
    EXPECT_TRUE(says(complaint("lens = \"tesar\"\nf_number = [4.0, 8.0]\n" + efl), "tesar"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\n" + efl), "sweeps over no number"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nf_number = [4.0, 4.0]\n" + efl), "f/4 twice"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nf_number = [4.0, -1.0]\n" + efl), "f_number"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nf_number = {from = 4.0, to = 8.0}\n" + efl), "count or step"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nf_number = {from = 4.0, to = 8.0, step = 1e-9}\n" + efl), "step"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nf_number = [4.0, 8.0]\nover = \"field_deg\"\n" + efl), "over"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nmodel = [\"fourier\"]\nf_number = [4.0, 8.0]\n" + efl), "fourier"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nf_number = [4.0, 8.0]\n" + efl +
                               "[[sweeps.checks]]\nmeasure = \"efl_mm\"\nat_most = 1.0\nwhere = { f_number = 5.6 }\n"),
                     "5.6"));
    EXPECT_TRUE(says(complaint("lens = \"tessar\"\nf_number = {from = 1.0, to = 9.0, count = 1000}\nfield_deg = {from "
                               "= 0.0, to = 9.0, count = 1000}\n" +
                               efl),
                     "1000000 values"));
}

}  // namespace lensproof::studies::sweep_study_test
