#include "engine/analysis/zernike.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/base/input_error.h"

namespace lensproof::analysis {

namespace {

std::size_t entry(int i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

int noll_index(ZernikeMode mode) {
    const int size = std::abs(mode.m);
    const int first = mode.n * (mode.n + 1) / 2 + size;
    // Of the two indices first and first + 1 that |m| > 0 has, the even one goes with the cosine.
    if (size == 0) {
        return first + 1;
    }
    const bool wants_even = mode.m > 0;
    return (first % 2 == 0) == wants_even ? first : first + 1;
}

int ansi_index(ZernikeMode mode) {
    return (mode.n * (mode.n + 2) + mode.m) / 2;
}

ZernikeMode mode_of_ansi(int index) {
    int n = 0;
    while (zernike_count(n) <= index) {
        ++n;
    }
    return {n, 2 * index - n * (n + 2)};
}

std::vector<double> zernike_values(int degree, Vec2d point) {
    const double r = length(point);
    const double cosine = r > 0.0 ? point.x / r : 1.0;
    const double sine = r > 0.0 ? point.y / r : 0.0;
    std::vector<double> cosines(entry(degree) + 1, 1.0);
    std::vector<double> sines(entry(degree) + 1, 0.0);
    for (std::size_t m = 1; m < cosines.size(); ++m) {
        cosines[m] = cosine * cosines[m - 1] - sine * sines[m - 1];
        sines[m] = sine * cosines[m - 1] + cosine * sines[m - 1];
    }
    // The radial polynomials of degrees n, n − 1 and n − 2 by m; zero for m > n.
    using Row = std::vector<double>;
    Row before_last(entry(degree) + 2, 0.0);
    Row last(entry(degree) + 2, 0.0);
    std::vector<double> values(entry(zernike_count(degree)));
    for (int n = 0; n <= degree; ++n) {
        Row row(entry(degree) + 2, 0.0);
        for (int m = n % 2; m <= n; m += 2) {
            const double radial =
                n == 0 ? 1.0 : r * (last[entry(std::abs(m - 1))] + last[entry(m + 1)]) - before_last[entry(m)];
            row[entry(m)] = radial;
            if (m == 0) {
                values[entry(noll_index({n, 0}) - 1)] = std::sqrt(n + 1.0) * radial;
            } else {
                const double norm = std::sqrt(2.0 * (n + 1.0));
                values[entry(noll_index({n, m}) - 1)] = norm * radial * cosines[entry(m)];
                values[entry(noll_index({n, -m}) - 1)] = norm * radial * sines[entry(m)];
            }
        }
        before_last = std::move(last);
        last = std::move(row);
    }
    return values;
}

ZernikeFit fit_zernike(std::span<const ZernikeSample> samples, int degree) {
    const int terms = zernike_count(degree);
    if (samples.size() < entry(terms)) {
        throw InputError(fmt::format("a Zernike fit to degree {} has {} terms: {} points of the wavefront are too few",
                                     degree, terms, samples.size()));
    }
    const auto count = static_cast<Eigen::Index>(samples.size());
    Eigen::MatrixXd design(count, terms);
    Eigen::VectorXd target(count);
    double weight = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
        const ZernikeSample& sample = samples[static_cast<std::size_t>(i)];
        const std::vector<double> values = zernike_values(degree, sample.point);
        const double root = std::sqrt(sample.weight);
        design.row(i) = root * Eigen::Map<const Eigen::RowVectorXd>(values.data(), terms);
        target(i) = root * sample.value;
        weight += sample.weight;
    }
    const Eigen::VectorXd solution = design.completeOrthogonalDecomposition().solve(target);
    return {.degree = degree,
            .coefficients = {solution.begin(), solution.end()},
            .residual_rms = (target - design * solution).norm() / std::sqrt(weight)};
}

double pupil_radius(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                    const ReferenceSphere& sphere, const optics::RegionOutline& outline) {
    std::vector<optics::RegionNode> rim;
    for (const optics::OutlinePoint& point : outline.points) {
        rim.push_back({outline.at(point, 1.0), 1.0});
    }
    double radius = 0.0;
    for (const WavefrontRay& ray : wavefront(lens, 1.0, bundle, sphere, rim).rays) {
        radius = std::max(radius, length(ray.pupil));
    }
    return radius;
}

ZernikeFit wavefront_zernike(const Wavefront& wavefront, double radius, int degree) {
    const double waves_per_mm = 1e6 / wavefront.wavelength_nm;
    std::vector<ZernikeSample> samples;
    samples.reserve(wavefront.rays.size());
    for (const WavefrontRay& ray : wavefront.rays) {
        samples.push_back({ray.pupil / radius, ray.opd_mm * waves_per_mm, ray.weight});
    }
    return fit_zernike(samples, degree);
}

}  // namespace lensproof::analysis
