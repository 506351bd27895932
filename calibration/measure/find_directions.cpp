#include "calibration/measure/find_directions.h"

#include <fmt/format.h>

#include <algorithm>

#include "calibration/geometry/fit_geometry.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr std::size_t kFewestToStart = 4;  // that a first model is fitted to
constexpr std::size_t kManyTerms = 12;     // from which the model has a centre and a second term of its own
constexpr double kFartherOut = 1.25;       // than those that the model was fitted to: no more is looked for at once
constexpr double kUnsure_px = 2.0;         // one standard error
constexpr double kOwnReach_px = 2.0;       // for what the model does not express

ChartView view_of(const std::vector<SeenDirection>& seen) {
    ChartView view{.name = "the directions with a place", .chart_mm = {}, .image_px = {}};
    for (const auto& [direction, place] : seen) {
        view.directions.push_back(direction);
        view.image_px.push_back(place.centre_px);
    }
    return view;
}

/// None where they do not tell.
std::optional<GeometryFit> model_of(const formats::Image& image, const std::vector<SeenDirection>& seen) {
    const bool has_many = seen.size() >= kManyTerms;
    try {
        return fit_geometry(
            {view_of(seen)}, image.width, image.height,
            {.model = ModelKind::kannala_brandt, .radial_terms = has_many ? 2 : 1, .fix_centre = !has_many});
    } catch (const InputError&) {
        return std::nullopt;
    }
}

bool is_in(const formats::Image& image, const Vec2d& pixel) {
    return pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x <= image.width - 1.0 && pixel.y <= image.height - 1.0;
}

}  // namespace

SeenDirections find_directions(const formats::Image& image, int channel, const std::vector<KnownDirection>& known) {
    SeenDirections found;
    std::vector<Vec3d> unplaced;
    for (const KnownDirection& one : known) {
        if (!one.near_px) {
            unplaced.push_back(one.direction);
            continue;
        }
        ++found.placed;
        if (const auto place = locate_star(image, channel, *one.near_px, kDirectionReach_px)) {
            found.seen.push_back({one.direction, *place});
        } else {
            ++found.dark;
        }
    }
    for (bool is_growing = found.seen.size() >= kFewestToStart; is_growing && !unplaced.empty();) {
        const auto fit = model_of(image, found.seen);
        if (!fit) {
            break;
        }
        is_growing = false;
        found.unseen = 0;
        std::vector<Vec3d> rest;
        for (const Vec3d& direction : unplaced) {
            const auto at = project(fit->model, turned(fit->views.front().pose, direction));
            if (!at || !is_in(image, *at)) {
                rest.push_back(direction);
                continue;
            }
            const double radius = length(*at - centre_px(fit->model));
            const auto unsure_px =
                radius <= kFartherOut * fit->covered_radius_px ? projection_uncertainty_px(*fit, *at) : std::nullopt;
            const auto place = unsure_px && *unsure_px <= kUnsure_px
                                   ? locate_star(image, channel, *at, kOwnReach_px + 3.0 * *unsure_px)
                                   : std::nullopt;
            if (place) {
                found.seen.push_back({direction, *place});
                is_growing = true;
            } else {
                ++found.unseen;
                rest.push_back(direction);
            }
        }
        unplaced = std::move(rest);
    }
    return found;
}

std::string in_words(const SeenDirections& directions) {
    std::string words;
    if (directions.dark > 0) {
        words = fmt::format("{} of {} directions show no light within {} px of where they are said to be",
                            directions.dark, directions.placed, kDirectionReach_px);
    }
    if (directions.unseen > 0) {
        words += fmt::format("{}{} more should be in the picture and were not found", words.empty() ? "" : "; ",
                             directions.unseen);
    }
    return words;
}

}  // namespace lensproof::calibration
