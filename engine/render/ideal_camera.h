// engine/render/ideal_camera.h — cameras without aberrations: pinhole, thin lens, and a lens's own Gaussian optics.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "engine/optics/lens.h"
#include "engine/render/camera_paths.h"
#include "engine/render/packet/path_kernels.h"
#include "engine/render/sampling/pixel_filter.h"
#include "engine/render/sampling/sensor.h"
#include "engine/scene/lens_model.h"

namespace lensproof::render {

/// First-order optics between film and scene at one wavelength; lens space, mm. A film ray crosses the pupil's plane
/// (z = `pupil_z`, behind the lens) at height h with slope s = dh/dz; in front of the lens it is the line that crosses
/// z = `object_z` at height h_h h + h_s s with slope s_h h + s_s s, in x and y alike.
struct GaussianCamera {
    double film_z = 0.0;
    double pupil_z = 0.0;
    double pupil_radius_mm = 0.0;
    bool is_pinhole = false;  // paths cross the pupil's centre, and count for all of it
    double object_z = 0.0;
    double h_h = 1.0;
    double h_s = 0.0;
    double s_h = 0.0;
    double s_s = 1.0;
    double transmittance = 1.0;

    friend bool operator==(const GaussianCamera&, const GaussianCamera&) = default;
};

/// `lens`, stopped down and focused, as one of the ideal models at a wavelength. Throws InputError for a lens that has
/// no focal length, and for a paraxial one whose exit pupil lies at infinity.
GaussianCamera gaussian_camera(const optics::Lens& lens, scene::LensModel model, double wavelength_nm);

/// A pinhole or a thin lens that stands for no lens: of focal length and f-number, focused `focus_distance_mm` before
/// it, at the frame's origin; it loses no light. Throws InputError for another model and for a focus within the focal
/// length.
GaussianCamera gaussian_camera(double focal_length_mm, double f_number, double focus_distance_mm,
                               scene::LensModel model);

/// What ideal camera paths are made of. `at`: the camera at the wavelengths that samples spread evenly over.
struct IdealPathSource {
    Sensor sensor;
    const std::vector<GaussianCamera>* at = nullptr;
    std::uint64_t seed = 0;
    PixelFilter filter;
};

/// As CameraPathProducer, for ideal cameras: the same samples on the film, the same sense of `weight`.
class IdealPathProducer {
  public:
    explicit IdealPathProducer(IdealPathSource source);

    void start(const CameraPathRange& range);
    bool fill(CameraPathBuffer<double>& buffer);
    [[nodiscard]] std::int64_t started() const { return started_; }

  private:
    void append(std::size_t sample, CameraPathBuffer<double>& buffer);

    IdealPathSource source_;
    const PathKernels<double>* kernels_;
    PathCursor cursor_;
    std::uint32_t end_pixel_ = 0;
    std::unique_ptr<PathStarts> starts_;
    PathColumn<double> filter_weight_{};
    std::int64_t started_ = 0;
};

}  // namespace lensproof::render
