#include "experiments/studies/chart_pictures/seen_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/affine.h"

namespace lensproof::studies {

namespace {

constexpr std::array kColours = {&Vec3d::x, &Vec3d::y, &Vec3d::z};

/// The plane a + b x + c y through light, by least squares; nothing through too little.
std::optional<Vec3d> plane_through(const std::vector<FilmLight>& light, double Vec3d::*colour) {
    AffineMap normal{.linear = {Vec3d{}, Vec3d{}, Vec3d{}}, .translation = {}};
    Vec3d right;
    for (const FilmLight& one : light) {
        const Vec3d row{1.0, one.at.x, one.at.y};
        normal.linear[0] = normal.linear[0] + row;
        normal.linear[1] = normal.linear[1] + one.at.x * row;
        normal.linear[2] = normal.linear[2] + one.at.y * row;
        right = right + one.rgb.*colour * row;
    }
    const std::optional<AffineMap> solved = inverse(normal);
    return solved ? std::optional(solved->linear * right) : std::nullopt;
}

}  // namespace

SeenLight seen_light(const formats::Image& rgb, const render::Sensor& sensor, Vec2d middle, double reach,
                     const std::function<Zone(Vec2d)>& zone_of) {
    const Vec2d at_px = sensor.pixel(middle);
    const double reach_px = reach / sensor.pixel_pitch_mm;
    SeenLight seen;
    std::vector<FilmLight> border;
    for (int y = static_cast<int>(std::floor(at_px.y - reach_px)); y <= at_px.y + reach_px; ++y) {
        for (int x = static_cast<int>(std::floor(at_px.x - reach_px)); x <= at_px.x + reach_px; ++x) {
            const Vec2d off = sensor.position(x, y) - middle;
            const Zone zone = zone_of(off);
            if (zone == Zone::beyond) {
                continue;
            }
            if (x < 0 || y < 0 || x >= rgb.width || y >= rgb.height) {
                return {.light = {}, .about = {}, .is_in_frame = false};
            }
            (zone == Zone::border ? border : seen.light)
                .push_back({off, {rgb.at(x, y, 0), rgb.at(x, y, 1), rgb.at(x, y, 2)}});
        }
    }
    for (double Vec3d::*colour : kColours) {
        const std::optional<Vec3d> plane = plane_through(border, colour);
        if (!plane || seen.light.empty()) {
            return {.light = {}, .about = {}, .is_in_frame = false};
        }
        seen.about.*colour = plane->x;
        double sum = 0.0;
        for (FilmLight& one : seen.light) {
            one.rgb.*colour -= dot(*plane, {1.0, one.at.x, one.at.y});
            sum += one.rgb.*colour;
        }
        if (sum < 0.0) {
            std::ranges::for_each(seen.light, [&](FilmLight& one) { one.rgb.*colour = -(one.rgb.*colour); });
        }
    }
    std::ranges::for_each(seen.light, [&](FilmLight& one) { one.at = one.at + middle; });
    return seen;
}

}  // namespace lensproof::studies
