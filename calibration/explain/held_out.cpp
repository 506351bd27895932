#include "calibration/explain/held_out.h"

#include <cmath>

namespace lensproof::calibration {

namespace {

struct Part {
    SeenPoints seen;
    std::vector<PoseParameters> poses;
};

/// One half of the views, or of each view's points.
Part half_of(const SeenPoints& seen, const LensState& state, std::size_t which) {
    constexpr std::size_t kFewViews = 4;
    Part part{.seen = {.camera = seen.camera, .views = {}, .shifts = {}}, .poses = {}};
    for (std::size_t v = 0; v < seen.views.size(); ++v) {
        const bool whole = seen.views.size() >= kFewViews;
        if (whole && v % 2 != which) {
            continue;
        }
        SeenView view = seen.views[v];
        if (!whole) {
            view.points.clear();
            for (std::size_t i = which; i < seen.views[v].points.size(); i += 2) {
                view.points.push_back(seen.views[v].points[i]);
            }
        }
        part.seen.views.push_back(std::move(view));
        part.poses.push_back(state.poses[v]);
    }
    return part;
}

/// Squared residuals of the points left out, by a lens fitted to the others.
std::optional<Eigen::VectorXd> predicted(const ExplainedLens& lens, const SeenPoints& seen, const LensState& start,
                                         const Belief& belief) {
    Part fitted = half_of(seen, start, 0);
    fitted.seen.shifts = seen.shifts;
    const auto fit = fit_lens(lens, fitted.seen, {start.changes, fitted.poses}, belief);
    const Part left_out = half_of(seen, start, 1);
    if (!fit || left_out.seen.views.empty()) {
        return std::nullopt;
    }
    const Belief held{.mean = fit->state.changes, .sigma = Eigen::VectorXd::Zero(belief.sigma.size())};
    const auto judged = fit_lens(lens, left_out.seen, {fit->state.changes, left_out.poses}, held);
    if (!judged) {
        return std::nullopt;
    }
    const Eigen::Index points = judged->residuals.size() / 2;
    return Eigen::VectorXd(judged->residuals.reshaped(2, points).colwise().squaredNorm().transpose());
}

}  // namespace

std::optional<HeldOut> held_out(const ExplainedLens& lens, const SeenPoints& seen, const LensState& start,
                                const Belief& belief) {
    LensState prescribed = start;
    const Belief as_prescribed = prescribed_belief(lens.changes);
    for (Eigen::Index i = 0; i < prescribed.changes.size(); ++i) {
        prescribed.changes[i] = as_prescribed.sigma[i] > 0.0 ? prescribed.changes[i] : 0.0;
    }
    const auto without = predicted(lens, seen, prescribed, as_prescribed);
    const auto with = predicted(lens, seen, start, belief);
    if (!without || !with || with->size() < 2) {
        return std::nullopt;
    }
    const Eigen::ArrayXd gain = (*without - *with).array();
    const double count = static_cast<double>(gain.size());
    const double variance = (gain - gain.mean()).square().sum() / (count - 1.0);
    return HeldOut{.prescribed = without->mean() / 2.0,
                   .changed = with->mean() / 2.0,
                   .significance = variance > 0.0 ? gain.mean() / std::sqrt(variance / count) : 0.0};
}

}  // namespace lensproof::calibration
