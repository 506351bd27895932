#include "engine/analysis/wavefront.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "engine/optics/paraxial.h"

namespace lensproof::analysis {

namespace {

constexpr double kNanometre = 1e-6;  // mm

/// Whether every surface is centred on the axis.
bool is_centred(const optics::TraceLens<double>& lens) {
    return std::ranges::all_of(lens.specials, [](const optics::SpecialSurface<double>& special) {
        return special.vertex == Vec2d{} && special.axes[2] == Vec3d{0.0, 0.0, 1.0};
    });
}

/// The component of W that weighted least squares over `columns` leaves, as a root mean square, and their factors.
struct Fit {
    double rms;
    Eigen::VectorXd factors;
};

Fit fit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& opd, const Eigen::VectorXd& weights) {
    const Eigen::VectorXd root = weights.cwiseSqrt();
    const Eigen::MatrixXd design = root.asDiagonal() * columns;
    const Eigen::VectorXd target = root.cwiseProduct(opd);
    const Eigen::VectorXd factors = design.colPivHouseholderQr().solve(target);
    return {(target - design * factors).norm() / root.norm(), factors};
}

}  // namespace

std::optional<ReferenceSphere> reference_sphere(const optics::TraceLens<double>& lens,
                                                const optics::FieldBundle& bundle) {
    const optics::TracedRay<double> chief = optics::trace_past_rims(lens, bundle.ray({}));
    const Vec3d& direction = chief.ray.direction;
    if (!optics::gets_through(chief.status) || !(direction.z > 0.0)) {
        return std::nullopt;
    }
    ReferenceSphere sphere;
    sphere.centre = optics::meet_plane(chief.ray, lens.image_z).point;
    if (sphere.centre.y != 0.0 && bundle.chief.field_angle != 0.0 && is_centred(lens)) {
        sphere.curvature = direction.y / sphere.centre.y;
        return sphere;
    }
    const optics::ParaxialData paraxial = optics::paraxial_data(lens);
    if (std::isfinite(paraxial.exit_pupil_z)) {
        const double pupil_z = lens.surfaces.back().vertex_z + paraxial.exit_pupil_z;
        sphere.curvature = direction.z / (lens.image_z - pupil_z);
    }
    return sphere;
}

std::optional<SphereMeeting> meet_sphere(const optics::TraceLens<double>& lens, const ReferenceSphere& sphere,
                                         const optics::TracedRay<double>& ray) {
    const double c = sphere.curvature;
    const Vec3d& direction = ray.ray.direction;
    const double to_foot = dot(sphere.centre - ray.ray.origin, direction);
    const Vec3d q = ray.ray.origin + to_foot * direction - sphere.centre;
    const double q2 = dot(q, q);
    const double cos2 = 1.0 - c * c * q2;
    if (!optics::gets_through(ray.status) || !(cos2 > 0.0)) {
        return std::nullopt;
    }
    const double sag = c * q2 / (1.0 + std::sqrt(cos2));
    const double index = lens.surfaces.back().index_after;
    return SphereMeeting{.optical_path = ray.optical_path + index * (to_foot + sag),
                         .towards = index * ((1.0 - c * sag) * direction - c * q)};
}

Wavefront wavefront(const optics::TraceLens<double>& lens, double wavelength_nm, const optics::FieldBundle& bundle,
                    const ReferenceSphere& sphere, std::span<const optics::RegionNode> nodes) {
    const auto meeting_at = [&](Vec2d offset) {
        return meet_sphere(lens, sphere, optics::trace_past_rims(lens, bundle.ray(offset)));
    };
    Wavefront front{.wavelength_nm = wavelength_nm, .sphere = sphere};
    const std::optional<SphereMeeting> chief = meeting_at({});
    const SphereMeeting zero = chief.value_or(SphereMeeting{0.0, {0.0, 0.0, 1.0}});
    double weight = 0.0;
    double sum = 0.0;
    for (const optics::RegionNode& node : nodes) {
        const std::optional<SphereMeeting> meeting = meeting_at(node.point);
        if (!meeting) {
            front.lost_weight += node.weight;
            continue;
        }
        const Vec3d pupil = meeting->towards - zero.towards;
        const double opd_mm = zero.optical_path - meeting->optical_path;
        front.rays.push_back({node.point, node.weight, opd_mm, {pupil.x, pupil.y}, pupil.z});
        weight += node.weight;
        sum += node.weight * opd_mm;
    }
    if (!chief && weight > 0.0) {
        for (WavefrontRay& ray : front.rays) {
            ray.opd_mm -= sum / weight;
        }
    }
    return front;
}

WavefrontErrors wavefront_errors(const Wavefront& wavefront) {
    const auto count = static_cast<Eigen::Index>(wavefront.rays.size());
    if (count < 4) {
        return {};
    }
    Eigen::MatrixXd columns(count, 4);
    Eigen::VectorXd opd(count);
    Eigen::VectorXd weights(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const WavefrontRay& ray = wavefront.rays[static_cast<std::size_t>(i)];
        columns.row(i) << 1.0, ray.pupil.x, ray.pupil.y, ray.pupil_z;
        opd(i) = ray.opd_mm;
        weights(i) = ray.weight;
    }
    const Fit free = fit(columns, opd, weights);
    const double per_mm = 1.0 / (wavefront.wavelength_nm * kNanometre);
    return {.rms = per_mm * fit(columns.leftCols(1), opd, weights).rms,
            .rms_without_tilt = per_mm * fit(columns.leftCols(3), opd, weights).rms,
            .rms_without_focus = per_mm * free.rms,
            .peak_to_valley = per_mm * (opd.maxCoeff() - opd.minCoeff()),
            .best_centre = {free.factors(1), free.factors(2), free.factors(3)}};
}

}  // namespace lensproof::analysis
