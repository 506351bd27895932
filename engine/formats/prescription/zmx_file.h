// engine/formats/prescription/zmx_file.h — a sequential Zemax file as it stands, before its meaning is worked out.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/formats/prescription/remarks.h"
#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// A SURF block. Lengths in the file's unit.
struct ZmxSurface {
    int line = 0;
    std::string type = "STANDARD";
    double curvature = 0.0;
    double conic = 0.0;
    double thickness = 0.0;
    bool is_stop = false;
    bool is_mirror = false;
    optics::StatedMedium medium;
    std::optional<double> semi_diameter;  // DIAM; 0 says nothing
    bool semi_diameter_is_fixed = false;  // by the user, not by the rays that the program traced
    std::optional<double> aperture;       // the outer radius of a circular aperture, CLAP or FLAP
    std::optional<double> mechanical;     // MEMA
    std::map<int, double> parameters;     // PARM
    std::map<int, double> extra;          // XDAT

    [[nodiscard]] double parameter(int number) const;
    [[nodiscard]] double extra_value(int number) const;
    [[nodiscard]] bool is_break() const { return type == "COORDBRK"; }
};

/// An operand of the multi-configuration editor, by its keyword and the surface it is for; its values by
/// configuration.
using ZmxOperands = std::map<std::pair<std::string, int>, std::map<int, double>>;

struct ZmxFile {
    std::string name;
    std::vector<std::string> notes;
    double unit_mm = 1.0;
    std::string aperture_type;  // ENPD, FNUM, OBNA or FLOA
    double aperture_value = 0.0;
    bool is_working_f_number = false;
    int field_type = 0;  // 0 angle, 1 object height, 2 paraxial and 3 real image height
    int fields = 0;      // 0: not said
    std::vector<double> field_x, field_y;
    std::map<std::string, std::vector<double>> vignetting;  // VDXN, VDYN, VCXN, VCYN, by field
    int wavelengths = 0;                                    // 0: not said
    std::map<int, double> wavelengths_um;
    int reference_wavelength = 1;
    std::vector<std::string> catalogues;
    std::vector<ZmxSurface> surfaces;  // the object first, the image last
    int configurations = 1;
    ZmxOperands operands;
};

/// Reads the lines of `text` (UTF-8). Each keyword is understood, or known to bear on no ray, or named in `remarks`
/// with its line; surfaces are numbered as in the file. Throws InputError naming the line for what is no number where
/// one belongs, surfaces out of order or more than a lens of 1000 makes, and non-sequential mode.
ZmxFile read_zmx_file(std::string_view text, const std::filesystem::path& file, Remarks& remarks);

}  // namespace lensproof::formats
