// Lenses as rayoptics saves them (OpticalModel.save_model, version 0.9; github.com/mjhoptics/ray-optics): JSON of its
// own objects, each with its class ("__instance_type__") and "attributes". Interfaces from the object's to the image's,
// gaps between them, profiles by their number in a dictionary. Lengths in the system's unit, angles in degrees,
// wavelengths in nm.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/python_json.h"

namespace lensproof::formats {

namespace {

constexpr double kFarObject = 1e10;      // mm, from which on rayoptics means infinity
constexpr double kUnsetAperture = 1.0;   // what a new interface has until its size is set
constexpr int kHighestEvenPower = 20;    // of EvenPolynomial's r², r⁴, …
constexpr int kHighestRadialPower = 10;  // of RadialPolynomial's r, r², …

std::string class_of(const JsonNode& object) {
    const std::vector<JsonNode> type = object.at("__instance_type__").elements();
    return type.size() == 2 ? type.back().text() : "";
}

class RayopticsLens {
  public:
    explicit RayopticsLens(const std::filesystem::path& file) : lens_(prescription_of(file)) {
        lens_.source += ", saved by rayoptics";
    }

    optics::Prescription read(const JsonNode& top) {
        const JsonNode model = top.at("optical_model").at("attributes");
        read_system(model);
        const JsonNode sequence = model.at("seq_model").at("attributes");
        const std::vector<JsonNode> interfaces = sequence.at("ifcs").elements();
        const std::vector<JsonNode> gaps = sequence.at("gaps").elements();
        if (interfaces.size() < 3 || interfaces.size() > kMostSurfaces || gaps.size() + 1 != interfaces.size()) {
            throw InputError(fmt::format(
                "{}: {} interfaces and {} gaps, expected from 3 interfaces, the object's and the image's included, to "
                "{}, and a gap fewer",
                lens_.file.string(), interfaces.size(), gaps.size(), kMostSurfaces));
        }
        const JsonNode spec = model.at("optical_spec").at("attributes");
        read_aperture(spec.at("pupil").at("attributes"));
        const int stop = sequence.has("stop_surface") ? sequence.at("stop_surface").count() : 1;
        for (std::size_t i = 1; i + 1 < interfaces.size(); ++i) {
            add_surface(model, interfaces[i], gaps[i], static_cast<int>(i) == stop);
        }
        if (!sequence.has("stop_surface")) {
            remark("stop-not-stated", 1, "the file has a floating stop; its first surface is taken for it");
        }
        read_medium(gaps.front().at("attributes").at("medium"), 0, lens_.object_medium);
        optics::set_mirror_media(lens_.surfaces, lens_.object_medium);
        const double distance = length(gaps.front().at("attributes"), "thi");
        lens_.object_distance_mm = distance > 0.0 && distance < kFarObject ? distance : kInfinity;
        read_image(model, interfaces.back());
        read_fields(spec.at("field_of_view").at("attributes"));
        read_wavelengths(spec.at("spectral_region").at("attributes"));
        return std::move(lens_);
    }

  private:
    void remark(const std::string& code, int surface, const std::string& message,
                optics::Severity severity = optics::Severity::warning) {
        lens_.remarks.push_back({code, severity, surface, message});
    }

    [[nodiscard]] double length(const JsonNode& object, const std::string& key) const {
        return unit_mm_ * any_number(object.at(key));
    }

    void read_system(const JsonNode& model) {
        const JsonNode system = model.at("system_spec").at("attributes");
        if (const std::string title = text_or(system, "title", ""); !title.empty()) {
            lens_.name = title;
        }
        static const std::map<std::string, double> kUnits = {{"mm", 1.0},    {"cm", 10.0},     {"m", 1000.0},
                                                             {"inch", 25.4}, {"inches", 25.4}, {"in", 25.4}};
        const std::string unit = text_or(system, "_dimensions", text_or(system, "dimensions", "mm"));
        const auto known = kUnits.find(lower_case(unit));
        if (known == kUnits.end()) {
            throw InputError(fmt::format("{}: its lengths are in \"{}\", expected mm, cm, m or inches", system.where(),
                                         printable(unit)));
        }
        unit_mm_ = known->second;
    }

    void add_surface(const JsonNode& model, const JsonNode& interface, const JsonNode& gap, bool is_stop) {
        const int number = static_cast<int>(lens_.surfaces.size()) + 1;
        const JsonNode attributes = interface.at("attributes");
        optics::PrescribedSurface surface;
        surface.where = interface.where();
        surface.is_stop = is_stop;
        surface.thickness_mm = length(gap.at("attributes"), "thi");
        surface.is_mirror = text_or(attributes, "interact_mode", "") == "reflect";
        const std::string kind = class_of(interface);
        if (kind == "ThinLens") {
            if (const double power = any_number(attributes.at("_power")); power != 0.0) {
                surface.ideal_focal_length_mm = unit_mm_ / power;
            }
        } else if (kind == "Surface") {
            read_profile(model, attributes, number, surface);
            read_phase(attributes, number, surface);
        } else {
            remark("surface-type", number,
                   fmt::format("an interface of the kind \"{}\" is not understood", printable(kind)),
                   optics::Severity::error);
        }
        if (attributes.has("decenter")) {
            remark("tilt-not-read", number, "its decentre and tilt are not followed", optics::Severity::error);
        }
        read_medium(gap.at("attributes").at("medium"), number, surface.medium);
        read_rim(attributes, number, surface);
        lens_.surfaces.push_back(std::move(surface));
    }

    /// By its number in the model's dictionary, or as older versions save it, inside the interface.
    [[nodiscard]] static JsonNode profile_of(const JsonNode& model, const JsonNode& attributes) {
        return attributes.has("profile_id") ? model.at("profile_dict").at(attributes.at("profile_id").text())
                                            : attributes.at("profile");
    }

    void read_profile(const JsonNode& model, const JsonNode& attributes, int number,
                      optics::PrescribedSurface& surface) {
        const JsonNode object = profile_of(model, attributes);
        const std::string kind = class_of(object);
        const JsonNode profile = object.at("attributes");
        const double curvature = number_or(profile, "cv", 0.0) / unit_mm_;
        surface.radius_mm = curvature == 0.0 ? kInfinity : 1.0 / curvature;
        if (kind == "Conic" || kind == "EvenPolynomial") {
            surface.conic = number_or(profile, "cc", 0.0);
        }
        if (kind == "EvenPolynomial") {
            read_terms(profile, number, 2, kHighestEvenPower, surface);
        } else if (kind == "RadialPolynomial") {
            surface.conic = number_or(profile, "ec", 1.0) - 1.0;
            read_terms(profile, number, 1, kHighestRadialPower, surface);
        } else if (kind != "Spherical" && kind != "Conic") {
            remark("shape-not-read", number,
                   fmt::format("a profile of the kind \"{}\" is not understood: its curvature alone is taken",
                               printable(kind)),
                   optics::Severity::error);
        }
    }

    /// A list "coefs" for powers by steps; older versions left it empty, beside "coef2", "coef4", …, or began it with
    /// power 0, one term more than there are powers.
    void read_terms(const JsonNode& profile, int number, int step, int highest, optics::PrescribedSurface& surface) {
        std::vector<double> terms;
        if (profile.has("coefs")) {
            for (const JsonNode& each : profile.at("coefs").elements()) {
                terms.push_back(any_number(each));
            }
        }
        if (std::ranges::all_of(terms, [](double term) { return term == 0.0; })) {
            terms.clear();
            for (int power = step; power <= highest; power += step) {
                terms.push_back(number_or(profile, fmt::format("coef{}", power), 0.0));
            }
        } else if (step == 1 && std::ssize(terms) == highest + 1) {
            terms.erase(terms.begin());
        }
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const int power = static_cast<int>(i + 1) * step;
            if (power <= optics::kHighestPower) {
                surface.term(power) = terms[i] * std::pow(unit_mm_, 1 - power);
            } else if (terms[i] != 0.0) {
                remark("asphere-term-not-read", number, fmt::format("its term of r^{} is left out", power),
                       optics::Severity::error);
            }
        }
    }

    /// A kinoform: the path Σ c_i r^(2i) at the reference wavelength.
    void read_phase(const JsonNode& attributes, int number, optics::PrescribedSurface& surface) {
        if (!attributes.has("phase_element")) {
            return;
        }
        const JsonNode object = attributes.at("phase_element");
        const JsonNode element = object.at("attributes");
        const std::string kind = class_of(object);
        if (kind != "DiffractiveElement" || text_or(element, "phase_fct_name", "") != "radial_phase_fct") {
            remark("shape-not-read", number,
                   fmt::format("what a \"{}\" adds to the phase is not understood", printable(kind)),
                   optics::Severity::error);
            return;
        }
        optics::PhaseElement phase;
        phase.order = number_or(element, "order", 1.0);
        phase.design_wavelength_nm = any_number(element.at("ref_wl"));
        const std::vector<JsonNode> terms = element.at("coefficients").elements();
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const double coefficient = any_number(terms[i]);
            if (i < phase.radial.size()) {
                phase.radial[i] = coefficient * std::pow(unit_mm_, -1.0 - 2.0 * static_cast<double>(i));
            } else if (coefficient != 0.0) {
                remark("asphere-term-not-read", number, "its phase has more terms than are carried",
                       optics::Severity::error);
            }
        }
        surface.phase = phase;
    }

    void read_medium(const JsonNode& object, int number, optics::StatedMedium& medium) {
        const std::string kind = class_of(object);
        if (kind == "Air") {
            return;
        }
        const JsonNode attributes = object.at("attributes");
        if (attributes.has("gname")) {  // SchottGlass, OharaGlass, …
            constexpr std::string_view kEnd = "Glass";
            const bool has_maker = kind.size() > kEnd.size() && kind.ends_with(kEnd);
            const std::string maker = has_maker ? upper_case(kind.substr(0, kind.size() - kEnd.size())) + " " : "";
            medium.glass = maker + attributes.at("gname").text();
        } else if (kind == "ModelGlass") {
            medium.n_d = any_number(attributes.at("n"));
            medium.V_d = any_number(attributes.at("v"));
            remark("dispersion-model", number,
                   "between the lines its index follows the normal line, not rayoptics' model", optics::Severity::info);
        } else if (kind == "ConstantIndex" && attributes.has("n")) {
            medium.n_d = any_number(attributes.at("n"));
        } else {
            medium.glass = text_or(attributes, "label", kind);
            remark("material-not-read", number,
                   fmt::format("a medium of the kind \"{}\" is not understood", printable(kind)));
        }
    }

    /// A circle that somebody set, else the size that rays had when the file was saved. The system's aperture opens the
    /// stop as far as it needs, unless a circle was set there.
    void read_rim(const JsonNode& attributes, int number, optics::PrescribedSurface& surface) {
        const std::vector<JsonNode> stated =
            attributes.has("clear_apertures") ? attributes.at("clear_apertures").elements() : std::vector<JsonNode>();
        for (const JsonNode& aperture : stated) {
            const JsonNode circle = aperture.at("attributes");
            if (class_of(aperture) == "Circular" && number_or(circle, "x_offset", 0.0) == 0.0 &&
                number_or(circle, "y_offset", 0.0) == 0.0) {
                surface.semi_diameter_mm = length(circle, "radius");
            } else {
                remark("aperture-not-read", number,
                       fmt::format("an aperture of the kind \"{}\" off the axis or not round is left out",
                                   printable(class_of(aperture))));
            }
        }
        const double largest = number_or(attributes, "max_aperture", kUnsetAperture);
        const bool is_governed = surface.is_stop && lens_.aperture.kind != optics::ApertureKind::stop;
        if (!surface.semi_diameter_mm && largest != kUnsetAperture && !is_governed) {
            surface.semi_diameter_mm = unit_mm_ * largest;
        }
    }

    void read_image(const JsonNode& model, const JsonNode& image) {
        const JsonNode attributes = image.at("attributes");
        if (class_of(image) == "Surface" &&
            number_or(profile_of(model, attributes).at("attributes"), "cv", 0.0) != 0.0) {
            remark("curved-image", 0, "the image's surface is curved; the sensor is flat");
        }
        if (attributes.has("decenter")) {
            remark("tilted-image", 0, "the image's surface is tilted or shifted; the sensor is not");
        }
    }

    /// ["aperture", "object" or "image", what], without the first word in older files.
    void read_aperture(const JsonNode& pupil) {
        const std::vector<JsonNode> words = pupil.at(pupil.has("_key") ? "_key" : "key").elements();
        const std::string space = words.size() < 2 ? "" : words[words.size() - 2].text();
        const std::string what = words.size() < 2 ? "" : words.back().text();
        const double value = any_number(pupil.at("value"));
        using optics::ApertureKind;
        if (space == "object" && (what == "epd" || what == "pupil")) {
            lens_.aperture = {ApertureKind::entrance_pupil_diameter, unit_mm_ * value};
        } else if (space == "image" && what == "f/#") {
            lens_.aperture = {ApertureKind::working_f_number, value};
        } else if (space == "image" && what == "NA" && value != 0.0) {
            lens_.aperture = {ApertureKind::working_f_number, 0.5 / value};
        } else if (space == "object" && what == "NA") {
            lens_.aperture = {ApertureKind::object_numerical_aperture, value};
        } else {
            remark("not-read", 0,
                   fmt::format("an aperture stated as \"{} {}\" is left out", printable(space), printable(what)));
        }
    }

    void read_fields(const JsonNode& view) {
        const std::vector<JsonNode> words = view.at(view.has("key") ? "key" : "_key").elements();
        const std::string space = words.size() < 2 ? "" : words[words.size() - 2].text();
        const std::string what = words.size() < 2 ? "" : words.back().text();
        optics::DesignFields design;
        if (space == "object" && what == "angle") {
            design.kind = optics::FieldKind::angle;
        } else if (space == "object" && what == "height") {
            design.kind = optics::FieldKind::object_height;
        } else if (space == "image" && what == "height") {
            design.kind = optics::FieldKind::paraxial_image_height;
        } else {
            remark("not-read", 0,
                   fmt::format("fields stated as \"{} {}\" are left out", printable(space), printable(what)));
            return;
        }
        const double scale = (is_true(view, "is_relative") ? any_number(view.at("value")) : 1.0) *
                             (design.kind == optics::FieldKind::angle ? 1.0 : unit_mm_);
        for (const JsonNode& each : view.at("fields").elements()) {
            const JsonNode field = each.at("attributes");
            design.points.push_back({scale * number_or(field, "x", 0.0), scale * number_or(field, "y", 0.0)});
            const Vec2d upper{number_or(field, "vux", 0.0), number_or(field, "vuy", 0.0)};
            const Vec2d lower{number_or(field, "vlx", 0.0), number_or(field, "vly", 0.0)};
            design.vignetting.push_back({.decentre = 0.5 * (lower - upper), .compression = 0.5 * (lower + upper)});
        }
        take_fields(lens_, std::move(design));
    }

    void read_wavelengths(const JsonNode& region) {
        const std::vector<JsonNode> wavelengths = region.at("wavelengths").elements();
        const auto reference = static_cast<std::size_t>(region.at("reference_wvl").count());
        for (std::size_t i = 0; i < wavelengths.size(); ++i) {
            const double nm = any_number(wavelengths[i]);
            if (!(nm > 0.0) || !std::isfinite(nm)) {
                throw wavelengths[i].error("a wavelength in nm");
            }
            lens_.wavelengths_nm.insert(i == reference ? lens_.wavelengths_nm.begin() : lens_.wavelengths_nm.end(), nm);
        }
    }

    optics::Prescription lens_;
    double unit_mm_ = 1.0;
};

}  // namespace

optics::Prescription parse_rayoptics(const std::string& text, const std::filesystem::path& file) {
    return RayopticsLens(file).read(parse_python_json(text, file.string()));
}

}  // namespace lensproof::formats
