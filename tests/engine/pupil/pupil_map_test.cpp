// Pupil maps: pdfs that agree with themselves, discs that miss no path, bytes and back.
#include "engine/pupil/pupil_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "tests/test_folder.h"

namespace lensproof::pupil::pupil_map_test {

std::vector<optics::TraceLens<double>> band_of(const optics::Lens& lens, const std::vector<double>& wavelengths_nm) {
    std::vector<optics::TraceLens<double>> band;
    band.reserve(wavelengths_nm.size());
    for (const double nm : wavelengths_nm) {
        band.push_back(optics::at_wavelength<double>(lens, nm));
    }
    return band;
}

/// The Tessar with its rear doublet tilted, at f/8.
optics::Lens tilted_tessar() {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "tilted.toml";
    write_file(file, read_file(formats::find_lens_file("tessar")) +
                         "\n[[groups]]\nsurfaces = [7, 8]\ntilt_deg = [1.0, 0, 0]\n");
    return optics::with_f_number(formats::load_lens(file.string()), 8.0);
}

const PupilMap& tessar_map() {
    static const PupilMap map(band_of(optics::with_f_number(formats::load_lens("tessar"), 4.0), {450.0, 550.0, 650.0}),
                              true, 45.0);
    return map;
}

const PupilMap& tilted_map() {
    static const PupilMap map(band_of(tilted_tessar(), {550.0}), false, 45.0);
    return map;
}

/// Somewhere on the sensor and in the band, out to where the Tessar is dark.
struct Place {
    Vec2d at;
    double band_position;
};

std::vector<Place> places() {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<Place> all = {{{0.0, 0.0}, 0.0}, {{0.0, 45.0}, 1.0}};
    for (int i = 0; i < 40; ++i) {
        all.push_back({{31.0 * uniform(random), 31.0 * uniform(random)}, 0.5 + 0.5 * uniform(random)});
    }
    return all;
}

/// The text of a lens that ships, with other words in the place of these.
std::string changed(const std::string& lens, const std::vector<std::pair<std::string, std::string>>& words) {
    std::string text = read_file(formats::find_lens_file(lens));
    for (const auto& [old, now] : words) {
        text.replace(text.find(old), old.size(), now);
    }
    return text;
}

// A kilometre behind its stop a double Gauss has regions that change from each node to the next, however near: it was
// given 4097 nodes a wavelength, and took a quarter of a minute before the first sample.
TEST(PupilMap, ALensThatWantsAllStepsHalvedIsGivenUp) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "mutated.toml";
    write_file(file, changed("double-gauss-tronnier", {{"radius_mm =  29.475, thickness_mm =  3.76",  //
                                                        "radius_mm = -29.475, thickness_mm =  0.1"},
                                                       {"stop = true,         thickness_mm =  4.5",
                                                        "stop = true,         thickness_mm =  1e6"}}));
    const PupilMap map(band_of(optics::with_f_number(formats::load_lens(file.string()), 8.0), {550.0}), true, 22.5);
    EXPECT_LE(map.size(), 129U);
}

// The pdf that a point is drawn with is that which the map states for it. Points at an edge of the region may be
// rounded across it; v keeps them 1e-6 of its height inside.
TEST(PupilMap, SamplesHaveTheStatedPdf) {
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (const PupilMap* map : {&tessar_map(), &tilted_map()}) {
        for (const auto& [at, position] : places()) {
            for (int i = 0; i < 200; ++i) {
                const double u = i % 4 == 0 ? 0.003 * uniform(random) : uniform(random);
                const PupilSample sample = map->sample(at, position, u, 1e-6 + (1.0 - 2e-6) * uniform(random));
                if (sample.pdf > 0.0) {
                    EXPECT_NEAR(map->pdf(at, position, sample.point) / sample.pdf, 1.0, 1e-12);
                }
            }
        }
    }
}

// ∫ pdf = 1 where there is light: the region's fraction, from its area, and the disc's. Drawn evenly over the disc,
// the mean of the pdf times the disc's area has the standard error that its own scatter gives; four of them.
TEST(PupilMap, PdfsIntegrateToOne) {
    constexpr int kPoints = 200000;
    for (const PupilMap* map : {&tessar_map(), &tilted_map()}) {
        for (const auto& [at, position] : places()) {
            if (!(map->region_area(at, position) > 0.0)) {
                continue;
            }
            std::mt19937_64 random(9);
            std::uniform_real_distribution<double> uniform(0.0, 1.0);
            double sum = 0.0;
            double sum_of_squares = 0.0;
            for (int i = 0; i < kPoints; ++i) {
                const double u = uniform(random);
                const Vec2d point = map->disc().warped(u, uniform(random));
                const double value = map->pdf(at, position, point) * map->disc().area();
                sum += value;
                sum_of_squares += value * value;
            }
            const double mean = sum / kPoints;
            const double error = std::sqrt((sum_of_squares / kPoints - mean * mean) / kPoints);
            EXPECT_NEAR(mean, 1.0, 4.0 * error + 1e-9) << at.x << ", " << at.y;
        }
    }
}

// Every line from the sensor's disc to a point of the rear surface crosses the disc before it: rear surfaces that bulge
// towards the sensor, away from it, that are tilted, and sensors wider and narrower than they. A thousand lines each,
// half of them from the sensor's rim to the surface's.
TEST(RearDisc, HoldsEveryPath) {
    std::mt19937_64 random(13);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (const optics::Lens& lens :
         {formats::load_lens("tessar"), formats::load_lens("wide-nakamura"), formats::load_lens("muller-fisheye"),
          formats::load_lens("canon-ef-s-24"), tilted_tessar()}) {
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, 550.0);
        const optics::LensSurface& rear = lens.surfaces.back();
        for (const double sensor_radius : {0.3 * rear.semi_diameter, 3.0 * rear.semi_diameter}) {
            const RearDisc disc = rear_disc(traced, sensor_radius);
            EXPECT_LT(disc.plane_z, lens.image_z);
            for (int i = 0; i < 1000; ++i) {
                const auto on_disc = [&](double radius) {
                    const double r = radius * (i % 2 == 0 ? 1.0 : std::sqrt(uniform(random)));
                    const double azimuth = 2.0 * std::numbers::pi * uniform(random);
                    return Vec2d{r * std::cos(azimuth), r * std::sin(azimuth)};
                };
                const Vec2d from = on_disc(sensor_radius);
                const Vec2d own = on_disc(rear.semi_diameter);
                optics::SurfaceShape<double> shape = rear.shape;
                shape.curvature = rear.curvature;
                const Vec3d on_surface{own.x, own.y, optics::sag(shape, own.x, own.y)};
                const Vec3d to =
                    Vec3d{rear.vertex.x, rear.vertex.y, rear.vertex_z} +
                    (on_surface.x * rear.axes[0] + (on_surface.y * rear.axes[1] + on_surface.z * rear.axes[2]));
                EXPECT_LE(to.z, disc.plane_z + 1e-12) << lens.id;
                const double fraction = (disc.plane_z - to.z) / (lens.image_z - to.z);
                const double radius = std::hypot(to.x + fraction * (from.x - to.x), to.y + fraction * (from.y - to.y));
                EXPECT_LE(radius, disc.radius * (1.0 + 1e-12)) << lens.id << ", sensor of " << sensor_radius;
            }
        }
    }
}

// A map and what its bytes become draw the same points, to the last bit.
TEST(PupilMap, ComesBackFromItsBytes) {
    const PupilMap whole =
        PupilMap::whole_element(optics::at_wavelength<double>(formats::load_lens("tessar"), 550.0), 45.0);
    for (const PupilMap* map : {&tessar_map(), &tilted_map(), &whole}) {
        const std::optional<PupilMap> again = PupilMap::deserialized(map->serialized());
        ASSERT_TRUE(again.has_value());
        EXPECT_EQ(again->serialized(), map->serialized());
        EXPECT_EQ(again->plane_z(), map->plane_z());
        for (const auto& [at, position] : places()) {
            for (const double u : {0.001, 0.3, 0.9}) {
                const PupilSample a = map->sample(at, position, u, 0.4);
                const PupilSample b = again->sample(at, position, u, 0.4);
                EXPECT_EQ(a.point, b.point);
                EXPECT_EQ(a.pdf, b.pdf);
            }
        }
    }
}

// Bytes that are cut short, that go on, that state sizes they do not have or hold what is no number are no map.
TEST(PupilMap, DamagedBytesAreNoMap) {
    const std::string bytes = tessar_map().serialized();
    for (std::size_t length = 0; length < bytes.size(); length += length < 2000 ? 1 : 997) {
        EXPECT_FALSE(PupilMap::deserialized(std::string_view(bytes).substr(0, length)).has_value()) << length;
    }
    EXPECT_FALSE(PupilMap::deserialized(bytes + std::string(8, '\0')).has_value());
    for (std::size_t at = 0; at + 8 <= bytes.size(); at += at < 1000 ? 8 : 8 * 101) {
        std::string damaged = bytes;
        std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(at), 8, '\xff');  // not a number
        EXPECT_FALSE(PupilMap::deserialized(damaged).has_value()) << at;
    }
}

}  // namespace lensproof::pupil::pupil_map_test
