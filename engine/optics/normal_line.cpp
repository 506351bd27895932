#include "engine/optics/normal_line.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/optics/glass.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

namespace {

constexpr std::array kExponents = {-4.0, -8.0, 2.0};

/// s_j = c[j] · (1, V_d, 1/V_d, n_d).
constexpr std::array<std::array<double, 4>, 3> kShape = {{
    {0.0280494632, -0.000254563544, 0.0437461996, -0.00460752061},
    {-0.000187552819, 1.83721968e-06, 0.00803749154, -2.99787513e-05},
    {0.000929298499, -0.00653268131, -1.03254171, 0.0554017701},
}};

/// λ^exponent − λ_d^exponent.
double from_d(double um, double exponent) {
    return std::pow(um, exponent) - std::pow(1e-3 * spectral::kLineD, exponent);
}

double between_F_and_C(double exponent) {
    return std::pow(1e-3 * spectral::kLineF, exponent) - std::pow(1e-3 * spectral::kLineC, exponent);
}

}  // namespace

NormalLine normal_line(double n_d, double V_d) {
    const double V = std::clamp(V_d, 15.0, 100.0);
    const double n = std::clamp(n_d, 1.4, 2.2);
    NormalLine glass{.n_d = n_d, .dispersion = (n_d - 1.0) / V_d};
    for (std::size_t j = 0; j < glass.shape.size(); ++j) {
        const auto& c = kShape[j];
        glass.shape[j] = c[0] + c[1] * V + c[2] / V + c[3] * n;
    }
    return glass;
}

double normal_line_shape(const std::array<double, 3>& shape, double um) {
    const double w = from_d(um, -2.0) / between_F_and_C(-2.0);
    double sum = w;
    for (std::size_t j = 0; j < shape.size(); ++j) {
        sum += shape[j] * (from_d(um, kExponents[j]) - between_F_and_C(kExponents[j]) * w);
    }
    return sum;
}

ModelError normal_line_error(std::span<const Glass> glasses, double n_d, double V_d, double wavelength_nm) {
    struct Neighbour {
        double distance = 0.0;
        double error = 0.0;
    };
    std::vector<Neighbour> neighbours;
    for (const Glass& glass : glasses) {
        if (!covers(glass, wavelength_nm) || !covers(glass, spectral::kLineF) || !covers(glass, spectral::kLineC)) {
            continue;
        }
        const double n = refractive_index(glass.formula, spectral::kLineD);
        const double V = abbe_number(glass.formula);
        if (!(n > 1.0 && V > 0.0)) {
            continue;
        }
        const double exact = refractive_index(glass.formula, wavelength_nm);
        neighbours.push_back({.distance = std::hypot(n - n_d, std::log(V / V_d)),
                              .error = std::abs(refractive_index(normal_line(n, V), wavelength_nm) - exact)});
    }
    constexpr std::size_t kNeighbours = 40;
    const std::size_t count = std::min(kNeighbours, neighbours.size());
    if (count == 0) {
        return {};
    }
    std::ranges::partial_sort(neighbours, neighbours.begin() + static_cast<std::ptrdiff_t>(count), {},
                              &Neighbour::distance);
    neighbours.resize(count);
    std::ranges::sort(neighbours, {}, &Neighbour::error);
    double squares = 0.0;
    for (const Neighbour& neighbour : neighbours) {
        squares += neighbour.error * neighbour.error;
    }
    return {.rms = std::sqrt(squares / static_cast<double>(count)),
            .percentile_95 = neighbours[(count - 1) * 95 / 100].error,
            .largest = neighbours.back().error,
            .glasses = static_cast<int>(count)};
}

}  // namespace lensproof::optics
