#include "engine/render/film/film_exr.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "engine/formats/image/exr_output.h"
#include "engine/render/film/film_exr_form.h"

namespace lensproof::render {

namespace {

void append(std::vector<float>& values, const Vec3d& v) {
    for (const double value : {v.x, v.y, v.z}) {
        values.push_back(static_cast<float>(value));
    }
}

void append(std::vector<float>& values, std::span<const double> more) {
    std::ranges::transform(more, std::back_inserter(values), [](double value) { return static_cast<float>(value); });
}

/// A part of the file: its channels, and what a pixel has in them.
struct Part {
    std::string name;
    std::vector<std::string> channels;
    std::function<void(int x, int y, std::vector<float>& values)> append_pixel;  // none: counts of samples
    const Film* counted = nullptr;                                               // whose
};

/// Of a film, or of the sum of several.
template <class Summed>
void add_estimates(const Summed& film, const std::string& prefix, std::vector<Part>& parts) {
    std::vector<double> layers(film.layout().layer_nm.size());
    parts.push_back({prefix + "rgb", kRgb,
                     [&film](int x, int y, std::vector<float>& values) { append(values, film.estimate(x, y).rgb); }});
    parts.push_back({prefix + "spectral", spectral_names(film.layout().layer_nm),
                     [&film, layers](int x, int y, std::vector<float>& values) mutable {
                         film.layers(x, y, layers);
                         append(values, std::span<const double>(layers));
                     }});
    parts.push_back({prefix + "variance", kVariance, [&film](int x, int y, std::vector<float>& values) {
                         append(values, film.estimate(x, y).variance);
                     }});
}

void add_film(const Film& film, const std::string& prefix, std::vector<Part>& parts) {
    const std::vector<std::string> spectral = spectral_names(film.layout().layer_nm);
    std::vector<double> layers(film.layout().layer_nm.size());
    add_estimates(film, prefix, parts);
    parts.push_back({prefix + "samples", kCounts, {}, &film});
    if (film.layout().has_features) {
        parts.push_back({prefix + "features", kFeatures, [&film](int x, int y, std::vector<float>& values) {
                             const PixelFeatures features = film.features(x, y);
                             values.push_back(static_cast<float>(features.depth_mm));
                             append(values, features.albedo_rgb);
                             append(values, features.normal);
                             values.push_back(static_cast<float>(film.coverage(x, y)));
                         }});
    }
    if (film.layout().has_splats) {
        parts.push_back({prefix + "light", joined(joined(kRgb, kVariance), spectral),
                         [&film, layers](int x, int y, std::vector<float>& values) mutable {
                             const auto [rgb, variance] = film.light_estimate(x, y);
                             append(values, rgb);
                             append(values, variance);
                             film.light_layers(x, y, layers);
                             append(values, std::span<const double>(layers));
                         }});
    }
}

std::vector<Part> parts_of(const Picture& picture) {
    std::vector<Part> parts;
    if (picture.parts().size() > 1) {
        add_estimates(picture, "", parts);
    }
    for (const auto& [pass, film] : picture.parts()) {
        add_film(*film, prefix_of(pass), parts);
    }
    return parts;
}

/// Calls `visit(y, end, values)` for the part's rows, some at once, until it returns false.
template <class Visit>
bool visit_rows(const Part& part, const Picture& picture, const Visit& visit) {
    std::vector<float> values;
    std::vector<std::uint32_t> counts;
    for (int y = 0; y < picture.height(); y += kRowsAtOnce) {
        const int end = std::min(picture.height(), y + kRowsAtOnce);
        values.clear();
        counts.clear();
        for (int row = y; row < end; ++row) {
            for (int x = 0; x < picture.width(); ++x) {
                if (part.append_pixel) {
                    part.append_pixel(x, row, values);
                } else {
                    counts.push_back(part.counted->counts(x, row).blocks);
                    counts.push_back(part.counted->counts(x, row).samples);
                }
            }
        }
        if (!(part.append_pixel ? visit(y, end, values) : visit(y, end, counts))) {
            return false;
        }
    }
    return true;
}

std::string digest_of(const std::vector<Part>& parts, const Picture& picture) {
    PixelDigest digest;
    for (const Part& part : parts) {
        visit_rows(part, picture, [&](int y, int end, const auto& values) {
            digest.add(part.name, values, end - y);
            return true;
        });
    }
    return digest.text();
}

OIIO::ImageSpec spec_of(const Part& part, const Picture& picture, const FilmNotes& notes) {
    OIIO::ImageSpec spec(picture.width(), picture.height(), static_cast<int>(part.channels.size()),
                         part.append_pixel ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT32);
    spec.channelnames = part.channels;
    spec.attribute("oiio:subimagename", part.name);
    spec.attribute("compression", "zip:1");  // what noise is left takes no less room at higher levels, but longer
    spec.attribute("oiio:ColorSpace", "linear");
    spec.attribute("DateTime",
                   "1970:01:01 00:00:00");  // else the library writes the clock's: the same render, other bytes
    if (notes.colours) {                    // of the first part, but what parts may share they have to
        const spectral::RgbSpace& space = *notes.colours;
        std::vector<float> chromaticities;
        for (const Vec2d& point : {space.red, space.green, space.blue, space.white}) {
            chromaticities.push_back(static_cast<float>(point.x));
            chromaticities.push_back(static_cast<float>(point.y));
        }
        spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities.data());
    }
    if (part.name.ends_with("spectral") || part.name.ends_with("light")) {
        for (const auto& [name, value] : spectral::spectral_attributes(spectral::kFilmIrradianceUnits)) {
            spec.attribute(name, value);
        }
    }
    if (part.name == "rgb") {
        for (const auto& [name, value] : notes.metadata) {
            spec.attribute(name, value);
        }
        for (const IdentityPart& of : notes.identity) {
            spec.attribute(kIdentityPrefix + of.name, of.value);
        }
        std::vector<std::string> passes;
        for (const auto& [pass, film] : picture.parts()) {
            if (film->layout().has_splats) {
                spec.attribute(attribute_of(kLightPaths, pass), fmt::format("{}", film->light_paths()));
            }
            if (film->left_out() > 0) {
                spec.attribute(attribute_of(kLeftOut, pass), fmt::format("{}", film->left_out()));
            }
            passes.push_back(pass);
        }
        if (!passes.front().empty()) {
            spec.attribute(kPasses, fmt::format("{}", fmt::join(passes, ",")));
        }
    }
    return spec;
}

bool write_rows(OIIO::ImageOutput& output, const Part& part, const Picture& picture) {
    return visit_rows(part, picture, [&]<class Number>(int y, int end, const std::vector<Number>& values) {
        return output.write_scanlines(y, end, 0, OIIO::BaseTypeFromC<Number>::value, values.data());
    });
}

bool write_parts(OIIO::ImageOutput& output, const std::string& name, const std::vector<Part>& parts,
                 const std::vector<OIIO::ImageSpec>& specs, const Picture& picture) {
    bool is_written = output.open(name, static_cast<int>(specs.size()), specs.data());
    for (std::size_t i = 0; is_written && i < parts.size(); ++i) {
        is_written = (i == 0 || output.open(name, specs[i], OIIO::ImageOutput::AppendSubimage)) &&
                     write_rows(output, parts[i], picture);
    }
    return is_written && output.close();
}

}  // namespace

void write_film_exr(const Picture& picture, const FilmNotes& notes, const std::filesystem::path& file) {
    const std::vector<Part> parts = parts_of(picture);
    std::vector<OIIO::ImageSpec> specs;
    std::ranges::transform(parts, std::back_inserter(specs),
                           [&](const Part& part) { return spec_of(part, picture, notes); });
    if (notes.has_digest) {
        specs.front().attribute(kDigest, digest_of(parts, picture));
    }
    formats::write_exr_file(file, [&](OIIO::ImageOutput& output, const std::string& name) {
        return write_parts(output, name, parts, specs, picture);
    });
}

std::size_t write_half_exr(const Picture& picture, const FilmNotes& notes, const std::filesystem::path& file) {
    constexpr double kLargest = 65504.0;
    std::size_t clipped = 0;
    const auto held = [&](double value) {
        clipped += std::abs(value) > kLargest ? 1 : 0;
        return std::clamp(value, -kLargest, kLargest);
    };
    const Part part{"rgb", kRgb, [&](int x, int y, std::vector<float>& values) {
                        const Vec3d rgb = picture.estimate(x, y).rgb;
                        append(values, {held(rgb.x), held(rgb.y), held(rgb.z)});
                    }};
    OIIO::ImageSpec spec = spec_of(part, picture, notes);
    spec.set_format(OIIO::TypeDesc::HALF);
    formats::write_exr_file(file, [&](OIIO::ImageOutput& output, const std::string& name) {
        clipped = 0;
        return output.open(name, spec) && write_rows(output, part, picture) && output.close();
    });
    return clipped;
}

}  // namespace lensproof::render
