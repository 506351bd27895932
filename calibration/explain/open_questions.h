// calibration/explain/open_questions.h — which changes of a lens the data cannot tell apart, and which picture would.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/explain/lens_fit.h"

namespace lensproof::calibration {

/// A direction in which the lens may change without the data seeing it. Its components are of the parameters in units
/// of their tolerances, of unit length; so is the standard error: 1 where the data say nothing, at least a half for
/// what is listed.
struct OpenCombination {
    std::vector<std::pair<std::string, double>> direction;
    double standard_error = 0.0;
};

/// The parameters of which the data say nothing at all, one by one; of the others the eigenvectors of what is left of
/// the belief's variance, the most open first.
std::vector<OpenCombination> open_combinations(const std::vector<LensChange>& changes, const LensFit& fit);

/// A picture that would tell, and what of: a combination's standard error in tolerances, now and with it.
struct Suggestion {
    std::string picture;
    OpenCombination about;
    double with_it = 0.0;
};

/// Among views of a chart that fills the frame, near and far, facing the camera and tilted, that which would shrink an
/// open combination most. Nothing where none is open, or no view would take a tenth of it.
std::optional<Suggestion> suggest_picture(const ExplainedLens& lens, const SeenPoints& seen, const Profile& profile,
                                          const LensFit& fit);

}  // namespace lensproof::calibration
