// Rays in someone else's arrays against the same rays one by one: the same fate, and the same bits.
#include "engine/optics/packet/trace_arrays.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/stop.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/lens.h"

namespace lensproof::optics::trace_arrays_test {

/// Rays as rows of six numbers, towards the front of a lens; directions of any length.
using Rows = std::vector<std::array<double, 6>>;

Rows rows_at(const Lens& lens, int count) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const double reach = 1.2 * lens.surfaces.front().semi_diameter;
    Rows rows;
    for (int i = 0; i < count; ++i) {
        const double scale = std::exp2(40.0 * unit(random));
        rows.push_back({reach * unit(random), reach * unit(random), -20.0, 0.3 * scale * unit(random),
                        0.3 * scale * unit(random), scale});
    }
    return rows;
}

RayArrays arrays_of(const Rows& rows) {
    const auto column = [&](std::size_t i) {
        return NumberColumn{reinterpret_cast<const char*>(&rows.front()[i]), sizeof(rows.front())};
    };
    return {column(0), column(1), column(2), column(3), column(4), column(5), rows.size()};
}

RayBatch<double> traced(const SpectralLens<double>& lens, const Rows& rows, int threads = 0) {
    RayBatch<double> to(static_cast<int>(rows.size()));
    to.size = to.capacity;
    for (int i = 0; i < to.size; ++i) {
        to.wavelength[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(i % lens.wavelengths());
    }
    trace_arrays(lens, arrays_of(rows), to.columns(), {}, threads);
    return to;
}

TEST(TraceArrays, HaveTheBitsOfRaysOneByOne) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at = at_wavelengths<double>(lens, {450.0, 550.0, 650.0});
    const Rows rows = rows_at(lens, 3001);  // no whole number of packets or of chunks
    for (const int threads : {1, 2}) {
        const RayBatch<double> found = traced(at, rows, threads);
        int passed = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto& [x, y, z, dx, dy, dz] = rows[i];
            const TracedRay<double> expected =
                trace(at.at(static_cast<int>(i) % 3), Ray<double>{{x, y, z}, normalized(Vec3d{dx, dy, dz})});
            const Ray<double> ray = found.ray(static_cast<int>(i));
            ASSERT_EQ(found.status[i], expected.status) << i;
            EXPECT_EQ(ray.origin, expected.ray.origin) << i;
            EXPECT_EQ(ray.direction, expected.ray.direction) << i;
            EXPECT_EQ(found.optical_path[i], expected.optical_path) << i;
            EXPECT_EQ(found.transmittance[i], expected.transmittance) << i;
            passed += expected.status == RayStatus::ok ? 1 : 0;
        }
        EXPECT_GT(passed, 300);
        EXPECT_LT(passed, 2700);
    }
}

// Lengths whose squares over- or underflow.
TEST(TraceArrays, TakeDirectionsOfAnyLength) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at = at_wavelengths<double>(lens, {550.0});
    const Rows rows = {{1.0, 2.0, -20.0, 0.25, -0.5, 1.0},
                       {1.0, 2.0, -20.0, std::ldexp(0.25, -1000), std::ldexp(-0.5, -1000), std::ldexp(1.0, -1000)},
                       {1.0, 2.0, -20.0, std::ldexp(0.25, 30), std::ldexp(-0.5, 30), std::ldexp(1.0, 30)}};
    const RayBatch<double> found = traced(at, rows);
    for (const int i : {1, 2}) {
        EXPECT_EQ(found.ray(i).origin, found.ray(0).origin);
        EXPECT_EQ(found.ray(i).direction, found.ray(0).direction);
    }
}

TEST(TraceArrays, SayWhichNumberCannotBeTraced) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at = at_wavelengths<double>(lens, {550.0});
    const Rows good = rows_at(lens, 2000);
    const auto complaint = [&](std::size_t ray, std::size_t number, double value) -> std::string {
        Rows rows = good;
        rows[ray][number] = value;
        try {
            traced(at, rows);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(complaint(1500, 1, std::numeric_limits<double>::quiet_NaN()),
              "rays: y_mm[1500] is nan, expected a number from -1e15 to 1e15");
    EXPECT_EQ(complaint(0, 5, std::numeric_limits<double>::infinity()),
              "rays: dz[0] is inf, expected a number from -1e15 to 1e15");
    Rows rows = good;
    rows[7] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    EXPECT_THROW(traced(at, rows), InputError);
}

TEST(TraceArrays, StopWhereTheyAreAsked) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at = at_wavelengths<double>(lens, {550.0});
    const std::atomic<bool> stop = true;
    const StopScope scope(&stop);
    EXPECT_THROW(traced(at, rows_at(lens, 100'000)), Stopped);
}

}  // namespace lensproof::optics::trace_arrays_test
