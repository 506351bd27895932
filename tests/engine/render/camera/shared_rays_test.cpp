#include "engine/render/camera/shared_rays.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
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

/// In what T the others' rays are traced, and the heroes'; where that is another, it judges at borders.
template <class Others, class Heroes>
struct Shared {
    const SharingCamera<Others>* others;
    const SharingCamera<Heroes>* heroes;
    bool is_judged = !std::is_same_v<Others, Heroes>;
    std::uint32_t paths = 4000;
};
template <class T>
Shared<T, T> all_of(const SharingCamera<T>& camera) {
    return {&camera, &camera};
}

/// `use(paths)` with each buffer that was filled and weighed.
template <class Others, class Heroes, class Use>
void for_each_buffer(const Shared<Others, Heroes>& traced, PathCarry carry, int capacity, SimdLevel level,
                     const Use& use) {
    const SharingCamera<Heroes>& camera = *traced.heroes;
    BasicLensPaths<Heroes> producer({.sensor = camera.sensor, .seed = 4}, camera.lens, camera.slices, level);
    BasicSharedRays<Others> shared(camera.grid, traced.others->lens, camera.slices, camera.sensor, true, carry, level,
                                   traced.is_judged ? &camera.in_double : nullptr);
    CameraPathBuffer paths(capacity);
    const auto width = static_cast<std::uint32_t>(camera.sensor.width);
    const std::uint32_t pixels = std::min(width, traced.paths);
    producer.start({.first_pixel = width + (width - pixels) / 2, .pixels = pixels, .samples = traced.paths / pixels});
    while (producer.fill(paths)) {
        shared.weigh(paths);
        use(paths);
    }
}

template <class Others, class Heroes>
Weighed weighed(const Shared<Others, Heroes>& traced, PathCarry carry, int capacity, SimdLevel level) {
    Weighed found;
    for_each_buffer(traced, carry, capacity, level, [&](const CameraPathBuffer& paths) {
        found.weights.insert(found.weights.end(), paths.weights.begin(), paths.weights.end());
        for (const PathPdf& pdf : paths.pdf) {
            found.shared_pdf.push_back(pdf.shared);
            found.hero_pdf.push_back(pdf.hero);
        }
    });
    return found;
}

template <class Others, class Heroes>
void expect_the_same_bits(const Shared<Others, Heroes>& traced, const std::string& name) {
    for (const PathCarry carry : {PathCarry::wavelengths, PathCarry::wavelengths_and_pdfs}) {
        const Weighed expected = weighed(traced, carry, 4096, SimdLevel::scalar);
        EXPECT_GT(expected.weights.size(), 1000U) << name;
        EXPECT_EQ(expected.hero_pdf.size(), carry == PathCarry::wavelengths ? 0 : expected.weights.size()) << name;
        for (const SimdLevel level : available_simd_levels()) {
            for (const int capacity : {1, 5, 16, 100, 4096}) {
                EXPECT_TRUE(weighed(traced, carry, capacity, level) == expected)
                    << fmt::format("{}, {}, capacity {}", name, simd_name(level), capacity);
            }
        }
    }
}

// What a path counts does not depend on the packets' width or on its neighbours in the buffer; nor where a lens that is
// not known to be round has no tables, or where its rays are traced in float, or those of the others alone.
TEST(SharedRays, HaveTheSameBitsAtEveryWidthAndCapacity) {
    const SharingCamera<double> tessar("tessar", 60.0, 1.0);
    const SharingCamera<float> tessar_in_float("tessar", 60.0, 1.0);
    const SharingCamera<float> small_pixels("tessar", 60.0, 0.02);
    const SharingCamera<double> small_pixels_of_heroes("tessar", 60.0, 0.02);
    expect_the_same_bits(all_of(tessar), "tessar");
    expect_the_same_bits(all_of(tessar_in_float), "tessar in float");
    expect_the_same_bits(Shared<float, double>{&small_pixels, &small_pixels_of_heroes}, "tessar's heroes in double");
    expect_the_same_bits(all_of(SharingCamera<double>("muller-fisheye", 16.0, 0.03)), "muller-fisheye");
    expect_the_same_bits(all_of(SharingCamera<double>("tessar", 30.0, 1.0, false)), "turned tessar");
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
    for_each_buffer(all_of(camera), carry, 4096, available_simd_levels().back(), [&](const CameraPathBuffer& paths) {
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

/// What float makes of paths' weights that a double gives them.
struct Beside {
    int elsewhere = 0;   // paths of which another wavelength arrives in the pixel
    double worst = 0.0;  // of the others' weights, relative
    double light = 0.0;  // of all, relative
};

Beside beside(const Weighed& expected, const Weighed& found) {
    Beside beside;
    double light = 0.0;
    double off = 0.0;
    for (std::size_t i = 0; i < expected.weights.size(); ++i) {
        double worst = 0.0;
        bool is_elsewhere = false;
        for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
            const double weight = expected.weights[i][m];
            const double difference = found.weights[i][m] - weight;
            light += weight;
            off += difference;
            is_elsewhere = is_elsewhere || (found.weights[i][m] > 0.0F) != (weight > 0.0);
            worst = std::max(worst, weight > 0.0 ? std::abs(difference / weight) : 0.0);
        }
        beside.elsewhere += is_elsewhere ? 1 : 0;
        beside.worst = std::max(beside.worst, is_elsewhere ? 0.0 : worst);
    }
    beside.light = off / light;
    return beside;
}

// Where rays end, the double lens says: none of those that float traces counts in another pixel, though float by itself
// mistakes some of these, of 1 µm. How much of them arrives float says: what each surface lets through to two ulps of
// 1.2e-7; and of all together what indices that are rounded by 6e-8 make of that, 1e-8 a surface.
TEST(SharedRays, OfFloatEndWhereDoubleSaysSo) {
    for (const auto& [name, half_diagonal_mm] : {std::pair{"tessar", 60.0}, {"double-gauss-tronnier", 21.0}}) {
        constexpr double kPitch = 0.001;
        const SharingCamera<double> in_double(name, half_diagonal_mm, kPitch);
        const SharingCamera<float> in_float(name, half_diagonal_mm, kPitch);
        const auto of = [](const auto& traced) {
            return weighed(traced, PathCarry::wavelengths, 4096, available_simd_levels().back());
        };
        constexpr std::uint32_t kPaths = 30000;
        const Weighed expected = of(Shared<double, double>{&in_double, &in_double, false, kPaths});
        const Weighed found = of(Shared<float, double>{&in_float, &in_double, true, kPaths});
        const Weighed alone = of(Shared<float, double>{&in_float, &in_double, false, kPaths});
        ASSERT_GT(expected.weights.size(), 20000U);
        ASSERT_EQ(found.weights.size(), expected.weights.size());
        const Beside judged = beside(expected, found);
        fmt::print("{}: {} paths, {} elsewhere, {} alone; weights off by {:.2g}, light by {:.2g}\n", name,
                   expected.weights.size(), judged.elsewhere, beside(expected, alone).elsewhere, judged.worst,
                   judged.light);
        const auto surfaces = static_cast<double>(in_double.lens.at(0).surfaces.size());
        EXPECT_EQ(judged.elsewhere, 0) << name;
        EXPECT_GT(beside(expected, alone).elsewhere, 3) << name;
        EXPECT_GT(judged.worst, 0.0) << name;
        EXPECT_LT(judged.worst, 2.4e-7 * surfaces) << name;
        EXPECT_LT(std::abs(judged.light), 1e-8 * surfaces) << name;
    }
}

}  // namespace lensproof::render::shared_rays_test
