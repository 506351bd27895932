#include "experiments/studies/stability/extreme_parts.h"

#include <cmath>

#include "engine/spectral/wavelengths.h"

namespace lensproof::studies {

optics::Prescription prescription_of(const std::vector<SurfaceRow>& rows) {
    optics::Prescription prescription;
    prescription.name = "extreme";
    optics::PrescribedSurface stop;
    stop.semi_diameter_mm = 1e7;
    stop.is_stop = true;
    prescription.surfaces.push_back(stop);
    for (const SurfaceRow& row : rows) {
        optics::PrescribedSurface surface;
        surface.radius_mm = row.radius;
        surface.conic = row.conic;
        surface.asphere = row.asphere;
        surface.thickness_mm = row.thickness;
        surface.semi_diameter_mm = row.semi_diameter;
        surface.misalignment = row.misalignment;
        surface.where = "surface";
        if (row.n != 1.0) {
            surface.medium.n_d = row.n;
        }
        prescription.surfaces.push_back(surface);
    }
    return prescription;
}

optics::TraceLens<double> lens_of(const std::vector<SurfaceRow>& rows) {
    return optics::at_wavelength<double>(optics::make_lens(prescription_of(rows), optics::GlassCatalogue{}),
                                         spectral::kLineD);
}

Ray<double> ray_through(const Vec3d& origin, const Vec3d& aim) {
    return {origin, normalized(aim - origin)};
}

std::vector<Ray<double>> random_rays(double height, double slope, std::mt19937_64& random, double distance) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> rays{{{0.0, 0.0, -distance}, {0.0, 0.0, 1.0}}};
    while (rays.size() < kRaysPerValue) {
        const Vec3d aim{height * unit(random), height * unit(random), 0.0};
        if (aim.x * aim.x + aim.y * aim.y > height * height) {
            continue;
        }
        const Vec3d direction = normalized(Vec3d{slope * unit(random), slope * unit(random), 1.0});
        rays.push_back({aim - distance * direction, direction});
    }
    return rays;
}

std::vector<double> decades(double low, double high, double per_decade) {
    std::vector<double> values;
    const double first = std::log10(low) * per_decade;
    const double last = std::log10(high) * per_decade;
    for (double step = first; step < last + 0.5; step += 1.0) {
        values.push_back(std::pow(10.0, step / per_decade));
    }
    return values;
}

}  // namespace lensproof::studies
