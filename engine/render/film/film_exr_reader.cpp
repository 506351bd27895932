#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/formats/image/picture_file.h"
#include "engine/render/film/film_exr.h"
#include "engine/render/film/film_exr_form.h"

namespace lensproof::render {

namespace {

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

FilmFile read_film_exr(const std::filesystem::path& file) {
    return FilmReader(file).read();
}

FilmNotes read_film_notes(const std::filesystem::path& file) {
    return FilmReader(file).read_notes();
}

}  // namespace lensproof::render
