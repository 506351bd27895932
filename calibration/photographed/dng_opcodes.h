// calibration/photographed/dng_opcodes.h — what a DNG's opcode lists correct of its lens.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::calibration {

/// WarpRectilinear, in units of the distance m from the centre to the corner that is farthest from it: a point that
/// belongs at the radius r is photographed at r (k0 + k1 r² + k2 r⁴ + k3 r⁶) (Digital Negative Specification 1.4,
/// chapter 7).
struct RectilinearWarp {
    struct Plane {
        std::array<double, 4> radial{};
        std::array<double, 2> tangential{};
    };
    std::vector<Plane> planes;               // one for all, or red, green and blue
    std::array<double, 2> centre{0.5, 0.5};  // fractions of the picture's width and height
};

/// FixVignetteRadial: the picture is multiplied by 1 + k0 r² + k1 r⁴ + … + k4 r¹⁰, in the same unit.
struct RadialGain {
    std::array<double, 5> k{};
    std::array<double, 2> centre{0.5, 0.5};
};

struct LensOpcodes {
    std::optional<RectilinearWarp> warp;
    std::optional<RadialGain> gain;
};

/// Adds what a list, its tag's bytes, has of them; other opcodes are passed over, as long as they leave places alone.
/// Throws InputError, which begins with `name`, where the list is cut, a number is not finite, an opcode comes twice,
/// or the lens is corrected by one that is not known here (WarpFisheye, WarpRectilinear2; TrimBounds before a warp).
void read_opcodes(std::string_view list, const std::string& name, LensOpcodes& found);

}  // namespace lensproof::calibration
