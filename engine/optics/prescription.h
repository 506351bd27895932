// engine/optics/prescription.h — a lens as its file states it: the table, the source, what the source claims.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lensproof {

/// The mapping from field angle θ to image height that a lens is designed for.
enum class Projection { rectilinear, equidistant, equisolid, stereographic, orthographic };

std::string projection_name(Projection projection);

/// r / f of a projection at field angle θ (radians): tan θ, θ, 2 sin(θ/2), 2 tan(θ/2), sin θ.
double projected_radius(Projection projection, double field_angle);

/// What a table states about the medium behind a surface.
struct StatedMedium {
    std::string glass;  // catalogue name; empty: air, or n_d below
    std::optional<double> n_d;
    std::optional<double> V_d;  // without it, n_d holds at every wavelength
};

/// One row of a prescription.
struct PrescribedSurface {
    double curvature = 0.0;     // 1/mm
    double thickness_mm = 0.0;  // to the next surface; for the last one: to the sensor
    double semi_diameter_mm = 0.0;
    StatedMedium medium;  // behind the surface
    bool is_stop = false;
    std::string where;  // "file:line: surfaces[3]", for messages
};

/// What the source claims about the lens as a whole; each is optional.
struct StatedData {
    std::optional<double> efl_mm;
    std::optional<double> bfl_mm;
    std::optional<double> f_number;
    std::optional<double> half_field_deg;
    std::optional<double> image_circle_mm;  // diameter
};

struct Prescription {
    std::string name;
    std::string source;
    std::string notes;
    Projection projection = Projection::rectilinear;
    StatedData stated;
    std::vector<PrescribedSurface> surfaces;
    std::filesystem::path file;
};

/// Reads the project's TOML form (described in lenses/README.md) or, for a file called *.csv, the plain table of
/// `surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind`. What can be read and traced is checked here: finite
/// numbers, positive semi-diameters, no negative thickness, exactly one stop. Throws InputError otherwise.
Prescription read_prescription(const std::filesystem::path& file);

/// The file of a LENS argument: a path, or the name of a lens that ships in lenses/. Throws InputError listing the
/// names.
std::filesystem::path find_lens_file(const std::string& lens);

/// Names of the lenses that ship, sorted.
std::vector<std::string> shipped_lens_names();

}  // namespace lensproof
