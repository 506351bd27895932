// experiments/studies/stray_light/stray_pictures.h — what of a scene's variants a report shows.
#pragma once
#include <vector>

#include "experiments/findings/findings.h"
#include "experiments/studies/stray_light/render_variant.h"

namespace lensproof::studies {

/// All variants together: a contact sheet of each pass and of the picture, where there are several; the ghosts one by
/// one and features of a chart, where they are asked for; light over what is varied.
std::vector<findings::Picture> pictures_of_all(const StrayScene& scene, const std::vector<VariantFindings>& variants);

/// The picture, and each pass by itself where there are several.
std::vector<findings::Picture> pictures_of(const StrayScene& scene, const StrayVariant& variant,
                                           const VariantFindings& found);

}  // namespace lensproof::studies
