// engine/analysis/veiling_glare.h — how much light a lens brings to a black spot from its bright surround.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/base/infinity.h"
#include "engine/optics/barrel.h"
#include "engine/optics/ghost_path.h"

namespace lensproof::analysis {

/// The veiling glare index of ISO 9358's integral method: the irradiance at the centre of the image of a small black
/// spot in an even surround, over that at the same place where the spot is as bright as the surround.
///
/// The surround is all of the space in front of the lens, from which a path may come at any angle; the spot is at the
/// middle of the field. Paths run backwards from the image's centre, by chance through glass and from wall to wall
/// (StrayWalk), until they leave at the front: there each sees the surround or the spot. Scatter in the air, at
/// polished surfaces and by diffraction is none of it.
struct VeilingGlareSettings {
    double wavelength_nm = 0.0;
    double spot_angle = 0.0;             // half of what the spot subtends, radians
    double object_distance = kInfinity;  // of the plane in which the spot lies, in front of z = 0
    optics::StrayMirrors<double> mirrors;
    bool polarised = false;  // finds `VeilingGlare::polarised` too
    std::int64_t paths = 400'000;
    std::uint64_t seed = 0;
    int threads = 0;
};

/// An irradiance's fraction of that of the even field, with its standard error.
struct GlareFraction {
    double fraction = 0.0;
    double standard_error = 0.0;
};

/// The same of light whose polarisation is carried from surface to surface, and not averaged at each: the surround's
/// light is unpolarised, and so is what walls scatter. `difference` is that of the two indices; the same paths find
/// both, so that its error is far below either's.
struct PolarisedGlare {
    GlareFraction index;
    GlareFraction ghosts;
    GlareFraction barrel;
    GlareFraction blur;
    GlareFraction difference;
};

/// `index` is the sum of the three after it: what glass (and the sensor, where it is a mirror) reflected, what met
/// walls, and what should have made the image beside the spot and reaches its middle by aberrations alone.
struct VeilingGlare {
    GlareFraction index;
    GlareFraction ghosts;
    GlareFraction barrel;
    GlareFraction blur;
    double spot_angle = 0.0;  // as in the settings
    double irradiance = 0.0;  // of the even field of radiance 1, at the image's centre; 0 where no light gets there
    std::optional<PolarisedGlare> polarised{};
};

/// The same settings give the same numbers for any number of threads. A lens whose walls are black may have any shape.
/// Throws InputError as `Barrel` and `at_wavelength` do, and for a lens with mirrors.
VeilingGlare veiling_glare(const optics::Lens& lens, const VeilingGlareSettings& settings);

/// Half of what a spot subtends whose image has a tenth of the image circle's diameter, radians. Throws InputError for
/// a lens without a focal length or an image circle.
double tenth_of_field(const optics::Lens& lens, double wavelength_nm);

}  // namespace lensproof::analysis
