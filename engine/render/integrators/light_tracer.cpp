#include "engine/render/integrators/light_tracer.h"

#include "engine/render/integrators/light_walk.h"

namespace lensproof::render {

namespace {

/// The way through the lens that makes the image.
class ImagedEntrance {
  public:
    static constexpr bool shows_points = false;  // their image's radiance is no number
    struct Entry : render::Entry {
        FilmImportance film;
    };

    explicit ImagedEntrance(const Camera& camera) : camera_(&camera) {}

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const {
        const auto u = numbers.next();
        const auto in = camera_->sample(from, path, u[0], u[1]);
        if (!in) {
            return std::nullopt;
        }
        const FilmImportance film = camera_->importance(in->ray, path);
        return Entry{{.direction = in->direction,
                      .end = in->end,
                      .at_px = film.at_px,
                      .weight = film.transmittance,
                      .pdf = is_hero_alone ? in->pdf.hero : in->pdf.shared},
                     film};
    }

  protected:
    const Camera* camera_;
};

/// The same where camera paths come that way too.
class SharedEntrance : public ImagedEntrance {
  public:
    using ImagedEntrance::ImagedEntrance;

    /// Of the path at a wavelength, as it comes about here.
    [[nodiscard]] double mis_weight(const Entry& entry, std::size_t wavelength, double others,
                                    bool is_hero_alone) const {
        const double drawn = is_hero_alone ? entry.film.pdf[wavelength] : entry.film.shared_pdf(wavelength);
        return LightMisWeight::weight(others, drawn / (camera_->film_area_mm2() * entry.pdf));
    }
};

constexpr std::uint64_t kSalt = 0xbb67ae8584caa73bULL;

}  // namespace

TileRenderer light_tracer(const View& view, Combination combination) {
    return combination == Combination::weighed ? TileRenderer(LightPaths(view, SharedEntrance(*view.camera), kSalt))
                                               : TileRenderer(LightPaths(view, ImagedEntrance(*view.camera), kSalt));
}

}  // namespace lensproof::render
