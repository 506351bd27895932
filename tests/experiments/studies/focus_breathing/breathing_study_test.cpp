// [[focus_breathing]]: the example of the documents is a study like others.
#include "experiments/studies/focus_breathing/breathing_study.h"

#include <gtest/gtest.h>

#include "engine/analysis/lens_analysis.h"
#include "engine/base/data_root.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/runner/experiment.h"

namespace lensproof::studies::breathing_study_test {

// A lens that moves as a whole has its image at f (1 + m), m = f / (x), x being the object's distance from the front
// focal point; of a small field the picture seen from the entrance pupil grows as the image's distance from the exit
// pupil does: by m f / (f − p), p being the exit pupil's place behind the rear principal plane over 1 (Welford, 2.5).
TEST(BreathingStudy, OfALensThatMovesAsAWholeIsThePupilsDistance) {
    const runner::Experiment experiment = runner::read_experiment(data_root() / "experiments/focus_breathing.toml");
    ASSERT_EQ(experiment.studies.size(), 1U);
    EXPECT_EQ(experiment.studies[0].second.name, "zoom");
    const findings::Findings found =
        experiment.studies[0].second.carry_out({.threads = 1}, [](const std::string&, double) {}, {});
    const Json& rows = found.tables.at(0).second;
    ASSERT_EQ(rows.size(), 15U);
    const std::vector<std::string> positions = {"72 mm", "135 mm", "194 mm"};
    for (std::size_t z = 0; z < positions.size(); ++z) {
        const optics::Lens lens = formats::load_lens("canon-zoom-70-200", {.indices = {}, .zoom = positions[z]});
        const optics::ParaxialData data = optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD));
        const double distance = 3000.0;
        const double m = data.efl / (distance + data.ffl);
        const double pupil_to_focus = data.bfl - data.exit_pupil_z;
        const double expected = 100.0 * m * data.efl / pupil_to_focus;
        EXPECT_NEAR(rows[5 * z + 4]["larger_by_percent"].number(), expected, 0.02 * expected) << positions[z];
        EXPECT_EQ(rows[5 * z]["larger_by_percent"].number(), 0.0);
    }
    EXPECT_EQ(found.subjects.at(0).pictures.size(), 1U);
}

}  // namespace lensproof::studies::breathing_study_test
