#include "engine/analysis/best_focus.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>

#include "engine/analysis/mtf.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/optics/paraxial.h"

namespace lensproof::analysis {

namespace {

constexpr int kRings = 8;

/// A ray of a field where it meets the image plane.
struct Hit {
    Vec2d position;  // mm from the image point
    Vec2d slope;     // dx/dz, dy/dz less the chief ray's, which the image point moves along
    Vec3d direction;
    double path;
    double weight;  // in the field's light
};

std::vector<Hit> hits_of(const PolychromaticField& field, const PolychromaticField::Part& part,
                         const std::vector<optics::RegionNode>& nodes) {
    const Vec3d& chief = field.chief_direction;
    std::vector<Hit> hits;
    for (const optics::RegionNode& node : nodes) {
        if (const std::optional<ImageRay> ray = image_ray(part, field, node.point)) {
            const Vec3d& along = ray->direction;
            hits.push_back({ray->aberration,
                            {along.x / along.z - chief.x / chief.z, along.y / along.z - chief.y / chief.z},
                            along,
                            ray->path,
                            part.weight * node.weight / part.outline.area});
        }
    }
    return hits;
}

std::vector<Hit> hits_of(const PolychromaticField& field) {
    std::vector<Hit> hits;
    for (const PolychromaticField::Part& part : field.parts) {
        const std::vector<Hit> more = hits_of(field, part, optics::region_quadrature(part.outline, kRings));
        hits.insert(hits.end(), more.begin(), more.end());
    }
    return hits;
}

double required(double numerator, double denominator) {
    if (!(denominator > 0.0)) {
        throw InputError("no light reaches the image at any of these fields: no best focus");
    }
    return numerator / denominator;
}

/// The place where rays cross the chief ray, and how far they scatter about it; mm from the image plane.
struct Crossing {
    double mean;
    double deviation;
};

Crossing crossing_of(const std::vector<Hit>& hits) {
    double weights = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (const Hit& hit : hits) {
        const double slope2 = dot(hit.slope, hit.slope);
        if (slope2 > 0.0) {
            const double z = -dot(hit.position, hit.slope) / slope2;
            weights += hit.weight * slope2;
            sum += hit.weight * slope2 * z;
            squares += hit.weight * slope2 * z * z;
        }
    }
    const double mean = required(sum, weights);
    return {mean, std::sqrt(std::max(0.0, squares / weights - mean * mean))};
}

/// The mean of tangential and sagittal MTF of one field, against the shift of the image plane.
class FieldModulation {
  public:
    FieldModulation(const PolychromaticField& field, double frequency, double spot_shift)
        : field_(field), frequency_(frequency) {
        // The window of a pupil of n samples is n λ / width: three cycles.
        constexpr int kFewest = 64;
        constexpr int kMost = 192;
        const double samples = 3.0 * cutoff_frequency(field) / frequency;
        pupils_ = sample_pupils(field, static_cast<int>(std::clamp(samples, 1.0 * kFewest, 1.0 * kMost)));
        is_geometric_ = std::ranges::any_of(pupils_, [&](const SampledPupil& pupil) {
            return refocused(pupil, field, spot_shift).status != PupilStatus::ok;
        });
        if (is_geometric_) {
            for (const PolychromaticField::Part& part : field.parts) {
                const std::vector<Hit> more = hits_of(field, part, polar_nodes(part, field.bundle, 96, 32));
                hits_.insert(hits_.end(), more.begin(), more.end());
            }
        }
    }

    [[nodiscard]] double at(double shift) const { return is_geometric_ ? geometric(shift) : diffracted(shift); }

  private:
    [[nodiscard]] double diffracted(double shift) const {
        std::vector<SampledPupil> moved;
        for (const SampledPupil& pupil : pupils_) {
            moved.push_back(refocused(pupil, field_, shift));
        }
        const MtfCurve curve = diffraction_mtf(moved, std::array{frequency_});
        return 0.5 * (curve.tangential.front() + curve.sagittal.front());
    }

    [[nodiscard]] double geometric(double shift) const {
        std::complex<double> tangential = 0.0;
        std::complex<double> sagittal = 0.0;
        const double turn = -2.0 * std::numbers::pi * frequency_;
        for (const Hit& hit : hits_) {
            tangential += std::polar(hit.weight, turn * (hit.position.y + shift * hit.slope.y));
            sagittal += std::polar(hit.weight, turn * (hit.position.x + shift * hit.slope.x));
        }
        return 0.5 * (std::abs(tangential) + std::abs(sagittal));
    }

    const PolychromaticField& field_;
    double frequency_;
    bool is_geometric_ = false;
    std::vector<SampledPupil> pupils_;
    std::vector<Hit> hits_;
};

}  // namespace

double paraxial_focus_shift(const optics::Lens& lens, double reference_nm, double object_distance) {
    const double distance =
        optics::paraxial_image_distance(optics::at_wavelength<double>(lens, reference_nm), object_distance);
    if (!std::isfinite(distance)) {
        throw InputError(fmt::format("{} has no paraxial image of an object at {} mm", lens.name, object_distance));
    }
    return lens.last_vertex_z() + distance - lens.image_z;
}

double spot_focus_shift(std::span<const WeightedField> fields) {
    double covariance = 0.0;
    double variance = 0.0;
    for (const WeightedField& weighted : fields) {
        const std::vector<Hit> hits = hits_of(weighted.field);
        Vec2d position{};
        Vec2d slope{};
        double sum = 0.0;
        for (const Hit& hit : hits) {
            position = position + hit.weight * hit.position;
            slope = slope + hit.weight * hit.slope;
            sum += hit.weight;
        }
        for (const Hit& hit : hits) {
            const Vec2d p = hit.position - position / sum;
            const Vec2d s = hit.slope - slope / sum;
            covariance += weighted.weight * hit.weight * dot(p, s);
            variance += weighted.weight * hit.weight * dot(s, s);
        }
    }
    return required(-covariance, variance);
}

double wavefront_focus_shift(std::span<const WeightedField> fields) {
    double product = 0.0;
    double square = 0.0;
    for (const WeightedField& weighted : fields) {
        const Vec3d& chief = weighted.field.chief_direction;
        for (const PolychromaticField::Part& part : weighted.field.parts) {
            const std::vector<Hit> hits =
                hits_of(weighted.field, part, optics::region_quadrature(part.outline, kRings));
            const auto count = static_cast<Eigen::Index>(hits.size());
            if (count < 4) {
                continue;
            }
            Eigen::MatrixXd tilt(count, 3);
            Eigen::MatrixXd terms(count, 2);  // path, and its change with the shift; waves
            const double waves = 1e6 / part.wavelength_nm;
            for (Eigen::Index i = 0; i < count; ++i) {
                const Hit& hit = hits[static_cast<std::size_t>(i)];
                const double root = std::sqrt(weighted.weight * hit.weight);
                const Vec3d apart = hit.direction - chief;
                tilt.row(i) << root, root * apart.x, root * apart.y;
                terms.row(i) << root * waves * (hit.path - hits.front().path),
                    root * waves * dot(apart, chief) / chief.z;
            }
            const Eigen::MatrixXd left = terms - tilt * tilt.colPivHouseholderQr().solve(terms);
            product += left.col(0).dot(left.col(1));
            square += left.col(1).squaredNorm();
        }
    }
    return required(-product, square);
}

double mtf_focus_shift(std::span<const WeightedField> fields, double frequency) {
    double cutoff = 0.0;
    double nearest = kInfinity;
    double farthest = -nearest;
    std::vector<std::pair<FieldModulation, double>> modulations;
    for (const WeightedField& weighted : fields) {
        if (weighted.field.parts.empty()) {
            continue;
        }
        cutoff = std::max(cutoff, cutoff_frequency(weighted.field));
        if (!(frequency > 0.0 && frequency < cutoff)) {
            continue;
        }
        const Crossing crossing = crossing_of(hits_of(weighted.field));
        double diffraction_depth = 0.0;  // λ / sin²U
        for (const PolychromaticField::Part& part : weighted.field.parts) {
            const double sine = 0.5 * cosine_box(weighted.field, part).width();
            diffraction_depth = std::max(diffraction_depth, 1e-6 * part.wavelength_nm / (sine * sine));
        }
        const double depth = 2.5 * crossing.deviation + 4.0 * diffraction_depth;
        nearest = std::min(nearest, crossing.mean - depth);
        farthest = std::max(farthest, crossing.mean + depth);
        modulations.emplace_back(FieldModulation(weighted.field, frequency, crossing.mean), weighted.weight);
    }
    if (modulations.empty()) {
        throw InputError(fmt::format("no field transfers {} cycles per mm: expected more than 0 and less than {:.4g}",
                                     frequency, cutoff));
    }
    const auto loss = [&](double shift) {
        double sum = 0.0;
        for (const auto& [modulation, weight] : modulations) {
            sum -= weight * modulation.at(shift);
        }
        return sum;
    };
    constexpr int kPlaces = 65;
    const double step = (farthest - nearest) / (kPlaces - 1);
    double best = nearest;
    double least = loss(nearest);
    for (int i = 1; i < kPlaces; ++i) {
        const double here = loss(nearest + i * step);
        if (here < least) {
            least = here;
            best = nearest + i * step;
        }
    }
    // A maximum is flat: its place is good to the root of the digits that its value is good to.
    constexpr int kBits = 20;
    std::uintmax_t steps = 40;
    return boost::math::tools::brent_find_minima(loss, best - step, best + step, kBits, steps).first;
}

optics::Lens with_image_shift(optics::Lens lens, double shift) {
    if (!(lens.final_heading() * (lens.image_z + shift - lens.last_vertex_z()) > 0.0) || !std::isfinite(shift)) {
        throw InputError(
            fmt::format("the image plane of {} cannot be moved by {} mm: it stands {} mm behind the last vertex",
                        lens.name, shift, lens.image_z - lens.last_vertex_z()));
    }
    lens.image_z += shift;
    return lens;
}

}  // namespace lensproof::analysis
