#include "engine/optics/focus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/bisect.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/optics/paraxial.h"

namespace lensproof::optics {

namespace {

/// The lens with its focusing groups driven by `drive` mm, or nothing where surfaces would meet or leave the space
/// between front and sensor.
std::optional<Lens> driven(const Lens& lens, double drive) {
    Lens moved = lens;
    for (const FocusGroup& group : lens.focus_groups) {
        for (int i = group.first - 1; i < group.last; ++i) {
            moved.surfaces[i].vertex_z -= group.travel * drive;
        }
    }
    for (std::size_t i = 0; i + 1 < moved.surfaces.size(); ++i) {
        if (moved.heading_behind(i) * (moved.surfaces[i + 1].vertex_z - moved.surfaces[i].vertex_z) < 0.0) {
            return std::nullopt;
        }
    }
    const double to_sensor = moved.final_heading() * (moved.image_z - moved.last_vertex_z());
    return to_sensor >= 0.0 ? std::optional(moved) : std::nullopt;
}

/// How far behind the sensor the paraxial image of an object in front of the table's first vertex lies.
double defocus(const Lens& lens, double object_distance_mm, double wavelength_nm) {
    const double distance = object_distance_mm + lens.surfaces.front().vertex_z;
    return lens.last_vertex_z() + paraxial_image_distance(at_wavelength<double>(lens, wavelength_nm), distance) -
           lens.image_z;
}

/// The lens with its focusing groups where the image of the object is as far from the sensor as infinity's is in the
/// table, which is where the table's own sensor stands.
Lens focused_by_groups(const Lens& lens, double object_distance_mm, double wavelength_nm) {
    const double aim = defocus(lens, kInfinity, wavelength_nm);
    const auto error = [&](double drive) -> std::optional<double> {
        const std::optional<Lens> moved = driven(lens, drive);
        return moved ? std::optional(defocus(*moved, object_distance_mm, wavelength_nm) - aim) : std::nullopt;
    };
    // Outwards in steps until the sign changes, then bisection.
    const double step = 1e-3 * (lens.image_z - lens.surfaces.front().vertex_z);
    for (const double direction : {1.0, -1.0}) {
        double near = 0.0;
        std::optional<double> last = error(near);
        for (int i = 1; i <= 1000 && last; ++i) {
            const double far = direction * i * step;
            const std::optional<double> here = error(far);
            if (here && (*here <= 0.0) != (*last <= 0.0) && std::abs(*here - *last) < lens.image_z) {
                const auto is_nearer = [&](double at) { return (*error(at) <= 0.0) == (*last <= 0.0); };
                return *driven(lens, bisected({near, far}, 60, is_nearer).inside);
            }
            last = here;
            near = far;
        }
    }
    throw InputError(fmt::format("{} cannot be focused at {} mm: its focusing groups do not reach so far", lens.name,
                                 object_distance_mm));
}

}  // namespace

Lens with_f_number(Lens lens, double f_number, double wavelength_nm) {
    const double widest = paraxial_data(at_wavelength<double>(lens, wavelength_nm)).f_number;
    LensSurface& stop = lens.surfaces[lens.stop_index()];
    // Published f-numbers are rounded: f/2.8 is asked of a lens that opens to f/2.83.
    constexpr double kRounding = 0.02;
    if (!(f_number >= widest * (1.0 - kRounding))) {
        throw InputError(fmt::format("f/{} is wider than {} opens: f/{:.2f}", f_number, lens.name, widest));
    }
    stop.semi_diameter *= std::min(1.0, widest / f_number);
    return lens;
}

Lens focused_at(Lens lens, double object_distance_mm, double wavelength_nm) {
    lens.object_distance_mm = object_distance_mm;
    const TraceLens<double> traced = at_wavelength<double>(lens, wavelength_nm);
    const double image_distance = paraxial_image_distance(traced, object_distance_mm);
    const double front_focus = -paraxial_data(traced).ffl;
    if (!lens.focus_groups.empty() && object_distance_mm > 0.0) {
        return std::isinf(object_distance_mm) ? lens : focused_by_groups(lens, object_distance_mm, wavelength_nm);
    }
    if (!(object_distance_mm > front_focus) || !std::isfinite(image_distance)) {
        throw InputError(
            fmt::format("{} cannot be focused at {} mm: its front focal point lies {:.2f} mm in front of it", lens.name,
                        object_distance_mm, front_focus));
    }
    if (!(lens.final_heading() * image_distance > 0.0)) {
        throw InputError(
            fmt::format("{} focused at {} mm has its image {:.2f} mm behind the last vertex, where no sensor "
                        "can stand",
                        lens.name, object_distance_mm, image_distance));
    }
    lens.image_z = lens.last_vertex_z() + image_distance;
    return lens;
}

}  // namespace lensproof::optics
