// calibration/sharpness/siemens_star.h — the modulation transfer function from a Siemens star, by direction.
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibration/sharpness/slanted_edge.h"
#include "calibration/sharpness/star_map.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// Why no star was found, or measured, in words.
struct StarRefusal {
    std::string reason;
};

/// Where the picture shows stars of this kind, from the left; or why there is none.
///
/// 1. Every steep pixel votes for the line along its edge: a star's edges all go through its centre.
/// 2. Circles around that point must cross from black to white and back as often as the star has sectors. The crossings
///    are the sectors' sides, and give centre and A (calibration/sharpness/star_map.h) by linear least squares.
/// 3. The black sectors end on the chart's circle, whose image gives scale and perspective.
/// 4. The phase of the pattern in cells of the picture, from the rim (low frequencies) inwards, gives centre and bend
///    to some thousandths of a pixel.
///
/// At least one circle of the pattern has to lie in the picture; tilts up to 50°, as far as the sectors are resolved.
std::variant<std::vector<StarMap>, StarRefusal> find_stars(const formats::Image& image, int channel,
                                                           const scene::SiemensStar& star);

/// The MTF along one direction.
struct StarSegment {
    /// The direction along which the pattern varies, from +x towards +y, in [0, 180): 0 for black and white beside one
    /// another. It is that of the middle of a segment of 45°, which the curve is the mean over.
    double frequency_deg = 0.0;
    double side_deg = 0.0;  // where the segment lies, seen from the star's centre
    std::vector<double> cycles_per_px;
    std::vector<double> mtf;
    std::vector<double> mtf_standard_error;
    double contrast = 0.0;  // (white − black) / (white + black) of the sectors
    double contrast_standard_error = 0.0;
    std::optional<MtfFrequency> mtf50;
    std::optional<MtfFrequency> mtf10;
};

struct StarMtf {
    Vec2d centre_px;
    EllipseOutline outline;
    std::vector<StarSegment> segments;  // by side_deg, at most eight; those outside the picture are missing
};

/// The sine-based spatial frequency response of ISO 12233:2014 (annexes E and F; Loebich, Wueller, Klingen & Jaeger
/// 2007, "Digital camera resolution measurement using sinusoidal Siemens stars"), in one channel of linear light:
///
/// 1. Pixels of a segment of 45° are sorted by their own frequency, sectors / 2 · |∇θ| / 2π, into bins 6 % wide, so
///    that a tilted star, or a bent one, mixes no frequencies. Frequencies beyond half a cycle per pixel are no
///    obstacle: each pixel knows its phase.
/// 2. In each bin least squares of a + Σ_k (b_k cos kψ + c_k sin kψ), k up to 5 where the pixels allow it: the star is
///    black and white, its square wave's other harmonics are fitted beside the fundamental and not taken for it. The
///    modulation is √(b₁² + c₁²) / a.
/// 3. A square wave's fundamental is 4/π of its contrast, (white − black) / (white + black), which is stated, and
///    divided out. Its white is that of the paper around the star; its mean is the pattern's own, which no blur
///    changes, followed outwards to the paper. So the contrast is the ink's and the veiling glare's. This takes
///    sectors of equal width: ink that spreads by 1 % of the widest one makes every MTF 1 % too large.
/// 4. Noise raises a modulus by its part in quadrature, whose variance is taken off.
///
/// Errors: the influence of each pixel times its residual, summed over 12 wedges of the segment (as in `measure_edge`),
/// which also holds where noise is correlated over a few pixels. That of the contrast is in it. 95 % bounds are
/// Student's t with 11 degrees of freedom. The pixel's own box is a part of the MTF.
std::variant<StarMtf, StarRefusal> measure_star(const formats::Image& image, int channel, const StarMap& map,
                                                const scene::SiemensStar& star);

}  // namespace lensproof::calibration
