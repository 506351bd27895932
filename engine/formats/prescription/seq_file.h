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

/// A kind of special surface, whose coefficients are stated by name or by number, C1, C2, …
struct SeqSpecial {
    std::string_view name;
    std::string_view terms;          // what the names of its terms begin with
    int step;                        // from one term's power of r to the next
    int first_power;                 // of r
    int first_number;                // the coefficient that it is
    int conic;                       // which coefficient K is; 0: there is none
    int radius;                      // which coefficient NRADIUS, the normalizing radius, is
    bool radius_stands_beside_name;  // "SPS ODD 0.0"
};

/// The odd polynomial's layout is a public exporter's, which cites CODE V's Lens System Setup Reference Manual. That of
/// Forbes's mild asphere is from a listing of CODE V's own (threemrc_qbfs.lis, which comes with rayoptics):
/// NRADIUS is C1, QB4, QB6, … are C3, C4, …; his strong asphere is taken to be laid out alike.
inline constexpr std::array<SeqSpecial, 3> kSeqSpecials = {
    {{"ODD", "AR", 1, 1, 2, 1, 33, true}, {"QBF", "QB", 2, 4, 3, 0, 1, false}, {"QCN", "QC", 2, 4, 3, 2, 1, false}}};

/// The kind of that name, or nullptr.
const SeqSpecial* find_special(std::string_view name);

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
    std::optional<optics::PhaseElement> kinoform;         // DIF DOE, in the file's unit
    std::array<double, 3> decentre{};                     // XDE, YDE, ZDE
    std::array<double, 3> tilt_deg{};                     // ADE, BDE, CDE
    SeqDecentre decentre_kind = SeqDecentre::basic;
};

struct SeqFile {
    std::string title;
    double unit_mm = 1.0;
    std::string aperture_type;  // EPD, FNO, NA or NAO
    double aperture_value = 0.0;
    // XAN, YAN, XOB, YOB, XIM, YIM, XRI, YRI, and the vignetting factors VUX, VLX, VUY, VLY
    std::map<std::string, std::vector<double>> fields;
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
