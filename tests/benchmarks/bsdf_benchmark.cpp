#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/scene/spectra/texture.h"
#include "tests/benchmarks/benchmarks.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"

namespace lensproof {

namespace {

constexpr std::size_t kQueries = 1024;  // so that neither branches nor sines are learnt by heart

struct Query {
    Vec3d wo;
    Vec3d wi;
    scene::BsdfNumbers numbers;
};

std::vector<Query> queries() {
    scene::Uniform uniform(1);
    std::vector<Query> all;
    for (std::size_t i = 0; i < kQueries; ++i) {
        const Vec3d wo = scene::direction(uniform(), 6.283 * uniform());
        const Vec3d wi = scene::direction(uniform(), 6.283 * uniform());
        all.push_back({wo, wi, scene::bsdf_numbers(uniform(), uniform(), uniform())});
    }
    return all;
}

void draw(benchmark::State& state, const scene::Bsdf& bsdf) {
    const std::vector<Query> all = queries();
    std::size_t i = 0;
    while (state.KeepRunning()) {
        const Query& q = all[i++ % kQueries];
        benchmark::DoNotOptimize(scene::sample(bsdf, q.wo, q.numbers, scene::Transport::radiance));
    }
}

/// What a light's sample asks for: the value, and the pdf for its weight.
void judge(benchmark::State& state, const scene::Bsdf& bsdf) {
    const std::vector<Query> all = queries();
    std::size_t i = 0;
    while (state.KeepRunning()) {
        const Query& q = all[i++ % kQueries];
        benchmark::DoNotOptimize(scene::evaluate(bsdf, q.wo, q.wi, scene::Transport::radiance));
        benchmark::DoNotOptimize(scene::pdf(bsdf, q.wo, q.wi, scene::Transport::radiance));
    }
}

void look_up(benchmark::State& state, const scene::Texture& texture, const spectral::SpectralGrid& grid) {
    const std::vector<Query> all = queries();
    std::size_t i = 0;
    while (state.KeepRunning()) {
        const Query& q = all[i % kQueries];
        benchmark::DoNotOptimize(
            scene::value_at(texture, {q.numbers.u1, q.numbers.u2}, grid.path(static_cast<int>(i++ % 64))));
    }
}

/// 256 × 256 pixels of any shapes: what they look like costs nothing.
scene::Texture picture(const spectral::SpectralGrid& grid) {
    scene::ImageTexture image{.grid = {.width = 256, .height = 256},
                              .abscissa = spectral::tabulated(grid, spectral::sigmoid_abscissa),
                              .white = spectral::constant_spectrum(1.0, grid)};
    scene::Uniform uniform(2);
    for (int i = 0; i < 256 * 256; ++i) {
        const auto number = [&] { return static_cast<float>(4.0 * uniform() - 2.0); };
        image.texel.push_back({.shape = {.coefficient = {number(), number(), number()}}, .scale = 1.0F});
    }
    return image;
}

}  // namespace

void register_bsdf_benchmarks() {
    static const scene::BsdfTables tables;
    for (const auto& [name, bsdf] : scene::broad_cases(tables)) {
        std::string word = name;
        std::replace(word.begin(), word.end(), ' ', '-');
        benchmark::RegisterBenchmark(("bsdf/" + word + "/sample").c_str(), draw, bsdf);
        benchmark::RegisterBenchmark(("bsdf/" + word + "/evaluate").c_str(), judge, bsdf);
    }
    benchmark::RegisterBenchmark(
        "bsdf/mirror/sample", draw,
        scene::Bsdf(scene::ConductorBsdf{.n = spectral::SpectralSample(0.2F), .k = spectral::SpectralSample(3.0F)}));
    benchmark::RegisterBenchmark("bsdf/glass/sample", draw,
                                 scene::Bsdf(scene::DielectricBsdf{.eta = spectral::SpectralSample(1.5F)}));
    const spectral::SpectralGrid grid = spectral::spectral_grid(400.0, 700.0, 64);
    benchmark::RegisterBenchmark("texture/constant", look_up, scene::Texture(spectral::constant_spectrum(0.5, grid)),
                                 grid);
    benchmark::RegisterBenchmark("texture/picture", look_up, picture(grid), grid);
    benchmark::RegisterBenchmark(
        "texture/colour-checker", look_up,
        scene::Texture(scene::chart_texture({.pattern = scene::ColourChecker{.patch_mm = 40.0, .gap_mm = 6.0}}, 282.0,
                                            190.0, grid)),
        grid);
}

}  // namespace lensproof
