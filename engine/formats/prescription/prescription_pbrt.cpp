// The lens files of pbrt's realistic camera: a row per surface, scene to sensor, of radius, distance to the next
// surface, index behind (0 or 1: air) and the aperture's DIAMETER, in mm; radius 0 is the stop's plane (Pharr, Jakob,
// Humphreys, Physically Based Rendering, 3rd ed., §6.4; the files in mmp/pbrt-v4-scenes/lenses). pbrt places the sensor
// by focusing, so the last distance often is 0.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/prescription_losses.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::formats {

namespace {

// What lens files for renderers write where they mean a plane that is not the stop's.
constexpr double kAlmostFlat = 1e5;

std::vector<double> read_numbers(std::string_view line, const std::string& where) {
    std::vector<double> numbers;
    for (const std::string_view word : words_of(line)) {
        const std::optional<double> number = parse_number(word);
        if (!number || numbers.size() == 5) {
            throw InputError(fmt::format("{}: found \"{}\", expected radius, thickness, index and aperture diameter",
                                         where, printable(word)));
        }
        numbers.push_back(*number);
    }
    return numbers;
}

class PbrtLens {
  public:
    explicit PbrtLens(const std::filesystem::path& file) : lens_(prescription_of(file)) {}

    optics::Prescription read(std::string_view text) {
        std::vector<std::string> comments;
        int number = 0;
        for (const std::string_view line : lines_of(without_byte_order_mark(text))) {
            ++number;
            const std::size_t hash = std::min(line.find('#'), line.size());
            if (const std::string_view comment = trimmed(line.substr(hash)); !comment.empty()) {
                comments.emplace_back(trimmed(comment.substr(1)));
            }
            const std::string where = fmt::format("{}:{}", lens_.file.string(), number);
            if (const std::vector<double> numbers = read_numbers(line.substr(0, hash), where); !numbers.empty()) {
                add_row(numbers, where);
            }
        }
        if (lens_.surfaces.empty()) {
            throw InputError(
                fmt::format("{}: holds no row of radius, thickness, index and aperture diameter", lens_.file.string()));
        }
        take_comments(comments);
        remark_on_thicknesses();
        return std::move(lens_);
    }

  private:
    void remark(const std::string& code, optics::Severity severity, int surface, const std::string& message) {
        lens_.remarks.push_back({code, severity, surface, message});
    }

    void add_row(const std::vector<double>& numbers, const std::string& where) {
        if (numbers.size() < 4) {
            throw InputError(fmt::format("{}: {} numbers, expected radius, thickness, index and aperture diameter",
                                         where, numbers.size()));
        }
        if (lens_.surfaces.size() == kMostSurfaces) {
            throw InputError(fmt::format("{}: more than {} surfaces", where, kMostSurfaces));
        }
        const int number = static_cast<int>(lens_.surfaces.size()) + 1;
        const double index = numbers[2] == 0.0 ? 1.0 : numbers[2];
        const double before = lens_.surfaces.empty() ? 1.0 : lens_.surfaces.back().medium.n_d.value_or(1.0);
        optics::PrescribedSurface surface;
        surface.where = fmt::format("{}: surface {}", where, number);
        surface.is_stop = numbers[0] == 0.0 && index == before;
        surface.radius_mm = numbers[0] == 0.0 ? kInfinity : numbers[0];
        surface.thickness_mm = numbers[1];
        surface.semi_diameter_mm = 0.5 * numbers[3];
        if (index != 1.0) {
            surface.medium.n_d = index;
        }
        if (numbers.size() == 5) {
            remark("column-beyond-pbrt", optics::Severity::info, number,
                   fmt::format("a fifth number, {}, taken as V_d where glass follows", numbers[4]));
            if (surface.medium.n_d && numbers[4] != 0.0) {
                surface.medium.V_d = numbers[4];
            }
        }
        if (numbers[0] == 0.0 && !surface.is_stop) {
            remark("flat-or-stop", optics::Severity::warning, number,
                   "radius 0 is pbrt's stop, but the index changes here: taken as a flat surface");
        }
        lens_.surfaces.push_back(std::move(surface));
    }

    void take_comments(std::vector<std::string>& comments) {
        std::erase(comments, "");
        const bool heads_columns = !comments.empty() && comments.back().find("radius") != std::string::npos;
        if (heads_columns) {
            comments.pop_back();
        }
        if (!comments.empty()) {
            lens_.name = comments.front();
            comments.erase(comments.begin());
        }
        lens_.notes = fmt::format("{}", fmt::join(comments, "\n"));
    }

    /// Some files give each surface the distance from the one before; and most leave the sensor to the camera.
    void remark_on_thicknesses() {
        const bool starts_with_zero = lens_.surfaces.size() > 1 && lens_.surfaces.front().thickness_mm == 0.0;
        if (starts_with_zero) {
            remark("thickness-shifted", optics::Severity::warning, 1,
                   "its thickness is 0: the column may hold distances from the surface before; it is read as pbrt "
                   "does, to the next");
        }
        if (lens_.surfaces.back().thickness_mm != 0.0) {
            return;
        }
        const double focus = paraxial_focus();
        if (std::isfinite(focus) && focus > 0.0) {
            lens_.surfaces.back().thickness_mm = focus;
            remark("sensor-placed", optics::Severity::warning, static_cast<int>(lens_.surfaces.size()),
                   fmt::format("the sensor's distance is 0, since pbrt's camera focuses: the sensor is put at the "
                               "paraxial focus of infinity, {:.6g} mm behind the last surface",
                               focus));
        }
    }

    /// From the last vertex; NaN or infinite where there is none.
    [[nodiscard]] double paraxial_focus() const {
        double height = 1.0;
        double slope = 0.0;  // times the index
        double before = 1.0;
        for (const optics::PrescribedSurface& surface : lens_.surfaces) {
            const double after = surface.medium.n_d.value_or(1.0);
            slope -= (after - before) * surface.curvature() * height;
            before = after;
            if (&surface != &lens_.surfaces.back()) {
                height += surface.thickness_mm * slope / after;
            }
        }
        return -height * before / slope;
    }

    optics::Prescription lens_;
};

class PbrtWriter {
  public:
    explicit PbrtWriter(const optics::Prescription& prescription)
        : lens_(single_position(prescription, written_.lost)),
          glasses_(with_own_catalogues(shipped_glasses(), lens_)) {}

    WrittenPrescription write() {
        std::ranges::copy(losses_of_tables(lens_), std::back_inserter(written_.lost));
        state_rims(lens_, written_.lost);
        add_comment(lens_.name);
        add_comment(lens_.source);
        add_comment(lens_.notes);
        written_.text += "# radius thickness index aperture_diameter\n";
        double before = 1.0;
        for (std::size_t i = 0; i < lens_.surfaces.size(); ++i) {
            before = add_row(i, before);
        }
        return std::move(written_);
    }

  private:
    void add_comment(std::string_view text) {
        while (!text.empty()) {
            const std::string_view line = text.substr(0, text.find('\n'));
            text.remove_prefix(std::min(line.size() + 1, text.size()));
            written_.text += fmt::format("# {}\n", trimmed(line));
        }
    }

    void lose(const std::string& code, optics::Severity severity, std::size_t index, const std::string& message) {
        written_.lost.push_back(lost(code, severity, static_cast<int>(index) + 1, message));
    }

    void add_line(double radius, double thickness, double index, double aperture) {
        written_.text += fmt::format("{}\t{}\t{}\t{}\n", radius, thickness, index, aperture);
    }

    /// Returns the index behind the surface.
    double add_row(std::size_t i, double before) {
        const optics::PrescribedSurface& row = lens_.surfaces[i];
        const optics::Glass medium = optics::resolved_medium(row, glasses_, lens_.preferred_makers);
        const double after = optics::refractive_index(medium.formula, spectral::kLineD);
        if (!row.medium.glass.empty() && !row.medium.is_air()) {
            lose("lost-dispersion", optics::Severity::warning, i,
                 fmt::format("of {} its index at the d line alone is written, {}", row.medium.glass, after));
        } else if (row.medium.V_d || row.medium.indices.size() > 1) {
            lose("lost-dispersion", optics::Severity::warning, i,
                 fmt::format("its index at the d line alone is written, {}", after));
        }
        if (row.conic != 0.0 || row.is_asphere()) {
            lose("lost-asphere", optics::Severity::warning, i, "its conic and aspheric terms are left out");
        }
        const double aperture = 2.0 * *plain_semi_diameter(lens_, i);
        const bool is_plane = row.is_flat();
        if (row.is_stop && is_plane && after == before) {
            add_line(0.0, row.thickness_mm, after == 1.0 ? 0.0 : after, aperture);
            return after;
        }
        if (row.is_stop) {
            lose("lost-stop", optics::Severity::warning, i,
                 "the stop lies on a refracting surface; it is written as a plane in front of that");
            add_line(0.0, 0.0, before == 1.0 ? 0.0 : before, aperture);
        }
        if (is_plane) {
            lose("lost-flat", optics::Severity::warning, i,
                 fmt::format("radius 0 is the stop; the plane is written with a radius of {} mm", kAlmostFlat));
        }
        add_line(is_plane ? kAlmostFlat : row.radius_mm, row.thickness_mm, after, aperture);
        return after;
    }

    WrittenPrescription written_;
    optics::Prescription lens_;
    optics::GlassCatalogue glasses_;
};

}  // namespace

optics::Prescription parse_pbrt_lens(const std::string& text, const std::filesystem::path& file) {
    return PbrtLens(file).read(to_utf8(text));
}

WrittenPrescription to_pbrt_lens(const optics::Prescription& prescription) {
    return PbrtWriter(prescription).write();
}

}  // namespace lensproof::formats
