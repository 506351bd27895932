#include "engine/analysis/mtf.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "engine/base/input_error.h"

namespace lensproof::analysis {

namespace {

enum class Axis { x, y };

void check_frequencies(std::span<const double> frequencies) {
    for (const double f : frequencies) {
        if (!(f >= 0.0) || !std::isfinite(f)) {
            throw InputError(fmt::format("a frequency of {} cycles per mm: expected 0 or a positive number", f));
        }
    }
}

std::complex<double> turned(double cycles) {
    return std::polar(1.0, 2.0 * std::numbers::pi * cycles);
}

/// The transfer function of one wavelength along one axis.
class Transfer {
  public:
    Transfer(const SampledPupil& pupil, const std::vector<std::complex<double>>& function, Axis axis, double centroid)
        : pupil_(pupil), function_(function), axis_(axis), centroid_(centroid) {}

    [[nodiscard]] std::complex<double> at(double frequency) {
        const double shear = frequency * 1e-6 * pupil_.wavelength_nm / pupil_.spacing;  // in cells
        if (!(shear < pupil_.size)) {
            return 0.0;
        }
        // Four whole shears around it. Zero has a cusp and is never in the middle.
        const int first = std::max(0, static_cast<int>(shear) - 1);
        std::complex<double> sum = 0.0;
        for (int i = 0; i < 4; ++i) {
            double factor = 1.0;
            for (int k = 0; k < 4; ++k) {
                factor *= k == i ? 1.0 : (shear - (first + k)) / (i - k);
            }
            const double whole = (first + i) * pupil_.spacing / (1e-6 * pupil_.wavelength_nm);  // cycles per mm
            sum += factor * turned(whole * centroid_) * autocorrelation(first + i);
        }
        return sum * turned(-frequency * centroid_);
    }

  private:
    /// Normalised by the beam's energy, which is its value at 0: cells at the rim, which the product of two fractions
    /// would count too little there, are whole in the energy.
    std::complex<double> autocorrelation(int shear) {
        if (shear == 0) {
            return 1.0;
        }
        const auto known = known_.find(shear);
        if (known != known_.end()) {
            return known->second;
        }
        const int rows = axis_ == Axis::y ? pupil_.size - shear : pupil_.size;
        const int columns = axis_ == Axis::x ? pupil_.size - shear : pupil_.size;
        const std::size_t apart = axis_ == Axis::y ? pupil_.cell(shear, 0) : pupil_.cell(0, shear);
        std::complex<double> sum = 0.0;
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                const std::size_t cell = pupil_.cell(row, column);
                // Written out: the product of std::complex looks for infinities.
                const std::complex<double>& a = function_[cell + apart];
                const std::complex<double>& b = function_[cell];
                sum += std::complex<double>(a.real() * b.real() + a.imag() * b.imag(),
                                            a.imag() * b.real() - a.real() * b.imag());
            }
        }
        return known_[shear] = sum * (pupil_.spacing * pupil_.spacing / pupil_.energy);
    }

    const SampledPupil& pupil_;
    const std::vector<std::complex<double>>& function_;
    Axis axis_;
    double centroid_;
    std::map<int, std::complex<double>> known_;
};

/// The rays' mean position, mm from the image point.
Vec2d centroid(const SampledPupil& pupil) {
    Vec2d sum{};
    double weight = 0.0;
    for (std::size_t i = 0; i < pupil.amplitude.size(); ++i) {
        const double light = pupil.amplitude[i] * pupil.amplitude[i];
        sum = sum + light * pupil.aberration[i];
        weight += light;
    }
    return sum / weight;
}

MtfCurve empty_curve(std::span<const double> frequencies) {
    check_frequencies(frequencies);
    return {.frequency = {frequencies.begin(), frequencies.end()},
            .tangential = std::vector<double>(frequencies.size(), 0.0),
            .sagittal = std::vector<double>(frequencies.size(), 0.0)};
}

}  // namespace

std::vector<SampledPupil> sample_pupils(const PolychromaticField& field, int samples) {
    constexpr int kUsual = 128;
    constexpr int kMost = 1024;
    if (samples != 0 && (samples < 8 || samples > 4096)) {
        throw InputError(fmt::format("{} samples across the pupil: expected 8 to 4096, or 0", samples));
    }
    std::vector<SampledPupil> pupils;
    for (const PolychromaticField::Part& part : field.parts) {
        const double width = cosine_box(field, part).width();
        SampledPupil pupil = sample_pupil(field, part, width / (samples > 0 ? samples : kUsual));
        if (samples == 0 && pupil.status == PupilStatus::aliased) {
            // Rays between the samples may land a little farther.
            const double needed = 1.05 * kUsual * pupil.largest_aberration / pupil.largest_seen_aberration();
            if (needed <= kMost) {
                pupil = sample_pupil(field, part, width / std::ceil(needed));
            }
        }
        pupils.push_back(std::move(pupil));
    }
    return pupils;
}

MtfCurve diffraction_mtf(std::span<const SampledPupil> pupils, std::span<const double> frequencies, MtfKind kind) {
    MtfCurve curve = empty_curve(frequencies);
    std::vector<std::complex<double>> tangential(frequencies.size(), 0.0);
    std::vector<std::complex<double>> sagittal(frequencies.size(), 0.0);
    const bool is_perfect = kind == MtfKind::diffraction_limited;
    for (const SampledPupil& pupil : pupils) {
        const bool is_usable = pupil.status == PupilStatus::ok || (is_perfect && pupil.status == PupilStatus::aliased);
        if (!is_usable) {
            curve.status = pupil.status;
            return curve;
        }
        const std::vector<std::complex<double>> function = pupil_function(pupil, is_perfect);
        const Vec2d middle = is_perfect ? Vec2d{} : centroid(pupil);
        Transfer along_y(pupil, function, Axis::y, middle.y);
        Transfer along_x(pupil, function, Axis::x, middle.x);
        for (std::size_t i = 0; i < frequencies.size(); ++i) {
            tangential[i] += pupil.weight * along_y.at(frequencies[i]);
            sagittal[i] += pupil.weight * along_x.at(frequencies[i]);
        }
    }
    if (!pupils.empty()) {
        curve.status = PupilStatus::ok;
    }
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
        curve.tangential[i] = std::abs(tangential[i]);
        curve.sagittal[i] = std::abs(sagittal[i]);
    }
    return curve;
}

MtfCurve diffraction_mtf(const PolychromaticField& field, std::span<const double> frequencies, MtfKind kind,
                         int samples) {
    return diffraction_mtf(sample_pupils(field, samples), frequencies, kind);
}

MtfCurve geometric_mtf(const PolychromaticField& field, std::span<const double> frequencies,
                       const GeometricMtfSettings& settings) {
    if (settings.azimuths < 3 || settings.rings < 1) {
        throw InputError("a geometric MTF needs at least 3 azimuths and a ring");
    }
    MtfCurve curve = empty_curve(frequencies);
    std::vector<std::complex<double>> tangential(frequencies.size(), 0.0);
    std::vector<std::complex<double>> sagittal(frequencies.size(), 0.0);
    double farthest = 0.0;  // from one ray to the next one along a radius, mm
    for (const PolychromaticField::Part& part : field.parts) {
        double energy = 0.0;
        std::vector<std::pair<Vec2d, double>> hits;
        std::optional<Vec2d> last;
        int count = 0;
        for (const optics::RegionNode& node : polar_nodes(part, field.bundle, settings.azimuths, settings.rings)) {
            const std::optional<ImageRay> ray = image_ray(part, field, node.point);
            last = count++ % settings.rings == 0 ? std::nullopt : last;
            if (!ray) {
                last.reset();
                continue;
            }
            if (last) {
                farthest = std::max(farthest, length(ray->aberration - *last));
            }
            last = ray->aberration;
            hits.emplace_back(ray->aberration, node.weight);
            energy += node.weight;
        }
        for (std::size_t i = 0; i < frequencies.size(); ++i) {
            std::complex<double> along_y = 0.0;
            std::complex<double> along_x = 0.0;
            for (const auto& [position, weight] : hits) {
                along_y += weight * turned(-frequencies[i] * position.y);
                along_x += weight * turned(-frequencies[i] * position.x);
            }
            tangential[i] += part.weight / energy * along_y;
            sagittal[i] += part.weight / energy * along_x;
        }
    }
    if (!field.parts.empty()) {
        const double highest = frequencies.empty() ? 0.0 : std::ranges::max(frequencies);
        curve.status = highest * farthest <= 0.5 ? PupilStatus::ok : PupilStatus::aliased;
    }
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
        curve.tangential[i] = std::abs(tangential[i]);
        curve.sagittal[i] = std::abs(sagittal[i]);
    }
    return curve;
}

double cutoff_frequency(const PolychromaticField& field) {
    double highest = 0.0;
    for (const PolychromaticField::Part& part : field.parts) {
        highest = std::max(highest, cosine_box(field, part).width() / (1e-6 * part.wavelength_nm));
    }
    return highest;
}

}  // namespace lensproof::analysis
