#include "engine/render/film/film_exr.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/formats/image/exr_output.h"
#include "engine/formats/image/picture_file.h"
#include "engine/spectral/spectral_exr.h"

namespace lensproof::render {

namespace {

constexpr int kRowsAtOnce = 64;
constexpr std::size_t kMostPasses = 16;
constexpr const char* kIdentityPrefix = "lensproof:identity:";
constexpr const char* kLightPaths = "lensproof:lightPaths";
constexpr const char* kLeftOut = "lensproof:leftOut";
constexpr const char* kDigest = "lensproof:digest";
constexpr const char* kPasses = "lensproof:passes";

const std::vector<std::string> kRgb = {"R", "G", "B"};
const std::vector<std::string> kVariance = {"variance.R", "variance.G", "variance.B"};
const std::vector<std::string> kCounts = {"blocks", "samples"};  // in the order that files keep
const std::vector<std::string> kFeatures = {"Z",        "albedo.R", "albedo.G", "albedo.B",
                                            "normal.X", "normal.Y", "normal.Z", "coverage"};

std::vector<std::string> joined(std::vector<std::string> names, const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
    return names;
}

std::vector<std::string> spectral_names(const std::vector<double>& layer_nm) {
    std::vector<std::string> names;
    std::ranges::transform(layer_nm, std::back_inserter(names), spectral::spectral_channel_name);
    return names;
}

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

/// What a part's name begins with.
std::string prefix_of(const std::string& pass) {
    return pass.empty() ? "" : pass + ".";
}

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

/// A digest of pixels, row by row of each part: however many rows are read or written at once.
class PixelDigest {
  public:
    template <class Number>
    void add(const std::string& part, const std::vector<Number>& values, int rows) {
        const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
        const std::size_t row = bytes.size() / static_cast<std::size_t>(rows);
        for (std::size_t at = 0; at < bytes.size(); at += row) {
            std::uint64_t& digest = parts_[part];
            digest = hash_of(bytes.substr(at, row), digest);
        }
    }

    [[nodiscard]] std::string text() const {
        std::string all;
        for (const auto& [part, digest] : parts_) {
            all += fmt::format("{} {:016x}\n", part, digest);
        }
        return hash_text(all);
    }

  private:
    std::map<std::string, std::uint64_t> parts_;
};

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

/// An attribute of a pass's film.
std::string attribute_of(const char* name, const std::string& pass) {
    return pass.empty() ? name : fmt::format("{}:{}", name, pass);
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

/// Reads the parts of a film's file.
class FilmReader {
  public:
    explicit FilmReader(const std::filesystem::path& file) : file_(file) {
        if (formats::picture_form(file) != formats::PictureForm::exr) {
            fail("not an OpenEXR file that can be read");
        }
        input_ = formats::open_picture(file, {}).input;
    }

    FilmNotes read_notes() { return notes_of(seek("rgb")); }

    FilmFile read() {
        const OIIO::ImageSpec first = seek("rgb");
        FilmFile read{.films = {}, .notes = notes_of(first)};
        std::vector<std::string> passes = names_in(first.get_string_attribute(kPasses));
        if (passes.size() > kMostPasses) {
            fail(fmt::format("names {} passes", passes.size()));
        }
        if (passes.empty()) {
            passes.emplace_back();
        }
        for (const std::string& pass : passes) {
            read.films.push_back({pass, read_film(pass, first)});
        }
        if (read.notes.has_digest && first.get_string_attribute(kDigest) != digest_text(read.films)) {
            throw InputError(
                fmt::format("{}: is damaged: its pixels are not those that its digest was made of", file_.string()));
        }
        return read;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: {}, expected a picture that lensproof rendered", file_.string(), what));
    }

    Film read_film(const std::string& pass, const OIIO::ImageSpec& first) {
        prefix_ = prefix_of(pass);
        FilmLayout layout{.width = first.width,
                          .height = first.height,
                          .layer_nm = layers_of(seek(prefix_ + "spectral")),
                          .rgb_weights = {},
                          .has_splats = find(prefix_ + "light").has_value(),
                          .has_features = find(prefix_ + "features").has_value()};
        layout.rgb_weights.resize(layout.layer_nm.size());
        formats::check_picture_size(file_, first, first.nchannels, static_cast<double>(film_bytes_per_pixel(layout)));
        Film film(std::move(layout));
        film.set_light_paths(count_in(first, attribute_of(kLightPaths, pass)));
        film.set_left_out(count_in(first, attribute_of(kLeftOut, pass)));
        for (int y = 0; y < film.height(); y += kRowsAtOnce) {
            read_rows(film, y, std::min(film.height(), y + kRowsAtOnce));
        }
        return film;
    }

    /// Of the films' parts, and of their sum's where there are several.
    std::string digest_text(const std::vector<PassFilm>& films) {
        prefix_.clear();
        const OIIO::ImageSpec spec = seek("spectral");
        const std::vector<std::string> spectral = spectral_names(layers_of(spec));
        for (int y = 0; films.size() > 1 && y < spec.height; y += kRowsAtOnce) {
            const int end = std::min(spec.height, y + kRowsAtOnce);
            rows("rgb", kRgb, y, end);
            rows("spectral", spectral, y, end);
            rows("variance", kVariance, y, end);
        }
        return digest_.text();
    }

    std::optional<int> find(const std::string& part) {
        for (int i = 0; input_->seek_subimage(i, 0); ++i) {
            if (input_->spec().get_string_attribute("oiio:subimagename") == part) {
                return i;
            }
        }
        input_->geterror();
        return std::nullopt;
    }

    OIIO::ImageSpec seek(const std::string& part) {
        const std::optional<int> found = find(part);
        if (!found) {
            fail(fmt::format("has no part \"{}\"", part));
        }
        input_->seek_subimage(*found, 0);
        const OIIO::ImageSpec& spec = input_->spec();
        formats::check_picture_size(file_, spec, spec.nchannels, sizeof(float) * static_cast<double>(spec.nchannels));
        if (size_ == std::pair(0, 0)) {
            size_ = {spec.width, spec.height};
        }
        if (spec.x != 0 || spec.y != 0 || size_ != std::pair(spec.width, spec.height)) {
            fail(fmt::format("part \"{}\" has {} × {} pixels", part, spec.width, spec.height));
        }
        return spec;
    }

    [[nodiscard]] static std::vector<std::string> names_in(const std::string& list) {
        std::vector<std::string> names;
        std::istringstream stream(list);
        for (std::string name; std::getline(stream, name, ',');) {
            names.push_back(name);
        }
        return names;
    }

    [[nodiscard]] static std::uint64_t count_in(const OIIO::ImageSpec& spec, const std::string& name) {
        const std::string text = spec.get_string_attribute(name, "0");
        std::uint64_t count = 0;
        std::from_chars(text.data(), text.data() + text.size(), count);
        return count;
    }

    [[nodiscard]] static FilmNotes notes_of(const OIIO::ImageSpec& spec) {
        FilmNotes notes;
        const std::string prefix = kIdentityPrefix;
        for (const auto& attribute : spec.extra_attribs) {
            const std::string name = attribute.name().string();
            if (name.starts_with(prefix)) {
                notes.identity.push_back({name.substr(prefix.size()), attribute.get_string()});
            } else if (name.starts_with("lensproof:") && !name.starts_with(kLightPaths) &&
                       !name.starts_with(kLeftOut) && name != kDigest && name != kPasses) {
                notes.metadata[name] = attribute.get_string();
            }
        }
        notes.has_digest = !spec.get_string_attribute(kDigest).empty();
        std::array<float, 8> xy{};
        if (spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy.data())) {
            notes.colours = {{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
        }
        return notes;
    }

    [[nodiscard]] std::vector<double> layers_of(const OIIO::ImageSpec& spec) const {
        std::vector<double> layer_nm;
        for (const std::string& name : spec.channelnames) {
            const std::optional<spectral::SpectralChannel> channel = spectral::parse_spectral_channel(name);
            if (!channel || channel->layer != "S0") {
                fail(fmt::format("has a spectral layer \"{}\"", name));
            }
            layer_nm.push_back(channel->wavelength_nm);
        }
        if (layer_nm.empty()) {
            fail("has no spectral layer");
        }
        std::ranges::sort(layer_nm);
        return layer_nm;
    }

    /// Rows of the channels called `names`, pixel by pixel.
    std::vector<float> rows(const std::string& of_film, const std::vector<std::string>& names, int y, int end) {
        const std::string part = prefix_ + of_film;
        const OIIO::ImageSpec spec = seek(part);
        std::vector<float> all(static_cast<std::size_t>(spec.width) * (end - y) * spec.nchannels);
        if (!input_->read_scanlines(*find(part), 0, y, end, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, all.data())) {
            fail(fmt::format("part \"{}\" is damaged ({})", part, formats::on_one_line(input_->geterror())));
        }
        std::vector<float> wanted(static_cast<std::size_t>(spec.width) * (end - y) * names.size());
        for (std::size_t k = 0; k < names.size(); ++k) {
            const int channel = spec.channelindex(names[k]);
            if (channel < 0) {
                fail(fmt::format("part \"{}\" has no channel \"{}\"", part, names[k]));
            }
            for (std::size_t i = 0; i * names.size() < wanted.size(); ++i) {
                wanted[i * names.size() + k] = all[i * spec.nchannels + static_cast<std::size_t>(channel)];
            }
        }
        digest_.add(part, wanted, end - y);
        return wanted;
    }

    std::vector<PixelCounts> count_rows(int y, int end) {
        const std::string part = prefix_ + "samples";
        const OIIO::ImageSpec spec = seek(part);
        std::vector<std::uint32_t> numbers(static_cast<std::size_t>(spec.width) * (end - y) * kCounts.size());
        if (spec.channelnames != kCounts || !input_->read_scanlines(*find(part), 0, y, end, 0, 0, spec.nchannels,
                                                                    OIIO::TypeDesc::UINT32, numbers.data())) {
            fail(fmt::format("part \"{}\" is damaged ({})", part, formats::on_one_line(input_->geterror())));
        }
        digest_.add(part, numbers, end - y);
        std::vector<PixelCounts> counts;
        for (std::size_t i = 0; i < numbers.size(); i += 2) {
            counts.push_back({.samples = numbers[i + 1], .blocks = numbers[i]});
        }
        return counts;
    }

    void read_rows(Film& film, int y, int end) {
        const FilmLayout& layout = film.layout();
        const std::vector<std::string> spectral = spectral_names(layout.layer_nm);
        const std::size_t layers = spectral.size();
        const std::vector<PixelCounts> counts = count_rows(y, end);
        const std::vector<float> rgb = rows("rgb", kRgb, y, end);
        const std::vector<float> variance = rows("variance", kVariance, y, end);
        const std::vector<float> spectrum = rows("spectral", spectral, y, end);
        const std::vector<float> features =
            layout.has_features ? rows("features", kFeatures, y, end) : std::vector<float>();
        const std::vector<float> light =
            layout.has_splats ? rows("light", joined(joined(kRgb, kVariance), spectral), y, end) : std::vector<float>();
        std::vector<double> camera_layers(layers);
        std::vector<double> light_layers(layers);
        const auto vector_at = [](const std::vector<float>& values, std::size_t at) {
            return Vec3d{values[at], values[at + 1], values[at + 2]};
        };
        for (std::size_t i = 0; i < counts.size(); ++i) {
            Film::PixelContent content{.counts = counts[i],
                                       .camera = {vector_at(rgb, 3 * i), vector_at(variance, 3 * i)},
                                       .camera_layers = camera_layers,
                                       .light_layers = light_layers};
            for (std::size_t k = 0; k < layers; ++k) {
                camera_layers[k] = spectrum[i * layers + k];
            }
            if (layout.has_features) {
                content.features = {.depth_mm = features[8 * i],
                                    .albedo_rgb = vector_at(features, 8 * i + 1),
                                    .normal = vector_at(features, 8 * i + 4)};
                content.coverage = features[8 * i + 7];
            }
            if (layout.has_splats) {
                const std::size_t first = i * (6 + layers);
                content.light = {vector_at(light, first), vector_at(light, first + 3)};
                content.camera = {content.camera.rgb - content.light.rgb,
                                  content.camera.variance - content.light.variance};
                for (std::size_t k = 0; k < layers; ++k) {
                    light_layers[k] = light[first + 6 + k];
                    camera_layers[k] -= light_layers[k];
                }
            }
            const auto width = static_cast<std::size_t>(film.width());
            film.set_pixel(static_cast<int>(i % width), y + static_cast<int>(i / width), content);
        }
    }

    std::filesystem::path file_;
    std::unique_ptr<OIIO::ImageInput> input_;
    std::string prefix_;  // of the film that is read
    std::pair<int, int> size_{0, 0};
    PixelDigest digest_;
};

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

FilmFile read_film_exr(const std::filesystem::path& file) {
    return FilmReader(file).read();
}

FilmNotes read_film_notes(const std::filesystem::path& file) {
    return FilmReader(file).read_notes();
}

}  // namespace lensproof::render
