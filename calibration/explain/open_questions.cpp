#include "calibration/explain/open_questions.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calibration/statistics/dense_solvers.h"
#include "engine/base/angle.h"

namespace lensproof::calibration {

namespace {

constexpr double kOpen = 0.5;  // of the tolerance
constexpr double kUntouched = 0.97;
constexpr double kListed = 0.15;  // a component that is worth its name

bool is_of_lens(const LensChange& change) {
    return change.kind != ChangeKind::scale && change.kind != ChangeKind::sensor_shift;
}

/// The covariance in tolerances.
Eigen::MatrixXd relative_covariance(const LensFit& fit, const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd scale =
        (fit.belief.sigma.array() > 0.0).select(fit.belief.sigma.array().inverse(), 0.0).matrix();
    return scale.asDiagonal() * covariance * scale.asDiagonal();
}

/// A direction over all changes, with those components that are worth a name.
OpenCombination combination(const std::vector<LensChange>& changes, const Eigen::VectorXd& direction, double error) {
    OpenCombination open{.direction = {}, .standard_error = error};
    std::vector<Eigen::Index> order;
    for (Eigen::Index i = 0; i < direction.size(); ++i) {
        if (std::abs(direction[i]) >= kListed) {
            order.push_back(i);
        }
    }
    std::ranges::stable_sort(order, std::greater<>(), [&](Eigen::Index i) { return std::abs(direction[i]); });
    const double sign = order.empty() || direction[order.front()] > 0.0 ? 1.0 : -1.0;
    for (const Eigen::Index i : order) {
        open.direction.emplace_back(changes[static_cast<std::size_t>(i)].name, sign * direction[i]);
    }
    return open;
}

struct OpenDirection {
    Eigen::VectorXd direction;
    double standard_error = 0.0;
};

std::vector<OpenDirection> open_directions(const std::vector<LensChange>& changes, const LensFit& fit) {
    const Eigen::MatrixXd relative = relative_covariance(fit, fit.covariance());
    std::vector<OpenDirection> found;
    std::vector<Eigen::Index> touched;
    for (Eigen::Index i = 0; i < relative.rows(); ++i) {
        if (std::sqrt(relative(i, i)) >= kUntouched) {
            found.push_back({Eigen::VectorXd::Unit(relative.rows(), i), std::sqrt(relative(i, i))});
        } else if (fit.belief.sigma[i] > 0.0) {
            touched.push_back(i);
        }
    }
    const SymmetricEigen axes = symmetric_eigen(relative(touched, touched));
    for (Eigen::Index k = static_cast<Eigen::Index>(touched.size()) - 1; k >= 0; --k) {
        const double error = std::sqrt(std::max(0.0, axes.values[k]));
        if (error < kOpen) {
            break;
        }
        Eigen::VectorXd direction = Eigen::VectorXd::Zero(relative.rows());
        for (std::size_t i = 0; i < touched.size(); ++i) {
            direction[touched[i]] = axes.vectors(static_cast<Eigen::Index>(i), k);
        }
        found.push_back({std::move(direction), error});
    }
    std::erase_if(found, [&](const OpenDirection& open) {
        for (std::size_t i = 0; i < changes.size(); ++i) {
            if (is_of_lens(changes[i]) && std::abs(open.direction[static_cast<Eigen::Index>(i)]) >= kListed) {
                return false;
            }
        }
        return true;
    });
    return found;
}

/// A chart that fills the frame: where rays of an even grid of pixels meet a plane at `distance_mm`, tilted.
SeenPoints chart_view(const SeenPoints& seen, const Profile& profile, double distance_mm, double about_x,
                      double about_y) {
    SeenPoints view{
        .camera = seen.camera, .views = {{.image = {}, .profile = 0, .pose = {}, .points = {}}}, .shifts = {}};
    const Vec3d normal{std::sin(about_y), -std::sin(about_x), std::cos(about_x) * std::cos(about_y)};
    constexpr int kAcross = 9;
    for (int i = 0; i < kAcross * kAcross; ++i) {
        const int row = i / kAcross;
        const Vec2d pixel{(seen.camera.width_px - 1) * (0.05 + 0.9 * (i % kAcross) / (kAcross - 1)),
                          (seen.camera.height_px - 1) * (0.05 + 0.9 * row / (kAcross - 1))};
        const auto ray = unproject(profile.geometry->model, pixel);
        if (ray && dot(*ray, normal) > 0.1) {
            view.views.front().points.push_back({distance_mm * normal.z / dot(*ray, normal) * *ray, pixel});
        }
    }
    return view;
}

struct CandidateSetup {
    double distance_mm = 0.0;
    double about_x = 0.0;
    double about_y = 0.0;
};

std::string candidate_text(const CandidateSetup& of) {
    const bool is_tilted = of.about_x != 0.0 || of.about_y != 0.0;
    return fmt::format("the same focus, and a chart that fills the frame at {:.0f} mm, {}", of.distance_mm,
                       !is_tilted
                           ? std::string("facing the camera")
                           : fmt::format("tilted by {:.0f}° about the {} axis", (of.about_x + of.about_y) / kDegree,
                                         of.about_x != 0.0 ? "horizontal" : "vertical"));
}

std::vector<CandidateSetup> candidates(double distance_mm) {
    constexpr double kTilt = 35.0 * kDegree;
    std::vector<CandidateSetup> all;
    for (const double factor : {0.5, 1.0, 2.0, 5.0}) {
        all.push_back({factor * distance_mm, 0.0, 0.0});
        all.push_back({factor * distance_mm, kTilt, 0.0});
        all.push_back({factor * distance_mm, 0.0, kTilt});
    }
    return all;
}

}  // namespace

std::vector<OpenCombination> open_combinations(const std::vector<LensChange>& changes, const LensFit& fit) {
    std::vector<OpenCombination> listed;
    for (const OpenDirection& open : open_directions(changes, fit)) {
        listed.push_back(combination(changes, open.direction, open.standard_error));
    }
    return listed;
}

std::optional<Suggestion> suggest_picture(const ExplainedLens& lens, const SeenPoints& seen, const Profile& profile,
                                          const LensFit& fit) {
    constexpr double kWorthwhile = 0.9;
    const auto directions = open_directions(lens.changes, fit);
    std::optional<Suggestion> best;
    double best_fraction = kWorthwhile;
    for (const CandidateSetup& candidate : candidates(seen.camera.chart_mm.front())) {
        const SeenPoints view = chart_view(seen, profile, candidate.distance_mm, candidate.about_x, candidate.about_y);
        LensState state{.changes = fit.state.changes, .poses = {PoseParameters{}}};
        ResidualTracer tracer(lens, view);
        const auto found = view.count() > 0 ? tracer.residuals(state, true) : std::nullopt;
        if (!found) {
            continue;
        }
        LensFit with_it = fit;
        with_it.information += information_of(*found);
        const Eigen::MatrixXd relative = relative_covariance(fit, with_it.covariance());
        for (const OpenDirection& open : directions) {
            const double error = std::sqrt(std::max(0.0, open.direction.dot(relative * open.direction)));
            if (error / open.standard_error < best_fraction) {
                best_fraction = error / open.standard_error;
                best = {candidate_text(candidate), combination(lens.changes, open.direction, open.standard_error),
                        error};
            }
        }
    }
    return best;
}

}  // namespace lensproof::calibration
