// engine/render/ideal_camera.h — cameras without aberrations: pinhole, thin lens, and a lens's own Gaussian optics.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "engine/optics/lens.h"
#include "engine/render/camera_paths.h"
#include "engine/render/packet/path_kernels.h"
#include "engine/render/pixel_filter.h"
#include "engine/render/sensor.h"

namespace lensproof {

/// What stands for the lens. All are made from it and its settings, expose alike, and so can be compared:
///
///   exact       the lens itself, surface by surface
///   paraxial    its Gaussian optics at each wavelength: pupils, principal planes, axial and lateral colour of first
///               order; no other aberration, no rims but the stop
///   thin-lens   focal length and entrance pupil of the reference line, at the front principal plane
///   pinhole     the thin lens's centre alone, with the light of its whole opening: no blur
///
/// The last three pass what the lens passes along its axis.
enum class CameraModel { exact, paraxial, thin_lens, pinhole };

/// "exact", "paraxial", "thin-lens", "pinhole".
std::vector<std::string> camera_model_names();
CameraModel camera_model_named(const std::string& name);

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
GaussianCamera gaussian_camera(const Lens& lens, CameraModel model, double wavelength_nm);

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

}  // namespace lensproof
