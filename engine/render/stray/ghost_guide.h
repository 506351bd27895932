// engine/render/stray/ghost_guide.h — which ghost far light most likely takes in a lens, and where it enters for that.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/analysis/ghost_region.h"
#include "engine/base/cache.h"
#include "engine/optics/lens.h"
#include "engine/pupil/entrance_beam.h"

namespace lensproof::render {

/// For light of each field angle, 2.5° apart: the energy of every ghost of two reflections, and the region of the
/// front from which it reaches the film (analysis/ghost_region.h). An angle is looked at when light first comes from
/// there, by whichever thread, or read from the cache; between two of them either is taken, the nearer one more often.
///
/// Of a lens that is not rotationally symmetric, and where it does not search, it knows but which ghosts there are.
class GhostGuide {
  public:
    /// `traced`: at the wavelength in the middle of the band. For light that lands within `film_radius_mm` of the axis.
    GhostGuide(const optics::Lens& lens, optics::TraceLens<double> traced, const optics::StrayMirrors<double>& mirrors,
               double film_radius_mm, bool searches, const Cache& cache);

    [[nodiscard]] const std::vector<optics::GhostPath>& paths() const { return paths_; }
    [[nodiscard]] bool is_known() const { return is_known_; }

    /// A ghost's number, and where its light crosses the plane of its beam.
    struct Draw {
        std::size_t ghost = 0;
        Vec2d offset;
    };
    /// Draws both for the light of a beam by three numbers in (0, 1). Nothing where no ghost is known.
    [[nodiscard]] std::optional<Draw> draw(const pupil::EntranceBeam& beam, const std::array<double, 3>& numbers) const;
    /// The pdf of that, 1/mm²; and the probability of the ghost.
    [[nodiscard]] double pdf(const pupil::EntranceBeam& beam, const Draw& drawn) const;
    [[nodiscard]] double probability(const pupil::EntranceBeam& beam, std::size_t ghost) const;

  private:
    struct Known {                                   // of an angle
        std::vector<analysis::GhostRegion> regions;  // a ghost each, in its FrontBeam's plane
        std::vector<double> cumulative;              // of the energies' shares; empty where there is none

        [[nodiscard]] std::string serialized() const;
        static std::optional<Known> deserialized(std::string_view bytes);
    };
    struct Angle {
        std::once_flag once;
        Known known;
        Vec2d centre;  // of the front sphere there
    };
    struct Place;
    [[nodiscard]] Place place_of(const pupil::EntranceBeam& beam) const;
    [[nodiscard]] const Angle* angle(std::size_t steps) const;
    void look_at(Angle& angle, double radians) const;
    [[nodiscard]] Known traced(double radians) const;
    /// Everything that an angle's regions follow from.
    [[nodiscard]] std::string key_of(double radians) const;

    optics::TraceLens<double> lens_;
    optics::StrayMirrors<double> mirrors_;
    double film_radius_mm_;
    Cache cache_;
    double pupil_area_ = 0.0;
    bool is_known_;
    std::vector<optics::GhostPath> paths_;
    mutable std::vector<std::unique_ptr<Angle>> angles_;
};

}  // namespace lensproof::render
