#include "calibration/sharpness/star_modulation.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>

#include "engine/base/vec.h"

namespace lensproof::calibration {
namespace {

constexpr double kBinRatio = 1.06;    // of frequencies
constexpr int kFewestInBin = 24;      // of a bin
constexpr double kMostAside = 0.15;   // of a segment's width, for a bin's mean
constexpr double kLeastSpread = 0.6;  // of the variance across the segment
constexpr int kPixelsPerTerm = 12;    // for terms beyond the fundamental
constexpr int kMostHarmonics = 5;

// 1, cos ψ, sin ψ; then what the number of pixels allows: uneven light, and harmonics that the picture may show.
int terms_of(std::size_t pixels, double cycles_per_px) {
    const int harmonics = std::clamp(static_cast<int>(kStarHighest / cycles_per_px), 1, kMostHarmonics);
    const int most = 1 + 2 * harmonics + 2;
    const int allowed = std::max(3, static_cast<int>(pixels) / kPixelsPerTerm);
    return allowed >= most ? most : 3 + (allowed - 3) / 2 * 2;
}

Eigen::VectorXd row_of(const StarPixel& pixel, int terms) {
    Eigen::VectorXd row(terms);
    row(0) = 1.0;
    row(1) = std::cos(pixel.phase);
    row(2) = std::sin(pixel.phase);
    if (terms > 3) {
        row(3) = pixel.turn;
        row(4) = pixel.turn * pixel.turn - 1.0 / 12.0;
    }
    for (int i = 5; i < terms; i += 2) {
        const int harmonic = (i - 1) / 2;
        row(i) = std::cos(harmonic * pixel.phase);
        row(i + 1) = std::sin(harmonic * pixel.phase);
    }
    return row;
}

// Whether pixels lie all over the segment. The lowest frequencies of a tilted star are at one end of the rim alone.
bool is_whole(const std::vector<StarPixel>& pixels, std::size_t first, std::size_t last) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = first; i < last; ++i) {
        sum += pixels[i].turn;
        squares += pixels[i].turn * pixels[i].turn;
    }
    const auto count = static_cast<double>(last - first);
    const double spread = squares / count - sum * sum / (count * count);
    return std::abs(sum) < kMostAside * count && spread * 12.0 > kLeastSpread;  // 1/12: even from -1/2 to 1/2
}

std::optional<StarModulation> modulation_of(const std::vector<StarPixel>& pixels, std::size_t first, std::size_t last) {
    StarModulation result;
    for (std::size_t i = first; i < last; ++i) {
        result.cycles_per_px += pixels[i].cycles_per_px / static_cast<double>(last - first);
        result.radius_px += pixels[i].radius_px / static_cast<double>(last - first);
    }
    const int terms = terms_of(last - first, result.cycles_per_px);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
    for (std::size_t i = first; i < last; ++i) {
        const Eigen::VectorXd row = row_of(pixels[i], terms);
        normal += row * row.transpose();
        right += pixels[i].light * row;
    }
    const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) {
        return std::nullopt;
    }
    const Eigen::VectorXd fit = solver.solve(right);
    const double amplitude = std::hypot(fit(1), fit(2));
    if (!(fit(0) > 0.0) || !(amplitude > 0.0)) {
        return std::nullopt;
    }
    const Vec2d towards{fit(1) / amplitude, fit(2) / amplitude};
    StarWedges quadrature{};
    for (std::size_t i = first; i < last; ++i) {
        const Eigen::VectorXd row = row_of(pixels[i], terms);
        const Eigen::VectorXd influence = solver.solve(row);
        // A fit follows its own pixels; their residuals are too small by the leverage (MacKinnon & White 1985, HC2).
        const double freedom = std::max(1.0 - row.dot(influence), 0.1);
        const double residual = (pixels[i].light - fit.dot(row)) / std::sqrt(freedom);
        const std::size_t wedge = pixels[i].wedge();
        result.level.of_wedge[wedge] += residual * influence(0);
        result.amplitude.of_wedge[wedge] += residual * (towards.x * influence(1) + towards.y * influence(2));
        quadrature[wedge] += residual * (towards.x * influence(2) - towards.y * influence(1));
    }
    result.level.value = fit(0);
    result.amplitude.value = std::sqrt(std::max(amplitude * amplitude - variance(quadrature), 0.0));
    return result;
}

}  // namespace

double variance(const StarWedges& wedges) {
    double sum = 0.0;
    for (const double w : wedges) {
        sum += w * w;
    }
    return sum;
}

void add(StarWedges& sum, double weight, const StarWedges& other) {
    for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] += weight * other[i];
    }
}

std::vector<StarModulation> star_modulations(std::vector<StarPixel>& pixels) {
    std::ranges::sort(pixels, {}, &StarPixel::cycles_per_px);
    std::vector<StarModulation> result;
    std::size_t first = 0;
    for (std::size_t i = 0; i <= pixels.size(); ++i) {
        const bool is_full = i < pixels.size() && i - first >= kFewestInBin &&
                             pixels[i].cycles_per_px > kBinRatio * pixels[first].cycles_per_px;
        if (is_full || (i == pixels.size() && i - first >= kFewestInBin)) {
            const auto one =
                is_whole(pixels, first, i) ? modulation_of(pixels, first, i) : std::optional<StarModulation>();
            if (one) {
                result.push_back(*one);
            }
            first = i;
        }
    }
    return result;
}

}  // namespace lensproof::calibration
