// The project's own form: read here key by key, written so that the surfaces stand as a table. lenses/README.md
// describes it for those who write one.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/toml.h"
#include "engine/formats/prescription/barrel_toml.h"
#include "engine/formats/prescription/coating_toml.h"
#include "engine/formats/prescription/forbes_asphere.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/shipped_coatings.h"

namespace lensproof::formats {

namespace {

/// A number as it stands, NaN and infinities included: whether it makes sense is for the checker to say.
double stated_number(TomlTable& table, const std::string& key) {
    return table.any_number(key);
}

std::optional<double> optional_stated_number(TomlTable& table, const std::string& key) {
    return table.has(key) ? std::optional(stated_number(table, key)) : std::nullopt;
}

template <std::size_t count>
std::array<double, count> numbers_or_zero(TomlTable& table, const std::string& key) {
    std::array<double, count> values{};
    if (table.has(key)) {
        std::ranges::copy(table.numbers(key, count), values.begin());
    }
    return values;
}

optics::Misalignment read_misalignment(TomlTable& table) {
    return {.decentre_mm = numbers_or_zero<2>(table, "decentre_mm"), .tilt_deg = numbers_or_zero<3>(table, "tilt_deg")};
}

optics::StatedMedium read_medium(TomlTable& row) {
    optics::StatedMedium medium;
    medium.glass = row.text_or("glass", "");
    medium.n_d = optional_stated_number(row, "n_d");
    medium.V_d = optional_stated_number(row, "V_d");
    if (row.has("indices")) {
        medium.indices = read_wavelength_values(row, "indices", {.min = 1.0, .max = 5.0});
    }
    if (medium.V_d && !medium.n_d) {
        row.fail("V_d", "stands without n_d");
    }
    if (!medium.indices.empty() && !medium.glass.empty()) {
        row.fail("indices", "stand beside a glass name: expected one of the two");
    }
    return medium;
}

/// Adds Forbes's departure from the conic, which the powers of r then hold.
void read_forbes_terms(TomlTable& row, optics::PrescribedSurface& surface) {
    surface.along_normal = row.boolean_or("along_normal", false) || row.has("Qbfs");
    if (surface.along_normal && (surface.has_odd_terms() || row.has("radius_x_mm") || row.has("Qcon"))) {
        row.fail("",
                 "odd terms, a radius_x_mm or Qcon stand beside terms along the conic's normal, expected A2, A4, … "
                 "or Qbfs alone");
    }
    const char* key = row.has("Qbfs") ? "Qbfs" : "Qcon";
    if (!row.has(key)) {
        if (row.has("Q_radius_mm")) {
            row.fail("Q_radius_mm", "stands without Qbfs or Qcon");
        }
        return;
    }
    if (surface.along_normal && surface.is_asphere()) {
        row.fail(key, "stands beside A2, A4, …, expected one of the two");
    }
    const std::vector<double> a = row.numbers(key, 0);
    if (a.size() > kForbesTerms) {
        row.fail(key, fmt::format("holds {} coefficients, expected up to {}, which make the terms to r^{}", a.size(),
                                  kForbesTerms, optics::kHighestPower));
    }
    const double radius = row.number("Q_radius_mm", kPositive);
    const optics::AsphereTerms powers = surface.along_normal ? powers_of_qbfs(a, radius) : powers_of_qcon(a, radius);
    std::ranges::transform(surface.asphere, powers, surface.asphere.begin(), std::plus());
}

/// A grating, a kinoform, or both.
std::optional<optics::PhaseElement> read_phase(TomlTable& row) {
    const bool has_lines = row.has("grating_lines_per_mm");
    const bool is_kinoform = row.has("kinoform");
    if (!has_lines && !is_kinoform) {
        for (const char* key : {"diffraction_order", "kinoform_nm"}) {
            if (row.has(key)) {
                row.fail(key, "stands without grating_lines_per_mm or kinoform");
            }
        }
        return std::nullopt;
    }
    optics::PhaseElement phase;
    phase.lines_per_mm = optional_stated_number(row, "grating_lines_per_mm").value_or(0.0);
    phase.order = optional_stated_number(row, "diffraction_order").value_or(1.0);
    if (is_kinoform) {
        const std::vector<double> terms = row.numbers("kinoform", 0);
        if (terms.size() > phase.radial.size()) {
            row.fail("kinoform", fmt::format("holds {} coefficients, expected up to {}, of r^2 to r^{}", terms.size(),
                                             phase.radial.size(), 2 * phase.radial.size()));
        }
        std::ranges::copy(terms, phase.radial.begin());
        phase.design_wavelength_nm = row.number("kinoform_nm", kPositive);
    }
    return phase;
}

optics::PrescribedSurface read_surface(TomlTable& row) {
    optics::PrescribedSurface surface;
    surface.where = row.where();
    surface.is_stop = row.boolean_or("stop", false);
    if (row.has("radius_mm")) {
        surface.radius_mm = stated_number(row, "radius_mm");
    }
    surface.conic = optional_stated_number(row, "conic").value_or(0.0);
    for (int power = 1; power <= optics::kHighestPower; ++power) {
        surface.term(power) = optional_stated_number(row, fmt::format("A{}", power)).value_or(0.0);
    }
    read_forbes_terms(row, surface);
    surface.radius_x_mm = optional_stated_number(row, "radius_x_mm");
    surface.thickness_mm = stated_number(row, "thickness_mm");
    surface.semi_diameter_mm = optional_stated_number(row, "semi_diameter_mm");
    surface.rim_mm = optional_stated_number(row, "rim_mm");
    surface.barrel_mm = optional_stated_number(row, "barrel_mm");
    surface.is_mirror = row.boolean_or("mirror", false);
    for (const char* key : {"glass", "n_d", "indices"}) {
        if (surface.is_mirror && row.has(key)) {
            row.fail(key, "stands on a mirror, behind which is what is in front of it");
        }
    }
    surface.medium = read_medium(row);
    surface.ideal_focal_length_mm = optional_stated_number(row, "ideal_focal_length_mm");
    surface.phase = read_phase(row);
    surface.coating = row.text_or("coating", "");
    surface.misalignment = read_misalignment(row);
    row.finish();
    return surface;
}

optics::StatedData read_stated(TomlTable& table) {
    optics::StatedData stated;
    for (const optics::Claim& claim : optics::kClaims) {
        stated.*claim.value = table.optional_number(claim.key, claim.is_positive ? kPositive : kAnyNumber);
    }
    stated.source = table.text_or("source", "");
    table.finish();
    return stated;
}

optics::StopShape read_stop_shape(TomlTable& table) {
    optics::StopShape shape;
    if (table.has("texture")) {
        shape = optics::TexturedStop{.image = table.text("texture")};
    } else {
        shape = optics::PolygonStop{.blades = table.integer("blades", 3, 64),
                                    .curvature = table.number_or("curvature", 0.0, {.min = 0.0, .max = 1.0}),
                                    .rotation_deg = table.number_or("rotation_deg", 0.0)};
    }
    table.finish();
    return shape;
}

/// Surfaces from `first` to `last`, both counted from 1.
void read_surface_range(TomlTable& table, int surfaces, int& first, int& last) {
    const std::vector<double> range = table.numbers("surfaces", 2, {.min = 1.0, .max = static_cast<double>(surfaces)});
    first = static_cast<int>(range[0]);
    last = static_cast<int>(range[1]);
    if (first != range[0] || last != range[1] || first > last) {
        table.fail("surfaces", fmt::format("is [{}, {}], expected the first and the last surface of a group, from 1",
                                           range[0], range[1]));
    }
}

optics::MisalignedGroup read_group(TomlTable& table, int surfaces) {
    optics::MisalignedGroup group;
    read_surface_range(table, surfaces, group.first, group.last);
    group.misalignment = read_misalignment(table);
    group.pivot_mm = table.number_or("pivot_mm", 0.0);
    table.finish();
    return group;
}

optics::FocusGroup read_focus_group(TomlTable& table, int surfaces) {
    optics::FocusGroup group;
    read_surface_range(table, surfaces, group.first, group.last);
    group.travel = table.number_or("travel", 1.0);
    table.finish();
    return group;
}

/// One key says what the number is.
optics::SystemAperture read_aperture(TomlTable& table) {
    optics::SystemAperture aperture;
    for (const auto& [key, kind] : kApertureKeys) {
        if (const std::optional<double> value = table.optional_number(key, kPositive)) {
            if (aperture.kind != optics::ApertureKind::stop) {
                table.fail(key, "is a second statement of the aperture, expected one");
            }
            aperture = {kind, *value};
        }
    }
    table.finish();
    if (aperture.kind == optics::ApertureKind::stop) {
        std::vector<std::string_view> keys;
        std::ranges::transform(kApertureKeys, std::back_inserter(keys), &ApertureKey::key);
        throw InputError(fmt::format("{} is empty, expected one of {}", table.where(), fmt::join(keys, ", ")));
    }
    return aperture;
}

optics::DesignFields read_fields(TomlTable& table) {
    optics::DesignFields fields;
    std::vector<std::string> names;
    std::ranges::transform(kFieldKinds, std::back_inserter(names), &FieldKindName::name);
    fields.kind = kFieldKinds[std::ranges::find(names, table.choice("kind", names)) - names.begin()].kind;
    const auto lists = [&](const std::string& key, std::size_t count) {
        std::vector<std::vector<double>> values = table.number_lists(key);
        if (std::ranges::any_of(values, [&](const std::vector<double>& each) { return each.size() != count; })) {
            table.fail(key, fmt::format("holds a list of another length, expected {} numbers in each", count));
        }
        return values;
    };
    for (const std::vector<double>& point : lists("points", 2)) {
        fields.points.push_back({point[0], point[1]});
    }
    if (table.has("vignetting")) {
        for (const std::vector<double>& each : lists("vignetting", 4)) {
            fields.vignetting.push_back({.decentre = {each[0], each[1]}, .compression = {each[2], each[3]}});
        }
        if (fields.vignetting.size() != fields.points.size()) {
            table.fail("vignetting", fmt::format("holds {} lists, expected one for each of the {} points",
                                                 fields.vignetting.size(), fields.points.size()));
        }
    }
    table.finish();
    return fields;
}

optics::ZoomPosition read_zoom_position(TomlTable& table, int surfaces) {
    optics::ZoomPosition position;
    position.name = table.text("name");
    TomlTable gaps = table.table("gaps_mm");
    for (const std::string& key : gaps.keys()) {
        const int surface = parse_exact<int>(key).value_or(0);
        if (surface < 1 || surface > surfaces) {
            gaps.fail(key, fmt::format("expected a surface from 1 to {}, whose gap it is", surfaces));
        }
        position.gaps_mm[surface] = stated_number(gaps, key);
    }
    position.stop_semi_diameter_mm = table.optional_number("stop_semi_diameter_mm", kPositive);
    if (auto aperture = table.optional_table("aperture")) {
        position.aperture = read_aperture(*aperture);
    }
    if (auto stated = table.optional_table("stated")) {
        position.stated = read_stated(*stated);
    }
    table.finish();
    return position;
}

void read_moving_parts(TomlTable& top, optics::Prescription& prescription) {
    const int count = static_cast<int>(prescription.surfaces.size());
    for (TomlTable& table : top.tables("groups")) {
        prescription.groups.push_back(read_group(table, count));
    }
    for (TomlTable& table : top.tables("zoom")) {
        prescription.zoom.push_back(read_zoom_position(table, count));
    }
    for (TomlTable& table : top.tables("focus")) {
        prescription.focus_groups.push_back(read_focus_group(table, count));
    }
}

void read_coatings(TomlTable& top, optics::Prescription& prescription) {
    if (auto coatings = top.optional_table("coatings")) {
        for (const std::string& name : coatings->keys()) {
            TomlTable coating = coatings->table(name);
            prescription.coatings[name] = read_coating(coating);
        }
    }
    for (const optics::PrescribedSurface& surface : prescription.surfaces) {
        const std::string& name = surface.coating;
        if (name.empty() || prescription.coatings.contains(name)) {
            continue;
        }
        if (!is_shipped_coating(name)) {
            top.fail("surfaces",
                     fmt::format("name the coating \"{}\", but there is no table [coatings.{}], and none of "
                                 "that name ships{}",
                                 printable(name), printable(name), coating_hint(name, prescription)));
        }
        prescription.coatings[name] = shipped_coating(name).coating;
    }
}

}  // namespace

optics::Prescription parse_toml_prescription(const std::string& text, const std::filesystem::path& file) {
    TomlTable top = TomlTable::parse(text, file);
    optics::Prescription prescription;
    prescription.file = file;
    prescription.name = top.text("name");
    prescription.source = top.text("source");
    prescription.notes = top.text_or("notes", "");
    prescription.design = top.text_or("design", "");
    if (top.has("projection")) {
        std::vector<std::string> names;
        std::ranges::transform(optics::kProjections, std::back_inserter(names), optics::projection_name);
        const std::string name = top.choice("projection", names);
        prescription.projection = optics::kProjections[std::ranges::find(names, name) - names.begin()];
    }
    if (auto stated = top.optional_table("stated")) {
        prescription.stated = read_stated(*stated);
    }
    if (auto aperture = top.optional_table("aperture")) {
        prescription.aperture = read_aperture(*aperture);
    }
    if (auto fields = top.optional_table("fields")) {
        prescription.fields = read_fields(*fields);
    }
    for (TomlTable& row : top.tables("surfaces")) {
        prescription.surfaces.push_back(read_surface(row));
    }
    if (auto medium = top.optional_table("object_medium")) {
        prescription.object_medium = read_medium(*medium);
        medium->finish();
    }
    optics::set_mirror_media(prescription.surfaces, prescription.object_medium);
    if (prescription.surfaces.empty() || prescription.surfaces.size() > kMostSurfaces) {
        top.fail("surfaces",
                 fmt::format("holds {} surfaces, expected 1 to {}", prescription.surfaces.size(), kMostSurfaces));
    }
    if (auto stop = top.optional_table("stop")) {
        prescription.stop_shape = read_stop_shape(*stop);
    }
    if (auto barrel = top.optional_table("barrel")) {
        prescription.barrel = read_barrel(*barrel);
    }
    read_coatings(top, prescription);
    read_moving_parts(top, prescription);
    if (top.has("surroundings")) {
        prescription.surroundings = top.choice("surroundings", {"air", "vacuum"}) == "air"
                                        ? optics::Surroundings::air
                                        : optics::Surroundings::vacuum;
    }
    if (top.has("object_distance_mm")) {
        prescription.object_distance_mm =
            top.infinity("object_distance_mm") > 0 ? kInfinity : top.number("object_distance_mm", kPositive);
    }
    if (top.has("wavelengths_nm")) {
        prescription.wavelengths_nm = top.numbers("wavelengths_nm", 0, kPositive);
    }
    if (top.has("catalogues")) {
        for (const std::string& name : top.texts("catalogues")) {
            prescription.catalogues.push_back(referred_file(file, name));
        }
    }
    if (top.has("makers")) {
        prescription.preferred_makers = top.texts("makers");
    }
    top.finish();
    return prescription;
}

}  // namespace lensproof::formats
