// experiments/studies/cameras/residual_findings.h — what the residuals of a subject's points look like: noise, or
// something that was left out.
#pragma once
#include <string>
#include <vector>

#include "calibration/measure/measure.h"
#include "calibration/statistics/residual_curves.h"
#include "engine/base/json_archive.h"
#include "experiments/findings/findings.h"

namespace lensproof::studies {

/// Where a subject's points lie.
struct ResidualFrame {
    int width_px = 0;
    int height_px = 0;
    Vec2d centre_px;
};

/// Adds to `subject` what its points lie about and a fact, and to `found` the residuals' distribution beside a
/// Gaussian, their radial and tangential means along the radius and around, and a map of their rms. `what` is what
/// they are, "measured − model". Nothing for fewer than kLeastResiduals, no map where they lie too thin for one.
void add_residuals(findings::Findings& found, findings::Subject& subject,
                   const std::vector<calibration::PlacedResidual>& residuals, const ResidualFrame& frame,
                   const std::string& what);

/// A point that is far off, with what there is to see of it.
struct FarPoint {
    double off_px = 0.0;
    std::string caption;
    std::string svg;
};

void fields(JsonArchive& json, FarPoint& point);

inline constexpr std::size_t kWorstPoints = 10;

/// The worst of a profile's points, those that its fit left out among them, as they are in its pictures.
std::vector<FarPoint> far_points(const calibration::Profile& profile,
                                 const std::vector<calibration::Picture>& pictures);

/// Keeps the worst.
void keep_worst(std::vector<FarPoint>& points);

/// As drawings of the subject.
void add_worst(findings::Subject& subject, std::vector<FarPoint> points);

}  // namespace lensproof::studies
