// engine/polynomial/polynomial_kernel.h — polynomials of many rays in step, for compilers to vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include <cstddef>

#include "engine/base/pack.h"
#include "engine/polynomial/exit_chart.h"
#include "engine/polynomial/polynomial_kernels.h"

namespace lensproof::polynomial {

/// Two packets at a time: while one sum waits for its last addition, the other goes on.
template <class Abi>
class ExitKernel {
    using Numbers = Pack<double, Abi>;
    static constexpr int kLanes = Numbers::kLanes;

  public:
    static constexpr int kRays = 2 * kLanes;

    ExitKernel(const PolynomialTables& tables, const FilmRays& from, optics::RayBatch<double>& rays)
        : tables_(tables), from_(from), rays_(rays) {}

    void find(int first) {
        Point points[2];
        for (int packet = 0; packet < 2; ++packet) {
            points[packet] = multiply(first, packet);
        }
        Sums sums;
        add(0, sums);
        Vec2<Numbers> w[2];
        Vec2<Numbers> u[2];
        for (int packet = 0; packet < 2; ++packet) {
            w[packet] = {sums.at[packet] * points[packet].x.x, sums.at[packet] * points[packet].x.y};
        }
        add(1, sums);
        for (int packet = 0; packet < 2; ++packet) {
            w[packet] = w[packet] + sums.at[packet] * points[packet].q;
        }
        add(2, sums);
        for (int packet = 0; packet < 2; ++packet) {
            u[packet] = sums.at[packet] * points[packet].x;
        }
        add(3, sums);
        for (int packet = 0; packet < 2; ++packet) {
            u[packet] = u[packet] + sums.at[packet] * points[packet].q;
        }
        add(4, sums);
        Numbers transmittance[2] = {sums.at[0], sums.at[1]};
        for (int rim = 0; rim < tables_.rims; ++rim) {
            add(5 + rim, sums);
            for (int packet = 0; packet < 2; ++packet) {
                transmittance[packet] = select(sums.at[packet] > Numbers(1.0), Numbers(0.0), transmittance[packet]);
            }
        }
        for (int packet = 0; packet < 2; ++packet) {
            store(first + packet * kLanes, exit_ray<Numbers>({u[packet], w[packet]}, Numbers(tables_.front_curvature)),
                  transmittance[packet]);
        }
    }

  private:
    struct Point {
        Vec2<Numbers> x;
        Vec2<Numbers> q;
    };
    struct Sums {
        Numbers at[2];
    };

    /// Fills the packet's products.
    Point multiply(int first, int packet) {
        const int i = first + packet * kLanes;
        const Vec2<Numbers> film{Numbers::load(from_.film_x + i), Numbers::load(from_.film_y + i)};
        const Vec2<Numbers> pupil{Numbers::load(from_.pupil_x + i), Numbers::load(from_.pupil_y + i)};
        const Point at{Numbers(tables_.per_film) * film,
                       Numbers(tables_.per_pupil) * (pupil - Numbers(tables_.pupil_shear) * film)};
        const Numbers two(2.0);
        const Numbers one(1.0);
        alignas(optics::kPacketAlignment) double invariants[kInvariants * kLanes];
        (two * dot(at.x, at.x) - one).store(invariants);
        (two * dot(at.q, at.q) - one).store(invariants + kLanes);
        dot(at.x, at.q).store(invariants + 2 * kLanes);
        Numbers::gather(tables_.band, from_.wavelength + i).store(invariants + 3 * kLanes);
        double* products = products_ + packet * kLanes;
        one.store(products);
        for (int k = 1; k < tables_.monomial_count; ++k) {
            const SymmetricMap::Monomial of = tables_.monomials[k];
            (Numbers::load(products + std::ptrdiff_t{of.parent} * kRays) *
             Numbers::load(invariants + static_cast<std::ptrdiff_t>(of.factor) * kLanes))
                .store(products + std::ptrdiff_t{k} * kRays);
        }
        return at;
    }

    /// Every other term by itself, so that four sums are under way.
    void add(int which, Sums& sums) const {
        Numbers even[2] = {Numbers(0.0), Numbers(0.0)};
        Numbers odd[2] = {Numbers(0.0), Numbers(0.0)};
        int term = tables_.first_term[which];
        const int end = tables_.first_term[which + 1];
        for (; term + 1 < end; term += 2) {
            add_term(term, even);
            add_term(term + 1, odd);
        }
        if (term < end) {
            add_term(term, even);
        }
        sums.at[0] = even[0] + odd[0];
        sums.at[1] = even[1] + odd[1];
    }

    void add_term(int term, Numbers (&sum)[2]) const {
        const Numbers coefficient(tables_.coefficients[term]);
        const double* products = products_ + tables_.term_monomial[term] * kRays;
        sum[0] = sum[0] + coefficient * Numbers::load(products);
        sum[1] = sum[1] + coefficient * Numbers::load(products + kLanes);
    }

    void store(int i, const Ray<Numbers>& ray, const Numbers& transmittance) {
        if (i >= from_.size) {
            return;
        }
        rays_.store(i, ray);
        transmittance.store(rays_.transmittance.data() + i);
    }

    const PolynomialTables& tables_;
    const FilmRays& from_;
    optics::RayBatch<double>& rays_;
    alignas(optics::kPacketAlignment) double products_[SymmetricMap::kMostMonomials * kRays];
};

template <class Abi>
[[gnu::flatten]] void find_exits(const PolynomialTables& tables, const FilmRays& from, optics::RayBatch<double>& rays) {
    ExitKernel<Abi> kernel(tables, from, rays);
    for (int first = 0; first < from.size; first += ExitKernel<Abi>::kRays) {
        kernel.find(first);
    }
}

template <>
PolynomialKernels polynomial_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, double>;
    return {find_exits<Abi>};
}

}  // namespace lensproof::polynomial
