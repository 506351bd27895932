// engine/render/chart_render.h — a chart seen through a lens: the camera-path pass for flat, evenly lit targets.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/formats/image/image.h"
#include "engine/optics/packet/spectral_lens.h"
#include "engine/optics/trace.h"
#include "engine/pupil/pupil_map.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/film.h"
#include "engine/render/progressive.h"
#include "engine/render/sampling/sensor.h"
#include "engine/scene/chart.h"
#include "engine/scene/pose.h"

namespace lensproof::render {

/// One of the wavelength strata that a render samples evenly.
struct WavelengthStratum {
    double wavelength_nm = 0.0;
    optics::TraceLens<double> lens;
    double white_radiance = 0.0;  // of a perfect white diffuser in the scene's light, W·m⁻²·sr⁻¹·nm⁻¹
    Vec3d rgb_weights;  // linear RGB a film irradiance of 1 W·m⁻²·nm⁻¹ yields per nm, exposure included
};

/// Reflectance of the world where a ray that left the lens arrives; a world as white as the chart's white, in which the
/// chart stands.
double seen_reflectance(const scene::Chart& chart, const scene::RigidMotion& pose, const Ray<double>& outwards);

/// What is seen. The world around the chart is as white as its white, in every direction.
struct SeenChart {
    scene::Chart chart;
    scene::RigidMotion pose;  // of the chart
    Sensor sensor;
    std::vector<WavelengthStratum> strata;  // of equal width
    double stratum_width_nm = 0.0;
    std::vector<double> layer_nm;  // centres of the spectral layers; strata.size() is a multiple of layer_nm.size()
    PixelFilter filter;
    bool has_features = false;  // depth, albedo and normal of the chart are kept too, in the camera's frame
};

/// A view ready to be rendered, tile by tile.
///
/// The estimator of the measurement equation at film point x (Kolb et al. 1995, eq. 4): E = ∫ L τ cos⁴θ / Z² dA over
/// the pupil, by points that `pupil` draws, a map of the strata's lenses, out to where the pixel filter reaches around
/// the sensor. A sample follows from view, pupil, seed, pixel and index alone.
class ChartRender {
  public:
    /// `pupil` outlives it.
    ChartRender(SeenChart view, const pupil::PupilMap& pupil, std::uint64_t seed);
    ChartRender(const ChartRender&) = delete;
    ChartRender& operator=(const ChartRender&) = delete;

    [[nodiscard]] FilmLayout film() const;

    /// A renderer for a thread; it is outlived by this.
    [[nodiscard]] TileRenderer make_renderer() const;

  private:
    SeenChart view_;
    optics::SpectralLens<double> lens_;
    pupil::PupilSlices pupil_;
    std::uint64_t seed_;
};

struct RenderSettings {
    int samples_per_pixel = 64;
    std::uint64_t seed = 0;
    int threads = 0;
};

/// Renders the view with that many samples everywhere. Channels: as `film_image` has them.
formats::Image render_chart(const SeenChart& view, const pupil::PupilMap& pupil, const RenderSettings& settings,
                            const std::function<void(double done)>& progress = {});

}  // namespace lensproof::render
