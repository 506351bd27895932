// experiments/studies/tradeoff/field_probe.h — where a camera's light lands, over the frame, beside where its lens lets
// it land.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "engine/render/camera/camera.h"
#include "experiments/studies/tradeoff/measured.h"

namespace lensproof::studies {

/// A pixel of the frame, and a point of the plane of focus that the exact camera sees there.
struct ProbePoint {
    std::uint32_t pixel = 0;  // row by row from the top left
    Vec2d at_px;
    double image_height = 0.0;   // of the half-diagonal, about the axis
    Vec2d outwards;              // unit vector from the axis
    render::LightOrigin origin;  // in the world
};

/// Such points on a grid of about `count` pixels over the frame, without those that the lens gives no light to.
/// `exact`: its paths say which scene points are in focus at a pixel; those more than 80° from the axis are taken as
/// far away.
std::vector<ProbePoint> probe_points(const render::Camera& exact, int count);

struct ProbeSettings {
    int rays = 256;       // of a point and a repetition, in all of the camera's wavelengths
    int even_rays = 512;  // the same, of what an even world gives
    int repetitions = 4;
    std::uint64_t seed = 0;
    int threads = 0;
};

/// What a camera makes of a point of light: of its image in R, G and B where it lies, px from the point's pixel, and
/// its rms radius; and what an even world gives to the pixel in green. Light of 0 where there is none.
struct PointLook {
    std::array<double, 3> light{};
    std::array<Vec2d, 3> centroid{};
    std::array<double, 3> spread_px{};
    double even_light = 0.0;
};

/// In the order of the points: in [r] without repetition r, in the last of all repetitions.
using PointLooks = std::vector<std::vector<PointLook>>;
PointLooks look_at_points(const render::Camera& camera, const std::vector<ProbePoint>& points,
                          const ProbeSettings& settings);

/// By the jackknife over repetitions (Miller 1974): `of(r)` is a statistic of what all but repetition r found together,
/// `of(repetitions)` that of all.
Measured jackknifed(int repetitions, const std::function<double(int left_out)>& of);

/// Of a point, from two cameras' looks at all of them; nothing where it has no such number.
using PointNumber = std::function<std::optional<double>(const std::vector<PointLook>& one,
                                                        const std::vector<PointLook>& other, std::size_t point)>;
/// Its root mean square over the points, by the jackknife.
Measured rms_over_points(const PointLooks& one, const PointLooks& other, const PointNumber& of);

/// What a model does otherwise than the exact camera at a point of the frame, and over the frame.
struct FieldError {
    double image_height = 0.0;
    /// From where the exact camera's rays of the point land to where the model puts them, root mean square over rays
    /// and wavelengths.
    Measured position_um;
    Measured image_px;     // the centroid of the point's image: root mean square over R, G and B
    Measured blur_px;      // rms radius of the point's image, less the exact one's; of the frame, rms
    Measured exposure_ev;  // what an even world gives to the pixel, over the exact one's; of the frame, rms
    /// The geometric MTF of the point's image in green at the pixels' Nyquist frequency, less the exact one's: along
    /// the image height, and across it; of the frame, rms. `mtf`: root mean square of both.
    Measured mtf_tangential;
    Measured mtf_sagittal;
    Measured mtf;
};
void fields(JsonArchive& json, FieldError& error);

struct FieldErrors {
    std::vector<FieldError> at;  // in the order of the points
    FieldError frame;
    double lost = 0.0;  // part of the exact camera's light that the model does not let in
};
void fields(JsonArchive& json, FieldErrors& errors);

/// Both cameras meet light paths, and stand at the same place with the same sensor and response. All rays of a pinhole
/// land where its one ray of the point does. Roots of squares are freed of what noise adds to them by the jackknife
/// over the repetitions, which also gives the standard errors; the points are the same in all of them.
FieldErrors field_errors(const render::Camera& exact, const render::Camera& model,
                         const std::vector<ProbePoint>& points, const ProbeSettings& settings);

}  // namespace lensproof::studies
