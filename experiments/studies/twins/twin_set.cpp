#include "experiments/studies/twins/twin_set.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/paraxial.h"

namespace lensproof::studies {

namespace {

double f_number_of(const TwinSettings& settings, const calibration::Profile& profile) {
    if (settings.f_number) {
        return *settings.f_number;
    }
    if (profile.source.notes && profile.source.notes->f_number) {
        return *profile.source.notes->f_number;
    }
    throw InputError(fmt::format("twins \"{}\": the photos state no f-number, expected f_number", settings.name));
}

double scale_of(const calibration::ExplainedLens& lens, const calibration::LensState& state) {
    for (std::size_t c = 0; c < lens.changes.size(); ++c) {
        if (lens.changes[c].kind == calibration::ChangeKind::scale) {
            return 1.0 + state.changes[static_cast<Eigen::Index>(c)];
        }
    }
    return 1.0;
}

/// What the photos decide, with its error.
std::vector<std::string> changes_in_words(const calibration::ExplainedLens& lens, const calibration::LensFit& fit) {
    const Eigen::MatrixXd covariance = fit.covariance();
    std::vector<std::string> words;
    for (std::size_t c = 0; c < lens.changes.size(); ++c) {
        const auto at = static_cast<Eigen::Index>(c);
        const double error = std::sqrt(std::max(0.0, covariance(at, at)));
        if (error < 0.5 * fit.belief.sigma[at]) {
            words.push_back(fmt::format("{} {:.4g} ± {:.2g}", lens.changes[c].name, fit.state.changes[at], error));
        }
    }
    return words;
}

/// The lens with the pixel pitch that the profile has; nothing where it does not image the points.
std::optional<FittedTwin> fit_at_pitch(const TwinSettings& settings, const optics::Lens& lens,
                                       const calibration::Profile& profile, double& scale) {
    FittedTwin twin;
    twin.seen = calibration::seen_points({{settings.photos, profile}});
    const calibration::ExplainedLens explained =
        calibration::explained_lens(lens, twin.seen, settings.free, settings.focus_distance_mm);
    twin.points_not_imaged = calibration::keep_imaged(explained, twin.seen);
    if (twin.seen.views.empty()) {
        return std::nullopt;
    }
    auto fit = calibration::fit_lens(explained, twin.seen, calibration::start_of(explained, twin.seen),
                                     calibration::prescribed_belief(explained.changes));
    if (fit && !settings.free.empty()) {
        fit = calibration::fit_lens(explained, twin.seen, fit->state, calibration::usual_belief(explained.changes));
    }
    auto predicted = fit ? calibration::predicted_points(explained, twin.seen, fit->state) : std::nullopt;
    if (!predicted) {
        return std::nullopt;
    }
    scale = scale_of(explained, fit->state);
    twin.camera = calibration::twin_camera(explained, twin.seen, fit->state);
    twin.predicted = *std::move(predicted);
    twin.changes = changes_in_words(explained, *fit);
    return twin;
}

}  // namespace

FittedTwin fit_twin(const TwinSettings& settings, const calibration::Profile& profile) {
    if (!profile.geometry) {
        throw InputError(fmt::format("twins \"{}\": {} has no geometry: {}", settings.name, settings.photos,
                                     calibration::why_not_measured(profile, "geometry", "it was not measured")));
    }
    const double f_number = f_number_of(settings, profile);
    const optics::Lens lens = optics::with_f_number(formats::load_lens(settings.lens), f_number);
    const double efl_mm = optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD)).efl;
    calibration::Profile sized = profile;
    const bool is_pitch_known = profile.pixel_pitch_um.has_value();
    if (!is_pitch_known) {
        sized.pixel_pitch_um = 1e3 * std::abs(efl_mm) / calibration::focal_length_px(profile.geometry->model);
    }
    // The camera model's focal length is not quite the lens's: what the scale is then asked for is the pitch's.
    constexpr int kMostTrials = 5;
    constexpr double kSettled = 1e-5;
    for (int trial = 1;; ++trial) {
        double scale = 1.0;
        auto twin = fit_at_pitch(settings, lens, sized, scale);
        if (!twin) {
            throw InputError(fmt::format("twins \"{}\": {} does not image the points that the photos show",
                                         settings.name, settings.lens));
        }
        if (is_pitch_known || trial == kMostTrials || std::abs(scale - 1.0) < kSettled) {
            twin->f_number = f_number;
            twin->efl_mm = efl_mm;
            twin->is_pitch_known = is_pitch_known;
            return *std::move(twin);
        }
        *sized.pixel_pitch_um /= scale;
    }
}

}  // namespace lensproof::studies
