// calibration/geometry/model_choice.h — which lens model the pictures support, and why.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/cross_validation.h"
#include "calibration/geometry/fit_geometry.h"

namespace lensproof::calibration {

/// A model that was tried.
struct ModelCandidate {
    std::string name;  // kind, and the number of its radial terms where it has fewer than it could
    ModelKind kind = ModelKind::brown_conrady;
    std::optional<int> radial_terms;
    int parameters = 0;  // fitted intrinsics
    /// Why it could not be fitted or was out at once; what follows is then absent.
    std::string refused;
    double rms_px = 0.0;
    double held_out_rms_px = 0.0;
    std::optional<double> halves_px;  // rms over the covered frame (cross_validation.h)
    /// Standard deviation of the projection at the worst of the four corners, or as far out towards them as the best
    /// predictor images anything, by noise: were this the right model. None where it images nothing there.
    std::optional<double> corner_px;
    /// What the choice minimises, px; none for a candidate that is out.
    std::optional<double> expected_error_px;

    friend bool operator==(const ModelCandidate&, const ModelCandidate&) = default;
};

struct ModelChoice {
    std::vector<ModelCandidate> candidates;
    int chosen = 0;
    int folds = 0;
    /// How far the chosen one and its rivals differ at the worst corner (models_disagreement_px); none without any.
    std::optional<double> corner_disagreement_px;
    std::string why;  // in words

    friend bool operator==(const ModelChoice&, const ModelChoice&) = default;
};

struct ChosenGeometry {
    GeometryFit fit;
    GeometryOptions options;
    ModelChoice choice;
    /// Fits of the same views by the other candidates that predict held-out points as well, whatever their corners.
    std::vector<GeometryFit> rivals;
};

/// Fits the candidates and weighs what they say against what they know.
///
/// One that leaves twice the residuals of the best is out at once. All others are judged on the same points: those that
/// the candidate with the smallest residuals (per point used) keeps. A candidate that predicts held-out points more
/// than 5 % worse than the best of them, beyond chance (one standard error of the paired difference between views), is
/// out; the rest are ordered by
///     expected error² = excess² + (halves / 2)² + corner²,
/// excess² being the held-out mean square above the best's, beyond chance (what the model cannot express), half the
/// difference of two half-size fits one standard error of the whole's mapping over the covered frame, and corner the
/// uncertainty where points are rarest. A rational function with the same residuals and an open corner so loses to a
/// model that knows less and says so. `options.model` and, where it is not set, `radial_terms` are chosen.
/// Throws InputError when no candidate can be fitted: the first one's reason.
ChosenGeometry choose_model(const std::vector<ChartView>& views, int width_px, int height_px,
                            const GeometryOptions& options);

}  // namespace lensproof::calibration
