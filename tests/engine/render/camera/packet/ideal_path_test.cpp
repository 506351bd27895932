#include "engine/render/camera/packet/ideal_path.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "engine/render/camera/packet/path_kernels.h"

namespace lensproof::render::ideal_path_test {

IdealOpticsColumns random_optics(std::mt19937_64& random, int wavelengths) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    IdealOpticsColumns at;
    for (int i = 0; i < wavelengths; ++i) {
        at.to_pupil_z.push_back(-50.0 - unit(random));
        at.pupil_radius.push_back(i % 2 == 0 ? 10.0 * unit(random) : 0.0);
        at.pupil_area.push_back(unit(random));
        at.object_z.push_back(unit(random));
        at.h_h.push_back(unit(random));
        at.h_s.push_back(unit(random));
        at.s_h.push_back(unit(random));
        at.s_s.push_back(unit(random));
        at.transmittance.push_back(unit(random));
    }
    return at;
}

IdealOptics<double> optics_of(const IdealOpticsColumns& at, std::size_t wavelength) {
    return {at.to_pupil_z[wavelength], at.pupil_radius[wavelength], at.pupil_area[wavelength],
            at.object_z[wavelength],   at.h_h[wavelength],          at.h_s[wavelength],
            at.s_h[wavelength],        at.s_s[wavelength],          at.transmittance[wavelength]};
}

// Every width of packets leaves an ideal camera as one path does, to the bit.
TEST(IdealPath, EveryLevelLeavesAsOnePathDoes) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const IdealOpticsColumns at = random_optics(random, 7);
    const auto starts = std::make_unique<PathStarts>();
    optics::RayBatch<double> rays(kPathChunk);
    for (int size = 0; size <= kPathChunk; size += 17) {
        starts->size = size;
        for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
            starts->film_x[i] = 20.0 * (unit(random) - 0.5);
            starts->film_y[i] = 20.0 * (unit(random) - 0.5);
            starts->pupil_u[i] = unit(random);
            starts->pupil_v[i] = unit(random);
            starts->filter_weight[i] = unit(random);
            starts->wavelength[i] = static_cast<std::uint16_t>(random() % 7);
        }
        for (const SimdLevel level : available_simd_levels()) {
            path_kernels(level).leave_ideal_camera(at, *starts, rays);
            ASSERT_EQ(rays.size, size);
            for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
                const IdealPath<double> path =
                    ideal_path<double>(optics_of(at, starts->wavelength[i]), {starts->film_x[i], starts->film_y[i]},
                                       starts->pupil_u[i], starts->pupil_v[i]);
                const Ray<double> found = rays.ray(static_cast<int>(i));
                EXPECT_EQ(found.origin, path.ray.origin) << simd_name(level);
                EXPECT_EQ(found.direction, path.ray.direction) << simd_name(level);
                EXPECT_EQ(starts->weight[i], path.weight * starts->filter_weight[i]) << simd_name(level);
            }
        }
    }
}

}  // namespace lensproof::render::ideal_path_test
