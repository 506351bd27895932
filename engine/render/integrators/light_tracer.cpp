#include "engine/render/integrators/light_tracer.h"

#include <algorithm>
#include <iterator>

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

    [[nodiscard]] std::optional<LensSample> aim(const LightOrigin& from, const spectral::PathWavelengths& path,
                                                PathSampler& numbers) const {
        const auto u = numbers.next();
        return camera_->sample(from, path, u[0], u[1]);
    }

    /// Calls enter(i, entry) for each of as many.
    template <class Enter>
    void arrive(std::span<const LensSample> aims, std::span<const LightArrival> arrivals, const Enter& enter) const {
        std::vector<Ray<double>> rays;
        std::ranges::transform(aims, std::back_inserter(rays), &LensSample::ray);
        std::vector<spectral::PathWavelengths> paths;
        std::ranges::transform(arrivals, std::back_inserter(paths), &LightArrival::path);
        std::vector<FilmImportance> films(aims.size());
        camera_->importances(rays, paths, films);
        for (std::size_t i = 0; i < aims.size(); ++i) {
            enter(i, Entry{{.direction = aims[i].direction,
                            .end = aims[i].end,
                            .at_px = films[i].at_px,
                            .weight = films[i].transmittance,
                            .pdf = arrivals[i].is_hero_alone ? aims[i].pdf.hero : aims[i].pdf.shared},
                           films[i]});
        }
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
