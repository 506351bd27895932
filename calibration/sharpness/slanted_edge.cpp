#include "calibration/sharpness/slanted_edge.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "calibration/sharpness/edge_alignment.h"
#include "calibration/statistics/student.h"
#include "engine/base/angle.h"

namespace lensproof::calibration {
namespace {

constexpr std::array<double, 3> kBins_px = {0.25, 1.0 / 3.0, 0.5};
constexpr int kFewestPerBin = 3;
constexpr double kFlatRises = 2.5;
constexpr double kLeastFlatRises = 1.2;
constexpr double kLeastSegment_px = 4.0;
constexpr int kFewestSegments = 8;
constexpr int kMostSegments = 24;
constexpr double kLeastFreedom = 0.1;
constexpr double kPlateau_px = 2.5;  // on either side, for the gradient of the light
constexpr int kSearchSteps = 100;
constexpr double kSearchStep = 0.5 * kMtfStep;
constexpr double kHighest = kSearchSteps * kSearchStep;  // cycles per pixel

using Row3 = Eigen::Vector3d;

struct Window {
    double flat = 0.0;
    double end = 0.0;

    [[nodiscard]] double operator()(double x) const {
        const double a = std::abs(x);
        if (a <= flat) {
            return 1.0;
        }
        return a >= end ? 0.0 : 0.5 * (1.0 + std::cos(std::numbers::pi * (a - flat) / (end - flat)));
    }
};

// A plane through one side's tone: value = a + b along + c across, and what each pixel adds to c.
struct Plateau {
    Row3 plane = Row3::Zero();
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    double side = 0.0;  // +1 bright, −1 dark
    double from = 0.0;

    [[nodiscard]] bool holds(const EdgePixel& p) const { return side * p.distance > from; }
    [[nodiscard]] static Row3 row(const EdgePixel& p) { return {1.0, p.along, p.across}; }
};

Plateau plateau(const std::vector<EdgePixel>& pixels, double side, double from) {
    Plateau result{.side = side, .from = from};
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Row3 right = Row3::Zero();
    for (const EdgePixel& p : pixels) {
        if (result.holds(p)) {
            normal += Plateau::row(p) * Plateau::row(p).transpose();
            right += p.value * Plateau::row(p);
        }
    }
    result.inverse = normal.ldlt().solve(Eigen::Matrix3d::Identity());
    result.plane = result.inverse * right;
    return result;
}

// Light that grows by `along` and `across` per pixel, relative to the region's middle, on both sides alike. A tail of
// the blur slopes the two sides by as much in absolute terms, so the difference of their slopes leaves it alone.
struct Gradient {
    double along = 0.0;
    double across = 0.0;
    Plateau bright, dark;
    double step = 1.0;

    [[nodiscard]] double factor(const EdgePixel& p) const { return 1.0 + along * p.along + across * p.across; }
};

Gradient gradient_of(const AlignedEdge& edge, double from) {
    Gradient g{.bright = plateau(edge.pixels, 1.0, from), .dark = plateau(edge.pixels, -1.0, from)};
    g.step = g.bright.plane(0) - g.dark.plane(0);
    g.along = (g.bright.plane(1) - g.dark.plane(1)) / g.step;
    g.across = (g.bright.plane(2) - g.dark.plane(2)) / g.step;
    return g;
}

// The transform of the edge-spread function's differences, and how it changes with each bin's mean.
class EdgeTransform {
  public:
    EdgeTransform(EdgeProfile profile, Window window) : profile_(std::move(profile)), window_(window) {
        transform_at_0_ = influence(0.0).value.real();
    }
    [[nodiscard]] const EdgeProfile& profile() const { return profile_; }
    /// `at`, and how it changes with each bin's mean: along its own direction (real) and in quadrature (imaginary).
    struct Influence {
        std::complex<double> value;
        std::vector<std::complex<double>> of_bin;
    };
    [[nodiscard]] Influence influence(double frequency) const {
        const std::size_t bins = profile_.mean.size();
        std::vector<std::complex<double>> kernels;  // of the difference at the lower end of each bin
        kernels.reserve(bins + 1);
        std::complex<double> sum = 0.0;
        for (std::size_t k = 0; k <= bins; ++k) {
            kernels.push_back(kernel(frequency, k));
            sum += k > 0 && k < bins ? kernels[k] * (profile_.mean[k] - profile_.mean[k - 1]) : 0.0;
        }
        Influence result{.value = sum / transform_at_0_, .of_bin = {}};
        result.of_bin.reserve(bins);
        const double modulus = std::abs(result.value);
        const std::complex<double> towards =
            (modulus > 0.0 ? std::conj(result.value) / modulus : 1.0) / transform_at_0_;
        for (std::size_t k = 0; k < bins; ++k) {
            const double total = window_(lower_end(k)) - window_(lower_end(k + 1));
            result.of_bin.push_back(towards * (kernels[k] - kernels[k + 1] - result.value * total));
        }
        return result;
    }

  private:
    [[nodiscard]] double sinc(double frequency) const {
        const double x = std::numbers::pi * frequency * profile_.width;
        return x > 0.0 ? std::sin(x) / x : 1.0;
    }
    [[nodiscard]] double lower_end(std::size_t k) const { return profile_.middle(k) - 0.5 * profile_.width; }
    [[nodiscard]] std::complex<double> kernel(double frequency, std::size_t k) const {
        const double x = lower_end(k);
        const double box = sinc(frequency);  // of the bin, and of the difference
        return std::polar(window_(x) / (box * box), -2.0 * std::numbers::pi * frequency * x);
    }

    EdgeProfile profile_;
    Window window_;
    double transform_at_0_ = 1.0;
};

// Residuals, summed over segments of the edge: of each bin's mean, and of the gradient of the light.
struct SegmentResiduals {
    std::vector<std::vector<double>> of_bin;  // by segment, then bin
    std::vector<double> of_gradient;
};

SegmentResiduals segment_residuals(const AlignedEdge& edge, const std::vector<EdgePixel>& even,
                                   const EdgeProfile& profile, const Gradient* gradient) {
    const auto count = static_cast<std::size_t>(
        std::clamp(static_cast<int>(2.0 * edge.half_length_px / kLeastSegment_px), kFewestSegments, kMostSegments));
    const std::size_t bins = profile.mean.size();
    SegmentResiduals result{std::vector(count, std::vector<double>(bins, 0.0)), std::vector<double>(count, 0.0)};
    std::vector<std::vector<int>> pixels(count, std::vector<int>(bins, 0));
    for (std::size_t i = 0; i < even.size(); ++i) {
        const EdgePixel& p = even[i];
        const double fraction = 0.5 * (1.0 + p.along / edge.half_length_px);
        const std::size_t segment =
            std::min(count - 1, static_cast<std::size_t>(fraction * static_cast<double>(count)));
        if (const int bin = profile.bin(p.distance); bin >= 0) {
            const auto k = static_cast<std::size_t>(bin);
            const double expected = profile.mean[k] + profile.slope(k) * (p.distance - profile.middle(k));
            result.of_bin[segment][k] += (p.value - expected) / profile.count[k];
            ++pixels[segment][k];
        }
        if (gradient == nullptr) {
            continue;
        }
        for (const Plateau* side : {&gradient->bright, &gradient->dark}) {
            if (side->holds(p)) {
                const Row3 row = Plateau::row(edge.pixels[i]);
                const double residual = edge.pixels[i].value - side->plane.dot(row);
                result.of_gradient[segment] += side->side * side->inverse.row(2).dot(row) * residual / gradient->step;
            }
        }
    }
    // A bin's mean follows its own pixels, a segment's residuals are too small by its fraction of them (Bell &
    // McCaffrey 2002). At a few degrees one segment can hold a quarter of a bin.
    for (std::size_t s = 0; s < count; ++s) {
        for (std::size_t k = 0; k < bins; ++k) {
            const double fraction = static_cast<double>(pixels[s][k]) / profile.count[k];
            result.of_bin[s][k] /= std::sqrt(std::max(1.0 - fraction, kLeastFreedom));
        }
    }
    return result;
}

struct Modulus {
    double value = 0.0;  // without the noise's part
    double standard_error = 0.0;
};

class MeasuredMtf {
  public:
    MeasuredMtf(EdgeTransform transform, SegmentResiduals residuals)
        : transform_(std::move(transform)), residuals_(std::move(residuals)) {
        for (int i = 0; i <= kSearchSteps; ++i) {
            searched_.push_back(at(i * kSearchStep));
        }
    }

    /// At every half of kMtfStep up to kHighest.
    [[nodiscard]] const std::vector<Modulus>& searched() const { return searched_; }

    [[nodiscard]] Modulus at(double frequency) const {
        const auto [transform, influence] = transform_.influence(frequency);
        const EdgeProfile& profile = transform_.profile();
        std::complex<double> of_gradient = 0.0;  // light that is 1 % brighter is divided by 1.01
        for (std::size_t k = 0; k < influence.size(); ++k) {
            of_gradient -= influence[k] * profile.mean[k] * profile.middle(k);
        }
        double along = 0.0;
        double quadrature = 0.0;
        for (std::size_t s = 0; s < residuals_.of_bin.size(); ++s) {
            std::complex<double> sum = of_gradient * residuals_.of_gradient[s];
            for (std::size_t k = 0; k < influence.size(); ++k) {
                sum += influence[k] * residuals_.of_bin[s][k];
            }
            along += sum.real() * sum.real();
            quadrature += sum.imag() * sum.imag();
        }
        return {std::sqrt(std::max(std::norm(transform) - quadrature, 0.0)), std::sqrt(along)};
    }

    /// Bounds are where the MTF's own 95 % band falls to the level: far from symmetric where the curve is flat.
    [[nodiscard]] std::optional<MtfFrequency> falls_to(double level) const {
        const auto frequency = first_below(level, 0.0);
        if (!frequency) {
            return std::nullopt;
        }
        const double t95 = student_95(static_cast<double>(residuals_.of_bin.size()) - 1.0);
        const double reach = std::min(0.5 * kSearchStep, 0.5 * *frequency);
        const double slope = (at(*frequency + reach).value - at(*frequency - reach).value) / (2.0 * reach);
        return MtfFrequency{.cycles_per_px = *frequency,
                            .standard_error = at(*frequency).standard_error / std::abs(slope),
                            .lower_95 = first_below(level, -t95).value_or(*frequency),
                            .upper_95 = first_below(level, t95).value_or(kHighest)};
    }

  private:
    // The first frequency where value + errors · standard error is below `level`.
    [[nodiscard]] std::optional<double> first_below(double level, double errors) const {
        const auto is_below = [&](const Modulus& modulus) {
            return modulus.value + errors * modulus.standard_error < level;
        };
        const auto found = std::find_if(searched_.begin() + 1, searched_.end(), is_below);
        if (found == searched_.end()) {
            return std::nullopt;
        }
        double below = kSearchStep * static_cast<double>(found - searched_.begin());
        double above = below - kSearchStep;
        while (below - above > kSearchStep * 1e-4) {
            const double middle = 0.5 * (above + below);
            (is_below(at(middle)) ? below : above) = middle;
        }
        return 0.5 * (above + below);
    }

    EdgeTransform transform_;
    SegmentResiduals residuals_;
    std::vector<Modulus> searched_;  // at multiples of kSearchStep
};

// The finest profile without a bin of fewer than kFewestPerBin pixels.
std::optional<EdgeProfile> finest_profile(const std::vector<EdgePixel>& pixels, double half_width) {
    for (const double width : kBins_px) {
        EdgeProfile profile = edge_profile(pixels, half_width, width);
        if (*std::min_element(profile.count.begin(), profile.count.end()) >= kFewestPerBin) {
            return profile;
        }
    }
    return std::nullopt;
}

}  // namespace

std::variant<EdgeMtf, EdgeRefusal> measure_edge(const formats::Image& image, int channel, const EdgeRegion& region) {
    const auto aligned = align_edge(image, channel, region);
    if (const auto* refusal = std::get_if<EdgeRefusal>(&aligned)) {
        return *refusal;
    }
    const auto& edge = std::get<AlignedEdge>(aligned);
    const double room = edge.half_width_px - kBins_px.back();
    Window window{.flat = kFlatRises * edge.rise_px + 1.0, .end = (kFlatRises + 1.0) * edge.rise_px + 2.5};
    if (window.end > room) {
        window = {.flat = room - edge.rise_px - 1.0, .end = room};
        if (window.flat < kLeastFlatRises * edge.rise_px) {
            return EdgeRefusal{"is too narrow for its blur"};
        }
    }
    std::vector<EdgePixel> even = edge.pixels;
    std::optional<Gradient> gradient;
    if (edge.half_width_px - window.flat >= kPlateau_px) {
        gradient = gradient_of(edge, window.flat);
        for (EdgePixel& p : even) {
            p.value /= gradient->factor(p);
        }
    }
    const auto profile = finest_profile(even, window.end);
    if (!profile) {
        return EdgeRefusal{"is too short, or lies along the pixels' rows, columns or diagonals"};
    }
    const MeasuredMtf measured(EdgeTransform(*profile, window),
                               segment_residuals(edge, even, *profile, gradient ? &*gradient : nullptr));
    EdgeMtf result{.centre_px = edge.centre_px,
                   .normal_deg = degrees(std::atan2(edge.normal.y, edge.normal.x)),
                   .rise_px = edge.rise_px,
                   .bend_px = edge.bend_px,
                   .length_px = 2.0 * region.half_length_px,
                   .width_px = 2.0 * region.half_width_px,
                   .mtf = {},
                   .mtf_standard_error = {},
                   .mtf50 = measured.falls_to(0.5),
                   .mtf10 = measured.falls_to(0.1)};
    for (std::size_t i = 0; i < measured.searched().size(); i += 2) {
        result.mtf.push_back(measured.searched()[i].value);
        result.mtf_standard_error.push_back(measured.searched()[i].standard_error);
    }
    return result;
}

}  // namespace lensproof::calibration
