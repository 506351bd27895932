#include "calibration/geometry/model_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/geometry/projection_uncertainty.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr double kHopeless = 2.0;    // residuals against the best's: no cross-validation will make up for that
constexpr double kMuchWorse = 1.05;  // held-out error against the best's

// A candidate at work.
struct Trial {
    ModelCandidate candidate;
    GeometryOptions options;
    std::optional<GeometryFit> fit;    // to all points, outliers marked
    std::optional<GeometryFit> clean;  // to the points that all candidates share
    CrossValidation validation;
    double excess2 = 0.0;
    bool predicts_well = false;
};

std::vector<Trial> make_trials(const GeometryOptions& options) {
    struct Model {
        ModelKind kind;
        std::optional<int> radial_terms;
    };
    std::vector<Model> models{{ModelKind::brown_conrady, 2},       {ModelKind::kannala_brandt, std::nullopt},
                              {ModelKind::division, std::nullopt}, {ModelKind::brown_conrady, std::nullopt},
                              {ModelKind::kannala_brandt, 2},      {ModelKind::brown_conrady_rational, std::nullopt},
                              {ModelKind::spline, std::nullopt}};
    if (options.radial_terms) {
        models = {{ModelKind::brown_conrady, options.radial_terms}, {ModelKind::kannala_brandt, options.radial_terms}};
    }
    std::vector<Trial> trials;
    for (const auto& [kind, terms] : models) {
        Trial trial;
        trial.options = options;
        trial.options.model = kind;
        trial.options.radial_terms = terms;
        const CameraModel model = empty_model(kind);
        const ModelTerms all = model_terms(model);
        const int radial = std::min(terms.value_or(100), static_cast<int>(all.radial.size()));
        trial.candidate.name = kind_name(model);
        trial.candidate.kind = kind;
        if (terms) {
            trial.candidate.radial_terms = radial;
            trial.candidate.name += fmt::format(" with {} radial term{}", radial, radial == 1 ? "" : "s");
        }
        trial.candidate.parameters = (options.known_focal_px ? 0 : 1) + (options.fix_centre ? 0 : 2) + radial +
                                     (options.fit_stretch ? 1 : 0) +
                                     (options.fit_tangential ? static_cast<int>(all.tangential.size()) : 0);
        trials.push_back(std::move(trial));
    }
    return trials;
}

// Outliers are a model's failure too: the one that uses more points is not punished for it.
double misfit(const GeometryFit& fit) {
    return fit.sigma_px / fit.points_used;
}

class Choice {
  public:
    Choice(const std::vector<ChartView>& views, int width, int height, const GeometryOptions& options)
        : views_(views), width_(width), height_(height), trials_(make_trials(options)) {}

    ChosenGeometry run() {
        fit_all();
        validate_all();
        const std::size_t best = best_predictor();
        judge(best);
        const std::size_t chosen = least_error(best);
        ModelChoice choice{.candidates = {},
                           .chosen = static_cast<int>(chosen),
                           .folds = trials_[chosen].validation.folds,
                           .corner_disagreement_px = std::nullopt,
                           .why = {}};
        std::vector<GeometryFit> rivals;
        for (const Trial& trial : trials_) {
            choice.candidates.push_back(trial.candidate);
            if (trial.predicts_well && &trial != &trials_[chosen]) {
                rivals.push_back(*trial.fit);
            }
        }
        for (const Vec2d& corner : corners(trials_[best].clean->model)) {
            choice.corner_disagreement_px =
                std::max(choice.corner_disagreement_px, models_disagreement_px(*trials_[chosen].fit, rivals, corner));
        }
        choice.why = why(best, chosen, choice.corner_disagreement_px);
        return {*trials_[chosen].fit, trials_[chosen].options, choice, std::move(rivals)};
    }

  private:
    template <class Step>
    static void attempt(Trial& trial, const Step& step) {
        try {
            step();
        } catch (const InputError& e) {
            trial.candidate.refused = e.what();
            trial.clean.reset();
        }
    }

    // The first two from nothing, the others from the better of these.
    void fit_all() {
        for (std::size_t i = 0; i < trials_.size(); ++i) {
            Trial& trial = trials_[i];
            attempt(trial, [&] {
                trial.fit = i < 2 || reference_ == nullptr
                                ? fit_geometry(views_, width_, height_, trial.options)
                                : refit_geometry(views_, width_, height_, trial.options, state_of(*reference_->fit));
                if (reference_ == nullptr || misfit(*trial.fit) < misfit(*reference_->fit)) {
                    reference_ = &trial;
                }
            });
        }
        if (reference_ == nullptr) {
            throw InputError(trials_.front().candidate.refused);
        }
    }

    // The same points for all, each candidate fitted to them and cross-validated.
    void validate_all() {
        const std::vector<ChartView> used = used_points(views_, *reference_->fit);
        for (Trial& trial : trials_) {
            if (!trial.fit) {
                continue;
            }
            if (misfit(*trial.fit) > kHopeless * misfit(*reference_->fit)) {
                trial.candidate.refused =
                    fmt::format("it leaves residuals of {:.3f} px rms where {} leaves {:.3f} px", trial.fit->rms_px,
                                reference_->candidate.name, reference_->fit->rms_px);
                continue;
            }
            attempt(trial, [&] {
                BundleState start = state_of(*trial.fit);
                const std::vector<PoseParameters> poses = std::move(start.poses);
                start.poses.clear();
                std::vector<ChartView> shared;
                for (std::size_t v = 0; v < used.size(); ++v) {
                    if (used[v].image_px.size() >= 4) {
                        shared.push_back(used[v]);
                        start.poses.push_back(poses[v]);
                    }
                }
                GeometryOptions options = trial.options;
                options.outlier_sigmas = 0.0;
                trial.clean = refit_geometry(shared, width_, height_, options, start);
                trial.validation = cross_validate(shared, width_, height_, options, *trial.clean);
                trial.candidate.rms_px = trial.clean->rms_px;
                trial.candidate.held_out_rms_px = trial.validation.held_out_rms_px;
                if (trial.validation.halves) {
                    trial.candidate.halves_px = trial.validation.halves->rms_px;
                }
            });
        }
    }

    [[nodiscard]] std::size_t best_predictor() const {
        std::size_t best = trials_.size();
        for (std::size_t i = 0; i < trials_.size(); ++i) {
            if (trials_[i].clean && (best == trials_.size() ||
                                     trials_[i].candidate.held_out_rms_px < trials_[best].candidate.held_out_rms_px)) {
                best = i;
            }
        }
        if (best == trials_.size()) {
            throw InputError(trials_.front().candidate.refused);
        }
        return best;
    }

    // The corners, or as far out towards them as `model` images anything.
    [[nodiscard]] std::vector<Vec2d> corners(const CameraModel& model) const {
        const Vec2d centre = centre_px(model);
        std::vector<Vec2d> points;
        for (const double x : {0.0, width_ - 1.0}) {
            for (const double y : {0.0, height_ - 1.0}) {
                double fraction = 1.0;
                const auto at = [&] {
                    return Vec2d{centre.x + fraction * (x - centre.x), centre.y + fraction * (y - centre.y)};
                };
                while (fraction > 0.1 && !unproject(model, at())) {
                    fraction -= 0.02;
                }
                points.push_back(at());
            }
        }
        return points;
    }

    void judge(std::size_t best) {
        const std::vector<Vec2d> far_points = corners(trials_[best].clean->model);
        const std::vector<double>& least = trials_[best].validation.held_out_squared_px;
        for (Trial& trial : trials_) {
            if (!trial.clean) {
                continue;
            }
            double worst = 0.0;
            for (const Vec2d& point : far_points) {
                worst = std::max(
                    worst,
                    projection_uncertainty_px(*trial.clean, point).value_or(std::numeric_limits<double>::infinity()));
            }
            ModelCandidate& candidate = trial.candidate;
            if (std::isfinite(worst)) {
                candidate.corner_px = worst;
            }
            trial.excess2 = excess(trial.validation.held_out_squared_px, least);
            const double best2 = std::pow(trials_[best].candidate.held_out_rms_px, 2);
            trial.predicts_well = best2 + trial.excess2 <= kMuchWorse * kMuchWorse * best2;
            if (candidate.corner_px && trial.predicts_well) {
                const double half = 0.5 * candidate.halves_px.value_or(0.0);
                candidate.expected_error_px = std::sqrt(trial.excess2 + half * half + worst * worst);
            }
        }
    }

    // Mean square above the best's, less one standard error of the mean of the differences between views.
    static double excess(const std::vector<double>& own, const std::vector<double>& least) {
        const auto n = static_cast<double>(own.size());
        double mean = 0.0;
        for (std::size_t v = 0; v < own.size(); ++v) {
            mean += (own[v] - least[v]) / n;
        }
        double squares = 0.0;
        for (std::size_t v = 0; v < own.size(); ++v) {
            squares += std::pow(own[v] - least[v] - mean, 2);
        }
        return std::max(0.0, mean - (n > 1.0 ? std::sqrt(squares / (n * (n - 1.0))) : 0.0));
    }

    // Fewer parameters win a tie; and should no candidate be left, the best predictor.
    [[nodiscard]] std::size_t least_error(std::size_t best) const {
        const auto order = [&](std::size_t i) {
            const ModelCandidate& c = trials_[i].candidate;
            return std::pair(c.expected_error_px.value_or(std::numeric_limits<double>::infinity()), c.parameters);
        };
        std::size_t chosen = best;
        for (std::size_t i = 0; i < trials_.size(); ++i) {
            if (order(i) < order(chosen)) {
                chosen = i;
            }
        }
        return chosen;
    }

    [[nodiscard]] std::string why(std::size_t best, std::size_t chosen,
                                  const std::optional<double>& corner_disagreement_px) const {
        const ModelCandidate& taken = trials_[chosen].candidate;
        std::string text = fmt::format("{} ({} parameters) predicts held-out points to {:.4f} px", taken.name,
                                       taken.parameters, taken.held_out_rms_px);
        text += best == chosen ? ", better than any other" : fmt::format(", within chance or 5 % of the best");
        if (taken.halves_px) {
            text += fmt::format("; fits to two halves of the views differ by {:.4f} px", *taken.halves_px);
        }
        if (taken.corner_px) {
            text += fmt::format("; its corners are known to {:.4f} px", *taken.corner_px);
            if (corner_disagreement_px) {
                text += fmt::format(", were it the right model; those that predict as well differ there by {:.4f} px",
                                    *corner_disagreement_px);
            }
        }
        text += ".";
        for (std::size_t i = 0; i < trials_.size(); ++i) {
            if (i != chosen) {
                text += " " + why_not(trials_[i], trials_[best], trials_[chosen]);
            }
        }
        return text;
    }

    static std::string why_not(const Trial& trial, const Trial& best, const Trial& chosen) {
        const ModelCandidate& c = trial.candidate;
        if (!trial.clean) {
            return fmt::format("{} is out: {}.", c.name, c.refused);
        }
        if (!c.corner_px) {
            return fmt::format("{} images nothing where the best does.", c.name);
        }
        if (!c.expected_error_px) {
            return fmt::format("{} predicts {:.0f} % worse than {} ({:.4f} px).", c.name,
                               100.0 * (c.held_out_rms_px / best.candidate.held_out_rms_px - 1.0), best.candidate.name,
                               c.held_out_rms_px);
        }
        std::string reason;
        const double half = 0.5 * c.halves_px.value_or(0.0);
        if (*c.corner_px >= half && *c.corner_px * *c.corner_px >= trial.excess2) {
            reason = fmt::format("its corners are known to {:.4f} px only", *c.corner_px);
        } else if (half * half >= trial.excess2) {
            reason = fmt::format("its two halves differ by {:.4f} px", 2.0 * half);
        } else {
            reason = fmt::format("it predicts worse ({:.4f} px)", c.held_out_rms_px);
        }
        return fmt::format("{} is expected to be off by {:.4f} px instead of {:.4f}: {}.", c.name, *c.expected_error_px,
                           chosen.candidate.expected_error_px.value_or(0.0), reason);
    }

    const std::vector<ChartView>& views_;
    int width_;
    int height_;
    std::vector<Trial> trials_;
    const Trial* reference_ = nullptr;  // into trials_
};

}  // namespace

ChosenGeometry choose_model(const std::vector<ChartView>& views, int width_px, int height_px,
                            const GeometryOptions& options) {
    return Choice(views, width_px, height_px, options).run();
}

}  // namespace lensproof::calibration
