#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <type_traits>

#include "engine/optics/chief_ray.h"
#include "engine/optics/lens.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

constexpr double kWavelengthNm = 550.0;
constexpr std::size_t kRays = 512;  // few enough to stay in the second-level cache

/// Rays from the sensor that pass the whole lens, reverse, or the same light forward. Every one passes, so that each
/// tracing takes all surfaces.
std::vector<Ray<double>> passing_rays(const Lens& lens, Direction way) {
    const TraceLens<double> traced_lens = at_wavelength<double>(lens, kWavelengthNm);
    const ChiefRays chief_rays(lens, kWavelengthNm);
    const double height = std::abs(chief_rays.at_field(0.7 * chief_rays.largest_field()).value().image_height);
    const double rim = lens.surfaces.back().semi_diameter;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> rays;
    while (rays.size() < kRays) {
        const Vec3d film{0.0, height * unit(random), traced_lens.image_z};
        const Vec3d rear{rim * unit(random), rim * unit(random), lens.last_vertex_z()};
        const Ray<double> outwards{film, normalized(rear - film)};
        const TracedRay<double> out = trace<Direction::reverse>(traced_lens, outwards);
        const Ray<double> inwards{out.ray.origin + 10.0 * out.ray.direction, -1.0 * out.ray.direction};
        if (out.status == RayStatus::ok && trace(traced_lens, inwards).status == RayStatus::ok) {
            rays.push_back(way == Direction::reverse ? outwards : inwards);
        }
    }
    return rays;
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

void count(benchmark::State& state, std::size_t surfaces) {
    const double rays = static_cast<double>(state.iterations()) * static_cast<double>(kRays);
    state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
    state.counters["ray-surfaces/s"] =
        benchmark::Counter(rays * static_cast<double>(surfaces), benchmark::Counter::kIsRate);
}

template <Direction way, Rims rims, class T>
void time_trace(benchmark::State& state, const std::string& name) {
    const Lens lens = load_lens(name);
    const TraceLens<T> traced_lens = at_wavelength<T>(lens, kWavelengthNm);
    const std::vector<Ray<T>> rays = in_precision<T>(passing_rays(lens, way));
    while (state.KeepRunning()) {
        for (const Ray<T>& ray : rays) {
            benchmark::DoNotOptimize(trace<way, rims>(traced_lens, ray));
        }
    }
    count(state, lens.surfaces.size());
}

/// The least that a surface costs: `intersect` and `refract`, and nothing that a renderer needs besides.
template <bool with_fresnel>
void time_plain_loop(benchmark::State& state, const std::string& name) {
    const Lens lens = load_lens(name);
    const TraceLens<double> traced_lens = at_wavelength<double>(lens, kWavelengthNm);
    const std::vector<Ray<double>> rays = passing_rays(lens, Direction::reverse);
    while (state.KeepRunning()) {
        for (const Ray<double>& ray : rays) {
            Vec3d origin = ray.origin;
            Vec3d way = ray.direction;
            double transmittance = 1.0;
            for (auto surface = traced_lens.surfaces.rbegin(); surface != traced_lens.surfaces.rend(); ++surface) {
                const double c = surface->curvature;
                const Vec3d from_vertex{origin.x, origin.y, origin.z - surface->vertex_z};
                const Intersection<double> met = intersect(from_vertex, way, c, -1.0);
                origin = {met.point.x, met.point.y, met.point.z + surface->vertex_z};
                const Vec3d normal{c * met.point.x, c * met.point.y, c * met.point.z - 1.0};
                const Refraction<double> bent =
                    refract(way, normal, met.cos_incidence, met.sin2_incidence, surface->reverse_ratio);
                way = bent.direction;
                if (with_fresnel) {
                    transmittance *= fresnel_transmittance(surface->index_after, surface->index_before,
                                                           met.cos_incidence, bent.cos_refraction);
                }
            }
            benchmark::DoNotOptimize(origin);
            benchmark::DoNotOptimize(way);
            benchmark::DoNotOptimize(transmittance);
        }
    }
    count(state, lens.surfaces.size());
}

template <Direction way, Rims rims, class T>
void register_one(const std::string& lens) {
    const std::string name = "trace/" + lens + (way == Direction::forward ? "/forward" : "/reverse") +
                             (rims == Rims::clip ? "/clip" : "/follow") +
                             (std::is_same_v<T, double> ? "/double" : "/float");
    benchmark::RegisterBenchmark(name.c_str(),
                                 [lens](benchmark::State& state) { time_trace<way, rims, T>(state, lens); });
}

template <class T>
void register_precision(const std::string& lens) {
    register_one<Direction::forward, Rims::clip, T>(lens);
    register_one<Direction::forward, Rims::follow, T>(lens);
    register_one<Direction::reverse, Rims::clip, T>(lens);
    register_one<Direction::reverse, Rims::follow, T>(lens);
}

}  // namespace

void register_trace_benchmarks() {
    for (const char* lens : {"tessar", "petzval", "muller-fisheye"}) {
        register_precision<double>(lens);
        register_precision<float>(lens);
    }
    benchmark::RegisterBenchmark("trace/tessar/reverse/plain",
                                 [](benchmark::State& state) { time_plain_loop<false>(state, "tessar"); });
    benchmark::RegisterBenchmark("trace/tessar/reverse/plain_fresnel",
                                 [](benchmark::State& state) { time_plain_loop<true>(state, "tessar"); });
}

}  // namespace lensproof
