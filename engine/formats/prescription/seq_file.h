// engine/formats/prescription/seq_file.h — a CODE V sequence file's lens as it stands, before its meaning is worked
// out.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/formats/prescription/remarks.h"
#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// How a surface's decentre and tilt act on those behind it.
enum class SeqDecentre {
    basic,    // they follow it
    restore,  // DAR: they stand as if it were not there
    reverse,  // REV: it acts behind the surface, and backwards
    bend      // BEN: it acts a second time behind the surface
};

/// Which of its coefficients a special surface's normalizing radius is (prescription_seq.cpp has the source).
inline constexpr int kSeqNormalizingRadius = 33;

/// An S line with what follows it. Lengths in the file's unit.
struct SeqSurface {
    int line = 0;
    std::string type = "SPH";
    double curvature = 0.0;
    double curvature_x = 0.0;  // of CYL, YTO and XTO
    double thickness = 0.0;
    std::string glass;
    bool is_stop = false;
    bool is_mirror = false;
    double conic = 0.0;
    std::array<double, optics::kAsphereTerms> asphere{};  // of r², r⁴, … r²⁰; the form has no first
    std::string special;                                  // SPS: the kind of a special surface
    std::map<int, double> special_values;                 // SCO C1, C2, …
    std::optional<double> semi_diameter;                  // CIR
    std::optional<double> edge;                           // CIR EDG
    std::array<double, 3> decentre{};                     // XDE, YDE, ZDE
    std::array<double, 3> tilt_deg{};                     // ADE, BDE, CDE
    SeqDecentre decentre_kind = SeqDecentre::basic;
};

struct SeqFile {
    std::string title;
    double unit_mm = 1.0;
    std::string aperture_type;  // EPD, FNO, NA or NAO
    double aperture_value = 0.0;
    std::map<std::string, std::vector<double>> fields;  // XAN, YAN, XOB, YOB, XIM, YIM, XRI, YRI
    std::vector<double> wavelengths_nm;
    int reference_wavelength = 1;
    std::map<std::string, std::vector<optics::WavelengthValue>> private_glasses;  // PRV, by rising wavelength
    std::vector<SeqSurface> surfaces;                                             // the object first
    bool has_image = false;                                                       // the last surface is SI
    int zoom_positions = 1;
    std::map<int, std::vector<double>> zoomed_thicknesses;        // ZOO THI, by surface
    std::map<std::string, std::vector<double>> zoomed_apertures;  // ZOO EPD, ZOO FNO
    std::vector<std::string> zoom_titles;
};

/// Reads the statements of `text` (UTF-8). Each command is understood, or known to bear on no ray, or named in
/// `remarks` with its line; surfaces are numbered as in the file, 0 the object. Throws InputError naming the line for
/// what is no number where one belongs, and for more than 1000 surfaces.
SeqFile read_seq_file(std::string_view text, const std::filesystem::path& file, Remarks& remarks);

}  // namespace lensproof::formats
