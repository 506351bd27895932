// Lenses as Optiland saves them (optiland.fileio.save_optiland_file, version 0.6; github.com/HarrisonKramer/optiland):
// JSON with the object's surface first and the image's last, each with its geometry in a coordinate system of the whole
// lens, the material behind it, and what happens to a ray there. Lengths in mm, angles in radians, wavelengths in µm.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/forbes_asphere.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/python_json.h"
#include "engine/optics/frame.h"

namespace lensproof::formats {

namespace {

/// Where a surface stands in the whole lens. Optiland turns about x, then the fixed y, then the fixed z, which is about
/// z, the turned y and the twice turned x.
optics::Frame read_frame(const JsonNode& system) {
    const Vec3d origin{number_or(system, "x", 0.0), number_or(system, "y", 0.0), number_or(system, "z", 0.0)};
    // As deep as the file, which is bounded. An infinite z, the object's, stays out of sums over the axes.
    const optics::Frame frame = system.has("reference_cs") ? read_frame(system.at("reference_cs")).shifted(origin)
                                                           : optics::Frame{.origin = origin};
    return frame.turned(2, number_or(system, "rz", 0.0) / kDegree)
        .turned(1, number_or(system, "ry", 0.0) / kDegree)
        .turned(0, number_or(system, "rx", 0.0) / kDegree);
}

/// The angles as a prescription has them, without the −0 of what is not turned.
std::array<double, 3> tilt_of(const optics::Frame& frame) {
    std::array<double, 3> tilts = optics::tilt_angles(frame);
    std::ranges::for_each(tilts, [](double& angle) { angle += 0.0; });
    return tilts;
}

class OptilandLens {
  public:
    explicit OptilandLens(const std::filesystem::path& file) : lens_(prescription_of(file)) {
        lens_.source += ", saved by Optiland";
    }

    optics::Prescription read(const JsonNode& top) {
        const std::vector<JsonNode> surfaces = top.at("surface_group").at("surfaces").elements();
        if (surfaces.size() < 3 || surfaces.size() > kMostSurfaces) {
            throw InputError(
                fmt::format("{}: {} surfaces, expected from 3, the object's and the image's included, to {}",
                            lens_.file.string(), surfaces.size(), kMostSurfaces));
        }
        if (const std::string name = text_or(top, "name", ""); !name.empty()) {
            lens_.name = name;
        }
        std::vector<optics::Frame> frames;
        frames.reserve(surfaces.size());
        for (const JsonNode& surface : surfaces) {
            frames.push_back(read_frame(surface.at("geometry").at("cs")));
        }
        for (std::size_t i = 1; i + 1 < surfaces.size(); ++i) {
            add_surface(surfaces[i], frames[i], frames[i + 1].origin.z - frames[i].origin.z);
        }
        if (says(surfaces.front(), "material_post")) {
            read_material(surfaces.front().at("material_post"), 0, lens_.object_medium);
        }
        optics::set_mirror_media(lens_.surfaces, lens_.object_medium);
        lens_.object_distance_mm = frames[1].origin.z - frames[0].origin.z;
        if (!(std::isfinite(lens_.object_distance_mm) && lens_.object_distance_mm > 0.0)) {
            lens_.object_distance_mm = kInfinity;
        }
        read_image(surfaces.back(), frames.back());
        read_aperture(top);
        read_fields(top);
        read_wavelengths(top);
        for (const char* key : {"apodization", "pickups"}) {
            if (says(top, key)) {
                remark("not-read", 0, fmt::format("\"{}\" is not carried over", key));
            }
        }
        if (top.has("solves") && (says(top.at("solves"), "solves"))) {
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
        lens_.remarks.push_back({code, severity, surface, message});
    }

    void name_unknown_keys(const JsonNode& value, int surface, const std::set<std::string>& known) {
        for (const std::string& key : keys_beside(value, known)) {
            remark("not-read", surface, fmt::format("\"{}\" is not understood", printable(key)));
        }
    }

    void add_surface(const JsonNode& value, const optics::Frame& frame, double thickness) {
        const int number = static_cast<int>(lens_.surfaces.size()) + 1;
        optics::PrescribedSurface surface;
        surface.where = value.where();
        // The saved thickness is the shorter number, but where both are said it is the vertices that count.
        const double stated = number_or(value, "thickness", thickness);
        surface.thickness_mm = std::abs(stated - thickness) < 1e-9 ? stated : thickness;
        surface.is_stop = is_true(value, "is_stop");
        surface.misalignment = {{frame.origin.x, frame.origin.y}, tilt_of(frame)};
        read_geometry(value.at("geometry"), number, surface);
        read_material(value.at("material_post"), number, surface.medium);
        read_rim(value, number, surface);
        read_interaction(value.has("interaction_model") ? value.at("interaction_model") : value, number, surface);
        const bool is_fold =
            surface.is_mirror && surface.is_flat() && !surface.phase && surface.misalignment != optics::Misalignment{};
        if (is_fold) {
            remark("mirror", number, "a flat mirror that folds the axis, which is not unfolded here",
                   optics::Severity::error);
        }
        name_unknown_keys(
            value, number,
            {"type", "thickness", "geometry", "material_pre", "material_post", "is_stop", "aperture", "comment",
             "interaction_model", "is_reflective", "coating", "bsdf", "surface_type", "semi_aperture"});
        lens_.surfaces.push_back(std::move(surface));
    }

    void read_geometry(const JsonNode& geometry, int number, optics::PrescribedSurface& surface) {
        const std::string type = text_or(geometry, "type", "");
        surface.radius_mm = number_or(geometry, "radius", kInfinity);
        surface.conic = number_or(geometry, "conic", 0.0);
        if (type == "Plane" || type == "StandardGeometry") {
            return;
        }
        if (type == "PlaneGrating" || type == "StandardGratingGeometry") {
            read_grating(geometry, number, surface);
        } else if (type == "EvenAsphere" || type == "OddAsphere") {
            read_terms(geometry, "coefficients", type == "OddAsphere" ? 1 : 2, number, surface);
        } else if (type == "ForbesQNormalSlopeGeometry" || type == "ForbesQbfsGeometry") {
            read_forbes_terms(geometry.at("surface_config"), number, surface);
        } else if (type == "ToroidalGeometry") {
            surface.radius_mm = number_or(geometry, "radius_y", kInfinity);
            surface.radius_x_mm = number_or(geometry, "radius_x", kInfinity);
            surface.conic = number_or(geometry, "conic_yz", 0.0);
            read_terms(geometry, "coeffs_poly_y", 2, number, surface);
        } else {
            surface.radius_mm = number_or(geometry, "radius_y", surface.radius_mm);
            surface.conic = number_or(geometry, "conic_y", surface.conic);
            remark("shape-not-read", number,
                   fmt::format("a surface of the kind \"{}\" is not understood: its radius and conic alone are taken",
                               printable(type)),
                   optics::Severity::error);
        }
    }

    /// Lines along its x where the angle of the grooves is 0. The period is in µm.
    void read_grating(const JsonNode& geometry, int number, optics::PrescribedSurface& surface) {
        constexpr double kMmPerUm = 1e-3;
        const double period_mm = kMmPerUm * any_number(geometry.at("period"));
        optics::PhaseElement grating;
        grating.order = any_number(geometry.at("order"));
        grating.lines_per_mm = 1.0 / period_mm;
        surface.phase = grating;
        if (number_or(geometry, "angle", 0.0) != 0.0) {
            remark("shape-not-read", number, "its grating's lines are turned about the axis, which is not followed",
                   optics::Severity::error);
        }
    }

    /// Forbes's mild asphere: {"radius", "conic", "norm_radius", "terms": {"0": a_0, …}}. Beyond the normalizing radius
    /// Optiland leaves the terms out; here they go on.
    void read_forbes_terms(const JsonNode& config, int number, optics::PrescribedSurface& surface) {
        surface.radius_mm = number_or(config, "radius", kInfinity);
        surface.conic = number_or(config, "conic", 0.0);
        surface.along_normal = true;
        std::array<double, kForbesTerms> a{};
        for (const std::string& key : config.at("terms").keys()) {
            const double coefficient = any_number(config.at("terms").at(key));
            const int m = parse_exact<int>(key).value_or(-1);
            if (m >= 0 && m < kForbesTerms) {
                a[m] = coefficient;
            } else if (coefficient != 0.0) {
                remark("asphere-term-not-read", number,
                       fmt::format("Forbes's term \"{}\" is left out: 0 to {} are carried", printable(key),
                                   kForbesTerms - 1),
                       optics::Severity::error);
            }
        }
        const double radius = number_or(config, "norm_radius", 0.0);
        if (radius > 0.0 && std::isfinite(radius)) {
            surface.asphere = powers_of_qbfs(a, radius);
        } else {
            remark("shape-not-read", number, "its Forbes terms have no norm_radius: they are left out",
                   optics::Severity::error);
        }
    }

    /// Coefficients of r^step, r^(2 step), …
    void read_terms(const JsonNode& geometry, const std::string& key, int step, int number,
                    optics::PrescribedSurface& surface) {
        if (!geometry.has(key)) {
            return;
        }
        const std::vector<JsonNode> terms = geometry.at(key).elements();
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const double coefficient = any_number(terms[i]);
            const std::size_t power = static_cast<std::size_t>(step) * (i + 1);
            if (power <= optics::kHighestPower) {
                surface.term(static_cast<int>(power)) = coefficient;
            } else if (coefficient != 0.0) {
                remark("asphere-term-not-read", number,
                       fmt::format("the term of r^{} is left out: powers up to r^{} are carried", power,
                                   optics::kHighestPower),
                       optics::Severity::error);
            }
        }
    }

    void read_material(const JsonNode& material, int number, optics::StatedMedium& medium) {
        const std::string type = text_or(material, "type", "");
        if (type == "IdealMaterial") {
            const double index = any_number(material.at("index"));
            if (index != 1.0) {
                medium.n_d = index;
            }
            if (number_or(material, "absorp", 0.0) != 0.0) {
                remark("absorption-not-read", number, "the absorption of its material is left out");
            }
        } else if (type == "AbbeMaterial" || type == "AbbeMaterialE") {
            medium.n_d = any_number(material.at("index"));
            medium.V_d = any_number(material.at("abbe"));
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
    static std::string glass_name(const JsonNode& material) {
        std::string path = text_or(material, "filename", "");
        std::ranges::replace(path, '\\', '/');
        const std::filesystem::path file(path);
        std::string name = text_or(material, "name", file.stem().string());
        if (file.parent_path().parent_path().filename() != "glass") {
            return name;
        }
        return upper_case(file.parent_path().filename().string()) + " " + name;
    }

    void read_rim(const JsonNode& value, int number, optics::PrescribedSurface& surface) {
        if (!value.has("aperture")) {
            return;
        }
        const JsonNode aperture = value.at("aperture");
        const std::string type = text_or(aperture, "type", "");
        if (type != "RadialAperture") {
            remark("aperture-not-read", number,
                   fmt::format("an aperture of the kind \"{}\" is left out", printable(type)));
            return;
        }
        if (const double largest = any_number(aperture.at("r_max")); largest != kInfinity) {  // a hole alone
            surface.semi_diameter_mm = largest;
        }
        if (number_or(aperture, "r_min", 0.0) != 0.0) {
            remark("aperture-not-read", number, "the hole in its aperture is left out");
        }
    }

    /// Whether it is a mirror, or an ideal lens.
    void read_interaction(const JsonNode& model, int number, optics::PrescribedSurface& surface) {
        if (model.has("coating")) {
            remark("coating-not-read", number, "its coating is left out");
        }
        if (model.has("bsdf")) {
            remark("not-read", number, "its scattering is left out");
        }
        const std::string type = text_or(model, "type", "RefractiveReflectiveModel");
        if (type == "ThinLensInteractionModel") {
            surface.ideal_focal_length_mm = any_number(model.at("focal_length"));
        } else if (type.find("Model") != std::string::npos && type != "RefractiveReflectiveModel" &&
                   type != "DiffractiveInteractionModel") {
            remark("not-read", number, fmt::format("what \"{}\" does to rays is left out", printable(type)));
        }
        surface.is_mirror = is_true(model, "is_reflective");
    }

    void read_image(const JsonNode& image, const optics::Frame& frame) {
        const double radius = number_or(image.at("geometry"), "radius", kInfinity);
        if (std::isfinite(radius) && radius != 0.0) {
            remark("curved-image", 0,
                   fmt::format("the image's surface has a radius of {} mm; the sensor is flat", radius));
        }
        if (tilt_of(frame) != std::array<double, 3>{} || frame.origin.x != 0.0 || frame.origin.y != 0.0) {
            remark("tilted-image", 0, "the image's surface is tilted or shifted; the sensor is not");
        }
    }

    void read_aperture(const JsonNode& top) {
        if (!top.has("aperture")) {
            return;
        }
        const JsonNode aperture = top.at("aperture");
        const std::string type = aperture.has("type") ? aperture.at("type").text() : text_or(aperture, "ap_type", "");
        const double value = any_number(aperture.at("value"));
        const auto stop = std::ranges::find_if(lens_.surfaces, &optics::PrescribedSurface::is_stop);
        using optics::ApertureKind;
        if (type == "EPD") {
            lens_.aperture = {ApertureKind::entrance_pupil_diameter, value};
        } else if (type == "imageFNO") {
            lens_.aperture = {ApertureKind::f_number, value};
        } else if (type == "objectNA") {
            lens_.aperture = {ApertureKind::object_numerical_aperture, value};
        } else if (type == "float_by_stop_size" && stop != lens_.surfaces.end()) {
            stop->semi_diameter_mm = 0.5 * value;
        } else {
            remark("not-read", 0, fmt::format("an aperture stated as \"{}\" is left out", printable(type)));
        }
    }

    void read_fields(const JsonNode& top) {
        if (!top.has("fields")) {
            return;
        }
        const JsonNode fields = top.at("fields");
        const std::string type = fields.has("field_definition")
                                     ? text_or(fields.at("field_definition"), "field_type", "")
                                     : text_or(fields, "field_type", "");
        optics::DesignFields design;
        if (type == "AngleField" || type == "angle") {
            design.kind = optics::FieldKind::angle;
        } else if (type == "ObjectHeightField" || type == "object_height") {
            design.kind = optics::FieldKind::object_height;
        } else if (type == "ParaxialImageHeightField" || type == "paraxial_image_height") {
            design.kind = optics::FieldKind::paraxial_image_height;
        } else if (type == "RealImageHeightField" || type == "real_image_height") {
            design.kind = optics::FieldKind::image_height;
        } else {
            remark("not-read", 0, fmt::format("fields stated as \"{}\" are left out", printable(type)));
            return;
        }
        for (const JsonNode& field : fields.at("fields").elements()) {
            design.points.push_back({number_or(field, "x", 0.0), number_or(field, "y", 0.0)});
            design.vignetting.push_back(
                {.decentre = {}, .compression = {number_or(field, "vx", 0.0), number_or(field, "vy", 0.0)}});
        }
        take_fields(lens_, std::move(design));
    }

    void read_wavelengths(const JsonNode& top) {
        if (!top.has("wavelengths")) {
            return;
        }
        for (const JsonNode& wavelength : top.at("wavelengths").at("wavelengths").elements()) {
            const std::string unit = text_or(wavelength, "unit", "um");
            // Rounded to what a wavelength in µm can have been written with: 0.5875618 is 587.5618.
            const double nm = std::round(any_number(wavelength.at("value")) * (unit == "nm" ? 1.0 : 1e3) * 1e9) / 1e9;
            if (!(nm > 0.0) || !std::isfinite(nm) || (unit != "um" && unit != "nm")) {
                remark("not-read", 0, fmt::format("a wavelength in \"{}\" is left out", printable(unit)));
                continue;
            }
            lens_.wavelengths_nm.insert(
                is_true(wavelength, "is_primary") ? lens_.wavelengths_nm.begin() : lens_.wavelengths_nm.end(), nm);
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
    return OptilandLens(file).read(parse_python_json(text, file.string()));
}

}  // namespace lensproof::formats
