#include "experiments/studies/stray_light/growing_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/formats/image/image.h"
#include "engine/render/film/film_image.h"

namespace lensproof::studies {

void fields(JsonArchive& json, PictureGrowth& growth) {
    json.field("samples", growth.samples)
        .field("seconds", growth.seconds)
        .field("error", growth.error)
        .field("pass_errors", growth.pass_errors)
        .field("pass_seconds", growth.pass_seconds);
}

namespace {

double difference(const formats::Image& a, const formats::Image& b) {
    double square = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double off = std::clamp(a.pixels[i], 0.0F, 1.0F) - std::clamp(b.pixels[i], 0.0F, 1.0F);
        square += off * off;
    }
    return std::sqrt(0.5 * square / static_cast<double>(a.pixels.size()));
}

void add(formats::Image& sum, const formats::Image& more, float of_sum, float of_more) {
    std::ranges::transform(sum.pixels, more.pixels, sum.pixels.begin(),
                           [&](float a, float b) { return of_sum * a + of_more * b; });
}

formats::Image sum_of(const std::vector<formats::Image>& pictures) {
    formats::Image all = pictures.front();
    for (std::size_t i = 1; i < pictures.size(); ++i) {
        add(all, pictures[i], 1.0F, 1.0F);
    }
    return all;
}

}  // namespace

std::vector<PictureGrowth> picture_growth(const std::vector<render::Render>& passes, int most_samples, int threads,
                                          const std::function<void(double done)>& progress) {
    std::vector<double> seconds(passes.size(), 0.0);
    const auto render = [&](std::uint32_t first, std::uint32_t end) {
        std::vector<formats::Image> pictures;
        for (std::size_t i = 0; i < passes.size(); ++i) {
            const auto start = std::chrono::steady_clock::now();
            pictures.push_back(render::film_rgb(render::render_film(passes[i], {.first = first, .end = end}, threads)));
            seconds[i] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        }
        return pictures;
    };
    render(0, 1);  // what is found before the first path, and kept, is no sample's
    std::ranges::fill(seconds, 0.0);
    std::vector<formats::Image> pictures = render(0, 1);
    std::vector<PictureGrowth> growth;
    for (int samples = 1; 2 * samples <= most_samples; samples *= 2) {
        PictureGrowth& point = growth.emplace_back();
        point.samples = samples;
        point.pass_seconds = seconds;
        for (const double one : seconds) {
            point.seconds += one;
        }
        const std::vector<formats::Image> others =
            render(static_cast<std::uint32_t>(samples), static_cast<std::uint32_t>(2 * samples));
        point.error = difference(sum_of(pictures), sum_of(others));
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            point.pass_errors.push_back(difference(pictures[i], others[i]));
            add(pictures[i], others[i], 0.5F, 0.5F);
        }
        progress(2.0 * samples / most_samples);
    }
    return growth;
}

}  // namespace lensproof::studies
