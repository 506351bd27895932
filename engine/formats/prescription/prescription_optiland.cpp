// Lenses as Optiland saves them (optiland.fileio.save_optiland_file, version 0.6; github.com/HarrisonKramer/optiland):
// JSON with the object's surface first and the image's last, each with its geometry in a coordinate system of the whole
// lens, the material behind it, and what happens to a ray there. Lengths in mm, angles in radians, wavelengths in µm.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "engine/base/input_error.h"
#include "engine/base/json_value.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/frame.h"

namespace lensproof::formats {

namespace {

constexpr std::size_t kMostSurfaces = 1000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDegree = std::numbers::pi / 180.0;

/// Where a surface stands in the whole lens. Optiland turns about x, then the fixed y, then the fixed z, which is about
/// z, the turned y and the twice turned x.
optics::Frame read_frame(const JsonValue& system) {
    const Vec3d origin{system.number_or("x", 0.0), system.number_or("y", 0.0), system.number_or("z", 0.0)};
    // As deep as the file, which is bounded. An infinite z, the object's, stays out of sums over the axes.
    const optics::Frame frame = system.has("reference_cs") ? read_frame(system.at("reference_cs")).shifted(origin)
                                                           : optics::Frame{.origin = origin};
    return frame.turned(2, system.number_or("rz", 0.0) / kDegree)
        .turned(1, system.number_or("ry", 0.0) / kDegree)
        .turned(0, system.number_or("rx", 0.0) / kDegree);
}

/// The angles as a prescription has them, without the −0 of what is not turned.
std::array<double, 3> tilt_of(const optics::Frame& frame) {
    std::array<double, 3> tilts = optics::tilt_angles(frame);
    std::ranges::for_each(tilts, [](double& angle) { angle += 0.0; });
    return tilts;
}

class OptilandLens {
  public:
    explicit OptilandLens(const std::filesystem::path& file) {
        lens_.file = file;
        lens_.name = file.stem().string();
        lens_.source = "the file " + file.filename().string() + ", saved by Optiland";
    }

    optics::Prescription read(const JsonValue& top) {
        const std::vector<JsonValue> surfaces = top.at("surface_group").at("surfaces").list();
        if (surfaces.size() < 3 || surfaces.size() > kMostSurfaces) {
            throw InputError(
                fmt::format("{}: {} surfaces, expected from 3, the object's and the image's included, to {}",
                            lens_.file.string(), surfaces.size(), kMostSurfaces));
        }
        if (const std::string name = top.text_or("name", ""); !name.empty()) {
            lens_.name = name;
        }
        std::vector<optics::Frame> frames;
        frames.reserve(surfaces.size());
        for (const JsonValue& surface : surfaces) {
            frames.push_back(read_frame(surface.at("geometry").at("cs")));
        }
        for (std::size_t i = 1; i + 1 < surfaces.size(); ++i) {
            add_surface(surfaces[i], frames[i], frames[i + 1].origin.z - frames[i].origin.z);
        }
        lens_.object_distance_mm = frames[1].origin.z - frames[0].origin.z;
        if (!(std::isfinite(lens_.object_distance_mm) && lens_.object_distance_mm > 0.0)) {
            lens_.object_distance_mm = kInfinity;
        }
        read_image(surfaces.back(), frames.back());
        read_aperture(top);
        read_fields(top);
        read_wavelengths(top);
        for (const char* key : {"apodization", "pickups"}) {
            if (top.says(key)) {
                remark("not-read", 0, fmt::format("\"{}\" is not carried over", key));
            }
        }
        if (top.has("solves") && (top.at("solves").says("solves"))) {
            remark("not-read", 0, "\"solves\" is not carried over; the lengths are those saved");
        }
        name_unknown_keys(top, 0,
                          {"version", "name", "aperture", "fields", "wavelengths", "apodization", "pickups", "solves",
                           "surface_group", "ray_tracer", "paraxial", "aberrations", "polarization", "wavelength"});
        return std::move(lens_);
    }

  private:
    void remark(const std::string& code, int surface, const std::string& message,
                optics::Severity severity = optics::Severity::warning) {
        lens_.remarks.push_back({.code = code, .severity = severity, .surface = surface, .message = message});
    }

    void name_unknown_keys(const JsonValue& value, int surface, const std::set<std::string>& known) {
        for (const std::string& key : value.keys_beside(known)) {
            remark("not-read", surface, fmt::format("\"{}\" is not understood", printable(key)));
        }
    }

    void add_surface(const JsonValue& value, const optics::Frame& frame, double thickness) {
        const int number = static_cast<int>(lens_.surfaces.size()) + 1;
        optics::PrescribedSurface surface;
        surface.where = value.where();
        // The saved thickness is the shorter number, but where both are said it is the vertices that count.
        const double stated = value.number_or("thickness", thickness);
        surface.thickness_mm = std::abs(stated - thickness) < 1e-9 ? stated : thickness;
        surface.is_stop = value.is_true("is_stop");
        surface.misalignment = {{frame.origin.x, frame.origin.y}, tilt_of(frame)};
        read_geometry(value.at("geometry"), number, surface);
        read_material(value.at("material_post"), number, surface.medium);
        read_rim(value, number, surface);
        read_interaction(value.has("interaction_model") ? value.at("interaction_model") : value, number);
        name_unknown_keys(
            value, number,
            {"type", "thickness", "geometry", "material_pre", "material_post", "is_stop", "aperture", "comment",
             "interaction_model", "is_reflective", "coating", "bsdf", "surface_type", "semi_aperture"});
        lens_.surfaces.push_back(std::move(surface));
    }

    void read_geometry(const JsonValue& geometry, int number, optics::PrescribedSurface& surface) {
        const std::string type = geometry.text_or("type", "");
        surface.radius_mm = geometry.number_or("radius", kInfinity);
        surface.conic = geometry.number_or("conic", 0.0);
        if (type == "Plane" || type == "StandardGeometry") {
            return;
        }
        if (type == "EvenAsphere") {
            read_terms(geometry, "coefficients", number, surface);
        } else if (type == "ToroidalGeometry") {
            surface.radius_mm = geometry.number_or("radius_y", kInfinity);
            surface.radius_x_mm = geometry.number_or("radius_x", kInfinity);
            surface.conic = geometry.number_or("conic_yz", 0.0);
            read_terms(geometry, "coeffs_poly_y", number, surface);
        } else {
            surface.radius_mm = geometry.number_or("radius_y", surface.radius_mm);
            surface.conic = geometry.number_or("conic_y", surface.conic);
            remark("shape-not-read", number,
                   fmt::format("a surface of the kind \"{}\" is not understood: its radius and conic alone are taken",
                               printable(type)),
                   optics::Severity::error);
        }
    }

    void read_terms(const JsonValue& geometry, const std::string& key, int number, optics::PrescribedSurface& surface) {
        if (!geometry.has(key)) {
            return;
        }
        const std::vector<JsonValue> terms = geometry.at(key).list();
        for (std::size_t term = 0; term < terms.size(); ++term) {
            const double coefficient = terms[term].number();
            if (term < optics::kAsphereTerms) {
                surface.asphere[term] = coefficient;
            } else if (coefficient != 0.0) {
                remark("asphere-term-not-read", number,
                       fmt::format("the term of r^{} is left out: even powers up to r²⁰ are carried", 2 * term + 2),
                       optics::Severity::error);
            }
        }
    }

    void read_material(const JsonValue& material, int number, optics::StatedMedium& medium) {
        const std::string type = material.text_or("type", "");
        if (type == "IdealMaterial") {
            const double index = material.at("index").number();
            if (index != 1.0) {
                medium.n_d = index;
            }
            if (material.number_or("absorp", 0.0) != 0.0) {
                remark("absorption-not-read", number, "the absorption of its material is left out");
            }
        } else if (type == "AbbeMaterial" || type == "AbbeMaterialE") {
            medium.n_d = material.at("index").number();
            medium.V_d = material.at("abbe").number();
            const bool at_e = type == "AbbeMaterialE";
            remark("dispersion-model", number,
                   at_e ? "its index and Abbe number are those of the e line, and are taken as if at the d line"
                        : "between the lines its index follows the normal line, not Optiland's fit",
                   at_e ? optics::Severity::warning : optics::Severity::info);
        } else if (type == "Material" || type == "MaterialFile") {
            medium.glass = glass_name(material);
        } else if (type != "Mirror") {
            medium.glass = type;
            remark("material-not-read", number,
                   fmt::format("a material of the kind \"{}\" is not understood", printable(type)));
        }
        if (medium.glass == "air") {
            medium = {};
        }
    }

    /// "SCHOTT N-BK7", with the maker that Optiland found, which stands in the path of its file.
    static std::string glass_name(const JsonValue& material) {
        std::string path = material.text_or("filename", "");
        std::ranges::replace(path, '\\', '/');
        const std::filesystem::path file(path);
        std::string name = material.text_or("name", file.stem().string());
        if (file.parent_path().parent_path().filename() != "glass") {
            return name;
        }
        std::string maker = file.parent_path().filename().string();
        std::ranges::transform(maker, maker.begin(), [](unsigned char letter) { return std::toupper(letter); });
        return maker + " " + name;
    }

    void read_rim(const JsonValue& value, int number, optics::PrescribedSurface& surface) {
        if (!value.has("aperture")) {
            return;
        }
        const JsonValue aperture = value.at("aperture");
        const std::string type = aperture.text_or("type", "");
        if (type != "RadialAperture") {
            remark("aperture-not-read", number,
                   fmt::format("an aperture of the kind \"{}\" is left out", printable(type)));
            return;
        }
        surface.semi_diameter_mm = aperture.at("r_max").number();
        if (aperture.number_or("r_min", 0.0) != 0.0) {
            remark("aperture-not-read", number, "the hole in its aperture is left out");
        }
    }

    void read_interaction(const JsonValue& model, int number) {
        if (model.is_true("is_reflective")) {
            remark("mirror", number, "a mirror: it is taken as a refracting surface", optics::Severity::error);
        }
        if (model.has("coating")) {
            remark("coating-not-read", number, "its coating is left out");
        }
        if (model.has("bsdf")) {
            remark("not-read", number, "its scattering is left out");
        }
        const std::string type = model.text_or("type", "RefractiveReflectiveModel");
        if (type.find("Model") != std::string::npos && type != "RefractiveReflectiveModel") {
            remark("not-read", number, fmt::format("what \"{}\" does to rays is left out", printable(type)));
        }
    }

    void read_image(const JsonValue& image, const optics::Frame& frame) {
        const double radius = image.at("geometry").number_or("radius", kInfinity);
        if (std::isfinite(radius) && radius != 0.0) {
            remark("curved-image", 0,
                   fmt::format("the image's surface has a radius of {} mm; the sensor is flat", radius));
        }
        if (tilt_of(frame) != std::array<double, 3>{} || frame.origin.x != 0.0 || frame.origin.y != 0.0) {
            remark("tilted-image", 0, "the image's surface is tilted or shifted; the sensor is not");
        }
    }

    void read_aperture(const JsonValue& top) {
        if (!top.has("aperture")) {
            return;
        }
        const JsonValue aperture = top.at("aperture");
        const std::string type = aperture.has("type") ? aperture.at("type").text() : aperture.text_or("ap_type", "");
        const double value = aperture.at("value").number();
        const auto stop = std::ranges::find_if(lens_.surfaces, &optics::PrescribedSurface::is_stop);
        if (type == "EPD") {
            lens_.stated.entrance_pupil_diameter_mm = value;
        } else if (type == "imageFNO") {
            lens_.stated.f_number = value;
        } else if (type == "float_by_stop_size" && stop != lens_.surfaces.end()) {
            stop->semi_diameter_mm = 0.5 * value;
        } else {
            remark("not-read", 0, fmt::format("an aperture stated as \"{}\" is left out", printable(type)));
        }
    }

    void read_fields(const JsonValue& top) {
        if (!top.has("fields")) {
            return;
        }
        const JsonValue fields = top.at("fields");
        const std::string type = fields.has("field_definition")
                                     ? fields.at("field_definition").text_or("field_type", "")
                                     : fields.text_or("field_type", "");
        double largest = 0.0;
        bool vignetted = false;
        for (const JsonValue& field : fields.at("fields").list()) {
            largest = std::max(largest, std::hypot(field.number_or("x", 0.0), field.number_or("y", 0.0)));
            vignetted = vignetted || field.number_or("vx", 0.0) != 0.0 || field.number_or("vy", 0.0) != 0.0;
        }
        if (vignetted) {
            remark("not-read", 0, "the fields' vignetting factors are left out: rims vignette here");
        }
        if (!(largest > 0.0)) {
            return;
        }
        if (type == "AngleField" || type == "angle") {
            lens_.stated.half_field_deg = largest;
        } else if (type.find("ImageHeight") != std::string::npos || type.find("image_height") != std::string::npos) {
            lens_.stated.image_circle_mm = 2.0 * largest;
        } else {
            remark("not-read", 0, fmt::format("fields stated as \"{}\" are left out", printable(type)));
        }
    }

    void read_wavelengths(const JsonValue& top) {
        if (!top.has("wavelengths")) {
            return;
        }
        for (const JsonValue& wavelength : top.at("wavelengths").at("wavelengths").list()) {
            const std::string unit = wavelength.text_or("unit", "um");
            // Rounded to what a wavelength in µm can have been written with: 0.5875618 is 587.5618.
            const double nm = std::round(wavelength.at("value").number() * (unit == "nm" ? 1.0 : 1e3) * 1e9) / 1e9;
            if (!(nm > 0.0) || !std::isfinite(nm) || (unit != "um" && unit != "nm")) {
                remark("not-read", 0, fmt::format("a wavelength in \"{}\" is left out", printable(unit)));
                continue;
            }
            lens_.wavelengths_nm.insert(
                wavelength.is_true("is_primary") ? lens_.wavelengths_nm.begin() : lens_.wavelengths_nm.end(), nm);
        }
        const std::string polarization =
            top.at("wavelengths").has("polarization") ? top.at("wavelengths").at("polarization").text() : "ignore";
        if (polarization != "ignore") {
            remark("not-read", 0, "the polarisation of the light is left out");
        }
    }

    optics::Prescription lens_;
};

}  // namespace

optics::Prescription parse_optiland(const std::string& text, const std::filesystem::path& file) {
    return OptilandLens(file).read(JsonValue::parse(text, file));
}

}  // namespace lensproof::formats
