#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/scene/texture.h"
#include "tests/benchmarks/benchmarks.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"

namespace lensproof {

namespace {

constexpr std::size_t kQueries = 1024;  // so that neither branches nor sines are learnt by heart

struct Query {
    Vec3d wo;
    Vec3d wi;
    double u_lobe, u1, u2;
};

std::vector<Query> queries() {
    Uniform uniform(1);
    std::vector<Query> all;
    for (std::size_t i = 0; i < kQueries; ++i) {
        const Vec3d wo = direction(uniform(), 6.283 * uniform());
        const Vec3d wi = direction(uniform(), 6.283 * uniform());
        all.push_back({wo, wi, uniform(), uniform(), uniform()});
    }
    return all;
}

void draw(benchmark::State& state, const Bsdf& bsdf) {
    const std::vector<Query> all = queries();
    std::size_t i = 0;
    while (state.KeepRunning()) {
        const Query& q = all[i++ % kQueries];
        benchmark::DoNotOptimize(sample(bsdf, q.wo, q.u_lobe, q.u1, q.u2, Transport::radiance));
    }
}

/// What a light's sample asks for: the value, and the density for its weight.
void judge(benchmark::State& state, const Bsdf& bsdf) {
    const std::vector<Query> all = queries();
    std::size_t i = 0;
    while (state.KeepRunning()) {
        const Query& q = all[i++ % kQueries];
        benchmark::DoNotOptimize(evaluate(bsdf, q.wo, q.wi, Transport::radiance));
        benchmark::DoNotOptimize(density(bsdf, q.wo, q.wi, Transport::radiance));
    }
}

void look_up(benchmark::State& state, const Texture& texture, const SpectralGrid& grid) {
    const std::vector<Query> all = queries();
    std::size_t i = 0;
    while (state.KeepRunning()) {
        const Query& q = all[i % kQueries];
        benchmark::DoNotOptimize(value_at(texture, {q.u1, q.u2}, grid.path(static_cast<int>(i++ % 64))));
    }
}

/// 256 × 256 pixels of any shapes: what they look like costs nothing.
Texture picture(const SpectralGrid& grid) {
    ImageTexture image{.grid = {.width = 256, .height = 256},
                       .abscissa = tabulated(grid, sigmoid_abscissa),
                       .white = constant_spectrum(1.0, grid)};
    Uniform uniform(2);
    for (int i = 0; i < 256 * 256; ++i) {
        const auto number = [&] { return static_cast<float>(4.0 * uniform() - 2.0); };
        image.texel.push_back({.shape = {.coefficient = {number(), number(), number()}}, .scale = 1.0F});
    }
    return image;
}

}  // namespace

void register_bsdf_benchmarks() {
    static const BsdfTables tables;
    for (const auto& [name, bsdf] : broad_cases(tables)) {
        std::string word = name;
        std::replace(word.begin(), word.end(), ' ', '-');
        benchmark::RegisterBenchmark(("bsdf/" + word + "/sample").c_str(), draw, bsdf);
        benchmark::RegisterBenchmark(("bsdf/" + word + "/evaluate").c_str(), judge, bsdf);
    }
    benchmark::RegisterBenchmark("bsdf/mirror/sample", draw,
                                 Bsdf(ConductorBsdf{.n = SpectralSample(0.2F), .k = SpectralSample(3.0F)}));
    benchmark::RegisterBenchmark("bsdf/glass/sample", draw, Bsdf(DielectricBsdf{.eta = SpectralSample(1.5F)}));
    const SpectralGrid grid = spectral_grid(400.0, 700.0, 64);
    benchmark::RegisterBenchmark("texture/constant", look_up, Texture(constant_spectrum(0.5, grid)), grid);
    benchmark::RegisterBenchmark("texture/picture", look_up, picture(grid), grid);
    benchmark::RegisterBenchmark(
        "texture/colour-checker", look_up,
        Texture(chart_texture({.pattern = ColourChecker{.patch_mm = 40.0, .gap_mm = 6.0}}, 282.0, 190.0, grid)), grid);
}

}  // namespace lensproof
