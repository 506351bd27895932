// experiments/studies/stability/measure_stability.h — the error of the tracer in each number type, against itself in a
// hundred digits.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "experiments/studies/stability/extremes.h"

namespace lensproof::studies {

/// The number types that are judged, in the order of all arrays here.
inline constexpr std::array<const char*, 3> kNumberTypes = {"float", "double", "long double"};
inline constexpr std::size_t kFloat = 0;
inline constexpr std::size_t kDouble = 1;
inline constexpr std::size_t kLongDouble = 2;

/// A double's error may be this large (mm), or so many times as large as what rounding the input does, whichever is
/// more.
inline constexpr double kErrorBoundMm = 1e-9;
inline constexpr double kConditioningFactor = 10.0;

/// How one number type did at one value of an extreme.
///
/// An error is the largest distance (mm) between a point that the type's tracer gives, on any surface or on the image
/// plane, and the same point in a hundred digits, of a lens and a ray with exactly the numbers that the type was given.
struct TypeResult {
    double error_mm = 0.0;   // largest, over the rays that agree on what becomes of them and are clear of a change
    int other_statuses = 0;  // rays that are clear of a change of status and yet have another
    int close_calls = 0;     // rays with another status, within rounding of a change
    int not_finite = 0;      // rays of which any number is NaN or infinite
};

struct StabilityPoint {
    double value = 0.0;
    std::string refusal;  // the message of a lens that the program refuses; else empty, and the rest is filled in
    bool is_rightly_refused = true;  // or rightly taken
    int rays = 0;
    int at_a_change = 0;               // rays within rounding of a change of status
    std::map<std::string, int> fates;  // status names of the double tracer, and how many rays had them
    double conditioning_mm = 0.0;      // largest movement of a point when each input moves by half an ulp of double
    double excess = 0.0;               // largest double error over its own ray's bound; the requirement is ≤ 1
    std::array<TypeResult, kNumberTypes.size()> types{};
    int lanes_unlike_scalar = 0;  // rays whose lane of a packet has not the bits of the float alone
};

void fields(JsonArchive& json, StabilityPoint& point);

struct StabilitySweep {
    Extreme extreme;
    std::vector<StabilityPoint> points;
};

/// Every value of `extreme`; the same seed gives the same numbers.
StabilitySweep measure_stability(const Extreme& extreme, std::uint64_t seed);

}  // namespace lensproof::studies
