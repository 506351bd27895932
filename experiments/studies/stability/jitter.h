// experiments/studies/stability/jitter.h — what rounding does to a lens and a ray, by chance.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "engine/optics/trace.h"

namespace lensproof::studies {

/// Rounds every number that the tracer is given anew: moves it by up to ± `relative` of itself, evenly distributed.
/// Equal indices stay equal, for they are one glass; a ratio of indices that differ is a rounded number of its own.
template <class T>
class Jitter {
  public:
    Jitter(double relative, std::mt19937_64& random) : relative_(relative), random_(random) {}

    optics::TraceLens<T> operator()(optics::TraceLens<T> lens) {
        using std::sqrt;
        std::map<T, T> moved_index{{T(1), T(1)}};
        const auto index = [&](const T& n) { return moved_index.try_emplace(n, moved(n)).first->second; };
        for (optics::TraceSurface<T>& s : lens.surfaces) {
            const int special = s.special;
            s = optics::make_trace_surface<T>(moved(s.curvature), moved(s.vertex_z),
                                              moved(sqrt(s.semi_diameter_squared)), index(s.index_before),
                                              index(s.index_after), s.is_stop);
            s.special = special;
            if (s.index_before != s.index_after) {
                s.forward_ratio = moved(s.forward_ratio);
                s.reverse_ratio = moved(s.reverse_ratio);
            }
        }
        for (optics::SpecialSurface<T>& special : lens.specials) {
            special.shape.curvature = moved(special.shape.curvature);
            special.shape.curvature_x = moved(special.shape.curvature_x);
            special.shape.conic = moved(special.shape.conic);
            for (auto* terms : {&special.shape.asphere, &special.shape.odd_asphere}) {
                std::ranges::transform(*terms, terms->begin(), [this](const T& term) { return moved(term); });
            }
            special.vertex = {moved(special.vertex.x), moved(special.vertex.y)};
            std::ranges::transform(special.axes, special.axes.begin(),
                                   [this](const Vec3<T>& axis) { return moved(axis); });
        }
        lens.image_z = moved(lens.image_z);
        return lens;
    }

    Ray<T> operator()(const Ray<T>& ray) { return {moved(ray.origin), normalized(moved(ray.direction))}; }

  private:
    T moved(const T& number) { return number * (T(1) + T(relative_ * unit_(random_))); }
    Vec3<T> moved(const Vec3<T>& v) { return {moved(v.x), moved(v.y), moved(v.z)}; }

    double relative_;
    std::mt19937_64& random_;
    std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

}  // namespace lensproof::studies
