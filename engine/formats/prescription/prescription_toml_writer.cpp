// The project's own form, written so that the surfaces stand as a table: numbers of a column below one another, columns
// that no surface needs left out. prescription_toml.cpp reads it back to the same prescription.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/base/toml_text.h"
#include "engine/formats/prescription/prescription_forms.h"

namespace lensproof::formats {

namespace {

/// The shortest digits that read back to the same number, as a TOML float.
std::string number(double value) {
    std::string text = fmt::format("{}", value);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

template <class Numbers>
std::string number_list(const Numbers& values) {
    std::vector<std::string> texts;
    std::ranges::transform(values, std::back_inserter(texts), number);
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string pairs(const std::vector<optics::WavelengthValue>& values) {
    std::vector<std::string> texts;
    std::ranges::transform(values, std::back_inserter(texts), [](const optics::WavelengthValue& pair) {
        return number_list(std::array{pair.wavelength_nm, pair.value});
    });
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

/// What holds at every wavelength, or a table.
std::string number_or_pairs(const std::vector<optics::WavelengthValue>& values) {
    return values.size() == 1 ? number(values.front().value) : pairs(values);
}

bool is_plain(const std::string& cell) {
    return cell.find_first_of("en") == std::string::npos;
}

/// `key = value` for each number that there is, with their points below one another.
std::vector<std::string> aligned(const std::string& key, const std::vector<std::optional<double>>& values) {
    constexpr std::size_t kMostPlacesFilled = 6;  // with zeros; columns of many more digits are left ragged
    std::vector<std::string> cells;
    std::ranges::transform(values, std::back_inserter(cells),
                           [](const auto& value) { return value ? number(*value) : std::string(); });
    const auto point = [](const std::string& cell) { return std::min(cell.find_first_of(".e"), cell.size()); };
    std::size_t whole = 0;
    std::size_t places = 0;
    for (const std::string& cell : cells) {
        whole = std::max(whole, point(cell));
        places = std::max(places, is_plain(cell) && !cell.empty() ? cell.size() - point(cell) - 1 : 0);
    }
    for (std::string& cell : cells) {
        if (!cell.empty()) {
            const std::size_t before = whole - point(cell);
            if (is_plain(cell) && places <= kMostPlacesFilled) {
                cell.append(places + 1 - (cell.size() - point(cell)), '0');
            }
            cell = fmt::format("{} = {}{}", key, std::string(before, ' '), cell);
        }
    }
    return cells;
}

/// The table of surfaces, a column at a time.
class Rows {
  public:
    explicit Rows(std::size_t count) : rows_(count, "  { ") {}

    /// Adds a column; a cell holds `key = value`, or nothing.
    void add(const std::vector<std::string>& cells) {
        const std::size_t width = std::ranges::max(cells, {}, &std::string::size).size();
        for (std::size_t row = 0; width > 0 && row < rows_.size(); ++row) {
            rows_[row] += cells[row] + (cells[row].empty() ? "  " : ", ") + std::string(width - cells[row].size(), ' ');
        }
    }

    [[nodiscard]] std::string text() const {
        std::string all;
        for (const std::string& row : rows_) {
            all += row.substr(0, row.find_last_not_of(", ") + 1) + " },\n";
        }
        return all;
    }

  private:
    std::vector<std::string> rows_;
};

/// What the form cannot hold is noted here.
class Writer {
  public:
    explicit Writer(const optics::Prescription& prescription) : prescription_(prescription) {}

    WrittenPrescription write() {
        write_head();
        write_surfaces();
        write_object_medium();
        write_claims("stated", prescription_.stated);
        write_aperture("aperture", prescription_.aperture);
        write_fields();
        write_stop();
        write_barrel();
        for (const auto& [name, coating] : prescription_.coatings) {
            write_coating(name, coating);
        }
        write_groups();
        write_zoom();
        return {.text = std::move(text_), .lost = std::move(lost_)};
    }

  private:
    void line(const std::string& key, const std::string& value) { text_ += fmt::format("{} = {}\n", key, value); }

    void lose(const std::string& code, int surface, const std::string& message) {
        lost_.push_back({code, optics::Severity::warning, surface, message});
    }

    void write_head() {
        const optics::Prescription& lens = prescription_;
        line("name", toml_string(lens.name));
        line("source", toml_string(lens.source));
        line("projection", toml_string(optics::projection_name(lens.projection)));
        if (lens.surroundings == optics::Surroundings::vacuum) {
            line("surroundings", toml_string("vacuum"));
        }
        if (lens.object_distance_mm != kInfinity) {
            if (std::isfinite(lens.object_distance_mm) && lens.object_distance_mm > 0.0) {
                line("object_distance_mm", number(lens.object_distance_mm));
            } else {
                lose("lost-object-distance", 0, fmt::format("an object at {} mm", lens.object_distance_mm));
            }
        }
        if (!lens.wavelengths_nm.empty()) {
            line("wavelengths_nm", number_list(lens.wavelengths_nm));
        }
        if (!lens.catalogues.empty()) {
            std::vector<std::string> names;
            std::ranges::transform(lens.catalogues, std::back_inserter(names), [&](const std::filesystem::path& file) {
                return file.lexically_proximate(lens.file.parent_path()).generic_string();
            });
            line("catalogues", toml_strings(names));
        }
        if (!lens.enclosed_glasses.empty()) {
            lose("lost-catalogues", 0, "the glass catalogues that its file encloses");
        }
        if (!lens.preferred_makers.empty()) {
            line("makers", toml_strings(lens.preferred_makers));
        }
        if (!lens.notes.empty()) {
            line("notes", toml_paragraph(lens.notes));
        }
    }

    template <class Value>
    void add_numbers(Rows& table, const std::string& key, const Value& value) const {
        std::vector<std::optional<double>> values;
        std::ranges::transform(prescription_.surfaces, std::back_inserter(values), value);
        table.add(aligned(key, values));
    }

    template <class Cell>
    void add_texts(Rows& table, const Cell& cell) {
        std::vector<std::string> cells;
        std::ranges::transform(prescription_.surfaces, std::back_inserter(cells), cell);
        table.add(cells);
    }

    void write_surfaces() {
        using Row = optics::PrescribedSurface;
        using Stated = std::optional<double>;
        const auto unless_zero = [](double value) { return value == 0.0 ? std::nullopt : Stated(value); };
        Rows table(prescription_.surfaces.size());
        table.add(radius_cells());
        add_numbers(table, "conic", [&](const Row& row) { return unless_zero(row.conic); });
        for (int power = 1; power <= optics::kHighestPower; ++power) {
            add_numbers(table, fmt::format("A{}", power), [&](const Row& row) { return unless_zero(row.term(power)); });
        }
        add_texts(table, [](const Row& row) { return std::string(row.along_normal ? "along_normal = true" : ""); });
        add_numbers(table, "radius_x_mm", [](const Row& row) { return row.radius_x_mm; });
        add_numbers(table, "thickness_mm", [](const Row& row) { return Stated(row.thickness_mm); });
        const auto medium = [](const Row& row) { return row.is_mirror ? optics::StatedMedium{} : row.medium; };
        add_texts(table, [&](const Row& row) {
            const std::string glass = medium(row).glass;
            return row.is_mirror ? "mirror = true" : glass.empty() ? std::string() : "glass = " + toml_string(glass);
        });
        add_numbers(table, "n_d", [&](const Row& row) { return medium(row).n_d; });
        add_numbers(table, "V_d", [&](const Row& row) { return medium(row).n_d ? row.medium.V_d : std::nullopt; });
        add_texts(table, [&](const Row& row) { return indices_cell(row); });
        add_numbers(table, "semi_diameter_mm", [](const Row& row) { return row.semi_diameter_mm; });
        add_numbers(table, "rim_mm", [](const Row& row) { return row.rim_mm; });
        add_numbers(table, "barrel_mm", [](const Row& row) { return row.barrel_mm; });
        add_numbers(table, "ideal_focal_length_mm", [](const Row& row) { return row.ideal_focal_length_mm; });
        add_texts(table, [](const Row& row) { return phase_cell(row); });
        add_texts(table, [](const Row& row) {
            return row.coating.empty() ? std::string() : "coating = " + toml_string(row.coating);
        });
        add_texts(table, [&](const Row& row) { return shift_cell("decentre_mm", row.misalignment.decentre_mm, row); });
        add_texts(table, [&](const Row& row) { return shift_cell("tilt_deg", row.misalignment.tilt_deg, row); });
        text_ += "\nsurfaces = [\n" + table.text() + "]\n";
    }

    /// The lines of a grating, the terms of a kinoform, and their order.
    static std::string phase_cell(const optics::PrescribedSurface& row) {
        if (!row.phase) {
            return {};
        }
        const auto& [order, lines_per_mm, radial, design_wavelength_nm] = *row.phase;
        std::vector<std::string> keys;
        if (lines_per_mm != 0.0 || radial == decltype(radial){}) {
            keys.push_back("grating_lines_per_mm = " + number(lines_per_mm));
        }
        if (radial != decltype(radial){}) {
            const auto* last = std::find_if(radial.rbegin(), radial.rend(), [](double c) { return c != 0.0; }).base();
            keys.push_back("kinoform = " + number_list(std::vector<double>(radial.begin(), last)));
            keys.push_back("kinoform_nm = " + number(design_wavelength_nm));
        }
        keys.push_back("diffraction_order = " + number(order));
        return fmt::format("{}", fmt::join(keys, ", "));
    }

    /// `stop = true` stands in the place of a radius, since most stops have none.
    [[nodiscard]] std::vector<std::string> radius_cells() const {
        const std::vector<optics::PrescribedSurface>& rows = prescription_.surfaces;
        std::vector<std::optional<double>> radii;
        for (const optics::PrescribedSurface& row : rows) {
            const bool is_plain_stop = row.is_stop && row.radius_mm == kInfinity;
            radii.push_back(is_plain_stop ? std::nullopt : std::optional(row.radius_mm));
        }
        std::vector<std::string> cells = aligned("radius_mm", radii);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i].is_stop) {
                cells[i] = cells[i].empty() ? "stop = true" : "stop = true, " + cells[i];
            }
        }
        return cells;
    }

    /// A decentre or a tilt; nothing where it is zero.
    template <std::size_t count>
    std::string shift_cell(const std::string& key, const std::array<double, count>& values,
                           const optics::PrescribedSurface& row) {
        if (values == std::array<double, count>{}) {
            return {};
        }
        if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) {
            lose("lost-misalignment", surface_number(row),
                 fmt::format("{} = {} is left out", key, number_list(values)));
            return {};
        }
        return key + " = " + number_list(values);
    }

    std::string indices_cell(const optics::PrescribedSurface& row) {
        if (row.medium.indices.empty() || row.is_mirror) {
            return {};
        }
        const bool readable = std::ranges::all_of(row.medium.indices, [](const optics::WavelengthValue& at) {
            return at.wavelength_nm > 0.0 && at.value >= 1.0 && at.value <= 5.0;
        });
        if (!row.medium.glass.empty() || !readable) {
            lose("lost-indices", surface_number(row),
                 "its indices are left out: they stand beside a glass name, or are not between 1 and 5");
            return {};
        }
        return "indices = " + pairs(row.medium.indices);
    }

    [[nodiscard]] int surface_number(const optics::PrescribedSurface& row) const {
        return static_cast<int>(&row - prescription_.surfaces.data()) + 1;
    }

    void write_claims(const std::string& table, const optics::StatedData& stated) {
        std::string claims;
        for (const auto& [key, member, is_positive] : optics::kClaims) {
            const std::optional<double>& value = stated.*member;
            if (value && std::isfinite(*value) && (*value > 0.0 || !is_positive)) {
                claims += fmt::format("{} = {}\n", key, number(*value));
            } else if (value) {
                lose("lost-stated", 0, fmt::format("{} = {} is left out of [{}]", key, *value, table));
            }
        }
        if (!stated.source.empty()) {
            claims += fmt::format("source = {}\n", toml_string(stated.source));
        }
        if (!claims.empty()) {
            text_ += fmt::format("\n[{}]\n{}", table, claims);
        }
    }

    void write_object_medium() {
        const optics::StatedMedium& medium = prescription_.object_medium;
        if (medium.is_air()) {
            return;
        }
        text_ += "\n[object_medium]\n";
        if (!medium.glass.empty()) {
            line("glass", toml_string(medium.glass));
        }
        if (medium.n_d) {
            line("n_d", number(*medium.n_d));
        }
        if (medium.n_d && medium.V_d) {
            line("V_d", number(*medium.V_d));
        }
        if (!medium.indices.empty()) {
            line("indices", pairs(medium.indices));
        }
    }

    void write_aperture(const std::string& table, const optics::SystemAperture& aperture) {
        const auto* key = std::ranges::find(kApertureKeys, aperture.kind, &ApertureKey::kind);
        if (key != std::end(kApertureKeys)) {
            text_ += fmt::format("\n[{}]\n{} = {}\n", table, key->key, number(aperture.value));
        }
    }

    void write_fields() {
        const optics::DesignFields& fields = prescription_.fields;
        if (fields.points.empty()) {
            return;
        }
        std::vector<std::string> points;
        std::ranges::transform(fields.points, std::back_inserter(points), [](const Vec2d& point) {
            return number_list(std::array{point.x, point.y});
        });
        text_ += fmt::format("\n[fields]\nkind = {}\npoints = [{}]\n",
                             toml_string(std::ranges::find(kFieldKinds, fields.kind, &FieldKindName::kind)->name),
                             fmt::join(points, ", "));
        if (!fields.vignetting.empty()) {
            std::vector<std::string> factors;
            std::ranges::transform(
                fields.vignetting, std::back_inserter(factors), [](const optics::PupilVignetting& each) {
                    return number_list(
                        std::array{each.decentre.x, each.decentre.y, each.compression.x, each.compression.y});
                });
            line("vignetting", fmt::format("[{}]", fmt::join(factors, ", ")));
        }
    }

    void write_stop() {
        if (const auto* polygon = std::get_if<optics::PolygonStop>(&prescription_.stop_shape)) {
            text_ += fmt::format("\n[stop]\nblades = {}\ncurvature = {}\nrotation_deg = {}\n", polygon->blades,
                                 number(polygon->curvature), number(polygon->rotation_deg));
        } else if (const auto* texture = std::get_if<optics::TexturedStop>(&prescription_.stop_shape)) {
            text_ += fmt::format("\n[stop]\ntexture = {}\n", toml_string(texture->image));
        }
    }

    void write_barrel() {
        if (prescription_.barrel == optics::BarrelFinish{}) {
            return;
        }
        text_ += "\n[barrel]\n";
        const auto& [tube, edges, blades] = prescription_.barrel;
        for (const auto& [key, finish] : {std::pair{"tube", tube}, {"edges", edges}, {"blades", blades}}) {
            line(key, fmt::format("{{ albedo = {}, gloss = {}, roughness = {} }}", number(finish.albedo),
                                  number(finish.gloss), number(finish.roughness)));
        }
    }

    static std::string layer_text(const optics::CoatingLayer& layer) {
        std::string text = layer.material.empty() ? "n = " + number_or_pairs(layer.index)
                                                  : "material = " + toml_string(layer.material);
        if (!layer.extinction.empty()) {
            text += ", k = " + number_or_pairs(layer.extinction);
        }
        text += layer.quarter_wave_nm > 0.0 ? ", quarter_wave_nm = " + number(layer.quarter_wave_nm)
                                            : ", thickness_nm = " + number(layer.thickness_nm);
        return "{ " + text + " }";
    }

    void write_coating(const std::string& name, const optics::Coating& coating) {
        text_ += fmt::format("\n[coatings.{}]\n", toml_key(name));
        if (const auto* stack = std::get_if<optics::LayerStack>(&coating)) {
            std::vector<std::string> each;
            std::ranges::transform(stack->layers, std::back_inserter(each), layer_text);
            line("layers", fmt::format("[{}]", fmt::join(each, ", ")));
            if (stack->from_air) {
                line("from_air", "true");
            }
            return;
        }
        const auto& reflectance = std::get<std::vector<optics::WavelengthValue>>(coating);
        line("reflectance", number_or_pairs(reflectance));
    }

    void write_groups() {
        for (const optics::MisalignedGroup& group : prescription_.groups) {
            text_ += fmt::format("\n[[groups]]\nsurfaces = [{}, {}]\ndecentre_mm = {}\ntilt_deg = {}\npivot_mm = {}\n",
                                 group.first, group.last, number_list(group.misalignment.decentre_mm),
                                 number_list(group.misalignment.tilt_deg), number(group.pivot_mm));
        }
        for (const optics::FocusGroup& group : prescription_.focus_groups) {
            text_ += fmt::format("\n[[focus]]\nsurfaces = [{}, {}]\ntravel = {}\n", group.first, group.last,
                                 number(group.travel));
        }
    }

    void write_zoom() {
        for (const optics::ZoomPosition& position : prescription_.zoom) {
            std::vector<std::string> gaps;
            for (const auto& [surface, gap] : position.gaps_mm) {
                gaps.push_back(fmt::format("{} = {}", surface, number(gap)));
            }
            text_ += fmt::format("\n[[zoom]]\nname = {}\ngaps_mm = {{ {} }}\n", toml_string(position.name),
                                 fmt::join(gaps, ", "));
            if (position.stop_semi_diameter_mm) {
                line("stop_semi_diameter_mm", number(*position.stop_semi_diameter_mm));
            }
            write_aperture("zoom.aperture", position.aperture);
            write_claims("zoom.stated", position.stated);
        }
    }

    const optics::Prescription& prescription_;
    std::string text_;
    std::vector<optics::Finding> lost_;
};

}  // namespace

WrittenPrescription to_toml(const optics::Prescription& prescription) {
    return Writer(prescription).write();
}

}  // namespace lensproof::formats
