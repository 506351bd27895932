// experiments/studies/chart_pictures/chart_features.h — what a picture shows of a chart's features, beside what the
// lens's rays make of them.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/formats/image/image.h"
#include "engine/render/camera/camera.h"
#include "engine/render/scene_setup.h"

namespace lensproof::studies {

/// The moments of a feature's light on the film (of its shadow, where it is black on white), along the radius from the
/// axis and across it; in green where no colour is said. Of a cross, those of the arms: along the radius of the arms
/// that run across it, and the other way round.
struct FeatureLook {
    double radius_um = 0.0;      // of the centroid, from the axis
    double tangential_um = 0.0;  // root mean square width along the radius,
    double sagittal_um = 0.0;    // and across it
    double red_um = 0.0;         // of the centroids, along the radius: red less green,
    double blue_um = 0.0;        // blue less green
    double coma_um =
        0.0;  // the third central moment over the second, along the radius: positive where light trails out
    double area_mm2 = 0.0;  // of an even ellipse of the same widths
    double light = 0.0;     // of the white about it, over that about the feature nearest to the axis
};

struct ChartFeature {
    double field_deg = 0.0;
    FeatureLook picture;
    FeatureLook rays;
};
void fields(JsonArchive& json, ChartFeature& feature);

/// A number of a FeatureLook, as files and charts call it.
struct LookQuantity {
    const char* key;    // "tangential_um"
    const char* label;  // "width along the radius"
    const char* unit;
    double FeatureLook::*value;
};
const std::vector<LookQuantity>& look_quantities();

inline constexpr int kMostFeatures = 48;  // evenly over the field, where a frame has more

/// Whose features are looked at.
struct ChartChoice {
    std::vector<std::string> objects{};  // charts of the scene; none: the scene that is a chart
    bool is_lamps = false;               // the scene's spherical lights in the place of a chart's
};

/// The features that lie in the frame with what is about them: discs, dots, crosses, lamps.
/// `rgb`: the picture, R, G and B, as the camera's film makes them of even light of the colour that it is balanced to.
/// By rays: the bundles of points of each feature, as `analyze` traces them, at several wavelengths. In the order of
/// their fields. Throws InputError where the scene has no such chart or lamps, its features have no moments, none lies
/// in the frame, or the lens is not rotationally symmetric.
std::vector<ChartFeature> chart_features(const render::SceneSetup& setup, const render::Camera& camera,
                                         const ChartChoice& choice, const formats::Image& rgb, int threads);

}  // namespace lensproof::studies
