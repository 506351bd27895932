#include "engine/render/camera/shared_rays.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/render/camera/lens_paths.h"

namespace lensproof::render::shared_rays_test {

/// A camera of eight wavelengths whose corners lie outside its image circle.
template <class T>
struct SharingCamera {
    SharingCamera(const std::string& name, double half_diagonal_mm, double pitch_mm, bool by_radius = true)
        : in_double(optics::at_wavelengths<double>(formats::load_lens(name), grid.strata.midpoints())),
          lens(optics::at_wavelengths<T>(formats::load_lens(name), grid.strata.midpoints())),
          pupil(in_double.at(), by_radius, half_diagonal_mm),
          slices(pupil, lens.wavelengths()),
          sensor{
              .width = static_cast<int>(1.6 * half_diagonal_mm / pitch_mm), .height = 3, .pixel_pitch_mm = pitch_mm} {}

    spectral::SpectralGrid grid = spectral::spectral_grid(420.0, 680.0, 8);
    optics::SpectralLens<double> in_double;
    optics::SpectralLens<T> lens;
    pupil::PupilMap pupil;
    pupil::PupilSlices slices;
    Sensor sensor;
};

/// Paths of the middle row with what they count.
struct Weighed {
    std::vector<std::array<float, spectral::kWavelengthsPerPath>> weights;
    std::vector<double> shared_pdf;
    std::vector<double> hero_pdf;
    friend bool operator==(const Weighed&, const Weighed&) = default;
};

/// `use(paths)` with each buffer that was filled and weighed.
template <class T, class Use>
void for_each_buffer(const SharingCamera<T>& camera, PathCarry carry, int capacity, SimdLevel level, const Use& use) {
    BasicLensPaths<T> producer({.sensor = camera.sensor, .seed = 4}, camera.lens, camera.slices, level);
    BasicSharedRays<T> shared(camera.grid, camera.lens, camera.slices, camera.sensor, true, carry, level);
    CameraPathBuffer paths(capacity);
    const auto width = static_cast<std::uint32_t>(camera.sensor.width);
    producer.start({.first_pixel = width, .pixels = width, .samples = 4000 / width});
    while (producer.fill(paths)) {
        shared.weigh(paths);
        use(paths);
    }
}

template <class T>
Weighed weighed(const SharingCamera<T>& camera, PathCarry carry, int capacity, SimdLevel level) {
    Weighed found;
    for_each_buffer(camera, carry, capacity, level, [&](const CameraPathBuffer& paths) {
        found.weights.insert(found.weights.end(), paths.weights.begin(), paths.weights.end());
        for (const PathPdf& pdf : paths.pdf) {
            found.shared_pdf.push_back(pdf.shared);
            found.hero_pdf.push_back(pdf.hero);
        }
    });
    return found;
}

template <class T>
void expect_the_same_bits(const SharingCamera<T>& camera, const std::string& name) {
    for (const PathCarry carry : {PathCarry::wavelengths, PathCarry::wavelengths_and_pdfs}) {
        const Weighed expected = weighed(camera, carry, 4096, SimdLevel::scalar);
        EXPECT_GT(expected.weights.size(), 1000U) << name;
        EXPECT_EQ(expected.hero_pdf.size(), carry == PathCarry::wavelengths ? 0 : expected.weights.size()) << name;
        for (const SimdLevel level : available_simd_levels()) {
            for (const int capacity : {1, 5, 16, 100, 4096}) {
                EXPECT_TRUE(weighed(camera, carry, capacity, level) == expected)
                    << fmt::format("{}, {}, capacity {}", name, simd_name(level), capacity);
            }
        }
    }
}

// What a path counts does not depend on the packets' width or on its neighbours in the buffer; nor where a lens that is
// not known to be round has no tables, or where its rays are traced in float.
TEST(SharedRays, HaveTheSameBitsAtEveryWidthAndCapacity) {
    expect_the_same_bits(SharingCamera<double>("tessar", 60.0, 1.0), "tessar");
    expect_the_same_bits(SharingCamera<float>("tessar", 60.0, 1.0), "tessar in float");
    expect_the_same_bits(SharingCamera<double>("muller-fisheye", 16.0, 0.03), "muller-fisheye");
    expect_the_same_bits(SharingCamera<double>("tessar", 30.0, 1.0, false), "turned tessar");
}

/// Of rays that are traced one by one and weighed by the map: the hero's, too.
FilmImportance one_by_one(const SharingCamera<double>& camera, const CameraPathBuffer& paths, std::size_t path) {
    const Ray<double> out = paths.ray(path);
    const spectral::PathWavelengths strata = camera.grid.path(paths.wavelength[path]);
    FilmImportance film;
    for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
        const optics::TracedRay<double> in = optics::trace<optics::Direction::forward>(
            camera.lens.at(strata.index[m]), {out.origin, -1.0 * out.direction});
        if (in.status != optics::RayStatus::ok) {
            continue;
        }
        const auto crossing = [&](double z) {
            const double along = (z - in.ray.origin.z) / in.ray.direction.z;
            return Vec2d{in.ray.origin.x + along * in.ray.direction.x, in.ray.origin.y + along * in.ray.direction.y};
        };
        const double film_z = camera.lens.at(0).image_z;
        const Vec2d at = crossing(film_z);
        const double distance = (film_z - camera.pupil.plane_z()) / in.ray.direction.z;
        film.at_px[m] = camera.sensor.pixel(at);
        film.transmittance[m] = in.transmittance;
        film.pdf[m] = camera.pupil.pdf(at, strata.index[m] / 7.0, crossing(camera.pupil.plane_z())) * distance *
                      distance / (in.ray.direction.z * in.ray.direction.z);
    }
    return film;
}

/// Those which arrive, by the hero's.
FilmImportance with_equal_pdfs(FilmImportance film) {
    for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
        film.pdf[m] = film.transmittance[m] > 0.0 ? film.pdf[0] : 0.0;
    }
    return film;
}

// By the balance heuristic, of pdfs that were looked up or, where nobody asks for them, of the hero's for all. The
// hero's ray lands where it came from, and its transmittance and pdf are the path's: nothing of it is traced again.
// A ray through the glass and back returns to 1e-12 of its place, so that pdfs agree to 1e-11 and weights to a float's
// digits; but where a border of a pixel, a region or a rim lies between the two.
void expect_each_ray_alone(const SharingCamera<double>& camera, const std::string& name, PathCarry carry) {
    int paths_seen = 0;
    int others = 0;
    int beside = 0;
    for_each_buffer(camera, carry, 4096, available_simd_levels().back(), [&](const CameraPathBuffer& paths) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(paths.size); ++i) {
            const FilmImportance film = one_by_one(camera, paths, i);
            PathPdf drawn;
            const auto expected = shared_weights(carry == PathCarry::wavelengths ? with_equal_pdfs(film) : film,
                                                 path_pixel(paths, i, camera.sensor, true), drawn);
            bool is_same =
                carry == PathCarry::wavelengths || (std::abs(paths.pdf[i].hero / drawn.hero - 1.0) < 1e-11 &&
                                                    std::abs(paths.pdf[i].shared / drawn.shared - 1.0) < 1e-11);
            for (std::size_t m = 0; m < expected.size(); ++m) {
                is_same = is_same && std::abs(paths.weights[i][m] - expected[m]) <= 1.2e-7F * expected[m];
                others += m > 0 && expected[m] > 0.0F ? 1 : 0;
            }
            ++paths_seen;
            beside += is_same ? 0 : 1;
        }
    });
    EXPECT_GT(paths_seen, 1000) << name;
    EXPECT_GT(others, 100) << name;
    EXPECT_LE(beside, paths_seen / 1000) << name;
}

TEST(SharedRays, CountWhatEachRayByItselfDoes) {
    for (const auto& [name, half_diagonal_mm, pitch_mm] :
         {std::tuple{"tessar", 60.0, 1.0}, {"tessar", 60.0, 0.05}, {"muller-fisheye", 16.0, 0.03}}) {
        const SharingCamera<double> camera(name, half_diagonal_mm, pitch_mm);
        expect_each_ray_alone(camera, name, PathCarry::wavelengths);
        expect_each_ray_alone(camera, name, PathCarry::wavelengths_and_pdfs);
    }
}

}  // namespace lensproof::render::shared_rays_test
