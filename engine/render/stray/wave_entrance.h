// engine/render/stray/wave_entrance.h — the light of suns, imaged by waves.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "engine/render/sampling/path_sampler.h"
#include "engine/render/stray/diffracted_entrance.h"
#include "engine/render/stray/wave_image.h"
#include "engine/scene/light/sun_light.h"

namespace lensproof::render {

/// An entrance (entry.h) for light that comes straight from suns: their images and what is diffracted about them. It
/// lands as the WaveImage of its sun has it, about where the chief ray of its direction does; beyond the reach of that
/// image, edges' rays go on (DiffractedEntrance). One image stands for all directions of a disc.
///
/// What stands before the lens in a sun's light cuts off as much of the image as of the beam, and changes its shape not
/// at all.
class WaveEntrance {
  public:
    static constexpr bool shows_points = false;
    static constexpr double kWidestDiscDeg = 1.0;  // the Sun and the Moon have half of it
    using Entry = render::Entry;

    /// Throws InputError as DiffractedEntrance and WaveImage do, for a stop with a picture, for a wider disc, and for a
    /// sun from where no ray comes through the middle of the stop. The camera outlives it.
    WaveEntrance(const Camera& camera, const std::vector<scene::SunLight>& suns, const DiffractionSettings& settings);

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const;

  private:
    /// A sun at a wavelength.
    struct Image {
        WaveImage wave;
        Vec2d chief_mm;               // where the chief ray from the middle of the disc lands
        std::array<Vec2d, 2> across;  // and by how much farther those from beside it do (Basis of the sun), mm
    };
    struct Sun {
        Vec3d towards;
        std::vector<Image> images;  // a stratum of the grid each
    };

    [[nodiscard]] Image image_of(const scene::SunLight& sun, std::size_t wavelength) const;

    const Camera* camera_;
    DiffractedEntrance far_edges_;
    std::vector<Sun> suns_;
};

}  // namespace lensproof::render
