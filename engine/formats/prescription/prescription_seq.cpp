// CODE V's .seq: what its surfaces, decentres, glass names and zoom positions mean.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/forbes_asphere.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/seq_file.h"
#include "engine/formats/prescription/surface_chain.h"
#include "engine/optics/glass_name.h"

namespace lensproof::formats {

namespace {

/// "NBK7_SCHOTT" is SCHOTT's N-BK7: CODE V leaves out the hyphen behind a maker's letter for glasses of its present
/// line.
std::string catalogue_name(const std::string& stated) {
    const std::size_t underscore = stated.find('_');
    if (underscore == std::string::npos) {
        return stated;
    }
    std::string name = stated.substr(0, underscore);
    const std::string maker = stated.substr(underscore + 1);
    struct Prefix {
        std::string_view maker;
        std::string_view letters;
    };
    constexpr Prefix kPrefixes[] = {{"SCHOTT", "N"}, {"OHARA", "S"}, {"CDGM", "HD"}, {"HIKARI", "JE"}};
    const auto* prefix = std::ranges::find(kPrefixes, maker, &Prefix::maker);
    if (prefix != std::end(kPrefixes) && name.size() > 2 && prefix->letters.find(name[0]) != std::string_view::npos &&
        std::isalpha(static_cast<unsigned char>(name[1]))) {
        name.insert(1, "-");
    }
    return maker + " " + name;
}

/// n_d and V_d from CODE V's codes. It writes no density: behind six digits and a point stands V_d, and a zero more
/// says so where there are three digits of it.
std::optional<optics::GlassCode> glass_code(const std::string& glass) {
    constexpr std::size_t kDigits = 6;
    const bool looks_dense = glass.find('.') == kDigits && glass.size() == kDigits + 4;
    return optics::parse_glass_code(looks_dense ? glass + "0" : glass);
}

/// The medium behind a surface; `where` is its place in the file.
optics::StatedMedium read_medium(const SeqFile& file, const std::string& glass, const std::string& where) {
    optics::StatedMedium medium;
    if (glass.empty() || glass == "AIR") {
        return medium;
    }
    const std::size_t colon = glass.find(':');
    const std::optional<double> n_d = parse_number(glass.substr(0, colon));
    if (const auto own = file.private_glasses.find(glass); own != file.private_glasses.end()) {
        medium.indices = own->second;
    } else if (const std::optional<optics::GlassCode> code = glass_code(glass)) {
        medium.n_d = code->n_d;
        medium.V_d = code->V_d;
    } else if (n_d) {
        medium.n_d = n_d;
        medium.V_d = colon == std::string::npos ? std::nullopt : parse_number(glass.substr(colon + 1));
        if (colon != std::string::npos && !medium.V_d) {
            throw InputError(fmt::format("{}: its glass is \"{}\", expected n_d:V_d", where, printable(glass)));
        }
    } else {
        medium.glass = catalogue_name(glass);
    }
    return medium;
}

/// A special surface's conic constant, normalizing radius (in the file's unit, 0: none) and terms, in the order of
/// their powers.
struct SpecialTerms {
    std::optional<double> conic;
    double radius = 0.0;
    std::vector<double> a;
};

/// As many terms as fit into the powers to r^20.
SpecialTerms special_terms(const SeqSpecial& special, const SeqSurface& surface, int number, Remarks& remarks) {
    SpecialTerms terms;
    terms.a.resize(static_cast<std::size_t>((optics::kHighestPower - special.first_power) / special.step) + 1);
    for (const auto& [index, value] : surface.special_values) {
        const int term = index - special.first_number;
        if (index == special.conic) {
            terms.conic = value;
        } else if (index == special.radius) {
            terms.radius = value;
        } else if (term >= 0 && term < static_cast<int>(terms.a.size())) {
            terms.a[term] = value;
        } else if (value != 0.0) {
            remarks.add("surface-type", optics::Severity::error, number,
                        fmt::format("line {}, surface {} of the file: the coefficient C{} = {} of the special surface "
                                    "{} is left out: powers to r^{} are known",
                                    surface.line, number, index, value, special.name, optics::kHighestPower));
        }
    }
    return terms;
}

/// The odd polynomial's terms are those of (r / R)^j, for which a radius R of 0 says 1; Forbes's need one.
void read_special(optics::PrescribedSurface& row, const SeqSpecial& special, const SeqSurface& surface, int number,
                  double unit_mm, Remarks& remarks) {
    SpecialTerms terms = special_terms(special, surface, number, remarks);
    row.conic = terms.conic.value_or(row.conic);
    if (special.name == "ODD") {
        const double radius = terms.radius == 0.0 ? 1.0 : terms.radius;
        for (int power = 1; power <= optics::kHighestPower; ++power) {
            row.term(power) = terms.a[power - 1] * std::pow(unit_mm, 1 - power) / std::pow(radius, power);
        }
        return;
    }
    if (!(terms.radius > 0.0)) {
        throw InputError(
            fmt::format("{}: the special surface {} has the normalizing radius {}, expected SCO NRADIUS "
                        "and a length",
                        row.where, special.name, terms.radius));
    }
    std::ranges::transform(terms.a, terms.a.begin(), [&](double a) { return a * unit_mm; });
    row.along_normal = special.name == "QBF";
    row.asphere = row.along_normal ? powers_of_qbfs(terms.a, terms.radius * unit_mm)
                                   : powers_of_qcon(terms.a, terms.radius * unit_mm);
}

optics::PrescribedSurface read_row(const SeqFile& file, int number, const std::filesystem::path& path,
                                   Remarks& remarks) {
    const SeqSurface& surface = file.surfaces[number];
    const double unit = file.unit_mm;
    const auto radius = [unit](double curvature) { return curvature == 0.0 ? kInfinity : unit / curvature; };
    const auto length = [unit](std::optional<double> value) {
        return value ? std::optional(*value * unit) : std::nullopt;
    };
    optics::PrescribedSurface row;
    row.where = fmt::format("{}:{}: S{}", path.string(), surface.line, number);
    row.is_stop = surface.is_stop;
    row.radius_mm = radius(surface.curvature);
    if (surface.type == "CYL" || surface.type == "YTO") {
        row.radius_x_mm = radius(surface.curvature_x);
    } else if (surface.type == "XTO") {  // the frame is turned by 90° about z for it
        row.radius_mm = radius(surface.curvature_x);
        row.radius_x_mm = radius(surface.curvature);
    }
    row.conic = surface.conic;
    for (int term = 0; term < optics::kAsphereTerms; ++term) {
        row.asphere[term] = surface.asphere[term] * std::pow(unit, 1 - 2 * (term + 1));
    }
    if (const SeqSpecial* const special = find_special(surface.special)) {
        read_special(row, *special, surface, number, unit, remarks);
    }
    row.phase = surface.kinoform;
    for (int i = 0; row.phase && i < optics::kPhaseTerms; ++i) {
        row.phase->radial[i] *= std::pow(unit, 1 - 2 * (i + 1));
    }
    row.thickness_mm = surface.thickness * unit;
    row.semi_diameter_mm = length(surface.semi_diameter);
    if (surface.edge && surface.edge > surface.semi_diameter.value_or(0.0)) {
        row.rim_mm = length(surface.edge);
    }
    row.medium = read_medium(file, surface.glass, row.where);
    row.is_mirror = surface.is_mirror;
    return row;
}

/// The frames of all surfaces but the object. Decentres come before tilts; ADE and BDE count by the left-hand rule, CDE
/// by the right-hand rule (CODE V Reference Manual, "Tilts and decenters").
std::vector<ChainLink> chain_of(const SeqFile& file, const std::filesystem::path& path) {
    const auto is_displaced = [](const SeqSurface& surface) {
        return surface.decentre != std::array<double, 3>{} || surface.tilt_deg != std::array<double, 3>{};
    };
    const bool has_displaced = std::ranges::any_of(file.surfaces, is_displaced);
    std::vector<ChainLink> links;
    optics::Frame frame;
    for (std::size_t number = 1; number < file.surfaces.size(); ++number) {
        const SeqSurface& surface = file.surfaces[number];
        const double thickness = surface.thickness * file.unit_mm;
        const double unit = file.unit_mm;
        const Vec3d decentre{surface.decentre[0] * unit, surface.decentre[1] * unit, surface.decentre[2] * unit};
        const std::array<double, 3> tilt = {-surface.tilt_deg[0], -surface.tilt_deg[1], surface.tilt_deg[2]};
        optics::Frame own = frame;
        if (is_displaced(surface)) {
            if (!links.empty()) {
                links.back().straight = false;
            }
            if (surface.decentre_kind == SeqDecentre::reverse) {
                frame = frame.turned(2, -tilt[2]).turned(1, -tilt[1]).turned(0, -tilt[0]).shifted(-1.0 * decentre);
            } else {
                own = frame.shifted(decentre).tilted(tilt);
                if (surface.decentre_kind != SeqDecentre::restore) {
                    frame = surface.decentre_kind == SeqDecentre::bend ? own.tilted(tilt) : own;
                }
            }
        }
        if (surface.type == "XTO") {
            own = own.turned(2, 90.0);
        }
        links.push_back({.frame = own, .thickness_mm = thickness, .straight = !is_displaced(surface)});
        if (has_displaced && number + 1 < file.surfaces.size()) {
            if (!std::isfinite(thickness + decentre.x + decentre.y + decentre.z + tilt[0] + tilt[1] + tilt[2])) {
                throw InputError(
                    fmt::format("{}:{}: S{}: decentres cannot be followed over a length that is not "
                                "finite",
                                path.string(), surface.line, number));
            }
            frame = frame.shifted({0.0, 0.0, thickness});
        }
    }
    if (!file.has_image) {  // the sensor lies behind the last surface
        links.push_back({.frame = frame.shifted({0.0, 0.0, links.back().thickness_mm})});
    }
    return links;
}

constexpr double kFarthest = 1e10;  // the program's infinity

double object_distance_mm(const SeqFile& file) {
    const double thickness = file.surfaces.front().thickness;
    return thickness >= kFarthest ? kInfinity : thickness * file.unit_mm;
}

/// CODE V Reference Manual, "System data": FNO and NA are those of the image as it is used.
optics::SystemAperture system_aperture(const SeqFile& file, const std::string& type, double value) {
    using optics::ApertureKind;
    const bool is_far = std::isinf(object_distance_mm(file));
    if (!(value > 0.0)) {
        return {};
    }
    if (type == "EPD") {
        return {ApertureKind::entrance_pupil_diameter, value * file.unit_mm};
    }
    if (type == "FNO" || type == "NA") {
        return {is_far ? ApertureKind::f_number : ApertureKind::working_f_number, type == "NA" ? 0.5 / value : value};
    }
    return type == "NAO" && !is_far ? optics::SystemAperture{ApertureKind::object_numerical_aperture, value}
                                    : optics::SystemAperture{};
}

/// A file has one kind of fields. Vignetting factors cut the pupil from −1 + VLY to 1 − VUY.
void read_fields(const SeqFile& file, optics::Prescription& prescription) {
    using optics::FieldKind;
    struct Kind {
        const char* x;
        const char* y;
        FieldKind kind;
    };
    constexpr Kind kKinds[] = {{"XAN", "YAN", FieldKind::angle},
                               {"XOB", "YOB", FieldKind::object_height},
                               {"XIM", "YIM", FieldKind::paraxial_image_height},
                               {"XRI", "YRI", FieldKind::image_height}};
    const auto at = [&](const char* command, std::size_t i) {
        const auto found = file.fields.find(command);
        return found != file.fields.end() && i < found->second.size() ? found->second[i] : 0.0;
    };
    const auto count_of = [&](const char* command) {
        const auto found = file.fields.find(command);
        return found == file.fields.end() ? 0 : found->second.size();
    };
    for (const Kind& kind : kKinds) {
        const std::size_t count = std::max(count_of(kind.x), count_of(kind.y));
        if (count == 0) {
            continue;
        }
        const double unit = kind.kind == FieldKind::angle ? 1.0 : file.unit_mm;
        optics::DesignFields fields{.kind = kind.kind, .points = {}, .vignetting = {}};
        for (std::size_t i = 0; i < count; ++i) {
            const Vec2d upper{at("VUX", i), at("VUY", i)};
            const Vec2d lower{at("VLX", i), at("VLY", i)};
            fields.points.push_back({unit * at(kind.x, i), unit * at(kind.y, i)});
            fields.vignetting.push_back({.decentre = 0.5 * (lower - upper), .compression = 0.5 * (lower + upper)});
        }
        take_fields(prescription, std::move(fields));
        return;
    }
}

/// CIR and CIR EDG on the stop are what drawings show, the aperture what the stop opens to.
void free_stop(optics::Prescription& prescription) {
    const auto stop = std::ranges::find_if(prescription.surfaces, &optics::PrescribedSurface::is_stop);
    if (prescription.aperture.kind != optics::ApertureKind::stop && stop != prescription.surfaces.end()) {
        stop->semi_diameter_mm.reset();
        stop->rim_mm.reset();
    }
}

/// Without STO the first surface is the stop, as CODE V has it.
void choose_stop(optics::Prescription& prescription, Remarks& remarks) {
    if (std::ranges::none_of(prescription.surfaces, &optics::PrescribedSurface::is_stop)) {
        prescription.surfaces.front().is_stop = true;
        remarks.add("stop", optics::Severity::warning, 1, "no STO says which surface is the stop; the first is taken");
    }
}

/// The object, the image and its defocus.
void read_ends(const SeqFile& file, const std::vector<ChainLink>& links, optics::Prescription& prescription,
               Remarks& remarks) {
    const SeqSurface& object = file.surfaces.front();
    prescription.object_distance_mm = object_distance_mm(file);
    if (object.curvature != 0.0) {
        remarks.add("object-shape", optics::Severity::warning, 0,
                    fmt::format("line {}: the object is curved, and taken as flat", object.line));
    }
    if (!is_upright(links.back().frame)) {
        remarks.add("image-tilt", optics::Severity::warning, 0,
                    "the image is tilted against the first surface's axis; the sensor is taken as perpendicular to it");
    }
    if (!file.has_image) {
        remarks.add("image", optics::Severity::info, 0,
                    "no SI line; the sensor is taken behind the last surface's thickness");
        return;
    }
    const SeqSurface& image = file.surfaces.back();
    if (image.curvature != 0.0 || image.type != "SPH") {
        remarks.add("image-shape", optics::Severity::warning, 0,
                    fmt::format("line {}: the image is not flat; the sensor is taken as flat", image.line));
    }
}

/// The rows in their places; the sensor stands off the image by its defocus, SI's thickness.
std::vector<optics::PrescribedSurface> placed(std::vector<optics::PrescribedSurface> rows, const SeqFile& file,
                                              const std::filesystem::path& path) {
    std::vector<ChainLink> links = chain_of(file, path);
    unfold(rows, links);
    place_rows(rows, links);
    if (file.has_image && file.surfaces.back().thickness != 0.0) {
        rows.back().thickness_mm += file.surfaces.back().thickness * file.unit_mm;
    }
    return rows;
}

void read_zoom(const SeqFile& file, const std::vector<optics::PrescribedSurface>& rows,
               optics::Prescription& prescription, Remarks& remarks) {
    if (file.zoom_positions == 1) {
        return;
    }
    SeqFile varied = file;
    std::vector<PrescriptionTable> tables;
    for (int i = 0; i < file.zoom_positions; ++i) {
        const auto at = static_cast<std::size_t>(i);
        for (const auto& [surface, values] : file.zoomed_thicknesses) {
            varied.surfaces[surface].thickness = values[std::min(at, values.size() - 1)];
        }
        tables.push_back(placed(rows, varied, prescription.file));
        optics::ZoomPosition position{.name = at < file.zoom_titles.size() ? file.zoom_titles[at]
                                                                           : fmt::format("position {}", i + 1)};
        for (const auto& [type, values] : file.zoomed_apertures) {
            position.aperture = system_aperture(file, type, values[std::min(at, values.size() - 1)]);
        }
        prescription.zoom.push_back(std::move(position));
    }
    for (const int row : take_zoom_gaps(prescription, tables)) {
        remarks.add(
            "multi-configuration", optics::Severity::warning, row,
            fmt::format("the decentre of surface {} differs between the zoom positions, which is left out", row));
    }
}

}  // namespace

optics::Prescription parse_seq(const std::string& text, const std::filesystem::path& file) {
    Remarks remarks;
    const SeqFile seq = read_seq_file(to_utf8(text), file, remarks);
    optics::Prescription prescription = prescription_of(file);
    prescription.name = seq.title.empty() ? prescription.name : seq.title;
    const int rows = static_cast<int>(seq.surfaces.size()) - (seq.has_image ? 1 : 0);
    std::vector<int> row_of = {0};
    for (int number = 1; number < rows; ++number) {
        prescription.surfaces.push_back(read_row(seq, number, file, remarks));
        row_of.push_back(number);
    }
    prescription.object_medium = read_medium(seq, seq.surfaces.front().glass, file.string() + ": SO");
    optics::set_mirror_media(prescription.surfaces, prescription.object_medium);
    if (prescription.surfaces.empty()) {
        throw InputError(fmt::format("{}: holds no surface between object and image", file.string()));
    }
    const std::vector<optics::PrescribedSurface> table = prescription.surfaces;
    std::vector<ChainLink> links = chain_of(seq, file);
    name_folds(unfold(prescription.surfaces, links), prescription.surfaces, remarks);
    prescription.surfaces = placed(table, seq, file);
    prescription.aperture = system_aperture(seq, seq.aperture_type, seq.aperture_value);
    choose_stop(prescription, remarks);
    free_stop(prescription);
    read_fields(seq, prescription);
    read_ends(seq, links, prescription, remarks);
    read_zoom(seq, table, prescription, remarks);
    prescription.wavelengths_nm = seq.wavelengths_nm;
    const auto reference = static_cast<std::size_t>(seq.reference_wavelength);
    if (reference <= prescription.wavelengths_nm.size()) {
        const auto first = prescription.wavelengths_nm.begin();
        std::rotate(first, first + seq.reference_wavelength - 1, first + seq.reference_wavelength);
    }
    prescription.remarks = remarks.renumbered(row_of);
    return prescription;
}

}  // namespace lensproof::formats
