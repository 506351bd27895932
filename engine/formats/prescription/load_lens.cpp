#include "engine/formats/prescription/load_lens.h"

#include <algorithm>
#include <iterator>
#include <memory>

#include "engine/base/file.h"
#include "engine/formats/glass/glass_file.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/image/image.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/formats/prescription/shipped_coatings.h"

namespace lensproof::formats {

optics::ApertureTexture read_aperture_texture(const std::filesystem::path& file) {
    const Image image = read_image(file);
    optics::ApertureTexture texture{.size_x = image.width, .size_y = image.height, .values = {}};
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            float sum = 0.0F;
            for (int channel = 0; channel < image.channel_count(); ++channel) {
                sum += image.at(x, y, channel);
            }
            texture.values.push_back(std::clamp(sum / static_cast<float>(image.channel_count()), 0.0F, 1.0F));
        }
    }
    return texture;
}

optics::GlassCatalogue with_own_catalogues(optics::GlassCatalogue glasses, const optics::Prescription& prescription) {
    for (const std::filesystem::path& file : prescription.catalogues) {
        glasses.add(read_glass_file(file).glasses);
    }
    glasses.add(prescription.enclosed_glasses);
    return glasses;
}

optics::Prescription with_stop_picture(optics::Prescription prescription) {
    if (auto* textured = std::get_if<optics::TexturedStop>(&prescription.stop_shape)) {
        textured->texture = std::make_shared<const optics::ApertureTexture>(
            read_aperture_texture(referred_file(prescription.file, textured->image)));
    }
    return prescription;
}

static std::string found_beside(const TomlTable& table, const std::string& lens) {
    if (lens.find_first_of("./") == std::string::npos) {  // no lens that ships has such a name
        return lens;
    }
    const std::filesystem::path beside = std::filesystem::path(table.file()).parent_path() / lens;
    std::error_code ignored;
    const std::filesystem::path file =
        std::filesystem::is_regular_file(beside, ignored) ? beside : std::filesystem::path(lens);
    check_reference(table.file(), file);
    return file.string();
}

std::string read_lens_name(TomlTable& table) {
    return found_beside(table, table.text("lens"));
}

std::vector<std::string> read_lens_names(TomlTable& table) {
    if (table.is_text("lens")) {
        return {read_lens_name(table)};
    }
    std::vector<std::string> lenses;
    std::ranges::transform(table.texts("lens"), std::back_inserter(lenses),
                           [&](const std::string& lens) { return found_beside(table, lens); });
    return lenses;
}

optics::Lens with_transmittance(optics::Lens lens) {
    for (optics::LensSurface& surface : lens.surfaces) {
        surface.medium.internal_transmittance = shipped_transmittance(surface.medium);
    }
    return lens;
}

optics::Lens load_lens(const std::string& lens, const LensSettings& settings) {
    optics::Prescription prescription =
        with_coatings(with_stop_picture(read_prescription(find_lens_file(lens))), settings.coatings);
    const std::size_t position = settings.zoom.empty() ? 0 : optics::find_zoom_position(prescription, settings.zoom);
    prescription = optics::at_zoom_position(std::move(prescription), position);
    const optics::GlassCatalogue& glasses = settings.glasses ? *settings.glasses : shipped_glasses();
    const bool has_own = !prescription.catalogues.empty() || !prescription.enclosed_glasses.empty();
    return with_transmittance(
        has_own ? optics::make_lens(prescription, with_own_catalogues(glasses, prescription), settings.indices)
                : optics::make_lens(prescription, glasses, settings.indices));  // thousands are not copied
}

}  // namespace lensproof::formats
