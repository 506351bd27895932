// What a device's jobs make of rays, against the tracer one by one.
#include "engine/optics/device/device_trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"
#include "tests/engine/every_device.h"
#include "tests/engine/optics/packet/rays_at.h"
#include "tests/engine/optics/packet/varied_tessars.h"
#include "tests/engine/optics/some_ghosts.h"

namespace lensproof::optics::device_trace_test {

template <class T>
SpectralLens<T> at_two(const Lens& lens) {
    return SpectralLens<T>({at_wavelength<T>(lens, 450.0), at_wavelength<T>(lens, 650.0)});
}

/// Traces rays, every second one at each wavelength, event by event; returns how many events there were.
template <class T>
std::size_t compare_events(const Device& device, const Lens& lens, const std::vector<Ray<double>>& given,
                           const EventWay& way) {
    const SpectralLens<T> at = at_two<T>(lens);
    std::vector<Ray<T>> rays;
    std::ranges::transform(given, std::back_inserter(rays), convert_ray<T, double>);
    std::vector<std::uint16_t> wavelengths;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        wavelengths.push_back(i % 2);
    }
    const DeviceLens<T> there(device, at);
    const DeviceEvents<T> found(device, there, rays, wavelengths, way);
    const StrayMirrors<T> mirrors{static_cast<T>(way.mirrors.sensor), static_cast<T>(way.mirrors.blades)};
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        std::vector<SurfaceEvent<T>> events;
        const auto visit = [&](const SurfaceEvent<T>& event) { events.push_back(event); };
        const auto traced = [&]<Rims rims>() {
            const TraceLens<T>& of = at.at(wavelengths[i]);
            if (!way.reflections.empty()) {
                return trace_ghost<Direction::forward, rims>(of, way.reflections, rays[i], mirrors, visit);
            }
            return way.direction == Direction::forward ? trace<Direction::forward, rims>(of, rays[i], visit)
                                                       : trace<Direction::reverse, rims>(of, rays[i], visit);
        };
        const TracedRay<T> end = way.rims == Rims::clip ? traced.template operator()<Rims::clip>()
                                                        : traced.template operator()<Rims::follow>();
        const std::string where = device.name() + ", ray " + std::to_string(i);
        EXPECT_EQ(found.end(i).status, end.status) << where;
        EXPECT_EQ(found.end(i).surface, end.surface) << where;
        EXPECT_EQ(found.end(i).ray.origin, end.ray.origin) << where;
        EXPECT_EQ(found.end(i).ray.direction, end.ray.direction) << where;
        EXPECT_EQ(found.end(i).optical_path, end.optical_path) << where;
        const auto found_events = found.events(i);
        EXPECT_EQ(found_events.size(), events.size()) << where;
        for (std::size_t e = 0; e < std::min(events.size(), found_events.size()); ++e) {
            EXPECT_EQ(found_events[e].surface, events[e].surface) << where;
            EXPECT_EQ(found_events[e].status, events[e].status) << where;
            EXPECT_EQ(found_events[e].ray.origin, events[e].ray.origin) << where;
            EXPECT_EQ(found_events[e].ray.direction, events[e].ray.direction) << where;
            EXPECT_EQ(found_events[e].optical_path, events[e].optical_path) << where;
            EXPECT_NEAR(found_events[e].transmittance, events[e].transmittance,
                        device.is_gpu() ? 100.0 * std::numeric_limits<T>::epsilon() : 0.0)
                << where;
        }
        count += events.size();
    }
    return count;
}

template <class T>
void compare_all_ways(const Lens& lens) {
    const std::vector<Ray<double>> forward = rays_at(lens, 101, 0.5);
    std::vector<Ray<double>> reverse = rays_at(lens, 101, 0.15);
    for (Ray<double>& ray : reverse) {
        ray = {{ray.origin.x, ray.origin.y, lens.image_z}, -1.0 * ray.direction};
    }
    for (const Device& device : every_device()) {
        for (const Rims rims : {Rims::clip, Rims::follow}) {
            EXPECT_GT(compare_events<T>(device, lens, forward, {.rims = rims}), 202U);
            EXPECT_GT(compare_events<T>(device, lens, reverse, {.direction = Direction::reverse, .rims = rims}), 202U);
        }
    }
}

TEST(DeviceEvents, AreThoseOfRaysOneByOne) {
    for (const char* name : {"tessar", "heliar-tronnier"}) {
        compare_all_ways<float>(formats::load_lens(name));
        compare_all_ways<double>(formats::load_lens(name));
    }
}

TEST(DeviceEvents, AreThoseOfLensesOfMoreThanSpheres) {
    for (const Lens& lens : varied_tessars()) {
        compare_all_ways<double>(lens);
    }
}

TEST(DeviceEvents, FollowGhosts) {
    const Lens lens = formats::load_lens("tessar");
    const std::vector<Ray<double>> rays = rays_at(lens, 40, 0.2);
    std::vector<GhostPath> paths = some_ghosts(static_cast<int>(lens.surfaces.size()));
    paths.push_back({static_cast<int>(lens.surfaces.size()), 2});  // from the sensor
    paths.push_back({3, lens.stop_index()});
    for (const Device& device : every_device()) {
        std::size_t events = 0;
        for (const GhostPath& path : paths) {
            const EventWay way{.reflections = path, .mirrors = {.sensor = 0.1, .blades = 0.05}};
            events += compare_events<double>(device, lens, rays, way);
            events += compare_events<float>(device, lens, rays, way);
        }
        EXPECT_GT(events, 40U * paths.size());
    }
}

// More rays than go to a device at a time, the last of them in a short piece.
TEST(DeviceTrace, TakesRaysInPieces) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<float> at = at_two<float>(lens);
    const std::vector<Ray<double>> some = rays_at(lens, 1000, 0.1);
    RayBatch<float> expected(3 * (1 << 18) - 17);
    expected.size = expected.capacity;
    for (int i = 0; i < expected.size; ++i) {
        expected.set(i, convert_ray<float>(some[static_cast<std::size_t>(i) % some.size()]));
        expected.wavelength[static_cast<std::size_t>(i)] = i / 1000 % 2;
    }
    const RayBatch<float> given = expected;
    const BatchSettings settings{.carry = Carry::transmittance};
    trace_batch(at, expected, settings);
    for (const Device& device : every_device()) {
        RayBatch<float> found = given;
        trace_columns_on(device, DeviceLens<float>(device, at), found.columns(), settings);
        EXPECT_TRUE(std::ranges::equal(found.status, expected.status));
        EXPECT_EQ(found.origin.x, expected.origin.x);
        EXPECT_EQ(found.direction.z, expected.direction.z);
        EXPECT_EQ(found.transmittance, expected.transmittance);
        EXPECT_EQ(found.optical_path, given.optical_path) << "not asked for";
    }
}

TEST(DeviceTrace, OfNoRaysIsNothing) {
    const SpectralLens<double> at = at_two<double>(formats::load_lens("tessar"));
    for (const Device& device : every_device()) {
        const DeviceLens<double> there(device, at);
        RayBatch<double> none(0);
        trace_columns_on(device, there, none.columns());
        DeviceEvents<double>(device, there, {}, {}, {});
    }
}

// Whichever call fails first: an error, and nothing else.
TEST(DeviceTrace, SaysThatADeviceFails) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at = at_two<double>(lens);
    const std::vector<Ray<double>> rays = rays_at(lens, 10, 0.1);
    const std::vector<std::uint16_t> wavelengths(rays.size());
    const auto works = [&](int calls) {
        const Device device = Device::stand_in(calls);
        try {
            DeviceEvents<double>(device, DeviceLens<double>(device, at), rays, wavelengths, {});
            return true;
        } catch (const DeviceError&) {
            return false;
        }
    };
    int calls = 0;
    while (!works(calls)) {
        ++calls;
    }
    EXPECT_GT(calls, 8);
    EXPECT_LT(calls, 100);
}

}  // namespace lensproof::optics::device_trace_test
