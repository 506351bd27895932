// A prescription as OpticStudio would save it: sequential, in mm, each tilted surface between a pair of coordinate
// breaks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/prescription/axial_terms.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/prescription_losses.h"
#include "engine/formats/prescription/surface_chain.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::formats {

namespace {

std::string one_line(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char letter) { return letter < 0x20; }, ' ');
    return text;
}

/// A name as one word, which is all that the form has room for.
std::string one_word(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char letter) { return letter <= 0x20; }, '_');
    return text;
}

std::string zmx_number(double value) {
    return std::isinf(value) ? (value > 0.0 ? "INFINITY" : "-INFINITY") : fmt::format("{}", value);
}

/// The surfaces with the groups' tilts written into each, so that each stands on its own.
optics::Prescription without_groups(optics::Prescription prescription) {
    if (!prescription.groups.empty()) {
        std::vector<ChainLink> links;
        for (const optics::Frame& frame : optics::surface_frames(prescription)) {
            links.push_back({.frame = frame, .straight = false});
        }
        double image_z = 0.0;
        for (const optics::PrescribedSurface& row : prescription.surfaces) {
            image_z += row.thickness_mm;
        }
        links.push_back({.frame = {.origin = {0.0, 0.0, image_z}}});
        // What a shift of the first vertex along the axis takes from the object's distance.
        prescription.object_distance_mm += links.front().frame.origin.z;
        place_rows(prescription.surfaces, links);
        prescription.groups.clear();
    }
    return prescription;
}

class ZmxWriter {
  public:
    explicit ZmxWriter(const optics::Prescription& prescription)
        : original_(prescription), prescription_(without_groups(prescription)) {
        state_along_axis(prescription_, lost_);
    }

    WrittenPrescription write() {
        write_head();
        write_surfaces();
        write_configurations();
        report_lost();
        return {.text = to_utf16(text_), .lost = std::move(lost_)};
    }

  private:
    template <class... Values>
    void line(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
        text_ += "\r\n";
    }

    void lose(const std::string& code, int surface, const std::string& what,
              optics::Severity severity = optics::Severity::warning) {
        lost_.push_back(lost(code, severity, surface, "a .zmx file cannot say " + what));
    }

    void write_head() {
        line("VERS 140124 0 0");
        line("MODE SEQ");
        line("NAME {}", one_line(prescription_.name));
        line("NOTE 0 Source: {}", one_line(prescription_.source));
        for (const std::string_view note : lines_of(prescription_.notes)) {
            line("NOTE 0 {}", one_line(std::string(note)));
        }
        line("UNIT MM X W X CM MR CPMM");
        write_aperture();
        line("ENVD 20 1 0");
        line("GFAC 0 0");
        write_catalogues();
        const auto wavelengths = std::max<std::size_t>(1, prescription_.wavelengths_nm.size());
        write_fields(wavelengths);
        for (std::size_t i = 0; i < wavelengths; ++i) {
            const double nm = prescription_.wavelengths_nm.empty() ? spectral::kLineD : prescription_.wavelengths_nm[i];
            line("WAVM {} {} 1", i + 1, nm * 1e-3);
        }
        line("PWAV 1");
    }

    void write_aperture() {
        const optics::SystemAperture aperture = prescription_.governing_aperture();
        switch (aperture.kind) {
            case optics::ApertureKind::entrance_pupil_diameter:
                line("ENPD {}", aperture.value);
                break;
            case optics::ApertureKind::f_number:
            case optics::ApertureKind::working_f_number:
                line("FNUM {} {}", aperture.value, aperture.kind == optics::ApertureKind::working_f_number ? 1 : 0);
                break;
            case optics::ApertureKind::object_numerical_aperture:
                line("OBNA {} 0", aperture.value);
                break;
            case optics::ApertureKind::stop:
                line("FLOA");
                break;
        }
    }

    /// Those of the design, or the axis, 0.7 and the whole of the field that the source claims.
    void write_fields(std::size_t wavelengths) {
        const optics::StatedData& stated = prescription_.stated;
        optics::DesignFields fields = prescription_.fields;
        if (fields.points.empty()) {
            const double field = stated.half_field_deg.value_or(0.5 * stated.image_circle_mm.value_or(0.0));
            fields.kind = stated.half_field_deg || !stated.image_circle_mm ? optics::FieldKind::angle
                                                                           : optics::FieldKind::image_height;
            fields.points = {{}};
            if (field > 0.0) {
                fields.points.push_back({0.0, std::numbers::sqrt2 / 2.0 * field});
                fields.points.push_back({0.0, field});
            }
        }
        const auto list = [&](const char* keyword, const auto& values, auto value_of) {
            std::string text = keyword;
            for (const auto& each : values) {
                text += fmt::format(" {}", value_of(each));
            }
            line("{}", text);
        };
        line("FTYP {} 0 {} {} 0 0 0", static_cast<int>(fields.kind), fields.points.size(), wavelengths);
        list("XFLN", fields.points, [](const Vec2d& point) { return point.x; });
        list("YFLN", fields.points, [](const Vec2d& point) { return point.y; });
        list("FWGN", fields.points, [](const Vec2d&) { return 1; });
        if (!fields.vignetting.empty()) {
            using optics::PupilVignetting;
            list("VDXN", fields.vignetting, [](const PupilVignetting& each) { return each.decentre.x; });
            list("VDYN", fields.vignetting, [](const PupilVignetting& each) { return each.decentre.y; });
            list("VCXN", fields.vignetting, [](const PupilVignetting& each) { return each.compression.x; });
            list("VCYN", fields.vignetting, [](const PupilVignetting& each) { return each.compression.y; });
        }
    }

    /// The makers that names of glasses carry, before those that the lens prefers.
    void write_catalogues() {
        std::vector<std::string> makers;
        const auto add = [&](const std::string& maker) {
            if (!maker.empty() && std::ranges::find(makers, maker) == makers.end()) {
                makers.push_back(maker);
            }
        };
        for (const optics::PrescribedSurface& row : prescription_.surfaces) {
            add(split_glass(row.medium.glass).first);
        }
        for (const std::string& maker : prescription_.preferred_makers) {
            add(one_word(maker));
        }
        std::string words;
        for (const std::string& maker : makers) {
            words += " " + maker;
        }
        if (!words.empty()) {
            line("GCAT{}", words);
        }
    }

    /// "SCHOTT LAK9": the maker and the name. What stands before the blank is a maker where it is letters only.
    static std::pair<std::string, std::string> split_glass(const std::string& glass) {
        const std::size_t space = glass.find(' ');
        const bool has_maker =
            space != std::string::npos &&
            std::ranges::all_of(glass.substr(0, space), [](unsigned char letter) { return std::isalpha(letter); });
        return has_maker ? std::pair(glass.substr(0, space), one_word(glass.substr(space + 1)))
                         : std::pair(std::string(), one_word(glass));
    }

    void begin_surface(const std::string& type) {
        line("SURF {}", surfaces_);
        line("  TYPE {}", type);
        ++surfaces_;
    }

    void write_break(const optics::Misalignment& break_by, double sign, double thickness) {
        begin_surface("COORDBRK");
        line("  CURV 0.0 0 0 0 0 \"\"");
        line("  PARM 1 {}", sign * break_by.decentre_mm[0]);
        line("  PARM 2 {}", sign * break_by.decentre_mm[1]);
        for (int axis = 0; axis < 3; ++axis) {
            line("  PARM {} {}", 3 + axis, sign * break_by.tilt_deg[axis]);
        }
        line("  PARM 6 {}", sign < 0.0 ? 1 : 0);
        line("  DISZ {}", zmx_number(thickness));
    }

    void write_surfaces() {
        begin_surface("STANDARD");
        line("  CURV 0.0 0 0 0 0 \"\"");
        line("  DISZ {}", zmx_number(prescription_.object_distance_mm));
        write_medium(prescription_.object_medium, 0);
        for (std::size_t i = 0; i < prescription_.surfaces.size(); ++i) {
            const optics::PrescribedSurface& row = prescription_.surfaces[i];
            const bool is_aligned = row.misalignment == optics::Misalignment{};
            if (!is_aligned) {
                write_break(row.misalignment, 1.0, 0.0);
            }
            write_surface(row, static_cast<int>(i) + 1, is_aligned ? row.thickness_mm : 0.0);
            if (!is_aligned) {
                write_break(row.misalignment, -1.0, row.thickness_mm);
            }
            gap_at_.push_back(surfaces_ - 1);
        }
        begin_surface("STANDARD");
        line("  CURV 0.0 0 0 0 0 \"\"");
        line("  DISZ 0");
        if (prescription_.stated.image_circle_mm) {
            line("  DIAM {} 1 0 0 1 \"\"", 0.5 * *prescription_.stated.image_circle_mm);
        }
    }

    void write_surface(const optics::PrescribedSurface& row, int number, double thickness) {
        constexpr int kPlainTerms = 8;  // of the even and of the odd asphere; the extended ones have 240
        constexpr int kToroidTerms = 7;
        const bool is_odd = !row.radius_x_mm && row.has_odd_terms();
        const int step = is_odd ? 1 : 2;  // from one term's power of r to the next
        int terms = 0;
        for (int power = step; power <= optics::kHighestPower; power += step) {
            terms = row.term(power) != 0.0 ? power / step : terms;
        }
        const bool is_extended = !row.radius_x_mm && terms > kPlainTerms;
        const char* asphere =
            is_odd ? (is_extended ? "XOSPHERE" : "ODDASPHE") : (is_extended ? "XASPHERE" : "EVENASPH");
        const bool is_thin = write_thin_element(row, number);
        if (is_thin) {
            terms = 0;
        } else {
            begin_surface(row.radius_x_mm ? "TOROIDAL" : (terms > 0 ? asphere : "STANDARD"));
        }
        if (row.is_stop) {
            line("  STOP");
        }
        line("  CURV {} 0 0 0 0 \"\"", row.curvature());
        if (row.radius_x_mm && !is_thin) {
            line("  PARM 1 {}", std::isinf(*row.radius_x_mm) ? 0.0 : *row.radius_x_mm);
            for (int i = 0; i < std::min(terms, kToroidTerms); ++i) {
                line("  PARM {} {}", i + 2, row.asphere[i]);
            }
            if (terms > kToroidTerms) {
                lose("lost-asphere", number, fmt::format("a toroid's terms beyond y^{}", 2 * kToroidTerms));
            }
            if (row.has_odd_terms()) {
                lose("lost-asphere", number, "a toroid's odd terms");
            }
        } else if (is_extended && !is_thin) {
            line("  XDAT 1 {} 0 0 1.0 0.0 0 \"\"", terms);
            line("  XDAT 2 1.0 0 0 1.0 0.0 0 \"\"");
            for (int i = 0; i < terms; ++i) {
                line("  XDAT {} {} 0 0 1.0 0.0 0 \"\"", i + 3, row.term(step * (i + 1)));
            }
        } else {
            for (int i = 0; i < terms; ++i) {
                line("  PARM {} {}", i + 1, row.term(step * (i + 1)));
            }
        }
        line("  DISZ {}", zmx_number(thickness));
        if (row.is_mirror) {
            line("  GLAS MIRROR 0 0 1.5 40 0 0 0 0 0 0");
        } else {
            write_medium(row.medium, number);
        }
        if (row.conic != 0.0) {
            line("  CONI {}", row.conic);
        }
        const std::optional<double> clear = plain_semi_diameter(prescription_, number - 1);
        if (clear) {
            line("  DIAM {} 1 0 0 1 \"\"", *clear);
        }
        if (row.rim_mm) {
            line("  MEMA {} 1 0 0 1 \"\"", *row.rim_mm);
        }
        if (clear) {
            line("  FLAP 0 {} 0", *clear);
        }
        if (row.barrel_mm) {
            lose("lost-barrel", number, "the radius of a barrel; the clear apertures at its ends are narrowed to it",
                 optics::Severity::info);
        }
        if (!row.coating.empty()) {
            lose("lost-coating", number, fmt::format("what the coating {} is", row.coating));
        }
    }

    /// Begins the surface if it has a thin element, and says what that is; false where it has none.
    bool write_thin_element(const optics::PrescribedSurface& row, int number) {
        if (row.ideal_focal_length_mm) {
            begin_surface("PARAXIAL");
            line("  PARM 1 {}", *row.ideal_focal_length_mm);
            return true;
        }
        if (!row.phase) {
            return false;
        }
        const auto& [order, lines_per_mm, radial, design_wavelength_nm] = *row.phase;
        const bool is_kinoform = radial != decltype(radial){};
        if (row.radius_x_mm || row.has_odd_terms() || (!is_kinoform && row.is_asphere())) {
            lose("lost-asphere", number, "the shape of a surface with a grating or a kinoform beyond a conic");
        }
        if (!is_kinoform) {
            begin_surface("DGRATING");
            line("  PARM 1 {}", lines_per_mm * 1e-3);
            line("  PARM 2 {}", order);
            return true;
        }
        if (lines_per_mm != 0.0) {
            lose("lost-grating", number, "the lines of a grating beside a kinoform");
        }
        begin_surface("BINARY_2");
        line("  PARM 0 {}", order);
        for (int power = 2; power <= 2 * kBinaryTerms; power += 2) {
            line("  PARM {} {}", power / 2, row.term(power));
        }
        line("  XDAT 1 {} 0 0 1.0 0.0 0 \"\"", radial.size());
        line("  XDAT 2 1.0 0 0 1.0 0.0 0 \"\"");
        for (std::size_t i = 0; i < radial.size(); ++i) {
            line("  XDAT {} {} 0 0 1.0 0.0 0 \"\"", i + 3,
                 2.0 * std::numbers::pi * radial[i] / (design_wavelength_nm * 1e-6));
        }
        return true;
    }
    static constexpr int kBinaryTerms = 8;  // of its shape

    void write_medium(const optics::StatedMedium& medium, int number) {
        if (medium.is_air()) {
            return;
        }
        double n_d = medium.n_d.value_or(0.0);
        double V_d = medium.V_d.value_or(0.0);
        if (!medium.indices.empty()) {
            std::tie(n_d, V_d) = figures_of_table(medium);
            lose("lost-indices", number,
                 fmt::format("a table of indices; n_d = {:.6f}, V_d = {:.2f} stand for it", n_d, V_d));
        }
        if (!medium.glass.empty()) {
            const auto [maker, name] = split_glass(medium.glass);
            if (medium.n_d) {
                line("  GLAS {} 0 0 {} {} 0 0 0 0 0 0", name, n_d, V_d);
            } else {
                line("  GLAS {} 0 0 1.5 40 0 0 0 0 0 0", name);  // as Zemax writes what only the catalogue knows
            }
            const auto [known, is_new] = makers_.try_emplace(name, maker);
            if (!is_new && known->second != maker) {
                lose("lost-makers", number, fmt::format("which maker's {} each surface has", name));
            }
        } else {
            line("  GLAS ___BLANK 1 0 {} {} 0 0 0 0 0 0", n_d, V_d);
        }
    }

    /// The surfaces at a zoom position, groups written in.
    [[nodiscard]] PrescriptionTable surfaces_at(std::size_t position) const {
        return without_groups(optics::at_zoom_position(original_, position)).surfaces;
    }

    void write_configurations() {
        const std::size_t count = original_.zoom.size();
        line("MNUM {} 1", std::max<std::size_t>(1, count));
        std::vector<PrescriptionTable> tables;
        for (std::size_t position = 0; position < count; ++position) {
            tables.push_back(surfaces_at(position));
            const optics::ZoomPosition& zoom = original_.zoom[position];
            if (zoom.stop_semi_diameter_mm) {
                lose("lost-stop-size", 0, fmt::format("the stop's size at the zoom position {}", zoom.name));
            }
        }
        if (count > 0) {
            lose("lost-zoom-names", 0, "the names and the stated data of zoom positions; they are numbered",
                 optics::Severity::info);
        }
        for (std::size_t row = 0; row < prescription_.surfaces.size(); ++row) {
            const bool has_gaps =
                differs(tables, prescription_.surfaces, row, &optics::PrescribedSurface::thickness_mm);
            for (std::size_t i = 0; has_gaps && i < tables.size(); ++i) {
                line("THIC {} {} {} 0 0 0 1 1 1 0 0 \"\" 0", gap_at_[row], i + 1,
                     zmx_number(tables[i][row].thickness_mm));
            }
            if (differs(tables, prescription_.surfaces, row, &optics::PrescribedSurface::misalignment)) {
                lose("lost-misalignment", static_cast<int>(row) + 1, "a decentre that differs between zoom positions");
            }
        }
    }

    void report_lost() {
        const optics::StatedData& stated = original_.stated;
        if (!original_.barrel.is_black()) {
            lose("lost-barrel", 0, "what its walls scatter", optics::Severity::info);
        }
        if (!std::holds_alternative<std::monostate>(original_.stop_shape)) {
            lose("lost-stop-shape", 0, "a stop that is no circle");
        }
        if (original_.projection != optics::Projection::rectilinear) {
            lose("lost-projection", 0, fmt::format("the projection, {}", optics::projection_name(original_.projection)),
                 optics::Severity::info);
        }
        if (!original_.focus_groups.empty()) {
            lose("lost-focus-groups", 0, "which groups move to focus");
        }
        if (original_.surroundings == optics::Surroundings::vacuum) {
            lose("lost-surroundings", 0, "that the lens stands in vacuum");
        }
        if (!original_.catalogues.empty() || !original_.enclosed_glasses.empty()) {
            lose("lost-catalogues", 0, "the lens's own glass catalogues");
        }
        if (stated.efl_mm || stated.bfl_mm || stated.total_track_mm || stated.f_number ||
            stated.entrance_pupil_diameter_mm) {
            lose("lost-stated", 0, "all of the stated data; the aperture that governs and the fields are written",
                 optics::Severity::info);
        }
        if (!original_.groups.empty() && optics::surface_frames(original_).front().origin.z != 0.0) {
            lose("lost-origin", 1, "that the first vertex lies off its untilted place; lens space begins at it");
        }
        if (!original_.groups.empty()) {
            lose("lost-groups", 0, "which surfaces are tilted as a group; each is tilted on its own, to the same place",
                 optics::Severity::info);
        }
    }

    const optics::Prescription& original_;
    optics::Prescription prescription_;  // without groups and terms along normals
    std::string text_;
    int surfaces_ = 0;
    std::vector<int> gap_at_;  // of each row, the surface of the file that carries its gap
    std::map<std::string, std::string> makers_;
    std::vector<optics::Finding> lost_;
};

}  // namespace

WrittenPrescription to_zmx(const optics::Prescription& prescription) {
    return ZmxWriter(prescription).write();
}

}  // namespace lensproof::formats
