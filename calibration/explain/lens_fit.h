// calibration/explain/lens_fit.h — the changes of a lens that explain best what was seen, within what is believed.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibration/explain/lens_residuals.h"

namespace lensproof::calibration {

/// What is believed of each change before anything is seen, one by one; sigma 0 holds it at the mean.
struct Belief {
    Eigen::VectorXd mean;
    Eigen::VectorXd sigma;
};

/// A lens that was made as it should be (kTolerances).
Belief usual_belief(const std::vector<LensChange>& changes);

/// The lens as prescribed: scale and sensor shift alone are free.
Belief prescribed_belief(const std::vector<LensChange>& changes);

/// The least sum of squares of residuals and of departures from what is believed, each in its standard deviations
/// (Levenberg and Marquardt, by Ceres), and what is known there to first order.
struct LensFit {
    LensState state;
    Belief belief;
    Eigen::VectorXd residuals{};    // of what was seen
    double chi2 = 0.0;              // their squares' sum
    double strain2 = 0.0;           // that of the departures
    Eigen::MatrixXd information{};  // what the data alone say of the changes, the charts' places being unknown
    /// Logarithm of how likely the data are under the belief (Laplace's approximation; MacKay 2003, Information Theory,
    /// ch. 28), up to what all beliefs share.
    double log_evidence = 0.0;

    /// Of the changes, given data and belief; rows of what is held are 0.
    [[nodiscard]] Eigen::MatrixXd covariance() const;
    /// The farthest departure from the belief, in its standard errors.
    [[nodiscard]] double largest_strain() const;
    /// Degrees of freedom of `chi2`: residuals less unknowns, of which a believed one counts as far as the data decide.
    [[nodiscard]] double freedom() const;
};

/// Nothing where rays stop arriving.
std::optional<LensFit> fit_lens(const ExplainedLens& lens, const SeenPoints& seen, const LensState& start,
                                const Belief& belief);

/// J'J of the changes once six unknowns a view are eliminated.
Eigen::MatrixXd information_of(const LensResiduals& residuals);

/// log √(det Σ⁻¹ / det(A + Σ⁻¹)) of an information A and a belief's variances Σ, over what is not held.
double log_occam_factor(const Eigen::MatrixXd& information, const Eigen::VectorXd& sigma);

}  // namespace lensproof::calibration
