#include "calibration/measure/measure_sharpness.h"

#include <algorithm>
#include <cmath>

#include "calibration/sharpness/chart_edges.h"
#include "calibration/sharpness/find_edges.h"
#include "calibration/sharpness/sharpness_field.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr std::size_t kMostCurves = 200;
constexpr double kCurveDigit = 1e-5;  // far below any error
constexpr double kMostRelativeError = 0.2;

void round_curve(std::vector<double>& values) {
    for (double& value : values) {
        value = std::round(value / kCurveDigit) * kCurveDigit;
    }
}

// Null, or why the edge is not worth listing.
const char* too_uncertain(const EdgeMtf& edge) {
    if (!edge.mtf50) {
        return "does not fall to half its contrast below one cycle per pixel";
    }
    return edge.mtf50->standard_error < kMostRelativeError * edge.mtf50->cycles_per_px ? nullptr : "is too noisy";
}

std::string listed(const std::map<std::string, int>& refusals) {
    std::string text;
    for (const auto& [reason, count] : refusals) {
        text += (text.empty() ? "" : "; ") + std::to_string(count) + (count == 1 ? " edge " : " edges: each ") + reason;
    }
    return text;
}

// The curve in cycles per mm.
Curve per_mm(Curve curve, double pixel_pitch_um) {
    for (std::vector<double>* values : {&curve.value, &curve.lower_95, &curve.upper_95}) {
        for (double& value : *values) {
            value *= 1e3 / pixel_pitch_um;
        }
    }
    return curve;
}

double median_mtf50(const std::vector<EdgeMtf>& edges) {
    std::vector<double> values;
    for (const EdgeMtf& edge : edges) {
        if (edge.mtf50) {
            values.push_back(edge.mtf50->cycles_per_px);
        }
    }
    return values.empty() ? 0.0 : median(values);
}

std::vector<FocusedEdges> by_position(const SharpnessObservations& seen, const std::vector<ProfileEdge>& edges) {
    std::map<double, FocusedEdges> series;
    for (const ProfileEdge& edge : edges) {
        const auto position = seen.focus_position_mm.find(edge.image);
        if (position != seen.focus_position_mm.end()) {
            FocusedEdges& focused = series[position->second];
            focused.position_mm = position->second;
            focused.edges.push_back(edge.edge);
        }
    }
    std::vector<FocusedEdges> result;
    result.reserve(series.size());
    for (auto& [position, focused] : series) {
        result.push_back(std::move(focused));
    }
    return result;
}

void add_field(Profile& profile, const std::string& channel, const std::vector<EdgeMtf>& edges, const Vec2d& centre) {
    SharpnessField field = fit_sharpness_field(edges, centre, half_diagonal_px(profile));
    const auto add = [&](const Quantity& per_px, const Quantity& per_millimetre, Curve& curve) {
        if (profile.pixel_pitch_um) {
            profile.curves[per_millimetre.key(channel)] = per_mm(curve, *profile.pixel_pitch_um);
        }
        profile.curves[per_px.key(channel)] = std::move(curve);
    };
    add(kQuantities.tangential_mtf50, kQuantities.tangential_mtf50_per_mm, field.tangential_cycles_per_px);
    add(kQuantities.sagittal_mtf50, kQuantities.sagittal_mtf50_per_mm, field.sagittal_cycles_per_px);
    profile.curves[kQuantities.astigmatism.key(channel)] = std::move(field.tangential_over_sagittal);
    profile.terms[kSharpnessTerms(channel)] = {.names = std::move(field.names),
                                               .values = std::move(field.coefficients),
                                               .covariance = std::move(field.covariance)};
}

void add_best_focus(Profile& profile, const std::string& channel, const std::vector<FocusedEdges>& series,
                    const Vec2d& centre) {
    BestFocus focus = fit_best_focus(series, centre, half_diagonal_px(profile));
    profile.curves[kQuantities.tangential_focus.key(channel)] = std::move(focus.tangential_mm);
    profile.curves[kQuantities.sagittal_focus.key(channel)] = std::move(focus.sagittal_mm);
    profile.terms[kBestFocusTerms(channel)] = {
        .names = {"axis_position_mm"},
        .values = {focus.axis_position_mm},
        .covariance = {focus.axis_standard_error_mm * focus.axis_standard_error_mm}};
}

// The edge, if it is worth listing; else its refusal is counted.
std::optional<EdgeMtf> measured_edge(SharpnessObservations& seen, const formats::Image& image, int channel,
                                     const EdgeRegion& region) {
    auto result = measure_edge(image, channel, region);
    if (const auto* refusal = std::get_if<EdgeRefusal>(&result)) {
        ++seen.refusals[refusal->reason];
        return std::nullopt;
    }
    if (const char* reason = too_uncertain(std::get<EdgeMtf>(result))) {
        ++seen.refusals[reason];
        return std::nullopt;
    }
    return std::get<EdgeMtf>(std::move(result));
}

// Whether both sides of an edge have one colour, as those of a black and a white square: the same contrast in all
// channels.
bool is_of_one_colour(const formats::Image& image, const std::vector<int>& channels, int reference,
                      const EdgeRegion& region) {
    constexpr double kSame = 0.05;
    const double expected = tone_contrast(image, reference, region);
    return std::ranges::all_of(
        channels, [&](int channel) { return std::abs(tone_contrast(image, channel, region) - expected) < kSame; });
}

InputError refused(const std::string& name, const std::string& channel, const PixelRectangle& r,
                   const std::string& reason) {
    return InputError(name + ": the rectangle " + std::to_string(r.x) + "," + std::to_string(r.y) + "," +
                      std::to_string(r.width) + "," + std::to_string(r.height) + " in channel " + channel + " " +
                      reason + ": expected one slanted edge with room on either side");
}

}  // namespace

void observe_chart_edges(SharpnessObservations& seen, const formats::Image& image, int channel, const std::string& name,
                         const ChartPoints& points, const scene::Chart& chart) {
    std::vector<ProfileEdge>& own = seen.edges[image.channels[static_cast<std::size_t>(channel)]];
    for (const EdgeRegion& region : chart_edges(points, chart)) {
        if (auto edge = measured_edge(seen, image, channel, region)) {
            own.push_back({name, std::move(*edge)});
        }
    }
}

std::map<std::string, std::vector<ChromaticPair>> observe_any_edges(SharpnessObservations& seen,
                                                                    const formats::Image& image,
                                                                    const std::vector<int>& channels, int reference,
                                                                    const std::string& name) {
    SharpnessObservations own;
    bool any = false;
    std::map<std::string, std::vector<ChromaticPair>> pairs;
    const std::vector<EdgeRegion> regions = find_edges(image, reference);
    for (const EdgeRegion& region : regions) {
        const auto expected = measured_edge(own, image, reference, region);
        if (!expected) {
            continue;
        }
        any = true;
        const double angle = radians(expected->normal_deg);
        const bool is_neutral = is_of_one_colour(image, channels, reference, region);
        own.coloured_edges += is_neutral ? 0 : 1;
        for (const int channel : channels) {
            const std::string& label = image.channels[static_cast<std::size_t>(channel)];
            const auto edge = channel == reference ? expected : measured_edge(own, image, channel, region);
            if (edge) {
                seen.edges[label].push_back({name, *edge});
            }
            if (edge && is_neutral && channel != reference) {
                pairs[label].push_back({expected->centre_px, edge->centre_px, Vec2d{std::cos(angle), std::sin(angle)}});
            }
        }
    }
    for (const auto& [reason, count] : own.refusals) {
        seen.refusals[reason] += count;
    }
    seen.coloured_edges += own.coloured_edges;
    if (!any) {
        throw InputError(name + ": none of " + std::to_string(regions.size()) + " edges can be measured" +
                         (own.refusals.empty() ? ": expected straight edges between even tones"
                                               : " (" + listed(own.refusals) + ")"));
    }
    return pairs;
}

void observe_edges(SharpnessObservations& seen, const formats::Image& image, int channel, const std::string& name,
                   const std::vector<PixelRectangle>& rectangles) {
    const std::string& own = image.channels[static_cast<std::size_t>(channel)];
    for (PixelRectangle r : rectangles) {
        if (r.width == 0 && r.height == 0) {
            r = {0, 0, image.width, image.height};
        }
        const auto refuse = [&](const std::string& reason) { return refused(name, own, r, reason); };
        const auto region = find_edge(image, channel, r);
        if (const auto* refusal = std::get_if<EdgeRefusal>(&region)) {
            throw refuse(refusal->reason);
        }
        auto result = measure_edge(image, channel, std::get<EdgeRegion>(region));
        if (const auto* refusal = std::get_if<EdgeRefusal>(&result)) {
            throw refuse(refusal->reason);
        }
        seen.edges[own].push_back({name, std::move(std::get<EdgeMtf>(result))});
    }
}

void observe_stars(SharpnessObservations& seen, const formats::Image& image, int channel, const std::string& name,
                   const scene::SiemensStar& star) {
    const auto found = find_stars(image, channel, star);
    if (const auto* refusal = std::get_if<StarRefusal>(&found)) {
        throw InputError(name + ": " + refusal->reason);
    }
    std::string reason;
    std::vector<ProfileStar>& own = seen.stars[image.channels[static_cast<std::size_t>(channel)]];
    const std::size_t before = own.size();
    for (const StarMap& map : std::get<std::vector<StarMap>>(found)) {
        auto result = measure_star(image, channel, map, star);
        if (const auto* refusal = std::get_if<StarRefusal>(&result)) {
            reason = refusal->reason;
            continue;
        }
        own.push_back({name, std::move(std::get<StarMtf>(result))});
        for (StarSegment& segment : own.back().star.segments) {
            for (std::vector<double>* curve : {&segment.cycles_per_px, &segment.mtf, &segment.mtf_standard_error}) {
                round_curve(*curve);
            }
        }
    }
    if (own.size() == before) {
        throw InputError(name + ": " + reason);
    }
}

void add_sharpness(Profile& profile, const SharpnessObservations& seen, const Vec2d& centre_px) {
    profile.siemens_stars = seen.stars;
    for (const auto& [channel, listed_edges] : seen.edges) {
        std::vector<FocusedEdges> series = by_position(seen, listed_edges);
        std::vector<EdgeMtf> edges;
        edges.reserve(listed_edges.size());
        for (const ProfileEdge& edge : listed_edges) {
            edges.push_back(edge.edge);
        }
        try {
            if (!series.empty()) {
                edges =
                    std::max_element(series.begin(), series.end(), [](const FocusedEdges& a, const FocusedEdges& b) {
                        return median_mtf50(a.edges) < median_mtf50(b.edges);
                    })->edges;
                add_best_focus(profile, channel, series, centre_px);
            }
        } catch (const InputError& e) {
            profile.not_measured[part::kFieldCurvature] = e.what();
        }
        try {
            add_field(profile, channel, edges, centre_px);
        } catch (const InputError& e) {
            const std::string refused = listed(seen.refusals);
            profile.not_measured[part::kSharpness] = e.what() + (refused.empty() ? "" : " (" + refused + ")");
        }
        std::vector<ProfileEdge>& kept = profile.sharpness[channel];
        kept = listed_edges;
        for (ProfileEdge& edge : kept) {
            if (kept.size() > kMostCurves) {
                edge.edge.mtf.clear();
                edge.edge.mtf_standard_error.clear();
            }
            round_curve(edge.edge.mtf);
            round_curve(edge.edge.mtf_standard_error);
        }
    }
}

}  // namespace lensproof::calibration
