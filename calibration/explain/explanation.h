// calibration/explain/explanation.h — what explains a measured profile: the question that `fit` answers.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/explain/causes.h"
#include "calibration/explain/held_out.h"
#include "calibration/explain/open_questions.h"

namespace lensproof::calibration {

/// explained: the lens with these changes predicts points that it was not fitted to, within the noise. not_this_lens:
/// more would have to be wrong with it than one thing. unexplained: no change predicts better than the prescription.
enum class FitVerdict { explained, not_this_lens, unexplained };
const char* fit_verdict_name(FitVerdict verdict);  // "not-this-lens"

struct ExplainedChange {
    LensChange change;
    double value = 0.0;
    double standard_error = 0.0;
    double prior_standard_error = 0.0;
    bool determined = false;  // the data more than halve what was believed
};

struct LensExplanation {
    FitVerdict verdict = FitVerdict::unexplained;
    std::string reason;
    std::vector<ExplainedChange> parameters;
    std::vector<OpenCombination> undetermined;
    std::string cause;                      // the one thing that is wrong; empty: nothing but tolerances
    std::vector<std::string> other_causes;  // nearly as likely
    double rms_um_before = 0.0;
    double rms_um_after = 0.0;
    double noise_um = 0.0;  // rms of a point's
    double chi2_per_freedom = 0.0;
    double largest_strain = 0.0;
    HeldOut held_out;
    std::optional<Suggestion> suggestion;
    int points = 0;
    int points_not_imaged = 0;
};

struct ExplainSettings {
    std::vector<std::string> free{kFreeKinds.begin(), kFreeKinds.end()};
    std::optional<double> focus_mm;  // object's distance from the first surface; none: the charts'
};

/// Throws InputError for profiles and kinds that cannot be used.
LensExplanation explain(const optics::Lens& lens, const std::vector<NamedProfile>& profiles,
                        const ExplainSettings& settings = {});

/// What the prescription leaves of a profile's points as it stands, where nothing but the charts' places and the
/// picture's scale is fitted.
struct PrescribedResidual {
    double rms_um = 0.0;    // of a point
    double noise_um = 0.0;  // what measuring alone would leave
    int points = 0;
};

/// Nothing where the lens does not image the points. Throws InputError as `explain`.
std::optional<PrescribedResidual> prescribed_residual(const optics::Lens& lens, const NamedProfile& profile,
                                                      std::optional<double> focus_mm);

}  // namespace lensproof::calibration
