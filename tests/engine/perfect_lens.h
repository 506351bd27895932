// tests/engine/perfect_lens.h — a lens without aberration, of closed form, for the wave optics' tests.
#pragma once
#include <numbers>

#include "engine/optics/lens.h"

namespace lensproof {

/// A plano-convex lens whose rear is the hyperboloid of conic −n²: it joins every ray parallel to the axis in its
/// focus, R/(n − 1) behind the rear's vertex, along equal optical paths (Descartes; Born & Wolf 4.2.3).
struct PerfectLens {
    double index = 1.5;
    double focal_length = 50.0;
    double thickness = 6.0;
    double beam_radius = 5.0;    // of the stop
    double stop_distance = 0.0;  // in front of the flat face
    double defocus = 0.0;        // of the image plane behind the focus
    double spherical = 0.0;      // r⁴ term of the hyperboloid's sag, 1/mm³

    /// The stop's distance that puts the exit pupil at infinity: the front focal plane.
    [[nodiscard]] double telecentric_distance() const { return focal_length - thickness / index; }

    [[nodiscard]] optics::Lens lens() const {
        optics::PrescribedSurface stop{.thickness_mm = stop_distance, .semi_diameter_mm = beam_radius, .is_stop = true};
        optics::PrescribedSurface flat{.thickness_mm = thickness, .semi_diameter_mm = 40.0, .medium = {.n_d = index}};
        optics::PrescribedSurface rear{.radius_mm = -focal_length * (index - 1.0),
                                       .conic = -index * index,
                                       .thickness_mm = focal_length + defocus,
                                       .semi_diameter_mm = 40.0};
        rear.asphere[1] = spherical;
        optics::Prescription prescription;
        prescription.name = "perfect";
        prescription.surfaces = {stop, flat, rear};
        return optics::make_lens(prescription, optics::GlassCatalogue{});
    }
};

}  // namespace lensproof
