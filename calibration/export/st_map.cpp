#include "calibration/export/st_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/export/covered_frame.h"
#include "engine/base/bisect.h"
#include "engine/base/parallel.h"

namespace lensproof::calibration {
namespace {

/// The photo, and the undistorted picture beside it, which share frame, focal length and principal point.
struct Pair {
    const Profile* profile = nullptr;
    optics::Projection ideal = optics::Projection::rectilinear;
    double focal_px = 0.0;
    Vec2d centre;
    double covered_radius_px = 0.0;
    double largest_angle_rad = 0.0;  // that the model images one to one, to well beyond the frame
};

/// To half a frame beyond the farthest corner, or where r(θ) turns back before.
double find_largest_angle(const Pair& pair) {
    const CameraModel& model = pair.profile->geometry->model;
    const double farthest = 3.0 * half_diagonal_px(*pair.profile);
    if (const auto angle = field_angle_rad(model, farthest)) {
        return *angle;
    }
    const auto is_imaged = [&](double radius) { return field_angle_rad(model, radius).has_value(); };
    return field_angle_rad(model, bisected({0.0, farthest}, 60, is_imaged).inside).value_or(0.0);
}

/// Where the undistorted picture shows what the photo shows at `photo_px`.
std::optional<Vec2d> undistorted(const Pair& pair, const Vec2d& photo_px) {
    const auto direction = unproject(pair.profile->geometry->model, photo_px);
    if (!direction) {
        return std::nullopt;
    }
    const double lateral = std::hypot(direction->x, direction->y);
    const auto radius = ideal_radius(pair.ideal, std::atan2(lateral, direction->z));
    if (!radius) {
        return std::nullopt;
    }
    const double scale = lateral > 0.0 ? pair.focal_px * *radius / lateral : 0.0;
    return Vec2d{pair.centre.x + scale * direction->x, pair.centre.y + scale * direction->y};
}

/// Where the photo shows what the undistorted picture shows at `ideal_px`.
std::optional<Vec2d> distorted(const Pair& pair, const Vec2d& ideal_px) {
    const double dx = ideal_px.x - pair.centre.x;
    const double dy = ideal_px.y - pair.centre.y;
    const double radius = std::hypot(dx, dy);
    const auto angle = ideal_angle(pair.ideal, radius / pair.focal_px);
    if (!angle || *angle > pair.largest_angle_rad) {
        return std::nullopt;
    }
    const double lateral = radius > 0.0 ? std::sin(*angle) / radius : 0.0;
    return project(pair.profile->geometry->model, {lateral * dx, lateral * dy, std::cos(*angle)});
}

/// The part of the undistorted plane that the photo fills, whole pixels, the frame at least.
formats::FramePlacement reach(const Pair& pair, double most_overscan, int& width, int& height) {
    const int w = pair.profile->width_px;
    const int h = pair.profile->height_px;
    const Vec2d most{most_overscan * w, most_overscan * h};
    Vec2d low{0.0, 0.0};
    Vec2d high{w - 1.0, h - 1.0};
    const auto include = [&](double x, double y) {
        const auto ideal = undistorted(pair, {x, y});
        if (ideal) {
            low = {std::min(low.x, ideal->x), std::min(low.y, ideal->y)};
            high = {std::max(high.x, ideal->x), std::max(high.y, ideal->y)};
        } else {  // beyond every frame
            low = {x < pair.centre.x ? -most.x : low.x, y < pair.centre.y ? -most.y : low.y};
            high = {x > pair.centre.x ? w - 1 + most.x : high.x, y > pair.centre.y ? h - 1 + most.y : high.y};
        }
    };
    for (int x = 0; x < w; ++x) {
        include(x, -0.5);
        include(x, h - 0.5);
    }
    for (int y = 0; y < h; ++y) {
        include(-0.5, y);
        include(w - 0.5, y);
    }
    const int left = static_cast<int>(std::floor(std::max(low.x, -most.x)));
    const int top = static_cast<int>(std::floor(std::max(low.y, -most.y)));
    width = static_cast<int>(std::ceil(std::min(high.x, w - 1 + most.x))) - left + 1;
    height = static_cast<int>(std::ceil(std::min(high.y, h - 1 + most.y))) - top + 1;
    return {.x = left, .y = top, .frame_width = w, .frame_height = h};
}

/// Sets R, G, B and A of one pixel of a map to a point of its source, px of the frame.
void set_pixel(StMap& map, int x, int y, const std::optional<Vec2d>& source_px, bool covered) {
    const formats::FramePlacement& frame = map.placement;
    const Vec2d source = source_px.value_or(Vec2d{});
    map.image.at(x, y, 0) = source_px ? static_cast<float>((source.x + 0.5) / frame.frame_width) : -1.0F;
    map.image.at(x, y, 1) = source_px ? static_cast<float>(1.0 - (source.y + 0.5) / frame.frame_height) : -1.0F;
    map.image.at(x, y, 2) = source_px && covered ? 1.0F : 0.0F;
    map.image.at(x, y, 3) = source_px ? 1.0F : 0.0F;
}

bool is_covered(const Pair& pair, const Vec2d& photo_px) {
    return std::hypot(photo_px.x - pair.centre.x, photo_px.y - pair.centre.y) <= pair.covered_radius_px;
}

StMap undistort_map(const Pair& pair, const StMapOptions& options) {
    int width = 0;
    int height = 0;
    const formats::FramePlacement placement = reach(pair, options.most_overscan, width, height);
    StMap map{.image = formats::make_image(width, height, {"R", "G", "B", "A"}), .placement = placement};
    const auto row = [&](int y) {
        for (int x = 0; x < width; ++x) {
            const auto photo = distorted(pair, {x + placement.x + 0.0, y + placement.y + 0.0});
            set_pixel(map, x, y, photo, photo && is_covered(pair, *photo));
        }
    };
    parallel_for(height, options.threads, row);
    return map;
}

StMap distort_map(const Pair& pair, const StMapOptions& options) {
    const int width = pair.profile->width_px;
    const int height = pair.profile->height_px;
    StMap map{.image = formats::make_image(width, height, {"R", "G", "B", "A"}),
              .placement = {.x = 0, .y = 0, .frame_width = width, .frame_height = height}};
    const auto row = [&](int y) {
        for (int x = 0; x < width; ++x) {
            const Vec2d photo{x + 0.0, y + 0.0};
            set_pixel(map, x, y, undistorted(pair, photo), is_covered(pair, photo));
        }
    };
    parallel_for(height, options.threads, row);
    return map;
}

void describe(StMap& map, const Pair& pair, const std::string& kind) {
    auto& texts = map.image.metadata;
    texts["lensproof:map"] = kind;
    texts["lensproof:profile"] = pair.profile->name;
    texts["lensproof:convention"] =
        "R, G = u, v of the source in 0...1 of the frame (display window), origin at its lower left corner, pixel "
        "centres at +0.5; B = 1 where measured, 0 where extrapolated; A = 0 and u = v = -1 where nothing is imaged";
    texts["lensproof:undistorted"] = fmt::format(
        "{}, focal length {:.9g} px, principal point ({:.9g}, {:.9g}) px from the centre of the top-left "
        "pixel",
        name_of(pair.ideal), pair.focal_px, pair.centre.x, pair.centre.y);
}

}  // namespace

StMaps st_maps(const Profile& profile, const StMapOptions& options) {
    const ProfileGeometry& geometry = exported_geometry(profile);
    Pair pair{.profile = &profile,
              .ideal = options.undistorted,
              .focal_px = focal_length_px(geometry.model),
              .centre = centre_px(geometry.model),
              .covered_radius_px = geometry.covered_image_height * half_diagonal_px(profile)};
    pair.largest_angle_rad = find_largest_angle(pair);
    StMaps maps{.undistort = undistort_map(pair, options), .distort = distort_map(pair, options), .notes = {}};
    describe(maps.undistort, pair, "undistort");
    describe(maps.distort, pair, "distort");

    const formats::FramePlacement& placement = maps.undistort.placement;
    maps.notes.push_back(fmt::format("undistorted: {}, focal length {:.6g} px", name_of(pair.ideal), pair.focal_px));
    maps.notes.push_back(fmt::format(
        "overscan of the undistorted picture: {} px left, {} px right, {} px above, {} px below its {} x {} frame",
        -placement.x, maps.undistort.image.width + placement.x - profile.width_px, -placement.y,
        maps.undistort.image.height + placement.y - profile.height_px, profile.width_px, profile.height_px));
    const auto lost = std::ranges::count_if(frame_points(profile, 99), [&](const FramePoint& point) {
        const auto ideal = undistorted(pair, point.pixel_px);
        return !ideal || ideal->x < placement.x || ideal->y < placement.y ||
               ideal->x > placement.x + maps.undistort.image.width - 1 ||
               ideal->y > placement.y + maps.undistort.image.height - 1;
    });
    if (lost > 0) {
        maps.notes.push_back(fmt::format(
            "{} of {} points of the photo lie beyond the overscan: a fisheye projection or more overscan holds them",
            lost, frame_points(profile, 99).size()));
    }
    if (geometry.covered_image_height < 1.0) {
        maps.notes.push_back(fmt::format("extrapolated beyond {:.0f} % of the half diagonal (B = 0)",
                                         100.0 * geometry.covered_image_height));
    }
    return maps;
}

}  // namespace lensproof::calibration
