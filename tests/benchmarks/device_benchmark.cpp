#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>
#include <random>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/device/device_trace.h"
#include "engine/optics/device/trace_job.h"
#include "engine/render/integrators/chart_tracer.h"
#include "engine/render/integrators/integrators.h"
#include "engine/render/progressive.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

/// Enough for a GPU to be full most of the time; to the stand-in, few.
std::size_t rays_for(const device::Device& device) {
    return std::size_t{1} << (device.is_gpu() ? 22U : 10U);
}

/// Rays from all of the front, up to 8° from the axis, that pass the lens.
template <class T>
std::vector<Ray<T>> passing_rays(const optics::TraceLens<double>& lens, double semi_diameter) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<T>> rays;
    while (rays.size() < 4096) {
        const Vec3d direction = normalized(Vec3d{0.1 * unit(random), 0.1 * unit(random), 1.0});
        const Vec3d at{semi_diameter * unit(random), semi_diameter * unit(random), 0.0};
        const Ray<double> ray{at - 10.0 * direction, direction};
        if (optics::trace(lens, ray).status == optics::RayStatus::ok) {
            rays.push_back(optics::convert_ray<T>(ray));
        }
    }
    return rays;
}

/// The loop alone: rays and results stay in the device's memory.
template <class T>
void time_loop(benchmark::State& state, const device::Device& device, const std::string& name, optics::Carry carry) {
    const std::size_t size = rays_for(device);
    const optics::Lens lens = formats::load_lens(name);
    const auto at = optics::at_wavelengths<T>(lens, {450.0, 500.0, 550.0, 600.0});
    const optics::DeviceLens<T> there(device, at);
    const std::vector<Ray<T>> passing =
        passing_rays<T>(optics::at_wavelength<double>(lens, 550.0), lens.surfaces.front().semi_diameter);
    device::Buffer buffer(device, 14 * device::Buffer::bytes_for<T>(size) +
                                      device::Buffer::bytes_for<std::uint16_t, optics::RayStatus, std::int16_t>(size));
    std::array<device::Column<T>, 14> numbers;
    for (device::Column<T>& column : numbers) {
        column = buffer.column<T>(size);
    }
    const auto wavelength = buffer.column<std::uint16_t>(size);
    const auto status = buffer.column<optics::RayStatus>(size);
    const auto surface = buffer.column<std::int16_t>(size);
    for (std::size_t i = 0; i < size; ++i) {
        const Ray<T>& ray = passing[i % passing.size()];
        const std::array<T, 6> given = {ray.origin.x,    ray.origin.y,    ray.origin.z,
                                        ray.direction.x, ray.direction.y, ray.direction.z};
        for (std::size_t k = 0; k < given.size(); ++k) {
            numbers[k].here[i] = given[k];
        }
        wavelength.here[i] = static_cast<std::uint16_t>(i % 4);
    }
    for (std::size_t k = 0; k < 6; ++k) {
        buffer.upload(numbers[k], size);
    }
    buffer.upload(wavelength, size);
    const auto columns = [&](std::size_t first) {
        return optics::RayColumns<T>{.x = numbers[first].there,
                                     .y = numbers[first + 1].there,
                                     .z = numbers[first + 2].there,
                                     .dx = numbers[first + 3].there,
                                     .dy = numbers[first + 4].there,
                                     .dz = numbers[first + 5].there,
                                     .optical_path = numbers[12].there,
                                     .transmittance = numbers[13].there,
                                     .wavelength = wavelength.there,
                                     .status = status.there,
                                     .surface = surface.there,
                                     .size = static_cast<int>(size)};
    };
    const int loops = device.is_gpu() ? 16 : 1;  // a wait
    const auto run = [&] {
        for (int i = 0; i < loops; ++i) {
            optics::with_trace_job<optics::Direction::forward>(
                there.view(), columns(0), columns(6), optics::Rims::clip, carry,
                [&](const auto& job) { buffer.queue().run(job, static_cast<int>(size)); });
        }
        buffer.queue().wait();
    };
    run();
    while (state.KeepRunning()) {
        run();
    }
    const double rays = static_cast<double>(state.iterations()) * loops * static_cast<double>(size);
    state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
    state.counters["ray-surfaces/s"] =
        benchmark::Counter(rays * static_cast<double>(lens.surfaces.size()), benchmark::Counter::kIsRate);
}

/// A whole render of an evenly lit chart, on all processors, with the device's help or without.
void time_chart(benchmark::State& state, const std::shared_ptr<device::SharedDevice>& device, render::LensModel model,
                std::uint32_t samples) {
    const render::Camera camera({.lens = "tessar",
                                 .f_number = 2.8,
                                 .focus_distance_mm = 2000.0,
                                 .sensor = {.width = 720, .height = 540, .pixel_pitch_mm = 0.1},
                                 .response = "cie-1931",
                                 .model = model},
                                {}, {}, {}, false, device);
    const render::World world =
        render::even_chart({.pattern = scene::Checkerboard{12, 9, 110.0}}, {.distance_mm = 2000.0}, 1000.0, camera);
    const render::Render chart = render::integrator_named("chart").render({.world = &world, .camera = &camera});
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(render::render_film(chart, {.first = 0, .end = samples}, 0));
    }
    state.counters["samples/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * 720 * 540 * samples, benchmark::Counter::kIsRate);
}

void register_on(const std::shared_ptr<device::SharedDevice>& device) {
    const auto add = [&]<class T>(const char* lens, const char* type, T /*number*/) {
        for (const auto& [what, carry] :
             {std::pair{"geometry", optics::Carry::geometry}, {"fresnel", optics::Carry::transmittance}}) {
            benchmark::RegisterBenchmark(
                fmt::format("device/trace/{}/{}/{}", lens, type, what).c_str(),
                [=](benchmark::State& state) { time_loop<T>(state, device->device(), lens, carry); })
                ->UseRealTime();
        }
    };
    for (const char* lens : {"tessar", "double-gauss-tronnier"}) {
        add(lens, "float", 0.0F);
        add(lens, "double", 0.0);
    }
    const bool is_gpu = device->device().is_gpu();
    for (const std::uint32_t samples : is_gpu ? std::vector<std::uint32_t>{64, 1024} : std::vector<std::uint32_t>{1}) {
        for (const render::LensModel model : {render::LensModel::exact, render::LensModel::exact_float}) {
            for (const bool has_device : {false, true}) {
                benchmark::RegisterBenchmark(
                    fmt::format("device/chart/{}/spp:{}/{}", render::name_of(model), samples,
                                has_device ? "device" : "processors")
                        .c_str(),
                    [=](benchmark::State& state) { time_chart(state, has_device ? device : nullptr, model, samples); })
                    ->Unit(benchmark::kMillisecond)
                    ->UseRealTime();
            }
        }
    }
}

}  // namespace

void register_device_benchmarks() {
    const auto fail = [](const std::string& why) { throw device::Error(why); };
    register_on(std::make_shared<device::SharedDevice>(
        device::Device::find().device.value_or(device::Device::stand_in()), fail, fail));
}

}  // namespace lensproof
