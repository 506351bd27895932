// engine/analysis/sampled_pupil.h — the pupil function of a field on an even grid of image-side direction cosines.
#pragma once
#include <algorithm>
#include <complex>
#include <vector>

#include "engine/analysis/polychromatic_field.h"

namespace lensproof::analysis {

/// Whether a pupil function, and what is computed from it, can be trusted.
enum class PupilStatus {
    ok,
    no_light,  // nothing passes the rims
    aliased,   // path differences grow by more than half a wave from one sample to the next: take more samples
    folded,    // two rays of the beam leave with the same direction (a caustic at infinity): no pupil function exists
};

/// An even grid of direction cosines, row-major: M (y) rising by rows, L (x) by columns.
struct PupilGrid {
    int size = 0;          // cells along each side
    double spacing = 0.0;  // of direction cosines
    Vec2d centre;          // direction cosines in the middle

    [[nodiscard]] Vec2d cosines(int row, int column) const {
        const double middle = 0.5 * (size - 1);
        return {centre.x + spacing * (column - middle), centre.y + spacing * (row - middle)};
    }
    [[nodiscard]] std::size_t cell(int row, int column) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(column);
    }
};

/// The pupil function of one wavelength. The image's amplitude is a sum of plane waves, one for each direction (L, M)
/// in which a ray leaves:
///     U(ξ, η) = ∫∫ A(L, M) exp(i k (V(L, M) + L ξ + M η)) dL dM,
/// V being the optical path up to the foot of the perpendicular from the image point (Hamilton's angle characteristic
/// up to a constant), and A² dL dM the cross-section of the incoming beam that goes into dL dM, so that ∫∫|U|² dξ dη =
/// λ² ∫∫ A² dL dM: energy is conserved, and an aplanatic lens on its axis has even A. Scalar: polarisation matters only
/// for cones faster than about f/1.4. Fresnel losses are left out.
struct SampledPupil : PupilGrid {
    PupilStatus status = PupilStatus::no_light;
    double wavelength_nm = 0.0;
    double weight = 0.0;              // of this wavelength, as in PolychromaticField
    std::vector<double> fraction;     // of each cell that lies inside the beam
    std::vector<double> amplitude;    // mm: √(d area / d cosines) times the fraction
    std::vector<double> path;         // V, mm, 0 where `amplitude` is 0; from a mean
    std::vector<Vec2d> offset;        // of the cell's ray in the incoming beam (FieldBundle), mm
    std::vector<Vec2d> aberration;    // where the cell's ray meets the image plane, mm from the image point
    double energy = 0.0;              // Σ of the beam's cross-section, mm²
    double largest_aberration = 0.0;  // mm

    /// How far from the image point a ray may land that this spacing shows: λ / (2 spacing), mm.
    [[nodiscard]] double largest_seen_aberration() const { return 0.5e-6 * wavelength_nm / spacing; }
};

/// How far the beam reaches in direction cosines.
struct CosineBox {
    Vec2d low;
    Vec2d high;
    [[nodiscard]] double width() const { return std::max(high.x - low.x, high.y - low.y); }
};
CosineBox cosine_box(const PolychromaticField& field, const PolychromaticField::Part& part);

/// How many cells along each side a pupil's grid has: all that the width takes, 1 % for what bulges out between the
/// outline's points, and a cell around it for the rim. At most 1e6.
int pupil_cells(double width, double spacing);

/// The pupil on a grid of the given spacing. Each cell's ray is aimed by tracing (Broyden's method, from its
/// neighbour's), not interpolated; cells at the rim count by how many of 8 × 8 points pass. The grid may be
/// `aliased` by itself where a ray lands farther than λ / (2 spacing) from the image point: since dV = −(ξ dL + η dM),
/// that is half a wave from sample to sample.
SampledPupil sample_pupil(const PolychromaticField& field, const PolychromaticField::Part& part, double spacing);

/// The pupil as seen from the image plane `shift` mm further along z, about the point where the chief ray meets it.
SampledPupil refocused(SampledPupil pupil, const PolychromaticField& field, double shift);

/// A exp(i k V) of every cell; `is_perfect`: without aberration, V = 0.
std::vector<std::complex<double>> pupil_function(const SampledPupil& pupil, bool is_perfect = false);

}  // namespace lensproof::analysis
