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
std::size_t compare_events(const device::Device& device, const Lens& lens, const std::vector<Ray<double>>& given,
                           const RayCourse<T>& course) {
    const SpectralLens<T> at = at_two<T>(lens);
    std::vector<Ray<T>> rays;
    std::ranges::transform(given, std::back_inserter(rays), convert_ray<T, double>);
    std::vector<std::uint16_t> wavelengths;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        wavelengths.push_back(i % 2);
    }
    const DeviceLens<T> there(device, at);
    const DeviceEvents<T> found(device, there, rays, wavelengths, course);
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        std::vector<SurfaceEvent<T>> events;
        const TracedRay<T> end = trace_along(at.at(wavelengths[i]), course, rays[i],
                                             [&](const SurfaceEvent<T>& event) { events.push_back(event); });
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
void compare_all_courses(const Lens& lens) {
    const std::vector<Ray<double>> forward = rays_at(lens, 101, 0.5);
    std::vector<Ray<double>> reverse = rays_at(lens, 101, 0.15);
    for (Ray<double>& ray : reverse) {
        ray = {{ray.origin.x, ray.origin.y, lens.image_z}, -1.0 * ray.direction};
    }
    for (const device::Device& device : every_device()) {
        for (const Rims rims : {Rims::clip, Rims::follow}) {
            EXPECT_GT(compare_events<T>(device, lens, forward, {.rims = rims}), 202U);
            EXPECT_GT(compare_events<T>(device, lens, reverse, {.direction = Direction::reverse, .rims = rims}), 202U);
        }
    }
}

TEST(DeviceEvents, AreThoseOfRaysOneByOne) {
    for (const char* name : {"tessar", "heliar-tronnier"}) {
        compare_all_courses<float>(formats::load_lens(name));
        compare_all_courses<double>(formats::load_lens(name));
    }
}

TEST(DeviceEvents, AreThoseOfLensesOfMoreThanSpheres) {
    for (const Lens& lens : varied_tessars()) {
        compare_all_courses<double>(lens);
    }
}

TEST(DeviceEvents, FollowGhosts) {
    const Lens lens = formats::load_lens("tessar");
    const std::vector<Ray<double>> rays = rays_at(lens, 40, 0.2);
    std::vector<GhostPath> paths = some_ghosts(static_cast<int>(lens.surfaces.size()));
    paths.push_back({static_cast<int>(lens.surfaces.size()), 2});  // from the sensor
    paths.push_back({3, lens.stop_index()});
    for (const device::Device& device : every_device()) {
        std::size_t events = 0;
        for (const GhostPath& path : paths) {
            events += compare_events<double>(device, lens, rays,
                                             {.reflections = path, .mirrors = {.sensor = 0.1, .blades = 0.05}});
            events += compare_events<float>(device, lens, rays,
                                            {.reflections = path, .mirrors = {.sensor = 0.1F, .blades = 0.05F}});
        }
        EXPECT_GT(events, 40U * paths.size());
    }
}

constexpr std::size_t kPiece = 256;

/// More rays than go to a device at a time, the last of them in a short piece.
RayBatch<float> many_rays(const Lens& lens) {
    RayBatch<float> rays(3 * kPiece - 17);
    rays.size = rays.capacity;
    const std::vector<Ray<double>> given = rays_at(lens, rays.size, 0.1);
    for (std::size_t i = 0; i < given.size(); ++i) {
        rays.set(static_cast<int>(i), convert_ray<float>(given[i]));
        rays.wavelength[i] = i / 7 % 2;
    }
    return rays;
}

constexpr BatchSettings kTransmittance{.carry = Carry::transmittance};

void expect_same(const RayBatch<float>& found, const RayBatch<float>& expected) {
    EXPECT_EQ(found.status, expected.status);
    EXPECT_EQ(found.origin.x, expected.origin.x);
    EXPECT_EQ(found.direction.z, expected.direction.z);
    EXPECT_EQ(found.transmittance, expected.transmittance);
    EXPECT_EQ(found.optical_path, expected.optical_path) << "not asked for";
}

TEST(ColumnTracer, TakesRaysInPieces) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<float> at = at_two<float>(lens);
    const RayBatch<float> given = many_rays(lens);
    RayBatch<float> expected = given;
    trace_batch(at, expected, kTransmittance);
    for (const device::Device& device : every_device()) {
        device::SharedDevice shared(device, {}, [](const std::string& why) { ADD_FAILURE() << why; });
        ColumnTracer<float> tracer(at, &shared, kPiece);
        for (const int size : {100, given.size, 300}) {  // as they come
            RayBatch<float> found = given;
            found.size = size;
            tracer.trace(found.columns(), kTransmittance);
            if (size == given.size) {
                expect_same(found, expected);
            } else {
                EXPECT_TRUE(
                    std::equal(found.origin.x.begin(), found.origin.x.begin() + size, expected.origin.x.begin()));
                EXPECT_EQ(found.origin.x.back(), given.origin.x.back()) << "beyond the size";
            }
        }
    }
}

// Whichever call fails first: every ray is traced, and that is told once.
TEST(ColumnTracer, GoesOnWhereADeviceFails) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<float> at = at_two<float>(lens);
    const RayBatch<float> given = many_rays(lens);
    RayBatch<float> expected = given;
    trace_batch(at, expected, kTransmittance);
    int told = 1;
    int calls = 0;
    for (; told == 1 && calls < 200; ++calls) {
        told = 0;
        const auto hear = [&](const std::string& /*why*/) { ++told; };
        device::SharedDevice shared(device::Device::stand_in(calls), hear, hear);
        ColumnTracer<float> tracer(at, &shared, kPiece);
        RayBatch<float> found = given;
        tracer.trace(found.columns(), kTransmittance);
        expect_same(found, expected);
        EXPECT_EQ(tracer.is_on_device(), told == 0);
    }
    EXPECT_EQ(told, 0);
    EXPECT_GT(calls, 40);
}

TEST(ColumnTracer, OfNoRaysIsNothing) {
    const SpectralLens<double> at = at_two<double>(formats::load_lens("tessar"));
    for (const device::Device& device : every_device()) {
        device::SharedDevice shared(device, {}, [](const std::string& why) { ADD_FAILURE() << why; });
        RayBatch<double> none(0);
        ColumnTracer<double>(at, &shared).trace(none.columns());
        const DeviceEvents<double> none_at_all(device, DeviceLens<double>(device, at), {}, {}, {});
    }
}

TEST(ColumnTracer, NeedsNoDevice) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<float> at = at_two<float>(lens);
    RayBatch<float> expected = many_rays(lens);
    RayBatch<float> found = expected;
    trace_batch(at, expected, kTransmittance);
    ColumnTracer<float> tracer(at, nullptr);
    EXPECT_FALSE(tracer.is_on_device());
    tracer.trace(found.columns(), kTransmittance);
    expect_same(found, expected);
}

// Whichever call fails first: an error, and nothing else.
TEST(DeviceEvents, SayThatADeviceFails) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at = at_two<double>(lens);
    const std::vector<Ray<double>> rays = rays_at(lens, 10, 0.1);
    const std::vector<std::uint16_t> wavelengths(rays.size());
    const auto works = [&](int calls) {
        const device::Device device = device::Device::stand_in(calls);
        try {
            const DeviceEvents<double> events(device, DeviceLens<double>(device, at), rays, wavelengths, {});
            return !events.events(0).empty();
        } catch (const device::Error&) {
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
