// engine/render/chart_render.h — a chart seen through a lens: the camera-path pass for flat, evenly lit targets.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/io/image.h"
#include "engine/optics/trace.h"
#include "engine/pupil/pupil_map.h"
#include "engine/render/sensor.h"
#include "engine/scene/chart.h"
#include "engine/scene/pose.h"

namespace lensproof {

/// One of the wavelength strata that a render samples evenly.
struct WavelengthStratum {
    double wavelength_nm = 0.0;
    TraceLens<double> lens;
    double white_radiance = 0.0;  // of a perfect white diffuser in the scene's light, W·m⁻²·sr⁻¹·nm⁻¹
    Vec3d rgb_weights;  // linear RGB a film irradiance of 1 W·m⁻²·nm⁻¹ yields per nm, exposure included
};

/// Reflectance of the world where a ray that left the lens arrives; a world as white as the chart's white, in which the
/// chart stands.
double seen_reflectance(const Chart& chart, const RigidMotion& pose, const Ray<double>& outwards);

/// What is seen. The world around the chart is as white as its white, in every direction.
struct SeenChart {
    Chart chart;
    RigidMotion pose;  // of the chart
    Sensor sensor;
    std::vector<WavelengthStratum> strata;  // of equal width
    double stratum_width_nm = 0.0;
    std::vector<double> layer_nm;  // centres of the spectral layers; strata.size() is a multiple of layer_nm.size()
};

struct RenderSettings {
    int samples_per_pixel = 64;
    std::uint64_t seed = 0;
    int threads = 0;
};

/// Renders the view. Channels: R, G, B (linear, 1 = saturation), their standard errors error.R, error.G, error.B
/// (as if samples were independent: an upper bound, since they are stratified), then one spectral layer a wavelength:
/// mean film irradiance over its band, W·m⁻²·nm⁻¹.
///
/// The estimator of the measurement equation at film point x (Kolb et al. 1995, eq. 4): E = ∫ L τ cos⁴θ / Z² dA over
/// the pupil, by points that `pupil` draws, a map of the strata's lenses; pixels integrate over their whole area. The
/// result depends on view, pupil, samples and seed alone.
Image render_chart(const SeenChart& view, const PupilMap& pupil, const RenderSettings& settings,
                   const std::function<void(double done)>& progress = {});

}  // namespace lensproof
