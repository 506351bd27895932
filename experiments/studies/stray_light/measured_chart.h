// experiments/studies/stray_light/measured_chart.h — [stray_light.chart]: the features of a chart in the variants'
// pictures, held to the lens's rays and to limits.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "experiments/findings/study.h"
#include "experiments/studies/chart_pictures/chart_features.h"

namespace lensproof::studies {

/// A mean over the features of some fields of a variant's picture, held to a limit.
struct LookCheck {
    const LookQuantity* quantity = nullptr;
    std::size_t variant = 0;
    std::vector<double> field_deg;  // from, to
    findings::Bound bound;
};

struct MeasuredChart {
    ChartChoice choice;
    /// What is drawn, and how far picture and rays may be apart in the mean over a third of a variant's
    /// features.
    std::vector<std::pair<const LookQuantity*, double>> agrees;
    std::vector<LookCheck> checks;
};

/// `variants`: their names.
MeasuredChart read_measured_chart(TomlTable table, const std::vector<std::string>& variants);

/// A variant and what its picture shows.
struct VariantFeatures {
    std::string name;
    std::string label;
    std::vector<ChartFeature> features;
};

/// Checks of the group `title`, whose ids begin with `name`. In a draft the noise is larger, and so are the limits of
/// agreement.
std::vector<findings::Check> chart_checks(const MeasuredChart& chart, const std::string& name, const std::string& title,
                                          const std::vector<VariantFeatures>& variants, findings::Quality quality);

/// A drawing of each quantity over the field: marks of the pictures on curves of the rays.
std::vector<findings::Picture> chart_drawings(const MeasuredChart& chart, const std::string& name,
                                              const std::vector<VariantFeatures>& variants);

/// [{"field_deg", "picture": {QUANTITY: value, …}, "rays": {…}}]
Json features_json(const std::vector<ChartFeature>& features);

}  // namespace lensproof::studies
