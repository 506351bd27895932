// engine/analysis/ghosts.h — the reflections between a lens's surfaces that reach the sensor, and which surface to
// coat.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/analysis/ghost_light.h"
#include "engine/device/shared_device.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial_ghost.h"

namespace lensproof::analysis {

/// What a lens's ghosts are looked for with. Angles in radians.
struct GhostSettings {
    double reference_wavelength_nm = 0.0;
    std::vector<double> wavelengths_nm;  // further ones, of which the energies are found too
    double source_angle = 0.0;           // of a distant light, |angle| < 90°
    double chief_angle = 0.0;            // of the paraxial chief rays
    int reflections = 2;                 // or 4: those of two and of four
    double tolerance = 1e-6;             // ghosts of four reflections that carry less are skipped
    optics::StrayMirrors<double> mirrors;
    bool polarised = false;     // finds each ghost's `polarised_energy` too
    double image_radius = 0.0;  // mm
    GhostSampling sampling;
    int threads = 0;
    std::shared_ptr<device::SharedDevice> device{};  // that traces rays, or null
};

/// A ghost; energies as in GhostLight.
struct Ghost {
    optics::GhostPath path;
    optics::ParaxialGhost paraxial;
    GhostLight light;
    std::vector<double> energies;           // at the settings' further wavelengths
    std::optional<double> peak_over_image;  // nothing where the light's own image is not on the sensor
    double polarised_energy = 0.0;  // with polarisation carried along the path, of unpolarised light; if asked for
};

/// What one surface has to do with the ghosts' light, as fractions of all of it.
struct SurfaceContribution {
    int surface = 0;        // from 0; the number of surfaces stands for the sensor
    double involved = 0.0;  // of the ghosts that it reflects
    double perfect = 0.0;   // what is gone where this surface alone reflects nothing: light that it then passes makes
                            // the other ghosts brighter
    std::optional<double> quarter_wave;  // and where it has a quarter wave of MgF₂ (n 1.38, 550 nm) in place of what it
                                         // has; negative where that makes it worse. Of glass surfaces
};

struct GhostSurvey {
    std::vector<Ghost> ghosts;  // the strongest first
    double energy = 0.0;        // of all
    double polarised_energy = 0.0;
    GhostLight image;  // of the light itself
    double skipped_energy_bound = 0.0;
    std::vector<SurfaceContribution> surfaces;  // that whose coating takes away most first
};

/// The entrance pupil is the paraxial one, a disc that the light meets at `source_angle`. The same settings give the
/// same numbers for any number of threads. Throws InputError for a wavelength that a glass's formula does not cover,
/// and for a lens whose entrance pupil has no finite size.
GhostSurvey survey_ghosts(const optics::Lens& lens, const GhostSettings& settings);

/// What the survey sees at one wavelength.
GhostScene ghost_scene(const optics::Lens& lens, const GhostSettings& settings, double wavelength_nm);

/// The image circle's radius: what the source states, else the height of the outermost chief ray that passes, mm;
/// nothing where there is none.
std::optional<double> image_radius(const optics::Lens& lens, double wavelength_nm);

}  // namespace lensproof::analysis
