// Light drawn into a lens by the regions that it can enter, against quadrature, the whole front element, and the light
// that the sensor sees.
#include "engine/pupil/entrance_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/analysis/beam_outline.h"
#include "engine/base/angle.h"
#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/focus.h"
#include "engine/optics/rim_margin.h"
#include "engine/pupil/pupil_map.h"
#include "engine/render/sampling/sampler.h"
#include "tests/test_folder.h"
#include "tests/validation/measured.h"

namespace lensproof::entrance_map_test {

struct Setting {
    std::string lens;
    double f_number;
};

// The set-ups that passage is judged by.
const std::vector<Setting> kSettings = {{"muller-fisheye", 4.0},        {"muller-fisheye", 8.0},
                                        {"double-gauss-tronnier", 2.0}, {"double-gauss-tronnier", 8.0},
                                        {"wide-nakamura", 8.0},         {"tessar", 2.8}};

/// A lens at five wavelengths across a band; its light is looked at in the fourth, between nodes.
struct Band {
    optics::Lens lens;
    std::vector<optics::TraceLens<double>> at;

    static constexpr std::array<double, 5> kWavelengths_nm = {450.0, 500.0, 550.0, 600.0, 650.0};
    static constexpr double kPosition = 0.75;
    [[nodiscard]] const optics::TraceLens<double>& seen() const { return at[3]; }
    [[nodiscard]] optics::ChiefRays chief_rays() const { return {lens, kWavelengths_nm[3], optics::Rims::follow}; }
};

Band band_of(const optics::Lens& lens) {
    Band band{.lens = lens, .at = {}};
    for (const double nm : Band::kWavelengths_nm) {
        band.at.push_back(optics::at_wavelength<double>(lens, nm));
    }
    return band;
}

Band band_of(const Setting& setting) {
    return band_of(optics::with_f_number(formats::load_lens(setting.lens), setting.f_number));
}

/// The mean of f over the unit cube, from 16 independently scrambled Sobol sequences, whose scatter tells its error.
template <class F>
Measured estimate(int samples_each, const F& f) {
    constexpr int kSequences = 16;
    std::array<double, kSequences> means{};
    for (std::size_t sequence = 0; sequence < kSequences; ++sequence) {
        const render::PixelSampler sampler(1, static_cast<std::uint32_t>(sequence));
        for (int i = 0; i < samples_each; ++i) {
            means[sequence] += f(sampler.point(static_cast<std::uint32_t>(i))) / samples_each;
        }
    }
    return mean_of(means);
}

/// What of a ray's light leaves the lens.
double passing(const optics::TraceLens<double>& lens, const Ray<double>& ray) {
    const optics::TracedRay<double> traced = optics::trace(lens, ray);
    return traced.status == optics::RayStatus::ok ? traced.transmittance : 0.0;
}

Vec3d direction_at(double field_angle) {
    return {0.0, std::sin(field_angle), std::cos(field_angle)};
}

/// What a sample stands for, of light that is even across its beam.
double passing(const optics::TraceLens<double>& lens, const pupil::EntranceSample& sample) {
    return sample.pdf > 0.0 ? passing(lens, sample.ray) / sample.pdf : 0.0;
}

/// ∫ τ dA over the beam of a direction, mm², or over that of a near point per its intensity, sr: by the outline that
/// the rims leave of it, six Gauss-Legendre nodes along each of its azimuths.
double flux_by_quadrature(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle) {
    double flux = 0.0;
    for (const optics::RegionNode& node : optics::region_quadrature(analysis::beam_outline(lens, bundle), 6)) {
        const double distance = bundle.distance();
        const double r2 = node.point.x * node.point.x + node.point.y * node.point.y;
        const double per_mm2 = bundle.is_near() ? distance / std::pow(distance * distance + r2, 1.5) : 1.0;
        flux += node.weight * per_mm2 * passing(lens, bundle.ray(node.point));
    }
    return flux;
}

/// Of the beam that passes the rims, mm².
double outline_area(const Band& band, const pupil::EntranceBeam& beam) {
    const optics::Region region = [&](Vec2d offset) {
        return optics::rim_margin(band.seen(), beam.ray(offset), optics::Direction::forward);
    };
    return optics::region_outline(region, {.start = {}, .reach = beam.radius}).area;
}

// Flux through the lens from a direction: regions against the outline's quadrature, which is exact to 1e-6 or so, to
// five standard errors of at most 0.02 %; on the axis, where a stop or a rim is about to cut, and where the last light
// enters. Between nodes of field angle and wavelength. The widest fisheye at 100°, too: its light comes from behind.
TEST(EntranceMap, SendsTheBeamsFlux) {
    std::vector<Setting> settings = kSettings;
    settings.push_back({"fisheye-220", 2.8});
    for (const auto& [name, f_number] : settings) {
        const Band band = band_of(Setting{name, f_number});
        const optics::ChiefRays chief_rays = band.chief_rays();
        const pupil::EntranceMap map(band.at, true);
        const double end = map.largest_angle();
        std::vector<double> angles = {0.0, 0.371 * end, 0.737 * end, 0.877 * end, 0.983 * end};
        if (name == "fisheye-220") {
            angles.push_back(radians(100.0));
        }
        for (const double angle : angles) {
            const pupil::EntranceBeam beam = map.beam(direction_at(angle));
            const Measured flux = estimate(1 << 13, [&](const auto& xi) {
                return passing(band.seen(), map.sample(beam, Band::kPosition, xi[0], xi[1]));
            });
            const double expected = flux_by_quadrature(band.seen(), optics::field_bundle(chief_rays, angle).value());
            const std::string where = name + " f/" + std::to_string(f_number) + " at " + std::to_string(angle);
            EXPECT_GT(expected, 0.0) << where;
            EXPECT_LT(flux.error, 2e-4 * expected) << where;
            EXPECT_NEAR(flux.value, expected, 5.0 * flux.error + 1e-6 * expected) << where;
        }
    }
}

// The whole front element sends the same flux, but of a hundred of its rays a fisheye passes one or less: to five
// standard errors of the difference, below 0.1 % where it passes 5 %.
TEST(EntranceMap, SendsWhatTheWholeElementSends) {
    for (const Setting& setting : kSettings) {
        const Band band = band_of(setting);
        const pupil::EntranceMap map(band.at, true);
        const pupil::EntranceMap whole = pupil::EntranceMap::whole_element(band.seen());
        for (const double fraction : {0.21, 0.83}) {
            const Vec3d direction = direction_at(fraction * map.largest_angle());
            const auto flux_of = [&](const pupil::EntranceMap& of, int samples_each) {
                const pupil::EntranceBeam beam = of.beam(direction);
                return estimate(samples_each, [&](const auto& xi) {
                    return passing(band.seen(), of.sample(beam, Band::kPosition, xi[0], xi[1]));
                });
            };
            const Measured flux = flux_of(map, 1 << 13);
            const Measured baseline = flux_of(whole, 1 << 15);
            EXPECT_NEAR(flux.value, baseline.value, 5.0 * std::hypot(flux.error, baseline.error)) << setting.lens;
            if (map.region_area(map.beam(direction), Band::kPosition) >
                0.05 * kPi * std::pow(whole.beam(direction).radius, 2)) {
                EXPECT_LT(baseline.error, 1e-3 * baseline.value) << setting.lens << " at " << fraction;
            }
        }
    }
}

/// Of the rays started, how many pass: over the directions at field angles from `from` to `to`, evenly in solid angle,
/// and over the band.
double passage(const Band& band, const pupil::EntranceMap& map, double from, double to) {
    int started = 0;
    int passed = 0;
    const render::PixelSampler sampler(2, 0);
    for (std::uint32_t i = 0; i < 1U << 14U; ++i) {
        const std::array<double, 5> xi = sampler.point(i);
        const double cosine = std::cos(from) + xi[2] * (std::cos(to) - std::cos(from));
        const double sine = std::sqrt(1.0 - cosine * cosine);
        const double azimuth = 2.0 * kPi * xi[3];
        const auto lens = static_cast<std::size_t>(xi[4] * static_cast<double>(band.at.size()));
        const pupil::EntranceBeam beam = map.beam({sine * std::sin(azimuth), sine * std::cos(azimuth), cosine});
        const double position = static_cast<double>(lens) / static_cast<double>(band.at.size() - 1);
        const pupil::EntranceSample sample = map.sample(beam, position, xi[0], xi[1]);
        started += sample.pdf > 0.0 ? 1 : 0;
        passed += passing(band.at[lens], sample) > 0.0 ? 1 : 0;
    }
    return static_cast<double>(passed) / started;
}

// Nearly every ray that is started passes: 97 % over the field by solid angle, 90 % in each of eight rings of it.
TEST(EntranceMap, StartsFewRaysInVain) {
    fmt::print("{:28}{:>10}{:>10}{:>10}{:>10}\n", "", "field/°", "passage", "least", "whole");
    for (const Setting& setting : kSettings) {
        const Band band = band_of(setting);
        const pupil::EntranceMap map(band.at, true);
        const double end = map.largest_angle();
        double least = 1.0;
        for (int ring = 0; ring < 8; ++ring) {
            least = std::min(least, passage(band, map, end * ring / 8, end * (ring + 1) / 8));
        }
        const double over_field = passage(band, map, 0.0, end);
        const double whole = passage(band, pupil::EntranceMap::whole_element(band.seen()), 0.0, end);
        fmt::print("{:28}{:10.2f}{:10.4f}{:10.4f}{:10.4f}\n", fmt::format("{} f/{}", setting.lens, setting.f_number),
                   degrees(end), over_field, least, whole);
        EXPECT_GE(over_field, 0.97) << setting.lens << " f/" << setting.f_number;
        EXPECT_GE(least, 0.90) << setting.lens << " f/" << setting.f_number;
    }
}

// Etendue: ∫ (beam's cross-section) dΩ over the directions of the scene is ∫ (projected solid angle) dA over the
// sensor's plane, in air on both sides, through every aberration and rim. Both integrals by samples of four numbers, to
// five standard errors of their difference, which is below 0.05 %. The sensor is as large as the last light needs.
TEST(EntranceMap, EtendueIsTheSensors) {
    struct Case {
        Setting setting;
        double sensor_radius;
    };
    for (const Case& given : {Case{{"tessar", 2.8}, 75.0}, Case{{"double-gauss-tronnier", 2.0}, 40.0},
                              Case{{"muller-fisheye", 4.0}, 14.0}}) {
        const Setting& setting = given.setting;
        const double sensor_radius = given.sensor_radius;
        const Band band = band_of(setting);
        const optics::TraceLens<double>& lens = band.seen();
        const pupil::EntranceMap entrance(band.at, true);
        const double end = entrance.largest_angle();
        const Measured entering = estimate(1 << 14, [&](const auto& xi) {
            const double solid_angle = 2.0 * kPi * (1.0 - std::cos(end));
            const pupil::EntranceBeam beam =
                entrance.beam(direction_at(std::acos(1.0 - xi[2] * (1.0 - std::cos(end)))));
            const pupil::EntranceSample sample = entrance.sample(beam, Band::kPosition, xi[0], xi[1]);
            const bool passes = sample.pdf > 0.0 && optics::trace(lens, sample.ray).status == optics::RayStatus::ok;
            return passes ? solid_angle / sample.pdf : 0.0;
        });
        const pupil::PupilMap pupil(band.at, true, sensor_radius);
        EXPECT_EQ(pupil.region_area({0.0, 0.99 * sensor_radius}, Band::kPosition), 0.0) << "the sensor holds all light";
        const Measured arriving = estimate(1 << 14, [&](const auto& xi) {
            const Vec3d from{0.0, sensor_radius * std::sqrt(xi[2]), lens.image_z};
            const pupil::PupilSample drawn = pupil.sample({from.x, from.y}, Band::kPosition, xi[0], xi[1]);
            const Vec3d to_pupil = Vec3d{drawn.point.x, drawn.point.y, pupil.plane_z()} - from;
            const double distance2 = dot(to_pupil, to_pupil);
            const Ray<double> ray{from, (1.0 / std::sqrt(distance2)) * to_pupil};
            const bool passes =
                drawn.pdf > 0.0 && optics::trace<optics::Direction::reverse>(lens, ray).status == optics::RayStatus::ok;
            const double cosine2 = ray.direction.z * ray.direction.z;
            return passes ? kPi * sensor_radius * sensor_radius * cosine2 / (distance2 * drawn.pdf) : 0.0;
        });
        const double sigma = std::hypot(entering.error, arriving.error);
        EXPECT_LT(sigma, 5e-4 * arriving.value) << setting.lens;
        EXPECT_NEAR(entering.value, arriving.value, 5.0 * sigma) << setting.lens;
    }
}

// A near point's light, per its intensity, against quadrature over the cone's outline.
TEST(EntranceMap, SendsANearPointsFlux) {
    struct Case {
        Setting setting;
        double object_distance;
        double angle;
    };
    for (const Case& given : {Case{{"tessar", 2.8}, 300.0, 0.3}, Case{{"double-gauss-tronnier", 2.0}, 60.0, 0.2},
                              Case{{"muller-fisheye", 4.0}, 80.0, 1.2}}) {
        const Setting& setting = given.setting;
        const Band band = band_of(setting);
        const optics::ChiefRays chief_rays = band.chief_rays();
        const optics::FieldBundle bundle = optics::field_bundle(chief_rays, given.angle, given.object_distance).value();
        ASSERT_TRUE(bundle.is_near());
        const double expected = flux_by_quadrature(band.seen(), bundle);
        EXPECT_GT(expected, 0.0);
        const pupil::EntranceBeam beam =
            pupil::beam_from(pupil::front_sphere(band.seen()), bundle.object_point()).value();
        const pupil::EntranceMap map(band.at, true, beam.distance);
        const Measured flux = estimate(1 << 13, [&](const auto& xi) {
            const pupil::EntranceSample sample = map.sample(beam, Band::kPosition, xi[0], xi[1]);
            return beam.solid_angle_per_mm2(sample.offset) * passing(band.seen(), sample);
        });
        EXPECT_LT(flux.error, 3e-4 * expected) << setting.lens;
        EXPECT_NEAR(flux.value, expected, 5.0 * flux.error + 1e-6 * expected) << setting.lens;
    }
}

// A lens that is not round: its front group is tilted and decentred. On every side the map over azimuth sends what the
// whole element sends, to five standard errors of the difference, of 0.1 % at most, and nine in ten rays pass.
TEST(EntranceMap, KnowsLensesThatAreNotRound) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "tilted.toml";
    write_file(file, read_file(formats::find_lens_file("double-gauss-tronnier")) +
                         "[[groups]]\nsurfaces = [1, 5]\ntilt_deg = [0.3, 0.4, 0]\ndecentre_mm = [0.2, 0]\n");
    const Band band = band_of(optics::with_f_number(formats::load_lens(file.string()), 2.0));
    ASSERT_FALSE(band.lens.is_rotationally_symmetric);
    const pupil::EntranceMap map(band.at, false);
    const pupil::EntranceMap whole = pupil::EntranceMap::whole_element(band.seen());
    for (const double azimuth : {0.0, 1.0, 2.5, 4.0, 5.9}) {
        const double angle = 0.3 * map.largest_angle();
        const Vec3d direction{std::sin(angle) * std::sin(azimuth), std::sin(angle) * std::cos(azimuth),
                              std::cos(angle)};
        const pupil::EntranceBeam beam = map.beam(direction);
        const auto flux_of = [&](int samples_each, const pupil::EntranceMap& from) {
            return estimate(samples_each, [&](const auto& xi) {
                return passing(band.seen(), from.sample(beam, Band::kPosition, xi[0], xi[1]));
            });
        };
        const Measured baseline = flux_of(1 << 14, whole);
        const Measured by_map = flux_of(1 << 13, map);
        EXPECT_LT(baseline.error, 1e-3 * baseline.value);
        EXPECT_NEAR(by_map.value, baseline.value, 5.0 * std::hypot(baseline.error, by_map.error)) << azimuth;
        EXPECT_LT(map.region_area(beam, Band::kPosition), outline_area(band, beam) / 0.9) << azimuth;
    }
}

// A region that is wrong costs noise and no light: of the f/8 lens's regions, the lens at f/2 gets its whole flux.
TEST(EntranceMap, WrongRegionsLoseNoLight) {
    const Band wide = band_of(Setting{"double-gauss-tronnier", 2.0});
    const pupil::EntranceMap narrow(band_of(Setting{"double-gauss-tronnier", 8.0}).at, true, kInfinity,
                                    {.defensive_fraction = 0.5});
    const optics::ChiefRays chief_rays = wide.chief_rays();
    for (const double angle : {0.0, 0.2, 0.4}) {
        const pupil::EntranceBeam beam = narrow.beam(direction_at(angle));
        const Measured flux = estimate(1 << 13, [&](const auto& xi) {
            return passing(wide.seen(), narrow.sample(beam, Band::kPosition, xi[0], xi[1]));
        });
        const double expected = flux_by_quadrature(wide.seen(), optics::field_bundle(chief_rays, angle).value());
        EXPECT_LT(flux.error, 2e-3 * expected);
        EXPECT_NEAR(flux.value, expected, 5.0 * flux.error) << angle;
        EXPECT_LT(narrow.region_area(beam, Band::kPosition), 0.7 * expected) << "too small for it";
    }
}

}  // namespace lensproof::entrance_map_test
