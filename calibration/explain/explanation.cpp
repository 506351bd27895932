#include "calibration/explain/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lensproof::calibration {

namespace {

// A factor of 150 between the likelihoods of what is claimed and what is not ("decisive": Kass and Raftery 1995, J. Am.
// Stat. Assoc. 90, 773).
constexpr double kDecisive = 5.0;
constexpr double kNearlyAsLikely = 3.0;
constexpr double kStrained = 4.0;     // standard errors of a tolerance
constexpr double kSignificant = 3.0;  // of a gain
constexpr double kShiftsGain = 30.0;  // of squares, by seven terms a channel
constexpr double kSystematic = 1.5;   // squares beyond the noise that a prescription may leave: its own roundings

Eigen::Index point_rows(const SeenPoints& seen) {
    return 2 * static_cast<Eigen::Index>(seen.count());
}

/// Of a point's residual, on the sensor.
double rms_um(const SeenPoints& seen, const Eigen::VectorXd& residuals) {
    double squares = 0.0;
    Eigen::Index row = 0;
    for (const SeenView& view : seen.views) {
        const double sigma = seen.camera.noise_px[static_cast<std::size_t>(view.profile)];
        const auto rows = 2 * static_cast<Eigen::Index>(view.points.size());
        squares += sigma * sigma * residuals.segment(row, rows).squaredNorm();
        row += rows;
    }
    return 1e3 * seen.camera.pitch_mm * std::sqrt(squares / seen.count());
}

double noise_um(const SeenPoints& seen) {
    Eigen::VectorXd ones = Eigen::VectorXd::Ones(point_rows(seen));
    return rms_um(seen, ones);
}

double shifts_chi2(const SeenPoints& seen, const LensFit& fit) {
    return fit.residuals.tail(fit.residuals.size() - point_rows(seen)).squaredNorm();
}

/// Whether what remains is noise, give or take what a prescription rounds.
bool is_noise(const LensFit& fit) {
    const double freedom = fit.freedom();
    constexpr double kSpread = 5.0;  // of χ², whose variance is twice its degrees of freedom
    return fit.chi2 / freedom <= std::max(kSystematic, 1.0 + kSpread * std::sqrt(2.0 / freedom));
}

/// A camera model that does not know decentred lenses overstates the noise: where the lens leaves less, that is it.
bool lower_noise(const LensFit& fit, SeenPoints& seen) {
    constexpr double kClearlyLess = 0.9;
    const double ratio = fit.chi2 / fit.freedom();
    if (!(ratio < kClearlyLess)) {
        return false;
    }
    for (double& sigma : seen.camera.noise_px) {
        sigma *= std::sqrt(ratio);
    }
    return true;
}

std::vector<ExplainedChange> explained_changes(const std::vector<LensChange>& changes, const LensFit& fit) {
    const Eigen::MatrixXd covariance = fit.covariance();
    std::vector<ExplainedChange> parameters;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        const double error = std::sqrt(std::max(0.0, covariance(at, at)));
        parameters.push_back({.change = changes[i],
                              .value = fit.state.changes[at],
                              .standard_error = error,
                              .prior_standard_error = fit.belief.sigma[at],
                              .determined = error < 0.5 * fit.belief.sigma[at]});
    }
    return parameters;
}

void judge(LensExplanation& explanation, const SeenPoints& seen, const LensFit& before, const LensFit& after) {
    const double shifts_gain = shifts_chi2(seen, before) - shifts_chi2(seen, after);
    const HeldOut& held = explanation.held_out;
    // A focus that the scale and the charts' places all but stand in for shows as what it asks of the scale.
    const bool is_likelier = after.log_evidence > before.log_evidence + kDecisive || shifts_gain > kShiftsGain;
    const bool predicts = held.significance > kSignificant || (is_likelier && held.significance > 0.0);
    const bool fits = is_noise(after);
    if (explanation.largest_strain > kStrained && predicts) {
        explanation.verdict = FitVerdict::not_this_lens;
        explanation.reason =
            fmt::format("more than one thing would have to be wrong: a parameter is asked for {:.1f} of its tolerances",
                        explanation.largest_strain);
    } else if (!predicts) {
        explanation.verdict = FitVerdict::unexplained;
        explanation.reason = is_noise(before)
                                 ? "the prescription itself explains the profile within its noise; nothing is claimed"
                                 : "no change predicts held-out points better than the prescription";
    } else if (!fits) {
        explanation.verdict = FitVerdict::unexplained;
        explanation.reason =
            fmt::format("{:.3g} µm remain, {:.2g} times the noise, that no change within tolerances takes",
                        explanation.rms_um_after, explanation.rms_um_after / explanation.noise_um);
    } else {
        explanation.verdict = FitVerdict::explained;
        explanation.reason = "held-out points are predicted, and what remains is noise";
    }
    if (explanation.verdict != FitVerdict::explained) {
        explanation.cause.clear();
        explanation.other_causes.clear();
    }
}

LensExplanation images_too_little(int imaged, int not_imaged) {
    LensExplanation explanation;
    explanation.verdict = FitVerdict::not_this_lens;
    explanation.points = imaged;
    explanation.points_not_imaged = not_imaged;
    explanation.reason =
        fmt::format("of {} points that the profile has, the lens images only {}", imaged + not_imaged, imaged);
    return explanation;
}

}  // namespace

const char* fit_verdict_name(FitVerdict verdict) {
    switch (verdict) {
        case FitVerdict::explained:
            return "explained";
        case FitVerdict::not_this_lens:
            return "not-this-lens";
        case FitVerdict::unexplained:
            break;
    }
    return "unexplained";
}

std::optional<PrescribedResidual> prescribed_residual(const optics::Lens& lens, const NamedProfile& profile,
                                                      std::optional<double> focus_mm) {
    SeenPoints seen = seen_points({profile});
    const ExplainedLens explained = explained_lens(lens, seen, {}, focus_mm);
    const int not_imaged = keep_imaged(explained, seen);
    if (seen.count() <= not_imaged || seen.views.empty()) {
        return std::nullopt;
    }
    const auto fit = fit_lens(explained, seen, start_of(explained, seen), prescribed_belief(explained.changes));
    return fit ? std::optional(PrescribedResidual{rms_um(seen, fit->residuals), noise_um(seen), seen.count()})
               : std::nullopt;
}

LensExplanation explain(const optics::Lens& lens, const std::vector<NamedProfile>& profiles,
                        const ExplainSettings& settings) {
    SeenPoints seen = seen_points(profiles);
    const ExplainedLens explained = explained_lens(lens, seen, settings.free, settings.focus_mm);
    const int not_imaged = keep_imaged(explained, seen);
    if (seen.count() <= not_imaged || seen.views.empty()) {
        return images_too_little(seen.count(), not_imaged);
    }
    auto before = fit_lens(explained, seen, start_of(explained, seen), prescribed_belief(explained.changes));
    auto usual = before ? fit_lens(explained, seen, before->state, usual_belief(explained.changes)) : std::nullopt;
    if (!usual) {
        return images_too_little(seen.count(), not_imaged);
    }
    LensExplanation explanation;
    if (lower_noise(*usual, seen)) {
        before = fit_lens(explained, seen, before->state, before->belief);
        usual = fit_lens(explained, seen, usual->state, usual->belief);
    }
    const std::vector<FittedCause> causes = likely_causes(explained, seen, *usual);
    const bool has_cause = !causes.empty() && causes.front().fit.log_evidence > usual->log_evidence + kDecisive;
    const LensFit& after = has_cause ? causes.front().fit : *usual;
    for (std::size_t i = 0; has_cause && i < causes.size(); ++i) {
        if (i == 0) {
            explanation.cause = causes[i].cause.what;
        } else if (causes[i].fit.log_evidence > after.log_evidence - kNearlyAsLikely) {
            explanation.other_causes.push_back(causes[i].cause.what);
        }
    }
    explanation.parameters = explained_changes(explained.changes, after);
    explanation.undetermined = open_combinations(explained.changes, after);
    explanation.rms_um_before = rms_um(seen, before->residuals);
    explanation.rms_um_after = rms_um(seen, after.residuals);
    explanation.noise_um = noise_um(seen);
    explanation.chi2_per_freedom = after.chi2 / after.freedom();
    explanation.largest_strain = after.largest_strain();
    explanation.held_out = held_out(explained, seen, after.state, after.belief).value_or(HeldOut{});
    explanation.suggestion = suggest_picture(explained, seen, profiles.front().profile, after);
    explanation.points = seen.count();
    explanation.points_not_imaged = not_imaged;
    judge(explanation, seen, *before, after);
    return explanation;
}

}  // namespace lensproof::calibration
