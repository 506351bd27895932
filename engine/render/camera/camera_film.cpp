// What a camera's film makes of light, and what files say of it.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "engine/base/input_error.h"
#include "engine/render/camera/camera.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::render {

FilmLayout Camera::make_film(int layers, const PixelFilter& filter) const {
    if (settings_.is_exposure_automatic) {
        throw std::logic_error("a camera whose exposure nobody has metered");
    }
    const spectral::WavelengthStrata& strata = grid_.strata;
    const spectral::Illuminant white = spectral::illuminant(settings_.white_balance);
    const spectral::SensorResponse response = spectral::sensor_response(settings_.response, settings_.exposure, white);
    FilmLayout film{.width = sensor().width,
                    .height = sensor().height,
                    .layer_nm = spectral::WavelengthStrata{strata.min_nm, strata.max_nm, layers}.midpoints(),
                    .rgb_weights = spectral::stratum_weights(response, strata, white),
                    .band_nm = strata.max_nm - strata.min_nm,
                    .filter = filter};
    if (response.channels.size() == 1) {  // of one number: a grey picture
        std::ranges::for_each(film.rgb_weights, [](Vec3d& weight) { weight = {weight.x, weight.x, weight.x}; });
    }
    const double bytes = static_cast<double>(film_bytes_per_pixel(film)) * film.width * film.height;
    if (bytes > kMostFilmBytes) {
        throw InputError(
            fmt::format("{} × {} pixels with {} spectral layers need {:.1f} GB, expected {:.0f} GB at most: "
                        "fewer pixels or layers",
                        film.width, film.height, layers, bytes / 1e9, kMostFilmBytes / 1e9));
    }
    return film;
}

std::vector<Vec3d> Camera::albedo_weights() const {
    const spectral::Illuminant white = spectral::illuminant(settings_.white_balance);
    std::vector<Vec3d> weights;
    Vec3d sum;
    for (int i = 0; i < grid_.size(); ++i) {
        weights.push_back(white.relative(grid_.strata.midpoint(i)) * film_.rgb_weights[static_cast<std::size_t>(i)]);
        sum = sum + weights.back();
    }
    const auto of_whole = [&](double weight, double whole) {
        return whole > 0.0 ? grid_.size() * weight / whole : 0.0;
    };
    for (Vec3d& weight : weights) {
        weight = {of_whole(weight.x, sum.x), of_whole(weight.y, sum.y), of_whole(weight.z, sum.z)};
    }
    return weights;
}

std::map<std::string, std::string> Camera::metadata() const {
    return {{"lensproof:lens", lens_ ? lens_->name : fmt::format("{} mm", settings_.focal_length_mm.value_or(0.0))},
            {"lensproof:model", name_of(settings_.model)},
            {"lensproof:fNumber", fmt::format("{}", settings_.f_number)},
            {"lensproof:focusDistance_mm", fmt::format("{}", settings_.focus_distance_mm)},
            {"lensproof:pixelPitch_um", fmt::format("{}", 1e3 * sensor().pixel_pitch_mm)},
            {"lensproof:shutter_s", fmt::format("{}", settings_.exposure.time_s)},
            {"lensproof:iso", fmt::format("{}", settings_.exposure.iso)},
            {"lensproof:response", settings_.response},
            {"lensproof:illuminant", settings_.white_balance},
            {"lensproof:pixelFilter", film_.filter.name()},
            {"lensproof:colourSpace", colours_ ? "linear, Rec. 709 primaries, the illuminant's white"
                                               : "linear, the sensor's own, balanced to the illuminant"}};
}

}  // namespace lensproof::render
