#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <random>
#include <type_traits>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/packet/trace_arrays.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

constexpr double kWavelengthNm = 550.0;
constexpr std::size_t kRays = 512;  // few enough to stay in the second-level cache

/// Rays from the sensor that pass the whole lens, reverse, or the same light forward. Every one passes, so that each
/// tracing takes all surfaces.
std::vector<Ray<double>> passing_rays(const optics::Lens& lens, optics::Direction direction) {
    const optics::TraceLens<double> traced_lens = optics::at_wavelength<double>(lens, kWavelengthNm);
    const optics::ChiefRays chief_rays(lens, kWavelengthNm);
    const double height = std::abs(chief_rays.at_field(0.7 * chief_rays.largest_field()).value().image_height);
    const double rim = lens.surfaces.back().semi_diameter;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> rays;
    while (rays.size() < kRays) {
        const Vec3d film{0.0, height * unit(random), traced_lens.image_z};
        const Vec3d rear{rim * unit(random), rim * unit(random), lens.last_vertex_z()};
        const Ray<double> outwards{film, normalized(rear - film)};
        const optics::TracedRay<double> out = optics::trace<optics::Direction::reverse>(traced_lens, outwards);
        const Ray<double> inwards{out.ray.origin + 10.0 * out.ray.direction, -1.0 * out.ray.direction};
        if (out.status == optics::RayStatus::ok &&
            optics::trace(traced_lens, inwards).status == optics::RayStatus::ok) {
            rays.push_back(direction == optics::Direction::reverse ? outwards : inwards);
        }
    }
    return rays;
}

void count(benchmark::State& state, std::size_t surfaces) {
    const double rays = static_cast<double>(state.iterations()) * static_cast<double>(kRays);
    state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
    state.counters["ray-surfaces/s"] =
        benchmark::Counter(rays * static_cast<double>(surfaces), benchmark::Counter::kIsRate);
}

/// The batch tracer at one level; `wavelengths` of them, so that one is a broadcast and more are looked up. `coatings`:
/// as `load_lens` has them.
template <class T>
void time_batch(benchmark::State& state, const std::string& name, SimdLevel level, optics::Carry carry, int wavelengths,
                const std::vector<std::string>& coatings) {
    const optics::Lens lens = formats::load_lens(name, {.coatings = coatings});
    const std::vector<Ray<double>> rays = passing_rays(lens, optics::Direction::reverse);
    std::vector<double> nm(static_cast<std::size_t>(wavelengths), kWavelengthNm);
    const optics::SpectralLens<T> at = optics::at_wavelengths<T>(lens, nm);
    optics::RayBatch<T> given(static_cast<int>(kRays));
    given.size = given.capacity;
    for (int i = 0; i < given.size; ++i) {
        given.set(i, optics::convert_ray<T>(rays[static_cast<std::size_t>(i)]));
        given.wavelength[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(i % wavelengths);
    }
    optics::RayBatch<T> batch = given;
    while (state.KeepRunning()) {
        batch.origin = given.origin;
        batch.direction = given.direction;
        optics::trace_batch<optics::Direction::reverse>(at, batch, {.carry = carry, .level = level});
        benchmark::ClobberMemory();
    }
    count(state, lens.surfaces.size());
}

/// Rays in arrays, a million of them, which the Python module is held to; `threads` as trace_arrays has them.
void time_arrays(benchmark::State& state, const std::string& name, int threads) {
    constexpr std::size_t kMillion = 1'000'000;
    const optics::Lens lens = formats::load_lens(name);
    const optics::SpectralLens<double> at = optics::at_wavelengths<double>(lens, {kWavelengthNm});
    const std::vector<Ray<double>> some = passing_rays(lens, optics::Direction::forward);
    optics::RayBatch<double> given(static_cast<int>(kMillion));
    for (std::size_t i = 0; i < kMillion; ++i) {
        given.set(static_cast<int>(i), some[i % some.size()]);
    }
    const auto column = [](const optics::PacketColumn<double>& numbers) {
        return optics::NumberColumn{reinterpret_cast<const char*>(numbers.data()), sizeof(double)};
    };
    const optics::RayArrays rays{column(given.origin.x),
                                 column(given.origin.y),
                                 column(given.origin.z),
                                 column(given.direction.x),
                                 column(given.direction.y),
                                 column(given.direction.z),
                                 kMillion};
    optics::RayBatch<double> traced(static_cast<int>(kMillion));
    while (state.KeepRunning()) {
        optics::trace_arrays(at, rays, traced.columns(), {}, threads);
        benchmark::ClobberMemory();
    }
    state.counters["rays/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * kMillion, benchmark::Counter::kIsRate);
}

template <class T>
std::vector<Ray<T>> in_precision(const std::vector<Ray<double>>& rays) {
    const auto cast = [](const Vec3d& v) {
        return Vec3<T>{static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
    };
    std::vector<Ray<T>> result;
    result.reserve(rays.size());
    for (const Ray<double>& ray : rays) {
        result.push_back({cast(ray.origin), cast(ray.direction)});
    }
    return result;
}

template <optics::Direction direction, optics::Rims rims, class T>
void time_trace(benchmark::State& state, const std::string& name) {
    const optics::Lens lens = formats::load_lens(name);
    const optics::TraceLens<T> traced_lens = optics::at_wavelength<T>(lens, kWavelengthNm);
    const std::vector<Ray<T>> rays = in_precision<T>(passing_rays(lens, direction));
    while (state.KeepRunning()) {
        for (const Ray<T>& ray : rays) {
            benchmark::DoNotOptimize(optics::trace<direction, rims>(traced_lens, ray));
        }
    }
    count(state, lens.surfaces.size());
}

/// What packets are judged by: the same physics in a plain loop over doubles, ray by ray, without statuses.
template <bool with_fresnel>
void time_plain_loop(benchmark::State& state, const std::string& name) {
    const optics::Lens lens = formats::load_lens(name);
    const optics::TraceLens<double> traced_lens = optics::at_wavelength<double>(lens, kWavelengthNm);
    const std::vector<Ray<double>> rays = passing_rays(lens, optics::Direction::reverse);
    while (state.KeepRunning()) {
        for (const Ray<double>& ray : rays) {
            Vec3d origin = ray.origin;
            Vec3d along = ray.direction;
            double transmittance = 1.0;
            for (auto surface = traced_lens.surfaces.rbegin(); surface != traced_lens.surfaces.rend(); ++surface) {
                const double c = surface->curvature;
                const Vec3d from_vertex{origin.x, origin.y, origin.z - surface->vertex_z};
                const optics::Intersection<double> met = optics::intersect(from_vertex, along, c, -1.0);
                if (!met.hit ||
                    met.point.x * met.point.x + met.point.y * met.point.y > surface->semi_diameter_squared) {
                    break;
                }
                origin = {met.point.x, met.point.y, met.point.z + surface->vertex_z};
                const Vec3d normal{c * met.point.x, c * met.point.y, c * met.point.z - 1.0};
                const optics::Refraction<double> bent =
                    optics::refract(along, normal, met.cos_incidence, met.sin2_incidence, surface->reverse_ratio);
                if (!bent.transmitted) {
                    break;
                }
                along = bent.direction;
                if (with_fresnel) {
                    transmittance *=
                        optics::fresnel_transmittance(surface->reverse_ratio, met.cos_incidence, bent.cos_refraction)
                            .value();
                }
            }
            benchmark::DoNotOptimize(origin);
            benchmark::DoNotOptimize(along);
            benchmark::DoNotOptimize(transmittance);
        }
    }
    count(state, lens.surfaces.size());
}

template <optics::Direction direction, optics::Rims rims, class T>
void register_one(const std::string& lens) {
    const std::string name = "trace/" + lens + (direction == optics::Direction::forward ? "/forward" : "/reverse") +
                             (rims == optics::Rims::clip ? "/clip" : "/follow") +
                             (std::is_same_v<T, double> ? "/double" : "/float");
    benchmark::RegisterBenchmark(name.c_str(),
                                 [lens](benchmark::State& state) { time_trace<direction, rims, T>(state, lens); });
}

template <class T>
void register_precision(const std::string& lens) {
    register_one<optics::Direction::forward, optics::Rims::clip, T>(lens);
    register_one<optics::Direction::forward, optics::Rims::follow, T>(lens);
    register_one<optics::Direction::reverse, optics::Rims::clip, T>(lens);
    register_one<optics::Direction::reverse, optics::Rims::follow, T>(lens);
}

std::string batch_name(const std::string& lens, const std::string& rest) {
    return "batch/" + lens + "/" + rest;
}

constexpr std::array kBatchLenses = {"tessar",       "petzval",       "double-gauss-tronnier",
                                     "westrogon-24", "wide-nakamura", "muller-fisheye"};

template <class T>
void register_batches(const std::string& lens, const std::string& type) {
    const auto add = [&](SimdLevel level, const std::string& what, optics::Carry carry, int wavelengths,
                         const std::vector<std::string>& coatings = {}) {
        benchmark::RegisterBenchmark(
            batch_name(lens, type + "/" + simd_name(level) + "/" + what).c_str(),
            [=](benchmark::State& state) { time_batch<T>(state, lens, level, carry, wavelengths, coatings); });
    };
    for (const SimdLevel level : available_simd_levels()) {
        add(level, "geometry", optics::Carry::geometry, 1);
        add(level, "fresnel", optics::Carry::transmittance, 1);
        add(level, "fresnel_64_wavelengths", optics::Carry::transmittance, 64);
        add(level, "mgf2_64_wavelengths", optics::Carry::transmittance, 64, {"mgf2"});
    }
}

}  // namespace

void register_trace_benchmarks() {
    for (const int threads : {1, 0}) {
        benchmark::RegisterBenchmark(
            threads == 1 ? "arrays/tessar/million/one_thread" : "arrays/tessar/million/all_cores",
            [threads](benchmark::State& state) { time_arrays(state, "tessar", threads); })
            ->UseRealTime();
    }
    for (const char* lens : {"tessar", "petzval", "muller-fisheye"}) {
        register_precision<double>(lens);
        register_precision<float>(lens);
    }
    for (const char* lens : kBatchLenses) {
        register_batches<double>(lens, "double");
        register_batches<float>(lens, "float");
        benchmark::RegisterBenchmark(batch_name(lens, "plain").c_str(),
                                     [lens](benchmark::State& state) { time_plain_loop<false>(state, lens); });
        benchmark::RegisterBenchmark(batch_name(lens, "plain_fresnel").c_str(),
                                     [lens](benchmark::State& state) { time_plain_loop<true>(state, lens); });
    }
}

}  // namespace lensproof
