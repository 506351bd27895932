#include "experiments/cli/denoised_files.h"

#include <algorithm>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/formats/image/denoise.h"
#include "engine/render/film/film_image.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

/// What the first surfaces are like, of the pass that knows; empty where none does.
struct Guides {
    std::vector<float> albedo;
    std::vector<float> normal;
};

Guides guides_of(const render::Picture& picture) {
    Guides guides;
    const auto knows = std::ranges::find_if(
        picture.parts(), [](const render::Picture::Part& part) { return part.film->layout().has_features; });
    if (knows == picture.parts().end()) {
        return guides;
    }
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            const render::PixelFeatures at = knows->film->features(x, y);
            for (const double value : {at.albedo_rgb.x, at.albedo_rgb.y, at.albedo_rgb.z}) {
                guides.albedo.push_back(static_cast<float>(std::clamp(value, 0.0, 1.0)));
            }
            for (const double value : {at.normal.x, at.normal.y, at.normal.z}) {
                guides.normal.push_back(static_cast<float>(value));
            }
        }
    }
    return guides;
}

}  // namespace

void add_denoise_option(Command& command, bool& is_denoised) {
    command.add_flag("--denoise", is_denoised,
                     "Also write the picture as Open Image Denoise guesses it without noise (by --features, if they "
                     "are there): to look at, not to measure");
}

void check_denoise(bool is_denoised) {
    if (is_denoised && !formats::denoiser()) {
        throw InputError(
            "--denoise: this program was built without Intel Open Image Denoise, expected a build that finds it "
            "(OpenImageDenoise/oidn.h and its library, version 2)");
    }
}

void write_denoised(const render::Picture& picture, const render::FilmNotes& notes, const std::filesystem::path& exr,
                    Json& json, const CommonOptions& common) {
    formats::Image noisy = render::film_rgb(picture);
    noisy.metadata = notes.metadata;
    Guides guides = guides_of(picture);
    noisy.metadata["lensproof:denoised"] =
        formats::denoiser().value() + (guides.albedo.empty() ? "" : ", by albedo and normals");
    const formats::Image clean =
        formats::denoised(noisy, std::move(guides.albedo), std::move(guides.normal), common.threads);
    const std::filesystem::path denoised = std::filesystem::path(exr).replace_extension(".denoised.exr");
    const std::filesystem::path png = std::filesystem::path(exr).replace_extension(".denoised.png");
    formats::write_exr(clean, denoised);
    formats::write_png(clean, png);
    json["denoised"] = {
        {"exr", denoised.string()}, {"png", png.string()}, {"by", clean.metadata.at("lensproof:denoised")}};
    if (prints_text(common)) {
        print("{}\n{}\n", denoised.string(), png.string());
    }
}

}  // namespace lensproof::cli
