// experiments/studies/stray_light/light_chart.h — the light of variants that `vary` made, over what it sets.
#pragma once
#include <optional>
#include <vector>

#include "experiments/findings/findings.h"
#include "experiments/studies/stray_light/render_variant.h"

namespace lensproof::studies {

/// The mean of each pass's picture, over the numbers of which there are most, a panel for each combination of what else
/// is varied. Nothing where no number is.
std::optional<findings::Picture> light_chart(const StrayScene& scene, const std::vector<VariantFindings>& variants);

}  // namespace lensproof::studies
