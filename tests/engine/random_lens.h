// tests/engine/random_lens.h — lenses that nobody designed, for properties that every lens has.
#pragma once
#include <algorithm>
#include <cmath>
#include <random>

#include "engine/optics/lens.h"

namespace lensproof {

/// Draws prescriptions: two to five groups of one to three cemented elements about a stop, of spheres, flats, conics
/// and even aspheres, semi-diameters of 6 to 12 mm, indices of 1.45 to 1.9 at every wavelength. Neighbours do not cross
/// within their rims, and no rim stands beyond 0.7 of its sphere's radius. Nothing is focused on anything.
class RandomLenses {
  public:
    explicit RandomLenses(std::uint64_t seed) : random_(seed) {}

    optics::Prescription next() {
        optics::Prescription lens;
        lens.name = "random";
        lens.source = "drawn at random";
        semi_diameter_ = between(6.0, 12.0);
        const int groups = whole(2, 5);
        const int before_stop = whole(0, groups);
        for (int group = 0; group <= groups; ++group) {
            if (group == before_stop) {
                optics::PrescribedSurface stop;
                stop.semi_diameter_mm = between(0.4, 0.9) * semi_diameter_;
                stop.is_stop = true;
                add(lens, stop);
            }
            if (group < groups) {
                add_group(lens);
            }
        }
        lens.surfaces.back().thickness_mm = between(20.0, 80.0);
        return lens;
    }

    double between(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
    int whole(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }

  private:
    void add_group(optics::Prescription& lens) {
        const int elements = whole(1, 3);
        for (int i = 0; i <= elements; ++i) {
            optics::PrescribedSurface surface = face();
            if (i < elements) {
                surface.medium.n_d = between(1.45, 1.9);
            }
            add(lens, surface);
        }
    }

    optics::PrescribedSurface face() {
        optics::PrescribedSurface surface;
        surface.semi_diameter_mm = semi_diameter_;
        const int kind = whole(0, 9);
        if (kind == 0) {
            return surface;  // flat
        }
        surface.radius_mm = std::copysign(semi_diameter_ / between(0.02, 0.7), between(-1.0, 1.0));
        if (kind > 5) {
            surface.conic = between(-3.0, 0.8);
        }
        if (kind > 7) {
            // Terms of r⁴ to r⁸ that depart from the conic by up to 1 % of the semi-diameter at the rim.
            for (int term = 1; term <= 3; ++term) {
                surface.asphere[term] =
                    between(-0.01, 0.01) * semi_diameter_ / std::pow(semi_diameter_, 2 * (term + 1));
            }
        }
        return surface;
    }

    /// Puts a surface at the end, so far behind its neighbour that they stand apart at their rims too.
    void add(optics::Prescription& lens, const optics::PrescribedSurface& surface) {
        if (!lens.surfaces.empty()) {
            optics::PrescribedSurface& last = lens.surfaces.back();
            const double r = semi_diameter_;
            const double at_rim = optics::sag(optics::prescribed_shape(last), r, 0.0) -
                                  optics::sag(optics::prescribed_shape(surface), r, 0.0);
            last.thickness_mm = std::max(0.0, at_rim) + between(0.3, 5.0);
        }
        lens.surfaces.push_back(surface);
    }

    std::mt19937_64 random_;
    double semi_diameter_ = 0.0;
};

}  // namespace lensproof
