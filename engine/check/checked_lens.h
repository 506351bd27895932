// engine/check/checked_lens.h — what the checks look at: a prescription at one zoom position, with all that could be
// made of it.
#pragma once
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/check/checker.h"

namespace lensproof::check {

using Findings = std::vector<optics::Finding>;

/// The numbers that first-order data come from, a surface each. No stop is needed, and no aperture.
struct ParaxialTable {
    std::vector<double> curvature;   // 1/mm, at the vertex
    std::vector<double> gap;         // mm, behind the surface
    std::vector<double> index;       // behind the surface; negative behind an odd number of mirrors
    std::vector<double> thin_power;  // 1/mm, of an ideal lens or a kinoform there
    double index_in_front = 1.0;     // of the first surface
};

/// Where a lens focuses; mm. Not finite where it does not.
struct Focus {
    double efl = 0.0;
    double bfl = 0.0;             // last vertex to the focus of an object at infinity
    double image_distance = 0.0;  // last vertex to the image of the object that the table is set to
};

Focus paraxial_focus(const ParaxialTable& table, double object_distance_mm);

/// The tracer's surfaces for it, whose rims are infinite.
optics::TraceLens<double> paraxial_lens(const ParaxialTable& table);

struct CheckedLens {
    optics::Prescription prescription;  // at one zoom position
    optics::StatedData claims;
    CheckSettings settings;
    double wavelength_nm = spectral::kLineD;  // of the first-order data and of the rays
    const optics::GlassCatalogue* known_glasses = nullptr;

    std::vector<std::optional<optics::Glass>> media;  // behind each surface; nothing where it is not known
    ParaxialTable table;                 // NaN where a number is missing, or a glass has none at the wavelength
    std::vector<double> headings;        // 1 where light runs along z behind the surface, −1 where against it
    std::optional<Focus> focus;          // nothing where a number is missing
    std::vector<double> semi_diameters;  // stated ones, else the rim, else estimated, else NaN
    std::vector<bool> is_estimated;      // whether that semi-diameter is not the table's

    // Of a lens with a full circle for a stop. Nothing where the table cannot be traced.
    std::optional<optics::Lens> lens;
    std::optional<optics::TraceLens<double>> traced;
    std::optional<optics::ParaxialData> paraxial;
    std::string why_not_traced;       // in make_lens's words
    std::optional<int> assumed_stop;  // the surface (from 0) that stands in for a stop that is missing or doubled
    bool is_at_best_focus = false;    // the last thickness ends where real axial rays are sharpest, not paraxial ones

    [[nodiscard]] int size() const { return static_cast<int>(prescription.surfaces.size()); }
    [[nodiscard]] const optics::PrescribedSurface& row(int i) const { return prescription.surfaces[i]; }
    [[nodiscard]] bool is_glass_behind(int i) const {
        return !row(i).medium.is_air() && std::abs(table.index[i]) != 1.0;
    }
    /// Whether light passes the surface unchanged: a stop's plane, or a dummy.
    [[nodiscard]] bool is_dummy(int i) const;
    /// From the last vertex to the sensor, in the light's direction.
    [[nodiscard]] double stated_image_distance() const { return headings.back() * row(size() - 1).thickness_mm; }
    /// Whether the table means a diverging lens: it puts the image plane in front of the last surface, where the
    /// virtual image lies.
    [[nodiscard]] bool has_virtual_image() const;
    /// Whether light of the object leaves the lens parallel: the image plane is then no image's.
    [[nodiscard]] bool collimates() const;
    /// One lens of glass, with windows perhaps, or one mirror: neither its colour nor, with spheres, its spherical
    /// aberration can be corrected, so what it has of them says nothing about its table.
    [[nodiscard]] bool is_single_element() const;
    /// How many surfaces in front change nothing; the object's distance is to be counted from the next.
    [[nodiscard]] int leading_dummies() const;
    /// Behind the surface, or in front of the first: the index.
    [[nodiscard]] double index_before(int i) const { return i == 0 ? table.index_in_front : table.index[i - 1]; }
};

CheckedLens make_checked_lens(const optics::Prescription& at_one_position, const optics::StatedData& claims,
                              const optics::GlassCatalogue& glasses, const CheckSettings& settings);

/// The glass behind a surface as the table names or describes it; nothing where the name is unknown and no index is
/// stated.
std::optional<optics::Glass> stated_glass(const optics::PrescribedSurface& row, const optics::GlassCatalogue& glasses,
                                          const std::vector<std::string>& preferred_makers);

}  // namespace lensproof::check
