#include "engine/render/prepared_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/bytes.h"
#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/optics/lens_bytes.h"
#include "engine/pupil/kept_maps.h"
#include "engine/render/film.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::render {

namespace {

constexpr double kMostBytes = 16e9;  // of sums in memory

/// Channels of one number make a grey picture.
Vec3d in_three_channels(const spectral::SensorResponse& response, const Vec3d& weights) {
    return response.channels.size() == 1 ? Vec3d{weights.x, weights.x, weights.x} : weights;
}

/// RGB of a reflectance of 1 in one stratum, such that a white in the balanced light gives 1 in all of them together
/// and each stratum's samples count alike.
std::vector<Vec3d> albedo_weights(const std::vector<Vec3d>& rgb_weights, const spectral::SpectralGrid& grid,
                                  const spectral::Illuminant& white) {
    std::vector<Vec3d> weights;
    Vec3d sum;
    for (int i = 0; i < grid.size(); ++i) {
        weights.push_back(white.relative(grid.strata.midpoint(i)) * rgb_weights[static_cast<std::size_t>(i)]);
        sum = sum + weights.back();
    }
    const auto share = [&](double weight, double whole) { return whole > 0.0 ? grid.size() * weight / whole : 0.0; };
    for (Vec3d& weight : weights) {
        weight = {share(weight.x, sum.x), share(weight.y, sum.y), share(weight.z, sum.z)};
    }
    return weights;
}

}  // namespace

PreparedScene::PreparedScene(const SceneSetup& setup, const PixelFilter& filter, const Cache& cache)
    : setup_(setup),
      filter_(filter),
      lens_(setup.camera.lens.empty() ? std::nullopt : std::optional(camera_lens(setup.camera))),
      lens_id_(lens_ ? lens_->id : ""),
      grid_(make_grid()),
      built_(scene::build_scene(setup.scene, grid_, cache)) {
    if (!clamp_note_.empty()) {
        built_.remarks.push_back(clamp_note_);
    }
    const spectral::Illuminant white = spectral::illuminant(setup.white_balance);
    const spectral::SensorResponse response =
        spectral::sensor_response(setup.camera.response, setup.camera.exposure, white);
    const std::vector<Vec3d> weights = spectral::stratum_weights(response, grid_.strata, white);
    std::ranges::transform(weights, std::back_inserter(rgb_weights_),
                           [&](const Vec3d& weight) { return in_three_channels(response, weight); });
    albedo_weights_ = albedo_weights(rgb_weights_, grid_, white);
    colours_ = spectral::rgb_space(setup.camera.response, white);
    if (setup.view.model == scene::LensModel::exact) {
        make_exact_camera(cache);
    } else {
        make_ideal_camera();
    }
    const Sensor& sensor = setup.camera.sensor;
    const double bytes = static_cast<double>(film_bytes_per_pixel(view(0, true).film)) * sensor.width * sensor.height;
    if (bytes > kMostBytes) {
        throw InputError(
            fmt::format("{} × {} pixels with {} spectral layers need {:.1f} GB, expected {:.0f} GB at most: "
                        "fewer pixels or layers",
                        sensor.width, sensor.height, setup.spectral.layers, bytes / 1e9, kMostBytes / 1e9));
    }
}

spectral::SpectralGrid PreparedScene::make_grid() {
    const SpectralSampling& sampling = setup_.spectral;
    const SampledBand band = lens_
                                 ? sampled_band(sampling, *lens_)
                                 : SampledBand{.min_nm = sampling.min_nm, .max_nm = sampling.max_nm, .clamp_note = {}};
    clamp_note_ = band.clamp_note;
    return spectral::spectral_grid(band.min_nm, band.max_nm, sampling.layers * sampling.strata_per_layer);
}

void PreparedScene::make_exact_camera(const Cache& cache) {
    if (!lens_) {
        throw InputError("the exact camera model needs a lens");
    }
    traced_ = std::make_unique<optics::SpectralLens<double>>(
        optics::at_wavelengths<double>(*lens_, grid_.strata.midpoints()));
    // Pixels are areas: the corner of what the corner pixel's filter reaches is the farthest point sampled.
    pupil_ = std::make_unique<pupil::PupilMap>(
        pupil::kept_pupil_map(cache, traced_->at(), lens_->is_rotationally_symmetric,
                              setup_.camera.sensor.half_diagonal_mm(filter_.radius_px() - 0.5)));
    slices_ = std::make_unique<pupil::PupilSlices>(*pupil_, grid_.size());
    camera_ = ExactCamera{traced_.get(), slices_.get()};
}

void PreparedScene::make_ideal_camera() {
    std::vector<GaussianCamera> cameras;
    for (const double nm : grid_.strata.midpoints()) {
        cameras.push_back(lens_ ? gaussian_camera(*lens_, setup_.view.model, nm)
                                : gaussian_camera(setup_.view.focal_length_mm.value(), setup_.camera.f_number,
                                                  setup_.camera.focus_distance_mm, setup_.view.model));
    }
    camera_ = std::move(cameras);
}

SceneView PreparedScene::view(std::uint64_t seed, bool has_features) const {
    const spectral::WavelengthStrata& strata = grid_.strata;
    return {.scene = &built_.scene,
            .camera = &camera_,
            .camera_to_world = scene::camera_to_world(setup_.view),
            .sensor = setup_.camera.sensor,
            .film = {.width = setup_.camera.sensor.width,
                     .height = setup_.camera.sensor.height,
                     .layer_nm =
                         spectral::WavelengthStrata{strata.min_nm, strata.max_nm, setup_.spectral.layers}.midpoints(),
                     .rgb_weights = rgb_weights_,
                     .band_nm = strata.max_nm - strata.min_nm,
                     .filter = filter_,
                     .has_features = has_features},
            .albedo_weights = albedo_weights_,
            .paths = {.max_bounces = setup_.max_bounces},
            .seed = seed};
}

const CameraEnd& PreparedScene::camera_end(const Cache& cache) {
    if (!end_) {
        end_ = CameraEnd{
            .entrance = {}, .camera_to_world = scene::camera_to_world(setup_.view), .sensor = setup_.camera.sensor};
        if (traced_) {
            // Drawn over the whole front in a fifth of all cases, since the map is that of far light.
            entrance_map_ = std::make_unique<pupil::EntranceMap>(
                pupil::kept_entrance_map(cache, traced_->at(), lens_->is_rotationally_symmetric,
                                         std::numeric_limits<double>::infinity(), {.defensive_fraction = 0.2}));
            end_->entrance = LensEntrance{.lens = traced_.get(),
                                          .pupil = pupil_.get(),
                                          .map = entrance_map_.get(),
                                          .front = pupil::front_sphere(traced_->at().front())};
        } else {
            end_->entrance = IdealEntrance{&std::get<std::vector<GaussianCamera>>(camera_)};
        }
    }
    return *end_;
}

std::string PreparedScene::camera_hash() const {
    std::string bytes;
    if (traced_) {
        for (const optics::TraceLens<double>& lens : traced_->at()) {
            optics::append_lens_bytes(bytes, lens);
        }
    } else {
        for (const GaussianCamera& camera : std::get<std::vector<GaussianCamera>>(camera_)) {
            bytes += fmt::format("{} {} {} {} {} {} {} {} {} {}\n", camera.film_z, camera.pupil_z,
                                 camera.pupil_radius_mm, camera.is_pinhole, camera.object_z, camera.h_h, camera.h_s,
                                 camera.s_h, camera.s_s, camera.transmittance);
        }
    }
    return hash_text(bytes);
}

std::map<std::string, std::string> PreparedScene::metadata() const {
    std::map<std::string, std::string> metadata = camera_metadata(
        setup_.camera, lens_ ? lens_->name : fmt::format("{} mm", setup_.view.focal_length_mm.value_or(0.0)),
        setup_.white_balance, filter_, colours_.has_value());
    metadata["lensproof:lensModel"] = scene::name_of(setup_.view.model);
    metadata["lensproof:maxBounces"] = fmt::format("{}", setup_.max_bounces);
    return metadata;
}

}  // namespace lensproof::render
