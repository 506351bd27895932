#include "engine/pupil/pupil_stations.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>

#include "engine/optics/rim_margin.h"

namespace lensproof::pupil {

namespace {

PupilFrame mean_frame(const std::vector<PupilFrame>& frames, const std::vector<double>& weights) {
    PupilFrame mean{.centre = {}, .scale = {}, .bend = 0.0};
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const PupilFrame& frame = frames[i];
        mean.centre = mean.centre + weights[i] * frame.centre;
        mean.scale = mean.scale + weights[i] * frame.scale;
        mean.bend += weights[i] * frame.bend;
    }
    return mean;
}

}  // namespace

void PupilStations::trace(std::vector<Request> requests) {
    std::erase_if(requests, [&](const Request& request) { return outlines_.contains(request.place); });
    std::ranges::sort(requests, std::less<>{}, &Request::place);  // lens by lens
    std::vector<std::optional<PupilFrame>> expected;
    std::ranges::transform(requests, std::back_inserter(expected),
                           [&](const Request& request) { return expected_frame(request); });
    const OutlineSearch search{.radius = disc_.radius, .symmetry = symmetry_, .look_closer = [&](int region) {
                                   return point_by_margin(requests[static_cast<std::size_t>(region)].place);
                               }};
    std::vector<PupilOutline> outlines = pupil_outlines(
        [&](std::span<const RegionPoint> points, std::span<std::uint8_t> answers) { ask(requests, points, answers); },
        expected, search);
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        outlines_[requests[i].place] = std::move(outlines[i]);
    }
}

/// Of a place through a point that is given in the place's frame.
Ray<double> PupilStations::ray(const StationPlace& place, Vec2d own_point) const {
    const double angle = 2.0 * std::numbers::pi * place.azimuth;
    const double cosine = std::cos(angle);
    const double sine = std::sin(angle);
    return rays_.ray({place.radius * sine, place.radius * cosine},
                     {cosine * own_point.x + sine * own_point.y, cosine * own_point.y - sine * own_point.x});
}

/// In batches, whose rays have each their own wavelength.
void PupilStations::ask(const std::vector<Request>& requests, std::span<const RegionPoint> points,
                        std::span<std::uint8_t> answers) {
    // A core's cache holds so many; a device wants more.
    const std::size_t most = tracer_.is_on_device() ? optics::ColumnTracer<double>::kUsualPiece : 1024;
    optics::RayBatch<double> batch(static_cast<int>(std::min(most, points.size())));
    for (std::size_t first = 0; first < points.size(); first += most) {
        const std::size_t count = std::min(most, points.size() - first);
        batch.size = static_cast<int>(count);
        for (std::size_t i = 0; i < count; ++i) {
            const RegionPoint& point = points[first + i];
            const StationPlace& place = requests[static_cast<std::size_t>(point.region)].place;
            batch.set(static_cast<int>(i), ray(place, point.point));
            batch.wavelength[i] = static_cast<std::uint16_t>(place.lens);
        }
        const optics::BatchSettings tracing{.carry = optics::Carry::geometry};
        rays_.direction == optics::Direction::forward
            ? tracer_.trace<optics::Direction::forward>(batch.columns(), tracing)
            : tracer_.trace<optics::Direction::reverse>(batch.columns(), tracing);
        std::ranges::transform(batch.status.begin(), batch.status.begin() + batch.size,
                               answers.begin() + static_cast<std::ptrdiff_t>(first), [](optics::RayStatus status) {
                                   return status == optics::RayStatus::ok ? std::uint8_t{1} : std::uint8_t{0};
                               });
    }
}

/// A point of a region that is thinner than a grid, by how far rays stand from the rims.
std::optional<Vec2d> PupilStations::point_by_margin(const StationPlace& place) const {
    return optics::find_inside(
        [&](Vec2d at) { return optics::rim_margin(band_[place.lens], ray(place, at), rays_.direction); },
        {.start = {}, .reach = disc_.radius, .is_mirror = symmetry_ == PupilSymmetry::mirror});
}

/// Between the neighbours' frames along the radius, or else the mean of those alike; nothing where there are none.
std::optional<PupilFrame> PupilStations::expected_frame(const Request& request) const {
    const StationPlace& place = request.place;
    std::vector<PupilFrame> frames;
    std::vector<double> weights;
    const auto is_lit_neighbour = [&](const auto& it) {
        return it->first.lens == place.lens && it->first.azimuth == place.azimuth && !it->second.is_empty();
    };
    const auto add = [&](const PupilFrame& frame, double weight) {
        frames.push_back(frame);
        weights.push_back(weight);
    };
    const auto above = outlines_.upper_bound(place);
    if (above != outlines_.end() && is_lit_neighbour(above)) {
        add(above->second.frame, 1.0 / (above->first.radius - place.radius));
    }
    if (above != outlines_.begin() && is_lit_neighbour(std::prev(above))) {
        add(std::prev(above)->second.frame, 1.0 / (place.radius - std::prev(above)->first.radius));
    }
    if (frames.empty()) {
        for (const StationPlace& alike : request.alike) {
            const PupilOutline* outline = find(alike);
            if (outline != nullptr && !outline->is_empty()) {
                add(outline->frame, 1.0);
            }
        }
    }
    double sum = 0.0;
    for (const double weight : weights) {
        sum += weight;
    }
    for (double& weight : weights) {
        weight /= sum;
    }
    return frames.empty() ? std::nullopt : std::optional(mean_frame(frames, weights));
}

}  // namespace lensproof::pupil
