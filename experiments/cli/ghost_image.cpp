#include "experiments/cli/ghost_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"
#include "engine/formats/image/exr_parts.h"
#include "engine/spectral/colour_matching.h"
#include "engine/spectral/spectral_exr.h"

namespace lensproof::cli {

namespace {

constexpr double kMostPixelsAcross = 20000.0;
constexpr double kMostValues = 2.5e8;  // of all parts together: three gigabytes

/// What each wavelength gives in R, G and B; each of them 1 together. A wavelength stands for what is nearest to it;
/// they are in order.
std::vector<Vec3d> rgb_weights(const std::vector<double>& wavelengths_nm) {
    const std::size_t count = wavelengths_nm.size();
    std::vector<Vec3d> grey(count, (1.0 / static_cast<double>(count)) * Vec3d{1.0, 1.0, 1.0});
    const spectral::ColourMatching observer = spectral::cie_1931();
    std::vector<Vec3d> tristimuli;
    tristimuli.reserve(count);
    Vec3d white{};
    for (std::size_t k = 0; k < count; ++k) {
        const double nm = wavelengths_nm[k];
        const double width = wavelengths_nm[std::min(k + 1, count - 1)] - wavelengths_nm[k > 0 ? k - 1 : 0];
        tristimuli.push_back(width * Vec3d{observer.x_bar(nm), observer.y_bar(nm), observer.z_bar(nm)});
        white = white + tristimuli.back();
    }
    if (count < 3 || !(white.x > 0.0 && white.y > 0.0 && white.z > 0.0)) {
        return grey;  // no colours can be told from them
    }
    const auto [red, green, blue] = spectral::rec709_primaries(white);
    const double volume = dot(red, cross(green, blue));
    std::vector<Vec3d> weights;
    weights.reserve(count);
    for (const Vec3d& xyz : tristimuli) {
        weights.push_back((1.0 / volume) *
                          Vec3d{dot(xyz, cross(green, blue)), dot(xyz, cross(blue, red)), dot(xyz, cross(red, green))});
    }
    return weights;
}

formats::Image image_of(const analysis::SpectralPixels& energies, const analysis::PictureSettings& picture,
                        double to_irradiance, const std::vector<Vec3d>& weights) {
    std::vector<std::string> channels{"R", "G", "B"};
    for (const double nm : picture.wavelengths_nm) {
        channels.push_back(spectral::spectral_channel_name(nm));
    }
    formats::Image image = formats::make_image(picture.width, picture.height, channels);
    image.metadata = spectral::spectral_attributes(spectral::kFilmIrradianceUnits);
    float* value = image.pixels.data();
    for (std::size_t i = 0; i < energies.front().size(); ++i) {
        Vec3d rgb{};
        for (std::size_t k = 0; k < energies.size(); ++k) {
            rgb = rgb + (to_irradiance * energies[k][i]) * weights[k];
        }
        for (const double channel : {rgb.x, rgb.y, rgb.z}) {
            *value++ = static_cast<float>(channel);
        }
        for (const std::vector<double>& at : energies) {
            *value++ = static_cast<float>(to_irradiance * at[i]);
        }
    }
    return image;
}

}  // namespace

void add_ghost_image_options(Command& command, GhostImageOptions& options) {
    command
        .add_option("--image", options.file,
                    "Write the ghosts' picture on the sensor: the sum, and the strongest (of --strongest, else eight) "
                    "as parts of their own (spectral EXR)")
        .type_name("FILE");
    command.add_option("--pixels", options.pixels, "Of that picture (default: 1000,1000)")
        .separated_by(',')
        .check(kPositiveOption)
        .type_name("W,H");
    command
        .add_option("--sensor-mm", options.sensor_mm,
                    "Its size, mm; pixels are square (default: the image circle's diameter is the longer side)")
        .separated_by(',')
        .check(kPositiveOption)
        .type_name("W,H");
}

analysis::PictureSettings picture_settings(const GhostImageOptions& options, double image_circle_mm,
                                           std::vector<double> wavelengths_nm, std::size_t layers) {
    std::ranges::sort(wavelengths_nm);
    wavelengths_nm.erase(std::unique(wavelengths_nm.begin(), wavelengths_nm.end()), wavelengths_nm.end());
    const std::vector<double>& pixels = options.pixels;
    const auto is_count = [](double value) {
        return value == std::floor(value) && value >= 1.0 && value <= kMostPixelsAcross;
    };
    if (pixels.size() != 2 || !is_count(pixels[0]) || !is_count(pixels[1])) {
        throw InputError(fmt::format("--pixels is \"{}\", expected two whole numbers W,H from 1 to {:.0f}",
                                     fmt::join(pixels, ","), kMostPixelsAcross));
    }
    const double values =
        static_cast<double>(layers + 1) * static_cast<double>(wavelengths_nm.size() + 3) * pixels[0] * pixels[1];
    if (values > kMostValues) {
        throw InputError(fmt::format(
            "--image would hold {} parts of {:.0f} × {:.0f} pixels and {} wavelengths, {:.3g} numbers, expected "
            "at most {:.3g}: fewer --pixels, --wavelengths or --strongest",
            layers + 1, pixels[0], pixels[1], wavelengths_nm.size(), values, kMostValues));
    }
    analysis::PictureSettings picture{.width = static_cast<int>(pixels[0]),
                                      .height = static_cast<int>(pixels[1]),
                                      .pitch_mm = image_circle_mm / std::max(pixels[0], pixels[1]),
                                      .wavelengths_nm = wavelengths_nm};
    if (!options.sensor_mm.empty()) {
        if (options.sensor_mm.size() != 2) {
            throw InputError(
                fmt::format("--sensor-mm is \"{}\", expected two numbers W,H", fmt::join(options.sensor_mm, ",")));
        }
        const double across = options.sensor_mm[0] / pixels[0];
        const double down = options.sensor_mm[1] / pixels[1];
        if (std::abs(across - down) > 1e-3 * across) {
            throw InputError(fmt::format(
                "--sensor-mm is \"{}\", of which a pixel of --pixels {} has {:g} × {:g} mm, expected squares",
                fmt::join(options.sensor_mm, ","), fmt::join(pixels, ","), across, down));
        }
        picture.pitch_mm = across;
    }
    return picture;
}

void write_ghost_image(const std::string& file, const analysis::PictureSettings& picture, double pupil_area_mm2,
                       const analysis::GhostPictures& pictures, const std::string& about,
                       const std::vector<GhostLayer>& layers) {
    const double to_irradiance = pupil_area_mm2 / (picture.pitch_mm * picture.pitch_mm);
    const std::vector<Vec3d> weights = rgb_weights(picture.wavelengths_nm);
    std::vector<formats::NamedImage> parts{
        {.name = "ghosts", .image = image_of(pictures.sum, picture, to_irradiance, weights)}};
    parts.front().image.metadata["lensproof:ghosts"] = about;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        parts.push_back({.name = "ghost " + layers[i].name,
                         .image = image_of(pictures.ghosts[i].pixels, picture, to_irradiance, weights)});
        parts.back().image.metadata["lensproof:ghost"] = layers[i].row;
    }
    formats::write_exr(parts, file);
}

}  // namespace lensproof::cli
