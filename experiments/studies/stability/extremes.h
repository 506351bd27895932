// experiments/studies/stability/extremes.h — lenses and rays that ask for more than lenses do: one number swept to
// breaking.
#pragma once
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/optics/trace.h"

namespace lensproof::studies {

/// What is traced at one value of an extreme's number. All its numbers are doubles; the directions mean their exact
/// unit vectors.
struct StabilityCase {
    optics::TraceLens<double> lens;
    std::vector<Ray<double>> rays;
};

/// A number that is swept, and the lens that it belongs to.
struct Extreme {
    std::string id;         // "radius-convex"
    std::string title;      // "Radius of a convex surface"
    std::string setting;    // one sentence: which lens, which rays
    std::string parameter;  // what the number is: "radius"
    std::string unit;
    std::vector<double>
        values;  // in the order of the sweep; may hold infinities and zeros, which a log axis leaves out
    bool is_logarithmic = true;
    /// Throws InputError where the program refuses such a lens: its message is a part of the result.
    std::function<StabilityCase(double value, std::mt19937_64& random)> build;
    /// What the program has to take; it has to refuse all other values.
    double least_taken = -kInfinity;
    double most_taken = kInfinity;
};

/// Every extreme, in the order of the report.
std::vector<Extreme> stability_extremes();

/// Those of the shapes of surfaces, of what stands between them, and of the rays.
std::vector<Extreme> shape_extremes();
std::vector<Extreme> medium_extremes();
std::vector<Extreme> ray_extremes();

}  // namespace lensproof::studies
