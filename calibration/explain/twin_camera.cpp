#include "calibration/explain/twin_camera.h"

#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>

#include "calibration/explain/lens_halves.h"
#include "engine/base/angle.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::calibration {

namespace {

/// A rigid motion of what stands in lens space, about `pivot`.
struct Turn {
    Vec3d pivot;
    double about_x = 0.0;  // radians
    double about_y = 0.0;

    [[nodiscard]] Vec3d vector(const Vec3d& v) const { return turned(v, about_x, about_y); }
    [[nodiscard]] Vec3d point(const Vec3d& p) const { return pivot + vector(p - pivot); }
    /// The same, undone: about y first.
    [[nodiscard]] Vec3d vector_back(const Vec3d& v) const { return turned(turned(v, 0.0, -about_y), -about_x, 0.0); }
    [[nodiscard]] Vec3d point_back(const Vec3d& p) const { return pivot + vector_back(p - pivot); }
};

Vec3d place_of(const optics::LensSurface& surface) {
    return {surface.vertex.x, surface.vertex.y, surface.vertex_z};
}

/// Each surface from `first` to `last` (from 1), moved.
template <class Point, class Vector>
void move_surfaces(optics::Lens& lens, int first, int last, const Point& point, const Vector& vector) {
    for (int i = first - 1; i < last; ++i) {
        optics::LensSurface& surface = lens.surfaces[static_cast<std::size_t>(i)];
        const Vec3d place = point(place_of(surface));
        surface.vertex = {place.x, place.y};
        surface.vertex_z = place.z;
        for (Vec3d& axis : surface.axes) {
            axis = vector(axis);
        }
    }
}

void widen(optics::Lens& lens, int gap, double by) {
    for (auto i = static_cast<std::size_t>(gap); i < lens.surfaces.size(); ++i) {
        lens.surfaces[i].vertex_z += by;
    }
    lens.image_z += by;
}

/// n = n_d + (n_d − 1) / V_d · dispersion, as `set_index` has it.
void change_glass(optics::Glass& glass, double d_n, double d_V) {
    if (d_n == 0.0 && d_V == 0.0) {
        return;
    }
    const optics::DispersionFormula before = glass.formula;
    const auto index = [&](double nm) { return optics::refractive_index(before, nm); };
    const double n_d = index(spectral::kLineD);
    const double main = index(spectral::kLineF) - index(spectral::kLineC);
    if (main == 0.0) {
        glass.formula = optics::ConstantIndex{n_d + d_n};
        return;
    }
    const double V_d = (n_d - 1.0) / main + d_V;
    constexpr double kStep_nm = 5.0;
    constexpr double kFrom_nm = 300.0;  // films and sensors see no farther
    constexpr double kTo_nm = 1200.0;
    const double from = std::max(kFrom_nm, glass.min_wavelength_nm);
    const double to = std::min(kTo_nm, glass.max_wavelength_nm);
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from) / kStep_nm)));
    optics::IndexTable table;
    for (int i = 0; i <= steps; ++i) {
        const double nm = from + (to - from) * i / steps;
        table.wavelength_um.push_back(1e-3 * nm);
        table.index.push_back(n_d + d_n + (n_d + d_n - 1.0) / V_d * (index(nm) - n_d) / main);
    }
    glass.formula = std::move(table);
    glass.min_wavelength_nm = from;
    glass.max_wavelength_nm = to;
}

AffineMap chart_in_camera(const PoseParameters& pose, double origin_z, const Turn& sensor) {
    const auto place = [&](const Vec3d& board) {
        const double on_board[3] = {board.x, board.y, board.z};
        double turned_by[3];
        ceres::AngleAxisRotatePoint(pose.data(), on_board, turned_by);
        const Vec3d in_lens{turned_by[0] + pose[3], -(turned_by[1] + pose[4]), origin_z - turned_by[2] - pose[5]};
        const Vec3d before_sensor = sensor.point_back(in_lens);
        return Vec3d{before_sensor.x, -before_sensor.y, -before_sensor.z};
    };
    const Vec3d origin = place({});
    const Vec3d x = place({1.0, 0.0, 0.0}) - origin;
    const Vec3d y = place({0.0, 1.0, 0.0}) - origin;
    const Vec3d z = place({0.0, 0.0, 1.0}) - origin;
    return {.linear = {Vec3d{x.x, y.x, z.x}, Vec3d{x.y, y.y, z.y}, Vec3d{x.z, y.z, z.z}}, .translation = origin};
}

/// A lens while its changes are made.
struct MadeChanges {
    optics::Lens lens;
    double scale = 1.0;
    double focus_mm = 0.0;
    Vec2d shift_mm;
    Turn sensor;
    std::vector<Vec2d> glass;  // changes of n_d and V_d, by surface

    void make(const LensChange& change, double value);
    void finish();
};

void MadeChanges::make(const LensChange& change, double value) {
    const Vec2d along = change.axis == 0 ? Vec2d{value, 0.0} : Vec2d{0.0, value};
    switch (change.kind) {
        case ChangeKind::focus:
            focus_mm = value;
            break;
        case ChangeKind::gap:
            widen(lens, change.first, value);
            break;
        case ChangeKind::decentre:
            move_surfaces(
                lens, change.first, change.last,
                [&](const Vec3d& p) {
                    return p + Vec3d{along.x, along.y, 0.0};
                },
                [](const Vec3d& v) { return v; });
            break;
        case ChangeKind::tilt: {
            const Turn turn{.pivot = place_of(lens.surfaces[static_cast<std::size_t>(change.first) - 1]),
                            .about_x = along.x * kDegree,
                            .about_y = along.y * kDegree};
            move_surfaces(
                lens, change.first, change.last, [&](const Vec3d& p) { return turn.point(p); },
                [&](const Vec3d& v) { return turn.vector(v); });
            break;
        }
        case ChangeKind::sensor_tilt:
            sensor.about_x += along.x * kDegree;
            sensor.about_y += along.y * kDegree;
            break;
        case ChangeKind::n_d:
            glass[static_cast<std::size_t>(change.first) - 1].x = value;
            break;
        case ChangeKind::V_d:
            glass[static_cast<std::size_t>(change.first) - 1].y = value;
            break;
        case ChangeKind::scale:
            scale = 1.0 + value;
            break;
        case ChangeKind::sensor_shift:
            shift_mm = shift_mm + along;
            break;
    }
}

void MadeChanges::finish() {
    lens.image_z += focus_mm;
    sensor.pivot = {0.0, 0.0, lens.image_z};
    for (std::size_t i = 0; i < glass.size(); ++i) {
        change_glass(lens.surfaces[i].medium, glass[i].x, glass[i].y);
    }
    if (sensor.about_x != 0.0 || sensor.about_y != 0.0) {
        move_surfaces(
            lens, 1, static_cast<int>(lens.surfaces.size()), [&](const Vec3d& p) { return sensor.point_back(p); },
            [&](const Vec3d& v) { return sensor.vector_back(v); });
    }
    lens.is_rotationally_symmetric =
        lens.is_rotationally_symmetric && std::ranges::none_of(lens.surfaces, &optics::LensSurface::is_misaligned);
}

}  // namespace

TwinCamera twin_camera(const ExplainedLens& lens, const SeenPoints& seen, const LensState& state) {
    MadeChanges made{.lens = lens.focused.front(), .shift_mm = {}, .sensor = {}, .glass = {}};
    made.glass.resize(made.lens.surfaces.size());
    for (std::size_t c = 0; c < lens.changes.size(); ++c) {
        if (lens.changes[c].profile <= 0) {
            made.make(lens.changes[c], state.changes[static_cast<Eigen::Index>(c)]);
        }
    }
    made.finish();
    TwinCamera twin{
        .lens = std::move(made.lens),
        .pixel_pitch_mm = seen.camera.pitch_mm / made.scale,
        // The picture is moved on the sensor; lens space's x runs to the left of it.
        .axis_from_middle_px = {-made.shift_mm.x / seen.camera.pitch_mm, made.shift_mm.y / seen.camera.pitch_mm},
        .charts = {}};
    for (const PoseParameters& pose : state.poses) {
        twin.charts.push_back(chart_in_camera(pose, lens.entrance_pupil_z, made.sensor));
    }
    return twin;
}

std::optional<std::vector<std::vector<Vec2d>>> predicted_points(const ExplainedLens& lens, const SeenPoints& seen,
                                                                const LensState& state) {
    const auto residuals = ResidualTracer(lens, seen).residuals(state, false);
    if (!residuals) {
        return std::nullopt;
    }
    std::vector<std::vector<Vec2d>> predicted;
    Eigen::Index row = 0;
    for (const SeenView& view : seen.views) {
        const double sigma = seen.camera.noise_px[static_cast<std::size_t>(view.profile)];
        predicted.emplace_back();
        for (const SeenPoint& point : view.points) {
            predicted.back().push_back({point.image_px.x - sigma * residuals->values[row],
                                        point.image_px.y - sigma * residuals->values[row + 1]});
            row += 2;
        }
    }
    return predicted;
}

}  // namespace lensproof::calibration
