// Ghosts drawn by their meshes, against closed forms, shifted grids, and rays at random.
#include "engine/analysis/ghost_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "engine/analysis/ghost_orders.h"
#include "engine/analysis/ghosts.h"
#include "engine/base/angle.h"
#include "engine/formats/prescription/load_lens.h"

namespace lensproof::analysis::ghost_mesh_test {

constexpr double kWavelength = 587.5618;

GhostScene scene_of(const optics::Lens& lens, double source_deg, double image_radius,
                    double wavelength_nm = kWavelength) {
    return ghost_scene(lens,
                       {.reference_wavelength_nm = kWavelength,
                        .wavelengths_nm = {},
                        .source_angle = source_deg * kDegree,
                        .mirrors = {},
                        .image_radius = image_radius,
                        .sampling = {}},
                       wavelength_nm);
}

MeshedGhost draw(const GhostScene& scene, const optics::GhostPath& path, LightRaster& raster) {
    return mesh_ghost(scene, path, ghost_region(scene, path), {.place_error = 0.5 * raster.pitch_mm()},
                      [&](const std::array<Vec2d, 3>& corners, double energy) { raster.add(corners, energy); });
}

// A plate sends its ghost straight on, as an even disc of the stop's width with R² T² of the light: in every pixel
// that lies within it the same irradiance, to rounding. Its chords leave no more of the disc's light than they say.
TEST(GhostMesh, PlateMakesAnEvenDisc) {
    optics::Prescription prescription;
    prescription.surfaces = {
        {.thickness_mm = 3.0, .semi_diameter_mm = 20.0, .medium = {.n_d = 1.7}},
        {.thickness_mm = 5.0, .semi_diameter_mm = 20.0},
        {.thickness_mm = 50.0, .semi_diameter_mm = 8.0, .is_stop = true},
    };
    const optics::Lens lens = optics::make_lens(prescription, {});
    const GhostScene scene = scene_of(lens, 0.0, 15.0);
    LightRaster raster(20, 20, 1.0);
    const MeshedGhost ghost = draw(scene, {1, 0}, raster);
    const double r = std::pow(0.7 / 2.7, 2);
    const double expected = (1.0 - r) * (1.0 - r) * r * r;
    EXPECT_NEAR(ghost.energy, expected, ghost.energy_bound);
    EXPECT_LT(ghost.energy_bound, 2e-3 * expected);
    const std::vector<double> pixels = raster.pixels();
    EXPECT_NEAR(std::accumulate(pixels.begin(), pixels.end(), 0.0), ghost.energy, 1e-12 * ghost.energy);
    for (std::size_t v = 0; v < 20; ++v) {
        for (std::size_t u = 0; u < 20; ++u) {
            const double corner = std::hypot(std::abs(u - 9.5) + 0.5, std::abs(v - 9.5) + 0.5);
            const double pixel = pixels[v * 20 + u];
            if (corner < 7.9) {
                EXPECT_NEAR(pixel, expected / (std::numbers::pi * 64.0), 1e-9 * expected) << u << ", " << v;
            } else if (std::hypot(std::abs(u - 9.5) - 0.5, std::abs(v - 9.5) - 0.5) > 8.0) {
                EXPECT_NEAR(pixel, 0.0, 1e-12 * expected) << u << ", " << v;
            }
        }
    }
}

// Energies of all ghosts, against grids shifted at random: within four of their standard errors and the mesh's bound.
// The region is found in yellow; the mesh of blue light grows out of it.
TEST(GhostMesh, EnergiesAreThoseOfShiftedGrids) {
    for (const auto& [name, source_deg] : {std::pair{"tessar", 12.0}, {"double-gauss-tronnier", 10.0}}) {
        const optics::Lens lens = formats::load_lens(name);
        const GhostScene scene = scene_of(lens, source_deg, 22.0);
        const GhostScene blue = scene_of(lens, source_deg, 22.0, 430.0);
        for (const optics::GhostPath& path : ghosts_of_two(scene)) {
            SCOPED_TRACE(std::string(name) + " " + testing::PrintToString(path));
            const GhostRegion region = ghost_region(scene, path);
            const MeshedGhost ghost = mesh_ghost(blue, path, region, {.place_error = 0.1}, [](const auto&, double) {});
            const GhostLight light = measure_ghost(blue, path, ghost_region(blue, path), {.rays = 6000});
            EXPECT_NEAR(ghost.energy, light.energy, 4.0 * light.standard_error + ghost.energy_bound);
            EXPECT_LE(ghost.energy_bound, 3e-3 * ghost.energy);
        }
    }
}

// Pictures, caustics included, against rays at random over the region: χ² over the coarse pixels in which enough of
// them land to know their error.
TEST(GhostMesh, PicturesAreThoseOfRaysAtRandom) {
    const optics::Lens lens = formats::load_lens("double-gauss-tronnier");
    constexpr std::size_t kAcross = 24;
    constexpr double kPitch = 1.25;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    int compared = 0;
    for (const double source_deg : {10.0, 20.0}) {
        LightRaster raster(kAcross, kAcross, kPitch);
        const GhostScene scene = scene_of(lens, source_deg, raster.half_diagonal_mm());
        for (const optics::GhostPath& path : {optics::GhostPath{2, 0}, {10, 6}, {4, 2}, {8, 6}, {10, 8}}) {
            SCOPED_TRACE(std::to_string(source_deg) + " " + testing::PrintToString(path));
            raster.clear();
            const GhostRegion region = ghost_region(scene, path);
            // As fine as a picture of 1000 pixels: then no error of its own counts.
            const MeshedGhost ghost =
                mesh_ghost(scene, path, region, {.energy_error = 1e-3, .place_error = 0.015},
                           [&](const std::array<Vec2d, 3>& corners, double energy) { raster.add(corners, energy); });
            if (!(ghost.energy > 1e-6)) {
                continue;
            }
            constexpr int kRays = 60'000;
            std::vector<double> sums(kAcross * kAcross);
            std::vector<double> squares(sums.size());
            std::vector<int> counts(sums.size());
            for (int i = 0; i < kRays; ++i) {
                const auto& cell = region.cells[static_cast<std::size_t>(unit(random) * region.cells.size())];
                const double x = cell.x + unit(random);
                const Vec2d offset = region.corner + region.cell * Vec2d{x, cell.y + unit(random)};
                const auto landed = landing(scene, path, offset);
                const Vec2d at = landed ? landed->point : Vec2d{1e9, 1e9};
                const double u = 0.5 * kAcross - at.x / kPitch;
                const double v = 0.5 * kAcross + at.y / kPitch;
                if (u >= 0.0 && v >= 0.0 && u < kAcross && v < kAcross) {
                    const auto pixel = static_cast<std::size_t>(v) * kAcross + static_cast<std::size_t>(u);
                    const double energy = landed->transmittance * region.area() / scene.pupil_area / kRays;
                    sums[pixel] += energy;
                    squares[pixel] += energy * energy;
                    ++counts[pixel];
                }
            }
            const std::vector<double> pixels = raster.pixels();
            double chi_squared = 0.0;
            int known = 0;
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                if (counts[i] >= 25) {
                    const double variance = squares[i] - sums[i] * sums[i] / kRays;
                    chi_squared += (pixels[i] - sums[i]) * (pixels[i] - sums[i]) / variance;
                    ++known;
                }
            }
            EXPECT_GT(known, 0);
            EXPECT_LT(chi_squared, known + 4.0 * std::sqrt(2.0 * known));
            ++compared;
        }
    }
    EXPECT_GE(compared, 6);
}

}  // namespace lensproof::analysis::ghost_mesh_test
