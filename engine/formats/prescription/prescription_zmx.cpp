// Zemax's .zmx, sequential: what its surfaces, breaks and configurations mean.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/glass/glass_file.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/surface_chain.h"
#include "engine/formats/prescription/zar_archive.h"
#include "engine/formats/prescription/zmx_file.h"
#include "engine/formats/prescription/zmx_shape.h"

namespace lensproof::formats {

namespace {

optics::PrescribedSurface read_row(const ZmxFile& file, int number, const std::filesystem::path& path,
                                   Remarks& remarks) {
    const ZmxSurface& surface = file.surfaces[number];
    const double unit = file.unit_mm;
    const auto length = [unit](std::optional<double> value) {
        return value ? std::optional(*value * unit) : std::nullopt;
    };
    optics::PrescribedSurface row;
    row.where = fmt::format("{}:{}: SURF {}", path.string(), surface.line, number);
    row.is_stop = surface.is_stop;
    if (surface.curvature != 0.0) {
        row.radius_mm = unit / surface.curvature;
    }
    row.conic = surface.conic;
    read_zmx_shape(row, surface, number, unit, remarks);
    row.thickness_mm = surface.thickness * unit;
    row.semi_diameter_mm = length(surface.aperture ? surface.aperture : surface.semi_diameter);
    if (surface.mechanical && surface.mechanical > surface.semi_diameter.value_or(0.0)) {
        row.rim_mm = length(surface.mechanical);
    }
    row.medium = surface.medium;
    row.is_mirror = surface.is_mirror;
    return row;
}

/// A coordinate break (OpticStudio's help, "Coordinate Break", "Tilt/Decenter"): decentres x and y, then tilts about x,
/// the turned y and the twice turned z, each by the right-hand rule; with the order flag set, the tilts in reverse
/// order, then the decentres in the turned coordinates.
optics::Frame broken(const optics::Frame& frame, const ZmxSurface& surface, double unit_mm) {
    const Vec3d decentre{surface.parameter(1) * unit_mm, surface.parameter(2) * unit_mm, 0.0};
    const std::array<double, 3> tilt = {surface.parameter(3), surface.parameter(4), surface.parameter(5)};
    if (surface.parameter(6) == 0.0) {
        return frame.shifted(decentre).tilted(tilt);
    }
    return frame.turned(2, tilt[2]).turned(1, tilt[1]).turned(0, tilt[0]).shifted(decentre);
}

/// The frames of all surfaces but the object and the breaks.
std::vector<ChainLink> chain_of(const ZmxFile& file, const std::filesystem::path& path) {
    const bool has_breaks = std::ranges::any_of(file.surfaces, &ZmxSurface::is_break);
    std::vector<ChainLink> links;
    optics::Frame frame;
    for (std::size_t number = 1; number < file.surfaces.size(); ++number) {
        const ZmxSurface& surface = file.surfaces[number];
        const double thickness = surface.thickness * file.unit_mm;
        if (surface.is_break()) {
            frame = broken(frame, surface, file.unit_mm);
            if (!links.empty()) {
                links.back().straight = false;
            }
        } else {
            links.push_back({.frame = frame, .thickness_mm = thickness});
        }
        if (has_breaks && number + 1 < file.surfaces.size()) {
            const Vec3d& origin = frame.origin;
            if (!std::isfinite(thickness) || !std::isfinite(origin.x + origin.y + origin.z)) {
                throw InputError(
                    fmt::format("{}:{}: SURF {}: coordinate breaks cannot be followed over a length that "
                                "is not finite",
                                path.string(), surface.line, number));
            }
            frame = frame.shifted({0.0, 0.0, thickness});
        }
    }
    return links;
}

/// Of every surface of the file the row it became, from 1; 0 for the object and the image. A break counts as the
/// surface behind it.
std::vector<int> rows_of_surfaces(const ZmxFile& file) {
    std::vector<int> rows = {0};
    int row = 1;
    for (std::size_t number = 1; number + 1 < file.surfaces.size(); ++number) {
        rows.push_back(row);
        row += file.surfaces[number].is_break() ? 0 : 1;
    }
    rows.push_back(0);
    return rows;
}

/// OpticStudio's help, "System Explorer", "Aperture": the image-space f-number is for an object at infinity whatever
/// the lens's is, the paraxial working one is not.
optics::SystemAperture system_aperture(const ZmxFile& file, double value) {
    using optics::ApertureKind;
    if (!(value > 0.0)) {
        return {};
    }
    if (file.aperture_type == "ENPD") {
        return {ApertureKind::entrance_pupil_diameter, value * file.unit_mm};
    }
    if (file.aperture_type == "FNUM") {
        return {file.is_working_f_number ? ApertureKind::working_f_number : ApertureKind::f_number, value};
    }
    if (file.aperture_type == "OBNA" && std::isfinite(file.surfaces.front().thickness)) {
        return {ApertureKind::object_numerical_aperture, value};
    }
    return {};
}

/// The stop's DIAM is what Zemax computed from the aperture, unless that is FLOA. Where it is a user's own it cuts
/// beams at surfaces of power alone, as an aperture does anywhere. MEMA follows DIAM, and cuts none.
void free_stop(const ZmxFile& file, const std::vector<int>& rows, optics::Prescription& prescription) {
    if (prescription.aperture.kind == optics::ApertureKind::stop) {
        return;
    }
    for (std::size_t number = 1; number + 1 < file.surfaces.size(); ++number) {
        const ZmxSurface& surface = file.surfaces[number];
        if (surface.is_stop && !surface.is_break()) {
            const bool cuts = surface.aperture || (surface.semi_diameter_is_fixed && surface.curvature != 0.0);
            optics::PrescribedSurface& row = prescription.surfaces[rows[number] - 1];
            if (!cuts) {
                row.semi_diameter_mm.reset();
                row.rim_mm.reset();
            }
        }
    }
}

/// OpticStudio writes no file without a STOP; other programs do.
void choose_stop(ZmxFile& file, Remarks& remarks) {
    if (file.surfaces.size() > 2 && std::ranges::none_of(file.surfaces, &ZmxSurface::is_stop)) {
        const auto first = std::find_if_not(file.surfaces.begin() + 1, file.surfaces.end() - 1,
                                            [](const ZmxSurface& each) { return each.is_break(); });
        first->is_stop = true;
        remarks.add("stop", optics::Severity::warning, static_cast<int>(first - file.surfaces.begin()),
                    "no STOP says which surface is the stop; the first is taken");
    }
}

void read_fields(const ZmxFile& file, optics::Prescription& prescription, Remarks& remarks) {
    using optics::FieldKind;
    static constexpr FieldKind kKinds[] = {FieldKind::angle, FieldKind::object_height, FieldKind::paraxial_image_height,
                                           FieldKind::image_height};
    if (file.field_type < 0 || file.field_type >= static_cast<int>(std::size(kKinds))) {
        remarks.add(
            "fields", optics::Severity::info, 0,
            fmt::format("fields are stated as {} (FTYP {}), and left out",
                        file.field_type == 4 ? "theodolite angles" : "a kind that is not known", file.field_type));
        return;
    }
    optics::DesignFields fields{.kind = kKinds[file.field_type], .points = {}, .vignetting = {}};
    std::size_t count = std::max(file.field_x.size(), file.field_y.size());
    count = file.fields > 0 ? std::min(count, static_cast<std::size_t>(file.fields)) : count;
    const double unit = fields.kind == FieldKind::angle ? 1.0 : file.unit_mm;
    const auto at = [](const std::vector<double>& values, std::size_t i) {
        return i < values.size() ? values[i] : 0.0;
    };
    const auto factor = [&](const char* keyword, std::size_t i) {
        const auto found = file.vignetting.find(keyword);
        return found == file.vignetting.end() ? 0.0 : at(found->second, i);
    };
    for (std::size_t i = 0; i < count; ++i) {
        fields.points.push_back({unit * at(file.field_x, i), unit * at(file.field_y, i)});
        fields.vignetting.push_back({.decentre = {factor("VDXN", i), factor("VDYN", i)},
                                     .compression = {factor("VCXN", i), factor("VCYN", i)}});
    }
    take_fields(prescription, std::move(fields));
}

std::vector<double> wavelengths_nm(const ZmxFile& file) {
    constexpr double kDigits = 1e6;  // of a nanometre
    std::vector<double> wavelengths;
    for (const auto& [index, um] : file.wavelengths_um) {
        if (file.wavelengths != 0 && index > file.wavelengths) {
            break;  // beyond those in use Zemax writes place-holders
        }
        const double nm = std::round(um * 1e3 * kDigits) / kDigits;
        if (index == file.reference_wavelength) {
            wavelengths.insert(wavelengths.begin(), nm);
        } else {
            wavelengths.push_back(nm);
        }
    }
    return wavelengths;
}

void read_names(const ZmxFile& file, optics::Prescription& prescription) {
    constexpr std::string_view kSource = "Source: ";
    prescription.name = file.name.empty() ? prescription.name : file.name;
    for (const std::string& note : file.notes) {
        if (note.starts_with(kSource)) {
            prescription.source = note.substr(kSource.size());
        } else {
            prescription.notes += (prescription.notes.empty() ? "" : "\n") + note;
        }
    }
}

/// What the object and the image say that a table has no row for.
void read_ends(const ZmxFile& file, const std::vector<ChainLink>& links, optics::Prescription& prescription,
               Remarks& remarks) {
    const ZmxSurface& object = file.surfaces.front();
    const ZmxSurface& image = file.surfaces.back();
    const int image_number = static_cast<int>(file.surfaces.size()) - 1;
    prescription.object_distance_mm = object.thickness * file.unit_mm;
    if (object.curvature != 0.0) {
        remarks.add("object-shape", optics::Severity::warning, 0,
                    fmt::format("line {}: the object is curved, and taken as flat", object.line));
    }
    if (image.curvature != 0.0 || image.type != "STANDARD") {
        remarks.add("image-shape", optics::Severity::warning, 0,
                    fmt::format("line {}: the image surface {} is not flat; the sensor is taken as flat", image.line,
                                image_number));
    }
    if (!is_upright(links.back().frame)) {
        remarks.add("image-tilt", optics::Severity::warning, 0,
                    fmt::format("line {}: the image surface {} is tilted against the first surface's axis; the sensor "
                                "is taken as perpendicular to it",
                                image.line, image_number));
    }
    if (image.semi_diameter_is_fixed && !prescription.stated.image_circle_mm) {
        prescription.stated.image_circle_mm = 2.0 * *image.semi_diameter * file.unit_mm;
    }
}

/// The gaps of each configuration: the file's with its thicknesses, `rows` placed anew.
void read_configurations(const ZmxFile& file, const std::vector<optics::PrescribedSurface>& rows,
                         optics::Prescription& prescription, Remarks& remarks) {
    if (file.configurations == 1) {
        return;
    }
    const int last = static_cast<int>(file.surfaces.size()) - 1;
    std::set<std::string> left_out;
    std::vector<PrescriptionTable> tables;
    for (int configuration = 1; configuration <= file.configurations; ++configuration) {
        ZmxFile varied = file;
        optics::ZoomPosition position{.name = fmt::format("configuration {}", configuration)};
        for (const auto& [operand, values] : file.operands) {
            const auto& [keyword, of] = operand;
            const auto value = values.find(configuration);
            if (keyword == "THIC" && of >= 1 && of < last) {
                varied.surfaces[of].thickness = value == values.end() ? varied.surfaces[of].thickness : value->second;
            } else if (keyword == "APER" && value != values.end()) {
                position.aperture = system_aperture(file, value->second);
            } else {
                left_out.insert(fmt::format("{} {}", keyword, of));
            }
        }
        tables.push_back(rows);
        std::vector<ChainLink> links = chain_of(varied, prescription.file);
        unfold(tables.back(), links);
        place_rows(tables.back(), links);
        prescription.zoom.push_back(std::move(position));
    }
    for (const int row : take_zoom_gaps(prescription, tables)) {
        left_out.insert(fmt::format("the decentre of row {}", row));
    }
    if (!left_out.empty()) {
        remarks.add("multi-configuration", optics::Severity::warning, 0,
                    fmt::format("of what differs between the {} configurations, this is left out: {}",
                                file.configurations, fmt::join(left_out, ", ")));
    }
}

/// A lens whose light leaves parallel has its image at infinity, where no sensor is: none is stated.
void take_image_from_infinity(ZmxFile& file, Remarks& remarks) {
    const int last = static_cast<int>(file.surfaces.size()) - 2;
    if (last > 0 && std::isinf(file.surfaces[last].thickness)) {
        file.surfaces[last].thickness = 0.0;
        remarks.add("image-at-infinity", optics::Severity::info, last,
                    fmt::format("line {}: the image lies at infinity; the table is taken as stating no image plane",
                                file.surfaces[last].line));
    }
}

}  // namespace

optics::Prescription parse_zmx(const std::string& text, const std::filesystem::path& file) {
    Remarks remarks;
    ZmxFile zmx = read_zmx_file(to_utf8(text), file, remarks);
    choose_stop(zmx, remarks);
    take_image_from_infinity(zmx, remarks);
    optics::Prescription prescription = prescription_of(file);
    read_names(zmx, prescription);
    const int image = static_cast<int>(zmx.surfaces.size()) - 1;
    for (int number = 1; number < image; ++number) {
        if (!zmx.surfaces[number].is_break()) {
            prescription.surfaces.push_back(read_row(zmx, number, file, remarks));
        } else if (zmx.surfaces[number].is_stop) {
            remarks.not_understood("STOP", number, zmx.surfaces[number].line, "the stop on a coordinate break");
        }
    }
    prescription.object_medium = zmx.surfaces.front().medium;
    optics::set_mirror_media(prescription.surfaces, prescription.object_medium);
    if (prescription.surfaces.size() > kMostSurfaces) {
        throw InputError(fmt::format("{}: holds a lens of {} surfaces, expected up to {}", file.string(),
                                     prescription.surfaces.size(), kMostSurfaces));
    }
    if (prescription.surfaces.empty() || zmx.surfaces.back().is_break()) {
        throw InputError(
            fmt::format("{}: holds {} surfaces, expected an object, a lens and an image that is no "
                        "coordinate break",
                        file.string(), zmx.surfaces.size()));
    }
    const std::vector<optics::PrescribedSurface> rows = prescription.surfaces;
    std::vector<ChainLink> links = chain_of(zmx, file);
    name_folds(unfold(prescription.surfaces, links), prescription.surfaces, remarks);
    place_rows(prescription.surfaces, links);
    for (std::size_t i = 0; i < prescription.surfaces.size(); ++i) {
        if (prescription.surfaces[i].is_stop && !is_upright(links[i].frame)) {
            remarks.add_once("", "stop-tilt", optics::Severity::info, 0,
                             fmt::format("{}: the stop is tilted against the axis", prescription.surfaces[i].where));
        }
    }
    prescription.aperture = system_aperture(zmx, zmx.aperture_value);
    free_stop(zmx, rows_of_surfaces(zmx), prescription);
    read_fields(zmx, prescription, remarks);
    read_ends(zmx, links, prescription, remarks);
    read_configurations(zmx, rows, prescription, remarks);
    prescription.wavelengths_nm = wavelengths_nm(zmx);
    prescription.preferred_makers = zmx.catalogues;
    prescription.figures_are_spare = true;  // Zemax takes a name's glass from its catalogue, whatever stands beside it
    prescription.remarks = remarks.renumbered(rows_of_surfaces(zmx));
    return prescription;
}

optics::Prescription parse_zar(const std::string& bytes, const std::filesystem::path& file) {
    constexpr std::size_t kMostCatalogues = 20;
    std::vector<ZarMember> lenses;
    std::vector<ZarMember> catalogues;
    for (ZarMember& member : zar_members(bytes, file)) {
        const std::string extension = lower_extension(member.name);
        if (extension == ".zmx" || extension == ".agf") {
            (extension == ".zmx" ? lenses : catalogues).push_back(std::move(member));
        }
    }
    if (lenses.size() != 1 || catalogues.size() > kMostCatalogues) {
        std::vector<std::string> names;
        std::ranges::transform(lenses, std::back_inserter(names),
                               [](const ZarMember& lens) { return printable(lens.name); });
        throw InputError(fmt::format(
            "{}: holds {} lenses{}{} and {} glass catalogues, expected one .zmx and up to {} .agf", file.string(),
            names.size(), names.empty() ? "" : ": ", fmt::join(names, ", "), catalogues.size(), kMostCatalogues));
    }
    optics::Prescription prescription = parse_zmx(unpacked(lenses.front(), file), file);
    for (const ZarMember& catalogue : catalogues) {
        try {
            std::ranges::move(parse_agf(unpacked(catalogue, file), file / catalogue.name).glasses,
                              std::back_inserter(prescription.enclosed_glasses));
        } catch (const InputError& error) {
            prescription.remarks.push_back({"not-read", optics::Severity::warning, 0,
                                            fmt::format("a glass catalogue is left out: {}", error.what())});
        }
    }
    return prescription;
}

}  // namespace lensproof::formats
