#include "experiments/studies/chart_pictures/chart_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/base/overloaded.h"
#include "engine/base/parallel.h"
#include "experiments/studies/chart_pictures/film_rays.h"
#include "experiments/studies/chart_pictures/seen_light.h"

namespace lensproof::studies {

static void fields(JsonArchive& json, FeatureLook& look) {
    for (const LookQuantity& quantity : look_quantities()) {
        json.field(quantity.key, look.*quantity.value);
    }
}

void fields(JsonArchive& json, ChartFeature& feature) {
    json.field("field_deg", feature.field_deg).field("picture", feature.picture).field("rays", feature.rays);
}

const std::vector<LookQuantity>& look_quantities() {
    static const std::vector<LookQuantity> all = {
        {"radius_um", "Distance from the axis", "µm", &FeatureLook::radius_um},
        {"tangential_um", "Width along the radius, rms", "µm", &FeatureLook::tangential_um},
        {"sagittal_um", "Width across the radius, rms", "µm", &FeatureLook::sagittal_um},
        {"red_um", "Red less green, along the radius", "µm", &FeatureLook::red_um},
        {"blue_um", "Blue less green, along the radius", "µm", &FeatureLook::blue_um},
        {"coma_um", "Asymmetry along the radius", "µm", &FeatureLook::coma_um},
        {"area_mm2", "Area of an ellipse as wide", "mm²", &FeatureLook::area_mm2},
        {"light", "Light over that on the axis", "", &FeatureLook::light}};
    return all;
}

namespace {

constexpr double kMicrometres = 1000.0;  // of a mm
constexpr double kStep = 0.05;           // of a pitch, for derivatives

/// A point of a part, mm from the feature's middle on the chart, and its fraction of the part's light.
struct Node {
    Vec2d off;
    double fraction = 0.0;
};

/// What of a feature is measured by itself: a rectangle of these half-widths `along` and across it, mm of the chart, of
/// which the middle is left out up to `from`. Its border lies to both sides, and of a disc all around.
struct Part {
    Vec2d along{1.0, 0.0};
    double half_along = 0.0;
    double half_across = 0.0;
    double from = 0.0;
    double border = 0.0;
    bool is_arm = false;
    std::vector<Node> nodes{};
    double beyond_nodes = 0.0;  // how far the feature reaches beyond them

    /// Of a place of the chart, mm from the feature's middle.
    [[nodiscard]] Zone zone(Vec2d off) const {
        const double a = std::abs(along.x * off.x + along.y * off.y);
        const double b = std::abs(along.x * off.y - along.y * off.x);
        if (a < from || a > half_along + (is_arm ? 0.0 : border) || b > half_across + border) {
            return Zone::beyond;
        }
        return a <= half_along && b <= half_across ? Zone::feature : Zone::border;
    }

    /// As narrow as its rays, which fall so far from the middle, are spread: what lies beyond tells of noise alone.
    void fit(const std::vector<Vec2d>& offs, double pixel) {
        const double more = beyond_nodes + pixel;
        double a = 0.0;
        double b = 0.0;
        for (const Vec2d& off : offs) {
            a = std::max(a, std::abs(along.x * off.x + along.y * off.y));
            b = std::max(b, std::abs(along.x * off.y - along.y * off.x));
        }
        half_along = is_arm ? half_along : std::min(half_along, a + more);
        half_across = std::min(half_across, b + more);
        border = std::max(2.0 * pixel, 0.25 * half_across);
    }
};

/// Seven nodes that integrate polynomials of degree 5 over a disc (Stroud, S2: 5-1).
std::vector<Node> disc_nodes(double radius) {
    std::vector<Node> nodes{{{0.0, 0.0}, 0.25}};
    for (int i = 0; i < 6; ++i) {
        const double angle = i * std::numbers::pi / 3.0;
        const double r = radius * std::sqrt(2.0 / 3.0);
        nodes.push_back({{r * std::cos(angle), r * std::sin(angle)}, 0.125});
    }
    return nodes;
}

Part disc_part(double radius, double pitch) {
    return {.half_along = 0.4 * pitch,
            .half_across = 0.4 * pitch,
            .nodes = disc_nodes(radius),
            .beyond_nodes = (1.0 - std::sqrt(2.0 / 3.0)) * radius};
}

/// The outer thirds of a line, without its ends, where the other line of the cross is out of the way. Gauss's two
/// points across it.
Part arm_part(const scene::AstigmatismCrosses& crosses, Vec2d along) {
    Part part{.along = along,
              .half_along = 0.38 * crosses.length_mm,
              .half_across = 0.24 * crosses.length_mm,
              .from = 0.2 * crosses.length_mm,
              .is_arm = true};
    const double middle = 0.5 * (part.from + part.half_along);
    const double beside = 0.5 * crosses.line_mm / std::numbers::sqrt3;
    part.beyond_nodes = 0.5 * crosses.line_mm - beside;
    for (const double a : {-middle, middle}) {
        for (const double b : {-beside, beside}) {
            part.nodes.push_back({{along.x * a - along.y * b, along.y * a + along.x * b}, 0.25});
        }
    }
    return part;
}

/// Those of the feature whose middle is there on the chart; of a cross first the arms across the radius.
std::vector<Part> parts_of(const scene::ChartPattern& pattern, Vec2d middle) {
    return std::visit(Overloaded{[](const scene::DiscGrid& grid) -> std::vector<Part> {
                                     return {disc_part(0.5 * grid.diameter_mm, grid.pitch_mm)};
                                 },
                                 [](const scene::PointGrid& grid) -> std::vector<Part> {
                                     return {disc_part(0.5 * grid.dot_mm, grid.pitch_mm)};
                                 },
                                 [&](const scene::AstigmatismCrosses& crosses) -> std::vector<Part> {
                                     const double radius = std::hypot(middle.x, middle.y);
                                     const Vec2d out = radius > 0.0 ? middle / radius : Vec2d{1.0, 0.0};
                                     return {arm_part(crosses, {-out.y, out.x}), arm_part(crosses, out)};
                                 },
                                 [](const auto&) -> std::vector<Part> { return {}; }},
                      pattern);
}

/// Features in a plane before the lens.
struct FeaturePlane {
    scene::ChartPattern pattern;
    double pitch_mm = 0.0;
    std::vector<Vec2d> middles;
    AffineMap to_camera;  // from the plane, z away from the camera

    /// A place of it in lens space.
    [[nodiscard]] Vec3d point(Vec2d at) const { return scene::camera_to_lens(map_point(to_camera, {at.x, at.y, 0.0})); }
};

FeaturePlane chart_plane(const render::SceneSetup& setup, const render::Camera& camera, const std::string& name) {
    const scene::Chart* chart = nullptr;
    AffineMap to_camera;
    if (setup.chart && name.empty()) {
        chart = &setup.chart->chart;
        to_camera = scene::place(setup.chart->placement);
    } else {
        const auto object = std::ranges::find(setup.scene.objects, name, &scene::ObjectDescription::name);
        if (object != setup.scene.objects.end() && std::holds_alternative<scene::ChartOnQuad>(object->shape)) {
            const AffineMap upright{.linear = {Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}}};  // a quad's y is up
            chart = &std::get<scene::ChartOnQuad>(object->shape).chart;
            to_camera = composed(inverse(camera.pose()).value(), composed(object->to_world, upright));
        }
    }
    if (chart == nullptr || parts_of(chart->pattern, {}).empty()) {
        throw InputError(fmt::format("the scene has no chart \"{}\" of discs, dots or crosses", name));
    }
    return {.pattern = chart->pattern,
            .pitch_mm = scene::traits(*chart).pitch_mm,
            .middles = scene::feature_points(*chart),
            .to_camera = to_camera};
}

/// Each spherical light by itself, a disc in a plane parallel to the film.
std::vector<FeaturePlane> lamp_planes(const render::SceneSetup& setup, const render::Camera& camera) {
    std::vector<const scene::SphereLightDescription*> lamps;
    for (const scene::LightDescription& light : setup.scene.lights) {
        if (const auto* lamp = std::get_if<scene::SphereLightDescription>(&light.kind)) {
            lamps.push_back(lamp);
        }
    }
    std::vector<FeaturePlane> planes;
    for (const scene::SphereLightDescription* lamp : lamps) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const scene::SphereLightDescription* other : lamps) {
            nearest = other == lamp ? nearest : std::min(nearest, length(other->position_mm - lamp->position_mm));
        }
        planes.push_back({.pattern = scene::DiscGrid{.pitch_mm = nearest, .diameter_mm = 2.0 * lamp->radius_mm},
                          .pitch_mm = nearest,
                          .middles = {{0.0, 0.0}},
                          .to_camera = {.linear = kIdentity3,
                                        .translation = map_point(inverse(camera.pose()).value(), lamp->position_mm)}});
    }
    if (planes.size() < 2) {
        throw InputError("the scene has no two spherical lights");
    }
    return planes;
}

/// The map from the film, mm from a feature's middle, to the chart about it, as far as it is linear.
struct LocalMap {
    Vec2d row_x;
    Vec2d row_y;
    double mm_of_film = 0.0;  // of a mm of the chart, the mean
    double area = 0.0;        // of the film, of 1 mm² of the chart
    Vec2d right;              // where the chart's x runs on the film

    [[nodiscard]] Vec2d operator()(Vec2d film) const {
        return {row_x.x * film.x + row_x.y * film.y, row_y.x * film.x + row_y.y * film.y};
    }
};

std::optional<LocalMap> local_map(const FeaturePlane& plane, const FilmRays& rays, Vec2d middle, double step) {
    std::array<Vec2d, 4> ends;
    const std::array<Vec2d, 4> steps = {Vec2d{step, 0.0}, Vec2d{-step, 0.0}, Vec2d{0.0, step}, Vec2d{0.0, -step}};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto chief = rays.chief(plane.point(middle + steps[i]));
        if (!chief) {
            return std::nullopt;
        }
        ends[i] = chief->place;
    }
    const Vec2d x = (ends[0] - ends[1]) / (2.0 * step);
    const Vec2d y = (ends[2] - ends[3]) / (2.0 * step);
    const double determinant = x.x * y.y - x.y * y.x;
    return LocalMap{.row_x = Vec2d{y.y, -y.x} / determinant,
                    .row_y = Vec2d{-x.y, x.x} / determinant,
                    .mm_of_film = 0.5 * (std::hypot(x.x, x.y) + std::hypot(y.x, y.y)),
                    .area = std::abs(determinant),
                    .right = x / std::hypot(x.x, x.y)};
}

void turn_to_radius(std::vector<FilmLight>& light, Vec2d out) {
    for (FilmLight& one : light) {
        one.at = {one.at.x * out.x + one.at.y * out.y, one.at.x * -out.y + one.at.y * out.x};
    }
}

/// What one part tells: of a cross's arms the first tells all but the width across the radius.
void tell(FeatureLook& look, const std::vector<FilmLight>& light, bool is_first, bool is_last) {
    const LightMoments green = light_moments(light, &Vec3d::y);
    if (is_last) {
        look.sagittal_um = kMicrometres * green.rms.y;
    }
    if (is_first) {
        look.radius_um = kMicrometres * green.centroid.x;
        look.tangential_um = kMicrometres * green.rms.x;
        look.coma_um = kMicrometres * green.asymmetry;
        look.red_um = kMicrometres * light_moments(light, &Vec3d::x).centroid.x - look.radius_um;
        look.blue_um = kMicrometres * light_moments(light, &Vec3d::z).centroid.x - look.radius_um;
        look.area_mm2 = 4.0 * std::numbers::pi * green.rms.x * green.rms.y;
    }
}

std::optional<ChartFeature> look_at(const FeaturePlane& plane, const FilmRays& rays, const render::Sensor& sensor,
                                    Vec2d middle, const formats::Image& rgb) {
    const Vec3d point = plane.point(middle);
    const auto chief = rays.chief(point);
    const double pitch = plane.pitch_mm;
    const auto to_chart = local_map(plane, rays, middle, kStep * pitch);
    if (!chief || !to_chart) {
        return std::nullopt;
    }
    const double radius = std::hypot(chief->place.x, chief->place.y);
    const Vec2d out = radius > sensor.pixel_pitch_mm ? chief->place / radius : to_chart->right;
    ChartFeature feature{.field_deg = std::abs(chief->field) / kDegree, .picture = {}, .rays = {}};
    std::vector<Part> parts = parts_of(plane.pattern, middle);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        std::vector<FilmLight> traced;
        for (const Node& node : parts[i].nodes) {
            // By how much of the film the node's part of the chart takes: a lens that distorts spreads a feature
            // unevenly.
            const auto there = local_map(plane, rays, middle + node.off, kStep * pitch);
            rays.add(plane.point(middle + node.off), node.fraction * (there ? there->area : 0.0), traced);
        }
        std::vector<Vec2d> offs;
        std::ranges::transform(traced, std::back_inserter(offs),
                               [&](const FilmLight& one) { return (*to_chart)(one.at - chief->place); });
        parts[i].fit(offs, sensor.pixel_pitch_mm / to_chart->mm_of_film);
        const auto zone_of = [&](Vec2d film) { return parts[i].zone((*to_chart)(film)); };
        SeenLight seen = seen_light(rgb, sensor, chief->place, 0.8 * pitch * to_chart->mm_of_film, zone_of);
        if (!seen.is_in_frame) {
            return std::nullopt;
        }
        std::erase_if(traced, [&](const FilmLight& one) { return zone_of(one.at - chief->place) != Zone::feature; });
        // Within a pixel nothing is told apart: its width is in the picture's, and not in that of rays.
        const bool is_last = i + 1 == parts.size();
        if (i == 0) {
            feature.picture.light = seen.about.y;
            feature.rays.light = rays.solid_angle(point);
        }
        turn_to_radius(seen.light, out);
        turn_to_radius(traced, out);
        tell(feature.picture, seen.light, i == 0, is_last);
        tell(feature.rays, traced, i == 0, is_last);
    }
    const double pixel_um = kMicrometres * sensor.pixel_pitch_mm;
    for (double FeatureLook::*width : {&FeatureLook::tangential_um, &FeatureLook::sagittal_um}) {
        feature.rays.*width = std::hypot(feature.rays.*width, pixel_um / std::sqrt(12.0));
    }
    return feature;
}

/// The middles of those in the frame, in the order of their distance from the axis, evenly thinned out.
std::vector<Vec2d> middles_in_frame(const FeaturePlane& plane, const FilmRays& rays, const render::Sensor& sensor) {
    std::vector<std::pair<double, Vec2d>> found;
    for (const Vec2d& middle : plane.middles) {
        const auto chief = rays.chief(plane.point(middle));
        const Vec2d at = chief ? sensor.pixel(chief->place) : Vec2d{-1.0, -1.0};
        if (at.x > 0.0 && at.y > 0.0 && at.x < sensor.width && at.y < sensor.height) {
            found.emplace_back(std::hypot(chief->place.x, chief->place.y), middle);
        }
    }
    std::ranges::stable_sort(found, {}, &std::pair<double, Vec2d>::first);
    std::vector<Vec2d> middles;
    const std::size_t stride = (found.size() + kMostFeatures - 1) / kMostFeatures;
    for (std::size_t i = 0; i < found.size(); i += stride) {
        middles.push_back(found[i].second);
    }
    return middles;
}

}  // namespace

std::vector<ChartFeature> chart_features(const render::SceneSetup& setup, const render::Camera& camera,
                                         const ChartChoice& choice, const formats::Image& rgb, int threads) {
    const FilmRays rays(camera);
    std::vector<FeaturePlane> planes = choice.is_lamps ? lamp_planes(setup, camera) : std::vector<FeaturePlane>{};
    if (!choice.is_lamps) {
        for (const std::string& object : choice.objects.empty() ? std::vector<std::string>{""} : choice.objects) {
            planes.push_back(chart_plane(setup, camera, object));
        }
    }
    std::vector<std::pair<const FeaturePlane*, Vec2d>> places;
    for (const FeaturePlane& plane : planes) {
        for (const Vec2d& middle : middles_in_frame(plane, rays, camera.sensor())) {
            places.emplace_back(&plane, middle);
        }
    }
    std::vector<std::optional<ChartFeature>> looks(places.size());
    parallel_for(
        static_cast<int>(places.size()), threads,
        [&](int i) {
            const auto at = static_cast<std::size_t>(i);
            looks[at] = look_at(*places[at].first, rays, camera.sensor(), places[at].second, rgb);
        },
        [](int) {});
    std::vector<ChartFeature> features;
    for (const std::optional<ChartFeature>& look : looks) {
        if (look) {
            features.push_back(*look);
        }
    }
    if (features.empty()) {
        throw InputError("no feature of the chart lies in the frame with what is about it");
    }
    std::ranges::stable_sort(features, {}, &ChartFeature::field_deg);
    const ChartFeature first = features.front();
    for (ChartFeature& feature : features) {
        feature.picture.light /= first.picture.light;
        feature.rays.light /= first.rays.light;
    }
    return features;
}

}  // namespace lensproof::studies
