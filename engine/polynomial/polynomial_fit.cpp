#include "engine/polynomial/polynomial_fit.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/optics/packet/spectral_lens.h"
#include "engine/optics/surface_shape.h"
#include "engine/polynomial/ray_samples.h"
#include "engine/polynomial/sparse_fit.h"

namespace lensproof::polynomial {

namespace {

using Terms = std::vector<SymmetricMap::Term>;

// Sets of rays begin here in RaySampler's sequence.
constexpr std::uint64_t kHeldOut = 10'000'000;
constexpr std::uint64_t kJudging = 20'000'000;

constexpr int kHighestInT = 3;
constexpr double kOutsider = 0.3;  // how much rays count that a rim cuts: they say where the rim is, and no more
constexpr double kSpare = 1.25;    // of a bound, for other rays

/// All products of invariants up to an order, of t at most `kHighestInT`.
std::vector<Exponents> products_up_to(int order) {
    std::vector<Exponents> found;
    for (int t = 0; t <= std::min(order, kHighestInT); ++t) {
        for (int xx = 0; xx + t <= order; ++xx) {
            for (int qq = 0; qq + xx + t <= order; ++qq) {
                for (int xq = 0; xq + qq + xx + t <= order; ++xq) {
                    found.push_back({static_cast<std::uint8_t>(xx), static_cast<std::uint8_t>(qq),
                                     static_cast<std::uint8_t>(xq), static_cast<std::uint8_t>(t)});
                }
            }
        }
    }
    return found;
}

double product_of(const Exponents& exponents, const std::array<double, kInvariants>& invariants) {
    double product = 1.0;
    for (std::size_t i = 0; i < exponents.size(); ++i) {
        for (int k = 0; k < exponents[i]; ++k) {
            product *= invariants[i];
        }
    }
    return product;
}

/// A matrix of two by its columns, as a fit weighs the errors of a vector.
using Weighing = std::array<Vec2d, 2>;

Vec2d weighed(const Weighing& by, Vec2d v) {
    return v.x * by[0] + v.y * by[1];
}

struct VectorRow {
    SymmetricPoint at;
    Vec2d value;
    Weighing weighing;
};

struct VectorTerms {
    Terms along_x;
    Terms along_q;
};

VectorTerms fitted_vector(const std::vector<VectorRow>& rows, int order, double wanted, int most_terms) {
    const std::vector<Exponents> products = products_up_to(order);
    const auto count = static_cast<Eigen::Index>(products.size());
    Eigen::MatrixXd columns(2 * static_cast<Eigen::Index>(rows.size()), 2 * count);
    Eigen::VectorXd target(columns.rows());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const VectorRow& row = rows[i];
        const Eigen::Index r = 2 * static_cast<Eigen::Index>(i);
        const std::array<double, kInvariants> invariants = row.at.invariants();
        const Vec2d x = weighed(row.weighing, row.at.x);
        const Vec2d q = weighed(row.weighing, row.at.q);
        const Vec2d value = weighed(row.weighing, row.value);
        target[r] = value.x;
        target[r + 1] = value.y;
        for (Eigen::Index k = 0; k < count; ++k) {
            const double product = product_of(products[static_cast<std::size_t>(k)], invariants);
            columns(r, k) = product * x.x;
            columns(r + 1, k) = product * x.y;
            columns(r, count + k) = product * q.x;
            columns(r + 1, count + k) = product * q.y;
        }
    }
    const SparseFit fit = sparse_fit(columns, target, wanted, most_terms);
    VectorTerms found;
    for (std::size_t i = 0; i < fit.terms.size(); ++i) {
        Terms& terms = fit.terms[i] < count ? found.along_x : found.along_q;
        terms.push_back(
            {products[static_cast<std::size_t>(fit.terms[i] % count)], fit.coefficients[static_cast<Eigen::Index>(i)]});
    }
    return found;
}

struct ScalarRow {
    SymmetricPoint at;
    double value = 0.0;
    double weight = 1.0;
};

Terms fitted_scalar(const std::vector<ScalarRow>& rows, int order, double wanted, int most_terms) {
    const std::vector<Exponents> products = products_up_to(order);
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(products.size()));
    Eigen::VectorXd target(columns.rows());
    for (Eigen::Index r = 0; r < columns.rows(); ++r) {
        const ScalarRow& row = rows[static_cast<std::size_t>(r)];
        const std::array<double, kInvariants> invariants = row.at.invariants();
        target[r] = row.weight * row.value;
        for (Eigen::Index k = 0; k < columns.cols(); ++k) {
            columns(r, k) = row.weight * product_of(products[static_cast<std::size_t>(k)], invariants);
        }
    }
    const SparseFit fit = sparse_fit(columns, target, wanted, most_terms);
    Terms terms;
    for (std::size_t i = 0; i < fit.terms.size(); ++i) {
        terms.push_back(
            {products[static_cast<std::size_t>(fit.terms[i])], fit.coefficients[static_cast<Eigen::Index>(i)]});
    }
    return terms;
}

/// Of the sphere through the front's vertex and rim: the front itself where that is a sphere.
double front_curvature(const optics::Lens& lens) {
    const optics::LensSurface& front = lens.surfaces.front();
    if (!front.has_shape) {
        return front.curvature;
    }
    const double sag = optics::sag(front.shape, front.semi_diameter, 0.0);
    return std::isfinite(sag) ? 2.0 * sag / (front.semi_diameter * front.semi_diameter + sag * sag) : front.curvature;
}

/// t of each wavelength: even in 1/λ², in which indices are nearly linear.
std::vector<double> band_of(const std::vector<double>& wavelengths_nm) {
    const auto [least, most] = std::ranges::minmax(wavelengths_nm);
    const double from = 1.0 / (most * most);
    const double to = 1.0 / (least * least);
    std::vector<double> band;
    band.reserve(wavelengths_nm.size());
    for (const double nm : wavelengths_nm) {
        band.push_back(to > from ? 2.0 * (1.0 / (nm * nm) - from) / (to - from) - 1.0 : 0.0);
    }
    return band;
}

/// The factor of one vector that leaves least of another, over all pairs.
template <class Of>
double shear_of(const std::vector<RaySample>& rays, const Of& pair_of) {
    double along = 0.0;
    double squares = 0.0;
    for (const RaySample& ray : rays) {
        const auto [x, p] = pair_of(ray);
        along += dot(x, p);
        squares += dot(x, x);
    }
    return squares > 0.0 ? along / squares : 0.0;
}

class Fit {
  public:
    Fit(const RaySampler& sampler, PolynomialFrame frame, std::vector<double> band, const FitSettings& settings)
        : sampler_(sampler), frame_(frame), band_(std::move(band)), settings_(settings) {
        for (RaySample& ray : sampler.samples(0, settings.fitted_rays)) {
            if (const std::optional<LandingSlopes> slopes = sampler.landing_slopes(ray)) {
                rays_.push_back(std::move(ray));
                slopes_.push_back(*slopes);
            }
        }
        if (static_cast<int>(rays_.size()) < settings.fitted_rays / 4) {
            throw InputError("hardly any light comes through the lens: too few rays to fit a polynomial to");
        }
        scale();
        for (const RaySample& ray : rays_) {
            inside_.push_back(frame_.inside(ray.film, ray.pupil, band_[static_cast<std::size_t>(ray.wavelength)]));
        }
        fit_losses();
    }

    /// With terms up to an order, until the rays fitted land within `wanted_um`.
    [[nodiscard]] PolynomialLens lens(int order, double wanted_um) const {
        std::vector<VectorRow> rows;
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const double weight = weight_of(rays_[i]);
            rows.push_back({inside_[i], rays_[i].exit.u, {Vec2d{weight, 0.0}, Vec2d{0.0, weight}}});
        }
        const double per_row = std::sqrt(0.5);  // of a vector's rms, two rows to it
        const VectorTerms u =
            fitted_vector(rows, order, per_row * settings_.wanted_entry * frame_.front_radius, settings_.most_terms);
        const SymmetricMap leaving(1, {u.along_x, u.along_q});
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            rows[i].value = aimed_direction(i, leaving.vector(0, inside_[i]) - rays_[i].exit.u);
            const double weight = weight_of(rays_[i]);
            rows[i].weighing = {weight * slopes_[i].by_w[0], weight * slopes_[i].by_w[1]};
        }
        const VectorTerms w = fitted_vector(rows, order, per_row * 1e-3 * wanted_um, settings_.most_terms);
        std::vector<Terms> sums{w.along_x, w.along_q, u.along_x, u.along_q};
        sums.insert(sums.end(), losses_.begin(), losses_.end());
        return {frame_, SymmetricMap(2, sums), guess(), band_};
    }

  private:
    static double weight_of(const RaySample& ray) { return ray.passes ? 1.0 : kOutsider; }

    /// Inputs and outputs to 1.
    void scale() {
        double lit_mm = 0.0;
        frame_.pupil_shear = shear_of(rays_, [](const RaySample& ray) { return std::pair{ray.film, ray.pupil}; });
        frame_.front_shear = shear_of(rays_, [](const RaySample& ray) { return std::pair{ray.exit.w, ray.exit.u}; });
        for (const RaySample& ray : rays_) {
            lit_mm = std::max(lit_mm, length(ray.film));
            frame_.pupil_radius_mm =
                std::max(frame_.pupil_radius_mm, length(ray.pupil - frame_.pupil_shear * ray.film));
            frame_.front_w = std::max(frame_.front_w, length(ray.exit.w));
            frame_.front_radius = std::max(frame_.front_radius, length(ray.exit.u - frame_.front_shear * ray.exit.w));
        }
        constexpr double kRoom = 1.01;  // for rays between those drawn
        frame_.film_radius_mm = std::min(frame_.film_radius_mm, kRoom * lit_mm);
        frame_.pupil_radius_mm *= kRoom;
        frame_.front_w *= kRoom;
        frame_.front_radius *= kRoom;
    }

    /// The direction that makes a ray land where it should, which leaves beside its own place by `beside`.
    [[nodiscard]] Vec2d aimed_direction(std::size_t i, Vec2d beside) const {
        const LandingSlopes& by = slopes_[i];
        const Vec2d off = weighed(by.by_u, beside);
        Eigen::Matrix2d by_w;
        by_w << by.by_w[0].x, by.by_w[1].x, by.by_w[0].y, by.by_w[1].y;
        const Eigen::Vector2d turn = by_w.partialPivLu().solve(Eigen::Vector2d(off.x, off.y));
        return rays_[i].exit.w - Vec2d{turn[0], turn[1]};
    }

    /// Transmittance, and rims.
    void fit_losses() {
        constexpr int kOrder = 5;
        std::vector<ScalarRow> rows;
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            rows.push_back({inside_[i], rays_[i].transmittance, weight_of(rays_[i])});
        }
        losses_.push_back(fitted_scalar(rows, kOrder, settings_.wanted_transmittance, settings_.most_terms));
        for (const std::size_t rim : cutting_rims()) {
            double squares = 0.0;
            for (std::size_t i = 0; i < rays_.size(); ++i) {
                // Only where it cuts or not does it matter.
                const double from_rim = (rays_[i].rims[rim] - 1.0) / 0.15;
                const double weight = 1.0 / (1.0 + from_rim * from_rim);
                rows[i] = {inside_[i], rays_[i].rims[rim], weight};
                squares += weight * weight;
            }
            const double mean = std::sqrt(squares / static_cast<double>(rays_.size()));
            losses_.push_back(fitted_scalar(rows, kOrder, mean * settings_.wanted_rim, settings_.most_terms));
        }
    }

    /// As few as cut all but a ten-thousandth of the rays that any cuts: each time the one that cuts most of the rest.
    [[nodiscard]] std::vector<std::size_t> cutting_rims() const {
        std::vector<const RaySample*> cut;
        for (const RaySample& ray : rays_) {
            if (std::ranges::any_of(ray.rims, [](double r2) { return r2 > 1.0; })) {
                cut.push_back(&ray);
            }
        }
        std::vector<std::size_t> rims;
        while (1e4 * static_cast<double>(cut.size()) > static_cast<double>(rays_.size())) {
            std::vector<std::ptrdiff_t> counts;
            for (std::size_t rim = 0; rim < rays_.front().rims.size(); ++rim) {
                counts.push_back(
                    std::ranges::count_if(cut, [&](const RaySample* ray) { return ray->rims[rim] > 1.0; }));
            }
            const auto most = static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin());
            rims.push_back(most);
            std::erase_if(cut, [&](const RaySample* ray) { return ray->rims[most] > 1.0; });
        }
        return rims;
    }

    /// From rays in front to scaled film and pupil points, to begin Newton's method with.
    [[nodiscard]] SymmetricMap guess() const {
        constexpr int kOrder = 5;
        constexpr double kWanted = 2e-3;
        constexpr Weighing kAlike{Vec2d{1.0, 0.0}, Vec2d{0.0, 1.0}};
        std::vector<VectorRow> films;
        std::vector<VectorRow> pupils;
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const SymmetricPoint from =
                frame_.outside(rays_[i].exit, band_[static_cast<std::size_t>(rays_[i].wavelength)]);
            films.push_back({from, inside_[i].x, kAlike});
            pupils.push_back({from, inside_[i].q, kAlike});
        }
        const VectorTerms film = fitted_vector(films, kOrder, kWanted, settings_.most_terms / 4);
        const VectorTerms pupil = fitted_vector(pupils, kOrder, kWanted, settings_.most_terms / 4);
        return {2, {film.along_x, film.along_q, pupil.along_x, pupil.along_q}};
    }

    const RaySampler& sampler_;
    PolynomialFrame frame_;
    std::vector<double> band_;
    FitSettings settings_;
    std::vector<RaySample> rays_;
    std::vector<LandingSlopes> slopes_;
    std::vector<SymmetricPoint> inside_;
    std::vector<Terms> losses_;
};

void require_round(const optics::Lens& lens) {
    optics::require_air_in_front(lens, "a polynomial");
    const auto refuse = [&](const char* why) {
        throw InputError(
            fmt::format("{}: {}; polynomials are fitted to rotationally symmetric lenses, expected the "
                        "exact model",
                        lens.name, why));
    };
    if (!lens.is_rotationally_symmetric) {
        refuse("a surface of it is tilted, displaced or a cylinder");
    }
    if (lens.has_mirrors() || lens.has_thin_elements()) {
        refuse("it has mirrors or thin elements");
    }
    if (!lens.stop_mask.is_full_circle()) {
        refuse("its stop has blades or a texture");
    }
}

}  // namespace

PolynomialLens fit_polynomial(const optics::Lens& lens, const std::vector<double>& wavelengths_nm,
                              const pupil::PupilMap& pupil, double film_radius_mm, const FitSettings& settings) {
    require_round(lens);
    const optics::SpectralLens<double> at = optics::at_wavelengths<double>(lens, wavelengths_nm);
    const PolynomialFrame frame{.film_radius_mm = film_radius_mm,
                                .film_z = lens.image_z,
                                .pupil_z = pupil.plane_z(),
                                .front_curvature = front_curvature(lens)};
    const RaySampler sampler(at.at(), pupil, film_radius_mm, frame.front_curvature);
    const Fit fit(sampler, frame, band_of(wavelengths_nm), settings);
    std::optional<PolynomialLens> best;
    double least_um = 0.0;
    for (const int order : {5, 7}) {
        double aim_um = 0.9 * settings.wanted_um;
        for (int attempt = 0; attempt < 2 && !(best && least_um <= settings.wanted_um); ++attempt) {
            PolynomialLens made = fit.lens(order, aim_um);
            const double rms_um = measured_error(made, at.at(), pupil, kHeldOut, settings.held_out_rays).rms_um;
            if (!best || rms_um < least_um) {
                best = std::move(made);
                least_um = rms_um;
            }
            aim_um *= 0.9 * settings.wanted_um / rms_um;
        }
    }
    best->set_error(measured_error(*best, at.at(), pupil, kJudging, settings.judging_rays));
    return *std::move(best);
}

}  // namespace lensproof::polynomial
