#include "experiments/studies/stability/measure_stability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/input_error.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/multiprecision.h"
#include "engine/optics/packet/trace_batch.h"
#include "experiments/studies/stability/jitter.h"

namespace lensproof::studies {

namespace {

// Draws of all inputs' rounding at once: how far a point moves, and whether the ray's fate changes.
constexpr int kDraws = 8;
constexpr double kHalfUlp = 0.5 * std::numeric_limits<double>::epsilon();

/// A ray's points, on each surface that it met and on the image plane, and its fate.
template <class T>
struct Path {
    std::vector<Vec3<T>> points;
    optics::RayStatus status = optics::RayStatus::ok;
    int surface = -1;
    bool is_finite = true;
};

template <class From>
bool same_fate(const Path<From>& a, const auto& b) {
    return a.status == b.status && a.surface == b.surface && a.points.size() == b.points.size();
}

template <class T>
bool is_finite(const Vec3<T>& v) {
    using std::isfinite;
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

template <class T>
void add_event(Path<T>& path, const optics::SurfaceEvent<T>& event) {
    using std::isfinite;
    if (event.status != optics::RayStatus::missed) {  // that has no point
        path.points.push_back(event.ray.origin);
    }
    // T = 4 r (1 − r) ≤ 1 but for rounding, a few ulps a surface.
    const T most = T(1) + T(4 * (event.surface + 1)) * std::numeric_limits<T>::epsilon();
    path.is_finite = path.is_finite && is_finite(event.ray.origin) && is_finite(event.ray.direction) &&
                     isfinite(event.optical_path) && event.transmittance >= T(0) && event.transmittance <= most;
}

template <class T>
void finish(Path<T>& path, const optics::TracedRay<T>& traced, const optics::TraceLens<T>& lens) {
    path.status = traced.status;
    path.surface = traced.surface;
    if (traced.status == optics::RayStatus::ok && traced.ray.direction.z > T(0)) {
        path.points.push_back(optics::meet_plane(traced.ray, lens.image_z).point);
        path.is_finite = path.is_finite && is_finite(path.points.back());
    }
}

template <class T>
Path<T> path_of(const optics::TraceLens<T>& lens, const Ray<T>& ray) {
    Path<T> path;
    const optics::TracedRay<T> traced =
        optics::trace(lens, ray, [&](const optics::SurfaceEvent<T>& event) { add_event(path, event); });
    finish(path, traced, lens);
    return path;
}

/// The same rays in float packets.
optics::RayBatch<float> traced_in_packets(const optics::TraceLens<float>& lens, const std::vector<Ray<float>>& rays) {
    optics::RayBatch<float> batch(static_cast<int>(rays.size()));
    batch.size = batch.capacity;
    for (int i = 0; i < batch.size; ++i) {
        batch.set(i, rays[static_cast<std::size_t>(i)]);
    }
    optics::trace_batch(optics::SpectralLens<float>({lens}), batch);
    return batch;
}

bool has_same_bits(const optics::RayBatch<float>& batch, std::size_t i, const optics::TracedRay<float>& alone) {
    const Ray<float> lane = batch.ray(static_cast<int>(i));
    return batch.status[i] == alone.status && batch.surface[i] == alone.surface && lane.origin == alone.ray.origin &&
           lane.direction == alone.ray.direction && batch.optical_path[i] == alone.optical_path &&
           batch.transmittance[i] == alone.transmittance;
}

using Exact = optics::Multiprecision;

/// The largest distance between two paths' points.
template <class T>
double distance(const Path<T>& a, const Path<Exact>& exact) {
    Exact largest(0);
    for (std::size_t i = 0; i < std::min(a.points.size(), exact.points.size()); ++i) {
        largest = std::max(largest, length(optics::convert_vector<Exact>(a.points[i]) - exact.points[i]));
    }
    return static_cast<double>(largest);
}

/// One ray in a hundred digits: its path, how far rounding the input moves it, and whether that may change its fate.
struct RayJudgement {
    Path<Exact> path;
    double conditioning_mm = 0.0;
    bool is_at_a_change = false;
};

RayJudgement judge(const optics::TraceLens<Exact>& lens, const Ray<double>& given, std::mt19937_64& random) {
    const Ray<Exact> ray = optics::convert_ray<Exact>(given);
    RayJudgement judgement{.path = path_of(lens, ray)};
    Jitter<Exact> by_half_an_ulp(kHalfUlp, random);
    Jitter<Exact> by_more(kConditioningFactor * kHalfUlp, random);
    for (int draw = 0; draw < kDraws; ++draw) {
        for (Jitter<Exact>* jitter : {&by_half_an_ulp, &by_more}) {
            const optics::TraceLens<Exact> moved_lens = (*jitter)(lens);
            const Path<Exact> moved = path_of(moved_lens, (*jitter)(ray));
            judgement.is_at_a_change = judgement.is_at_a_change || !same_fate(moved, judgement.path);
            if (jitter == &by_half_an_ulp) {
                judgement.conditioning_mm = std::max(judgement.conditioning_mm, distance(moved, judgement.path));
            }
        }
    }
    return judgement;
}

template <class T>
void count(TypeResult& result, const Path<T>& path, const Path<Exact>& exact, bool is_at_a_change) {
    result.not_finite += path.is_finite ? 0 : 1;
    if (!same_fate(path, exact)) {
        ++(is_at_a_change ? result.close_calls : result.other_statuses);
    } else if (!is_at_a_change) {
        result.error_mm = std::max(result.error_mm, distance(path, exact));
    }
}

void measure_point(StabilityPoint& point, const StabilityCase& given, std::mt19937_64& random) {
    const optics::TraceLens<float> lens_in_float = optics::convert_lens<float>(given.lens);
    const optics::TraceLens<Exact> exact_of_float = optics::convert_lens<Exact>(lens_in_float);
    const optics::TraceLens<long double> lens_in_long = optics::convert_lens<long double>(given.lens);
    const optics::TraceLens<Exact> exact_lens = optics::convert_lens<Exact>(given.lens);
    std::vector<Ray<float>> float_rays;
    for (const Ray<double>& ray : given.rays) {
        float_rays.push_back(optics::convert_ray<float>(ray));
    }
    const optics::RayBatch<float> packets = traced_in_packets(lens_in_float, float_rays);
    point.rays = static_cast<int>(given.rays.size());
    for (std::size_t i = 0; i < given.rays.size(); ++i) {
        const RayJudgement judged = judge(exact_lens, given.rays[i], random);
        const bool at_a_change = judged.is_at_a_change;
        point.at_a_change += at_a_change ? 1 : 0;

        const Path<double> in_double = path_of(given.lens, given.rays[i]);
        ++point.fates[optics::status_name(in_double.status)];
        count(point.types[kDouble], in_double, judged.path, at_a_change);
        count(point.types[kLongDouble], path_of(lens_in_long, optics::convert_ray<long double>(given.rays[i])),
              judged.path, at_a_change);
        if (!at_a_change && same_fate(in_double, judged.path)) {
            const double bound = std::max(kErrorBoundMm, kConditioningFactor * judged.conditioning_mm);
            point.conditioning_mm = std::max(point.conditioning_mm, judged.conditioning_mm);
            point.excess = std::max(point.excess, distance(in_double, judged.path) / bound);
        }

        const Path<float> in_float = path_of(lens_in_float, float_rays[i]);
        const Path<Exact> exact = path_of(exact_of_float, optics::convert_ray<Exact>(float_rays[i]));
        count(point.types[kFloat], in_float, exact, at_a_change);
        point.lanes_unlike_scalar += has_same_bits(packets, i, optics::trace(lens_in_float, float_rays[i])) ? 0 : 1;
    }
}

}  // namespace

// Where the archive looks for it, beside the type.
static void fields(JsonArchive& json, TypeResult& type) {
    json.any_number("error_mm", type.error_mm)
        .field("other_statuses", type.other_statuses)
        .field("close_calls", type.close_calls)
        .field("not_finite", type.not_finite);
}

void fields(JsonArchive& json, StabilityPoint& point) {
    json.any_number("value", point.value)
        .field("refusal", point.refusal)
        .field("is_rightly_refused", point.is_rightly_refused)
        .field("rays", point.rays)
        .field("at_a_change", point.at_a_change)
        .field("fates", point.fates)
        .any_number("conditioning_mm", point.conditioning_mm)
        .any_number("excess", point.excess)
        .field("lanes_unlike_scalar", point.lanes_unlike_scalar);
    for (std::size_t type = 0; type < kNumberTypes.size(); ++type) {
        json.field(kNumberTypes.at(type), point.types.at(type));
    }
}

StabilitySweep measure_stability(const Extreme& extreme, std::uint64_t seed) {
    StabilitySweep sweep{.extreme = extreme, .points = {}};
    for (std::size_t i = 0; i < extreme.values.size(); ++i) {
        std::mt19937_64 random(seed * 1000 + i);
        StabilityPoint point{.value = extreme.values[i]};
        try {
            measure_point(point, extreme.build(point.value, random), random);
        } catch (const InputError& error) {
            point.refusal = error.what();
        }
        const bool is_taken = point.value >= extreme.least_taken && point.value <= extreme.most_taken;
        point.is_rightly_refused = is_taken == point.refusal.empty();
        sweep.points.push_back(std::move(point));
    }
    return sweep;
}

}  // namespace lensproof::studies
