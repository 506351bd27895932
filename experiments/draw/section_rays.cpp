#include "experiments/draw/section_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/optics/design_fields.h"
#include "engine/optics/meridional_bundle.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::draw {

namespace {

/// The ray from a wavefront that the chief ray (along `incoming`) crosses at `start`, to the sensor or its block.
SectionRay drawn_ray(const optics::TraceLens<double>& lens, const Ray<double>& ray, const Vec3d& start,
                     const Vec3d& incoming) {
    SectionRay drawn;
    const auto add = [&](const Vec3d& point) {
        if (std::isfinite(point.z) && std::isfinite(point.y)) {
            drawn.points.push_back({point.z, point.y});
        }
    };
    const double to_wavefront = dot(start - ray.origin, incoming) / dot(ray.direction, incoming);
    add(ray.origin + to_wavefront * ray.direction);
    const optics::TracedRay<double> traced = optics::trace(lens, ray, [&](const optics::SurfaceEvent<double>& event) {
        if (event.status != optics::RayStatus::missed) {
            add(event.ray.origin);
        }
    });
    drawn.passes = traced.status == optics::RayStatus::ok && traced.ray.direction.z > 0.0;
    if (drawn.passes) {
        add(optics::meet_plane(traced.ray, lens.image_z).point);
    }
    return drawn;
}

/// The field that is asked for, radians: stated, or implied by the image circle; infinite where neither is stated.
double wanted_field(const optics::StatedData& stated, const optics::ChiefRays& chiefs) {
    if (stated.half_field_deg && *stated.half_field_deg > 0.0) {
        return *stated.half_field_deg * kDegree;
    }
    if (!stated.image_circle_mm || !(*stated.image_circle_mm > 0.0)) {
        return kInfinity;
    }
    return optics::field_at_image_height(chiefs, 0.5 * *stated.image_circle_mm);
}

SectionBundle drawn_bundle(const optics::TraceLens<double>& lens, const optics::MeridionalBundle& bundle, double lead,
                           int count) {
    SectionBundle drawn{.field_angle = bundle.chief.field_angle, .rays = {}};
    const Vec3d& incoming = bundle.chief.front.direction;
    const Vec3d start = bundle.chief.front.origin - lead * incoming;
    const auto add = [&](double offset, bool is_chief) {
        SectionRay ray = drawn_ray(lens, bundle.ray({0.0, offset}), start, incoming);
        ray.is_chief = is_chief;
        if (ray.passes && ray.points.size() >= 2) {
            drawn.rays.push_back(std::move(ray));
        }
    };
    for (int i = 0; i < count - 1; ++i) {
        add(bundle.lower + (bundle.upper - bundle.lower) * i / (count - 2), false);
    }
    add(0.0, true);
    return drawn;
}

/// The ray along the axis, up to where it ends.
SectionBundle blocked_axis(const optics::TraceLens<double>& lens, double lead) {
    const Vec3d along{0.0, 0.0, 1.0};
    return {.field_angle = 0.0, .rays = {drawn_ray(lens, {{0.0, 0.0, 0.0}, along}, {0.0, 0.0, -lead}, along)}};
}

}  // namespace

double drawing_wavelength(const optics::Prescription& prescription, const optics::Lens& lens) {
    const double asked = prescription.reference_wavelength_nm();
    const optics::WavelengthRange range = optics::wavelength_range(lens);
    return asked >= range.min_nm && asked <= range.max_nm ? asked : 0.5 * (range.min_nm + range.max_nm);
}

SectionRays section_rays(const optics::Prescription& prescription, const optics::Lens& lens, double lead, int count,
                         const std::vector<double>& fields_deg) {
    SectionRays rays;
    try {
        const double wavelength_nm = drawing_wavelength(prescription, lens);
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, wavelength_nm);
        const optics::ChiefRays chiefs(lens, wavelength_nm);
        const double largest = chiefs.largest_field() > 0.0 ? chiefs.largest_field() : 0.0;
        const double wanted = wanted_field(lens.stated, chiefs);
        // A hair inside the last ray that passes, where rounding does not decide.
        const double edge = std::min(wanted, largest * (1.0 - 1e-6));
        std::vector<double> fields{0.0};
        if (edge > 0.0) {
            fields = {0.0, 0.7 * edge, edge};
        }
        const std::vector<double> asked =
            fields_deg.empty()
                ? optics::design_fields_deg(prescription, lens, wavelength_nm, prescription.object_distance_mm)
                : fields_deg;
        if (!asked.empty()) {
            fields.clear();
            std::ranges::transform(asked, std::back_inserter(fields), [](double deg) { return deg * kDegree; });
        }
        for (const double field : fields) {
            if (const std::optional<optics::ChiefRay> chief = chiefs.at_field(field)) {
                const auto bundle = optics::meridional_bundle(traced, *chief, prescription.object_distance_mm);
                rays.bundles.push_back(drawn_bundle(traced, bundle, lead, count));
            }
        }
        if (rays.bundles.empty()) {
            rays.bundles.push_back(blocked_axis(traced, lead));
            rays.remark = "no ray through the middle of the stop reaches the sensor";
        } else if (fields_deg.empty() && std::isfinite(wanted) && wanted > largest * (1.0 + 1e-6)) {
            rays.remark =
                fmt::format("chief rays pass up to {:.4g}°; {:.4g}° is stated", largest / kDegree, wanted / kDegree);
        }
    } catch (const InputError& error) {
        rays.remark = error.what();
    }
    return rays;
}

}  // namespace lensproof::draw
