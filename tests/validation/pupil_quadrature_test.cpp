// Pupil maps against the whole rear element and against quadrature: no light lost, and hardly a path.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/focus.h"
#include "engine/optics/illumination.h"
#include "engine/optics/lens.h"
#include "engine/optics/packet/trace_batch.h"
#include "engine/pupil/pupil_map.h"
#include "engine/render/sampling/sampler.h"
#include "tests/test_folder.h"
#include "tests/validation/measured.h"

namespace lensproof::pupil_quadrature_test {

constexpr int kRings = 8;
constexpr int kWavelengths = 16;  // the centres of as many strata from 400 to 700 nm

struct Setting {
    std::string lens;
    double f_number;
    double focus_distance_mm = kInfinity;
    std::string zoom{};
    std::string more{};  // added to the lens's file
};

std::string name_of(const Setting& s) {
    return fmt::format("{} f/{}{}{}{}", s.lens, s.f_number,
                       std::isinf(s.focus_distance_mm) ? "" : fmt::format(" at {} mm", s.focus_distance_mm),
                       s.zoom.empty() ? "" : " zoom " + s.zoom, s.more.empty() ? "" : ", changed");
}

optics::Lens lens_of(const Setting& s) {
    const TestFolder folder;
    std::string file = s.lens;
    if (!s.more.empty()) {
        file = (folder.path() / "changed.toml").string();
        write_file(file, read_file(formats::find_lens_file(s.lens)) + s.more);
    }
    return optics::focused_at(optics::with_f_number(formats::load_lens(file, {.zoom = s.zoom}), s.f_number),
                              s.focus_distance_mm);
}

/// A lens across the band, its image circle and its map.
struct Mapped {
    std::vector<optics::TraceLens<double>> band;
    double circle_mm = 0.0;  // radius: where the last light of any wavelength ends, or what is stated, if smaller
    pupil::PupilMap map;
    pupil::PupilMap whole;
};

double position(int wavelength) {
    return wavelength / (kWavelengths - 1.0);
}

/// The radius up to which some wavelength has light, on the azimuth +y.
double last_light(const std::vector<optics::TraceLens<double>>& band) {
    double last = 0.0;
    for (const std::size_t i : {std::size_t{0}, band.size() / 2, band.size() - 1}) {
        double lit = 0.0;
        double dark = 1.0;
        while (!optics::image_outline(band[i], {0.0, dark}).is_empty()) {
            lit = dark;
            dark *= 1.25;
        }
        while (dark - lit > 1e-4 * dark) {
            const double middle = 0.5 * (lit + dark);
            (optics::image_outline(band[i], {0.0, middle}).is_empty() ? dark : lit) = middle;
        }
        last = std::max(last, lit);
    }
    return last;
}

Mapped mapped(const Setting& setting) {
    const optics::Lens lens = lens_of(setting);
    std::vector<optics::TraceLens<double>> band;
    band.reserve(kWavelengths);
    for (int i = 0; i < kWavelengths; ++i) {
        band.push_back(optics::at_wavelength<double>(lens, 400.0 + 300.0 * (i + 0.5) / kWavelengths));
    }
    const double circle = std::min(last_light(band), lens.stated.image_circle_mm.value_or(kInfinity) / 2.0);
    pupil::PupilMap map(band, lens.is_rotationally_symmetric, circle);
    pupil::PupilMap whole = pupil::PupilMap::whole_element(band.front(), circle);
    return {std::move(band), circle, std::move(map), std::move(whole)};
}

/// The path from the sensor through a point of the pupil, and its part of the film irradiance in a world of radiance
/// 1, before the pdf: τ cos⁴θ / Z² = τ cos²θ / |to_pupil|² (Kolb et al. 1995, eq. 4). 0 where it does not leave the
/// front.
double film_irradiance(const optics::TraceLens<double>& lens, Vec2d at, Vec2d pupil_point, double plane_z) {
    const Vec3d from{at.x, at.y, lens.image_z};
    const Vec3d to_pupil = Vec3d{pupil_point.x, pupil_point.y, plane_z} - from;
    const Ray<double> ray{from, normalized(to_pupil)};
    const optics::TracedRay<double> traced = optics::trace<optics::Direction::reverse>(lens, ray);
    return traced.status == optics::RayStatus::ok
               ? traced.transmittance * ray.direction.z * ray.direction.z / dot(to_pupil, to_pupil)
               : 0.0;
}

/// A sensor point of a ring, evenly over its area.
Vec2d in_ring(double circle_mm, int ring, double u, double v) {
    const double radius = circle_mm / kRings * std::sqrt(ring * ring + u * (2 * ring + 1));
    return {radius * std::sin(2.0 * kPi * v), radius * std::cos(2.0 * kPi * v)};
}

// --- Unbiased ---

/// A ring's mean film irradiance by a map's points, on one azimuth of a lens that is round. As `film_irradiance` has it
/// for one path; in batches, since the whole element's needs many.
class RingIrradiance {
  public:
    RingIrradiance(const Mapped& lens, int ring, int wavelength)
        : lens_(&lens), traced_({lens.band[wavelength]}), ring_(ring), wavelength_(wavelength) {}

    Measured operator()(const pupil::PupilMap& map, int points) {
        constexpr int kScrambles = 16;
        std::vector<double> values;
        values.reserve(kScrambles);
        for (int scramble = 0; scramble < kScrambles; ++scramble) {
            values.push_back(by_scramble(map, scramble, points / kScrambles));
        }
        return mean_of(values);
    }

  private:
    static constexpr int kBatch = 2048;

    double by_scramble(const pupil::PupilMap& map, int scramble, int points) {
        const render::PixelSampler sampler(static_cast<std::uint64_t>(wavelength_),
                                           static_cast<std::uint32_t>(ring_ * 16 + scramble));
        double sum = 0.0;
        for (int done = 0; done < points; done += kBatch) {
            const int count = std::min(kBatch, points - done);
            sampler.points(static_cast<std::uint32_t>(done), static_cast<std::uint32_t>(count), columns());
            start(map, count);
            optics::trace_batch<optics::Direction::reverse>(traced_, rays_, {.carry = optics::Carry::transmittance});
            for (int i = 0; i < rays_.size; ++i) {
                const auto at = static_cast<std::size_t>(i);
                sum += rays_.status[at] == optics::RayStatus::ok ? weights_[at] * rays_.transmittance[at] : 0.0;
            }
        }
        return sum / points;
    }

    std::array<double*, render::PixelSampler::kDimensions> columns() {
        std::array<double*, render::PixelSampler::kDimensions> of{};
        std::ranges::transform(numbers_, of.begin(), [](auto& column) { return column.data(); });
        return of;
    }

    void start(const pupil::PupilMap& map, int count) {
        rays_.size = 0;
        for (int i = 0; i < count; ++i) {
            const auto& [along, unused, u, v, also_unused] = numbers_;
            const Vec2d at = in_ring(lens_->circle_mm, ring_, along[i], 0.0);
            const pupil::PupilSample sample = map.sample(at, position(wavelength_), u[i], v[i]);
            if (sample.pdf > 0.0) {
                const Vec3d from{at.x, at.y, lens_->band[wavelength_].image_z};
                const Vec3d to_pupil = Vec3d{sample.point.x, sample.point.y, map.plane_z()} - from;
                const double squared = dot(to_pupil, to_pupil);
                weights_[static_cast<std::size_t>(rays_.size)] =
                    to_pupil.z * to_pupil.z / (squared * squared * sample.pdf);
                rays_.set(rays_.size++, {from, normalized(to_pupil)});
            }
        }
    }

    const Mapped* lens_;
    optics::SpectralLens<double> traced_;
    int ring_;
    int wavelength_;
    std::array<std::array<double, kBatch>, render::PixelSampler::kDimensions> numbers_{};
    std::array<double, kBatch> weights_{};  // cos²θ / |to_pupil|² over the pdf
    optics::RayBatch<double> rays_{kBatch};
};

// Film irradiance by the map's points and by points of the whole rear element, in eight rings of the image circle at
// three wavelengths: within four standard errors of the difference, those of 16 independent scrambles. Points are
// added until that error is 0.05 % of the ring's own irradiance: some 16 million in the last ring, where 3 % of the
// whole element's paths pass the double Gauss.
TEST(PupilMap, LosesNoLight) {
    constexpr int kMostPoints = 1 << 26;
    constexpr double kGoal = 5e-4;
    for (const Setting& setting : {Setting{"muller-fisheye", 4.0}, Setting{"double-gauss-tronnier", 2.0}}) {
        const Mapped lens = mapped(setting);
        double largest_error = 0.0;
        for (const int wavelength : {0, kWavelengths / 2, kWavelengths - 1}) {
            for (int ring = 0; ring < kRings; ++ring) {
                RingIrradiance irradiance(lens, ring, wavelength);
                const Measured by_map = irradiance(lens.map, 1 << 17);
                Measured by_whole;
                double error = kInfinity;
                for (int points = 1 << 16; points <= kMostPoints && error > kGoal;
                     points *= error > 4 * kGoal ? 16 : 4) {
                    by_whole = irradiance(lens.whole, points);
                    error = std::hypot(by_map.error, by_whole.error) / by_whole.value;
                }
                largest_error = std::max(largest_error, error);
                EXPECT_NEAR(by_map.value / by_whole.value, 1.0, 4.0 * error) << name_of(setting) << ", ring " << ring;
                EXPECT_LE(error, kGoal) << name_of(setting) << ", ring " << ring << ", wavelength " << wavelength;
            }
        }
        fmt::print("{}: standard errors up to {:.3f} %\n", name_of(setting), 100.0 * largest_error);
    }
}

// --- Passage ---

struct Passage {
    double passage = 0.0;  // of the paths started, the mean over the image circle's area
    double least = 1.0;    // of the rings
    double whole = 0.0;    // of the whole element's paths
};

/// Paths that leave the front over paths started, ring by ring, every wavelength alike.
Passage passage(const Mapped& lens) {
    constexpr int kPaths = 20000;
    Passage result;
    for (int ring = 0; ring < kRings; ++ring) {
        const render::PixelSampler sampler(1, static_cast<std::uint32_t>(ring));
        int started = 0;
        int passed = 0;
        int passed_whole = 0;
        for (int i = 0; i < kPaths; ++i) {
            const auto xi = sampler.point(static_cast<std::uint32_t>(i));
            const Vec2d at = in_ring(lens.circle_mm, ring, xi[0], xi[1]);
            const int wavelength = static_cast<int>(xi[4] * kWavelengths);
            const optics::TraceLens<double>& traced = lens.band[wavelength];
            const auto passes = [&](Vec2d point) {
                return film_irradiance(traced, at, point, lens.map.plane_z()) > 0.0 ? 1 : 0;
            };
            const pupil::PupilSample sample = lens.map.sample(at, position(wavelength), xi[2], xi[3]);
            started += sample.pdf > 0.0 ? 1 : 0;
            passed += sample.pdf > 0.0 ? passes(sample.point) : 0;
            passed_whole += passes(lens.whole.sample(at, position(wavelength), xi[2], xi[3]).point);
        }
        const double area = (2.0 * ring + 1.0) / (kRings * kRings);
        const double passing = static_cast<double>(passed) / std::max(1, started);
        result.passage += area * passing;
        result.least = std::min(result.least, passing);
        result.whole += area * passed_whole / kPaths;
    }
    return result;
}

/// Of the light's part of the pupil, what lies outside the region, at places all over the image circle and the band.
double missed_fraction(const Mapped& lens) {
    constexpr int kPlaces = 400;
    constexpr int kPoints = 1000;
    const render::PixelSampler places(2, 0);
    double lit = 0.0;
    double missed = 0.0;
    for (int i = 0; i < kPlaces; ++i) {
        const auto xi = places.point(static_cast<std::uint32_t>(i));
        const double radius = lens.circle_mm * std::sqrt(xi[0]);
        const Vec2d at{radius * std::sin(2.0 * kPi * xi[1]), radius * std::cos(2.0 * kPi * xi[1])};
        const int wavelength = static_cast<int>(xi[4] * kWavelengths);
        const double area = lens.map.region_area(at, position(wavelength));
        if (!(area > 0.0)) {
            continue;
        }
        // A box around what the map draws, an eighth larger.
        const render::PixelSampler points(3, static_cast<std::uint32_t>(i));
        Vec2d lower{kInfinity, kInfinity};
        Vec2d upper{-kInfinity, -kInfinity};
        for (std::uint32_t k = 0; k < 256; ++k) {
            const auto eta = points.point(k);
            const double u = 0.004 + 0.995 * eta[0];  // beyond the defensive fraction
            const Vec2d p = lens.map.sample(at, position(wavelength), u, eta[1]).point;
            lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
            upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
        }
        const Vec2d size{upper.x - lower.x, upper.y - lower.y};
        for (std::uint32_t k = 0; k < kPoints; ++k) {
            const auto eta = points.point(k);
            const Vec2d p{lower.x + (1.125 * eta[2] - 0.0625) * size.x, lower.y + (1.125 * eta[3] - 0.0625) * size.y};
            if (film_irradiance(lens.band[wavelength], at, p, lens.map.plane_z()) > 0.0) {
                lit += 1.0;
                missed += lens.map.pdf(at, position(wavelength), p) < 0.5 / area ? 1.0 : 0.0;
            }
        }
    }
    return missed / lit;
}

struct Bound {
    Setting setting;
    double passage;  // at least
    double ring;     // each of the eight rings
};

// Nearly every path that the map starts leaves the front. Round stops: 97 % over the image circle and 90 % in each
// ring. Seven blades of curvature 0 leave 7 sin(2π/7) / 2π = 87.1 % of the circle that is drawn from, until rims cut
// it: 84 %. Tilted lenses have coarser maps (pupil_nodes.cpp): 95 % and 88 %. The fraction of the light that lies
// outside the regions is 0 for most and was 7e-6 at worst; 1e-4 would double the noise that the regions save.
TEST(PupilMap, NearlyAllPathsPass) {
    const std::vector<Bound> bounds = {
        {{"muller-fisheye", 4.0}, 0.97, 0.9},
        {{"muller-fisheye", 8.0}, 0.97, 0.9},
        {{"double-gauss-tronnier", 2.0}, 0.97, 0.9},
        {{"double-gauss-tronnier", 8.0}, 0.97, 0.9},
        {{"wide-nakamura", 8.0}, 0.97, 0.9},
        {{"tessar", 2.8}, 0.97, 0.9},
        {{"muller-fisheye", 8.0, 300.0}, 0.97, 0.9},
        {{"double-gauss-tronnier", 2.0, 500.0}, 0.97, 0.9},
        {{"canon-zoom-70-200", 2.8, kInfinity, "1"}, 0.97, 0.9},
        {{"canon-zoom-70-200", 2.8, kInfinity, "3"}, 0.97, 0.9},
        {{"fisheye-220", 8.0}, 0.97, 0.9},
        {{"tessar", 22.0}, 0.97, 0.9},
        {{"double-gauss-tronnier", 4.0, kInfinity, "", "\n[stop]\nblades = 7\n"}, 0.84, 0.84},
        {{"double-gauss-tronnier", 2.0, kInfinity, "",
          "\n[[groups]]\nsurfaces = [1, 3]\ntilt_deg = [0.5, 0.3, 0]\ndecentre_mm = [0.1, 0.2]\n"},
         0.95,
         0.88},
    };
    fmt::print("{:44} {:>8} {:>8} {:>8} {:>8} {:>6}\n", "", "passage", "least", "whole", "missed", "size");
    for (const Bound& bound : bounds) {
        const Mapped lens = mapped(bound.setting);
        const Passage found = passage(lens);
        const double missed = missed_fraction(lens);
        fmt::print("{:44} {:8.4f} {:8.4f} {:8.4f} {:8.1e} {:6}\n", name_of(bound.setting), found.passage, found.least,
                   found.whole, missed, lens.map.size());
        EXPECT_GT(found.passage, bound.passage) << name_of(bound.setting);
        EXPECT_GT(found.least, bound.ring) << name_of(bound.setting);
        EXPECT_LT(missed, 1e-4) << name_of(bound.setting);
    }
}

// The same irradiance by quadrature of the bundle, which asks the rims and knows of no map (image_bundle, to 1e-11):
// at eight radii of the image circle, out to 0.95 of it, within 0.05 %. The sum over 2^16 points scatters by 1e-4 from
// scramble to scramble.
TEST(PupilMap, AgreesWithQuadrature) {
    for (const Setting& setting : {Setting{"muller-fisheye", 8.0}, Setting{"tessar", 2.8}}) {
        const Mapped lens = mapped(setting);
        for (const int wavelength : {0, kWavelengths / 2, kWavelengths - 1}) {
            for (int k = 0; k < 8; ++k) {
                const Vec2d at{0.0, lens.circle_mm * (k + 0.3) / 7.7};
                const render::PixelSampler sampler(4, static_cast<std::uint32_t>(k));
                constexpr int kPoints = 1 << 16;
                double sum = 0.0;
                for (std::uint32_t i = 0; i < kPoints; ++i) {
                    const auto xi = sampler.point(i);
                    const pupil::PupilSample sample = lens.map.sample(at, position(wavelength), xi[2], xi[3]);
                    if (sample.pdf > 0.0) {
                        sum +=
                            film_irradiance(lens.band[wavelength], at, sample.point, lens.map.plane_z()) / sample.pdf;
                    }
                }
                EXPECT_NEAR(sum / kPoints / optics::image_bundle(lens.band[wavelength], at.y).transmitted, 1.0, 5e-4)
                    << name_of(setting) << " at " << at.y << " mm, wavelength " << wavelength;
            }
        }
    }
}

}  // namespace lensproof::pupil_quadrature_test
