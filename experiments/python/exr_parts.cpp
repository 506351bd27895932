#include "experiments/python/exr_parts.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <memory>

#include "engine/base/input_error.h"
#include "engine/formats/image/picture_file.h"

namespace lensproof::python {

namespace {

std::unique_ptr<OIIO::ImageInput> open_exr(const std::filesystem::path& file) {
    if (formats::picture_form(file) != formats::PictureForm::exr) {
        throw InputError(fmt::format("{}: not an OpenEXR file that can be read", file.string()));
    }
    return formats::open_picture(file, {}).input;
}

bool is_whole(const OIIO::ImageSpec& spec) {
    return spec.format == OIIO::TypeDesc::UINT32;
}

ExrPart part_of(const OIIO::ImageSpec& spec) {
    ExrPart part{.name = std::string(spec.get_string_attribute("oiio:subimagename")),
                 .channels = spec.channelnames,
                 .width = spec.width,
                 .height = spec.height,
                 .is_whole = is_whole(spec),
                 .attributes = {}};
    for (const auto& attribute : spec.extra_attribs) {
        if (attribute.type() == OIIO::TypeString) {
            part.attributes[attribute.name().string()] = attribute.get_string();
        }
    }
    return part;
}

}  // namespace

std::vector<ExrPart> exr_parts(const std::filesystem::path& file) {
    const std::unique_ptr<OIIO::ImageInput> input = open_exr(file);
    std::vector<ExrPart> parts;
    for (int i = 0; input->seek_subimage(i, 0); ++i) {
        parts.push_back(part_of(input->spec()));
    }
    input->geterror();
    return parts;
}

void read_exr_part(const std::filesystem::path& file, int part, std::uint32_t* numbers, std::size_t count) {
    const std::unique_ptr<OIIO::ImageInput> input = open_exr(file);
    if (!input->seek_subimage(part, 0)) {
        throw InputError(fmt::format("{}: has no part {}", file.string(), part + 1));
    }
    const OIIO::ImageSpec& spec = input->spec();
    formats::check_picture_size(file, spec, spec.nchannels, sizeof(float) * static_cast<double>(spec.nchannels));
    if (spec.image_pixels() * static_cast<std::size_t>(spec.nchannels) != count) {
        throw InputError(fmt::format("{}: has changed while it was read", file.string()));
    }
    const OIIO::TypeDesc type = is_whole(spec) ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT;
    if (!input->read_image(part, 0, 0, spec.nchannels, type, numbers)) {
        throw InputError(fmt::format("{}: {}", file.string(), formats::on_one_line(input->geterror())));
    }
}

}  // namespace lensproof::python
