#include "calibration/measure/observe.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>
#include <thread>
#include <utility>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "calibration/detection/star_place.h"
#include "calibration/detection/working_copy.h"
#include "calibration/lines/find_lines.h"
#include "calibration/measure/find_directions.h"
#include "calibration/picture/picture_quality.h"
#include "engine/base/hash.h"
#include "engine/base/parallel.h"

namespace lensproof::calibration {
namespace {

constexpr double kLeastFoundFraction = 0.6;  // of the points detected; with fewer the detection itself is doubtful

std::string describe(const scene::Chart& chart) {
    const scene::GridSize grid = scene::feature_grid(chart);
    return std::to_string(grid.columns) + " × " + std::to_string(grid.rows) + " " + scene::kind_name(chart);
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : ", ") + word;
    }
    return text;
}

// What one picture shows by itself, whatever the others do.
struct Look {
    PictureObservation own;
    int width = 0;  // 0 where it could not be loaded
    int height = 0;
    std::vector<std::string> channels;
    bool grey = true;
    SharpnessObservations sharpness;
};

std::string size_in_words(int width, int height) {
    return std::to_string(width) + " × " + std::to_string(height);
}

void check_pixels(const formats::Image& image, const std::string& name) {
    if (image.width < 1 || image.height < 1 || image.channels.empty() ||
        image.pixels.size() != static_cast<std::size_t>(image.width) * image.height * image.channels.size()) {
        throw InputError(name + ": the picture is " + size_in_words(image.width, image.height) + " with " +
                         std::to_string(image.channels.size()) + " channels: expected pixels");
    }
}

// Why the picture does not go with those before it; empty where it does.
std::string unlike_those_before(const Observations& seen, const Look& look) {
    if (seen.width != 0 && (look.width != seen.width || look.height != seen.height)) {
        return "the picture is " + size_in_words(look.width, look.height) + " pixels: expected " +
               size_in_words(seen.width, seen.height) + " like the pictures before it";
    }
    if (!seen.channels.empty() && look.channels != seen.channels) {
        return "the picture has the channels " + joined(look.channels) + ": expected " + joined(seen.channels) +
               " like the pictures before it";
    }
    const auto same = std::ranges::find(seen.pictures, look.own.pixels_hash, &PictureObservation::pixels_hash);
    return same != seen.pictures.end() ? "the same picture as " + same->account.image : "";
}

// Why what was refined does not do; empty where it does.
std::string too_few(const ChartPoints& refined, const ChartPoints& detected) {
    const int count = count_found(refined);
    const int seen = count_found(detected);
    return count >= kLeastFoundFraction * seen
               ? ""
               : "only " + std::to_string(count) + " of " + std::to_string(seen) +
                     " points seen could be measured: too little contrast, clipped, or not this chart";
}

// What the fits keep of a chart that was found: its points, and what each channel shows there.
void observe_channels(Look& look, const formats::Image& image, const Picture& picture, const MeasureInput& input,
                      const ChartPoints& points) {
    PictureObservation& own = look.own;
    const scene::Chart& chart = input.chart;
    const int reference = reference_channel(image);
    const std::vector<Vec2d> features = scene::feature_points(chart);
    own.reference_channel = image.channels[reference];
    own.lines = line_points(image, reference, points, chart);
    own.points.name = picture.name;
    for (std::size_t i = 0; i < features.size(); ++i) {
        if (points.found[i]) {
            own.points.chart_mm.push_back(features[i]);
            own.points.image_px.push_back(points.image_px[i]);
            own.point_errors_px.push_back(points.standard_error_px[i]);
        }
    }
    const bool grey = all_channels_alike(image);
    for (int channel = 0; channel < image.channel_count(); ++channel) {
        const std::string& channel_name = image.channels[channel];
        if (picture.use_light && input.parts.vignetting) {
            own.light[channel_name] = chart_white_samples(image, channel, points, chart);
        }
        if (input.parts.sharpness && (channel == reference || !grey)) {
            observe_chart_edges(look.sharpness, image, channel, picture.name, points, chart);
        }
        if (channel == reference || grey || !input.parts.chromatic_shift) {
            continue;
        }
        const ChartPoints other = refine(image, channel, points, chart);
        for (std::size_t i = 0; i < features.size(); ++i) {
            if (points.found[i] && other.found[i]) {
                own.chromatic_pairs[channel_name].push_back({points.image_px[i], other.image_px[i]});
            }
        }
    }
}

void observe_chart(Look& look, const formats::Image& image, const Picture& picture, const MeasureInput& input) {
    PictureObservation& own = look.own;
    const scene::Chart& chart = input.chart;
    ProfileView& view = own.view.emplace();
    PictureAccount& account = own.account;
    view.image = picture.name;
    const Detection detection = detect(image, chart);
    const int reference = reference_channel(image);
    const ChartPoints points = detection.found() ? refine(image, reference, detection.points, chart) : ChartPoints{};
    view.reason = detection.found() ? too_few(points, detection.points) : detection.reason;
    if (!detection.found()) {
        const std::string fault = visible_fault(image, reference);
        view.reason += (fault.empty() ? "" : "; ") + fault;
    }
    if (view.reason.empty()) {
        view.traits = picture_traits(image, reference, points);
        view.reason = view.traits ? too_blurred(*view.traits, points, chart) : "";
    }
    view.found = view.reason.empty();
    account.used = view.found;
    account.reason = view.found ? picture.remark : view.reason;
    if (!view.found) {
        return;
    }
    if (view.traits && is_white_clipped(*view.traits)) {
        account.reason += std::string(account.reason.empty() ? "" : "; ") +
                          "over-exposed: the chart's white is clipped, so it says nothing of vignetting";
    }
    view.numbering = numbering_key(detection.numbering);
    const std::string open = numbering_in_words(detection.numbering);
    account.reason += (account.reason.empty() || open.empty() ? "" : "; ") + open;
    observe_channels(look, image, picture, input, points);
}

// All channels; of a picture whose channels are alike, one.
std::vector<int> channels_that_differ(const formats::Image& image) {
    if (all_channels_alike(image)) {
        return {reference_channel(image)};
    }
    std::vector<int> channels(static_cast<std::size_t>(image.channel_count()));
    std::iota(channels.begin(), channels.end(), 0);
    return channels;
}

// Each known direction's light, in the channel of the geometry and, of those found, in the others.
void observe_directions(Look& look, const formats::Image& image, const Picture& picture, const MeasureInput& input) {
    constexpr std::size_t kFewestDirections = 4;  // that a fit takes
    PictureObservation& own = look.own;
    const auto listed = input.directions.find(picture.name);
    const int reference = reference_channel(image);
    const SeenDirections found =
        listed == input.directions.end() ? SeenDirections() : find_directions(image, reference, listed->second);
    own.reference_channel = image.channels[reference];
    own.points.name = picture.name;
    for (const auto& [direction, place] : found.seen) {
        own.points.directions.push_back(direction);
        own.points.image_px.push_back(place.centre_px);
        own.point_errors_px.push_back(place.standard_error_px);
    }
    for (const int channel : input.parts.chromatic_shift ? channels_that_differ(image) : std::vector{reference}) {
        for (const Vec2d& place : own.points.image_px) {
            const auto other =
                channel != reference ? locate_star(image, channel, place, kDirectionReach_px) : std::nullopt;
            if (other) {
                own.chromatic_pairs[image.channels[channel]].push_back({place, other->centre_px});
            }
        }
    }
    ProfileView& view = own.view.emplace();
    view.image = picture.name;
    view.found = found.seen.size() >= kFewestDirections;
    const std::string missing = in_words(found);
    if (!view.found) {
        view.reason = fmt::format("{} of {} that are listed with a place, expected {} at least{}{}", found.seen.size(),
                                  found.placed, kFewestDirections, missing.empty() ? "" : ": ", missing);
    }
    own.account.used = view.found;
    own.account.reason = view.found ? picture.remark : view.reason;
    if (view.found) {
        own.account.reason += (picture.remark.empty() || missing.empty() ? "" : "; ") + missing;
    }
}

// Throws InputError for a picture that is not to be used.
formats::Image load(const Picture& picture) {
    if (!picture.left_out.empty()) {
        throw InputError(picture.left_out);
    }
    if (!picture.load) {
        throw InputError("the picture cannot be loaded");
    }
    formats::Image image = picture.load();
    check_pixels(image, picture.name);
    return image;
}

std::string hash_of_pixels(const formats::Image& image) {
    return hash_text({reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size() * sizeof(float)});
}

std::string role_name(PictureRole role) {
    return role == PictureRole::chart        ? "chart"
           : role == PictureRole::edges      ? "edges"
           : role == PictureRole::lines      ? "lines"
           : role == PictureRole::directions ? "directions"
                                             : "flat field";
}

// A message without the picture's name, which stands beside it.
std::string without_name(const std::string& message, const std::string& name) {
    return message.rfind(name + ": ", 0) == 0 ? message.substr(name.size() + 2) : message;
}

void observe_picture(Look& look, const Picture& picture, const MeasureInput& input) {
    const formats::Image image = load(picture);
    PictureObservation& own = look.own;
    own.pixels_hash = hash_of_pixels(image);
    PictureAccount& account = own.account;
    look.width = image.width;
    look.height = image.height;
    look.channels = image.channels;
    look.grey = all_channels_alike(image);
    if (const auto* star = std::get_if<scene::SiemensStar>(&input.chart.pattern);
        star != nullptr && picture.role == PictureRole::chart) {
        for (const int channel : channels_that_differ(image)) {
            observe_stars(look.sharpness, image, channel, picture.name, *star);
        }
        account.used = true;
        account.reason = picture.remark;
        return;
    }
    if (picture.role == PictureRole::chart) {
        observe_chart(look, image, picture, input);
        return;
    }
    if (picture.role == PictureRole::edges && input.edges.empty()) {
        own.chromatic_pairs = observe_any_edges(look.sharpness, image, channels_that_differ(image),
                                                reference_channel(image), picture.name);
        account.used = true;
        account.reason = picture.remark;
        return;
    }
    if (picture.role == PictureRole::edges) {
        for (const int channel : channels_that_differ(image)) {
            observe_edges(look.sharpness, image, channel, picture.name, input.edges);
        }
        account.used = true;
        return;
    }
    if (picture.role == PictureRole::lines) {
        own.scene_lines = find_lines(image, reference_channel(image), picture.name);
        account.used = !own.scene_lines.empty();
        account.reason = account.used ? picture.remark : "no edge is a tenth of the diagonal long";
        return;
    }
    if (picture.role == PictureRole::directions) {
        observe_directions(look, image, picture, input);
        return;
    }
    for (int channel = 0; channel < image.channel_count() && picture.use_light; ++channel) {
        own.light[image.channels[channel]] = flat_field_samples(image, channel);
    }
    account.used = picture.use_light;
    account.reason = picture.remark;
}

PictureObservation not_looked_at(const Picture& picture) {
    PictureObservation own;
    own.account = {.image = picture.name,
                   .role = role_name(picture.role),
                   .used = false,
                   .reason = {},
                   .orientation = picture.orientation};
    return own;
}

void leave_out(PictureObservation& own, const Picture& picture, const MeasureInput& input, const std::string& reason) {
    own.account.reason = reason;
    if ((picture.role == PictureRole::chart && !shows_star(input)) || picture.role == PictureRole::directions) {
        own.view = ProfileView{.image = picture.name, .reason = reason, .traits = {}, .pose = {}, .points = {}};
    }
}

Look look_at(const Picture& picture, const MeasureInput& input) {
    Look look{.own = not_looked_at(picture), .channels = {}, .sharpness = {}};
    try {
        observe_picture(look, picture, input);
    } catch (const InputError& e) {
        leave_out(look.own, picture, input, without_name(e.what(), picture.name));
    }
    return look;
}

void add_observed(SharpnessObservations& all, SharpnessObservations& own) {
    const auto append = [](auto& to, auto& from) {
        for (auto& [channel, list] : from) {
            auto& known = to[channel];
            std::ranges::move(list, std::back_inserter(known));
        }
    };
    append(all.edges, own.edges);
    append(all.stars, own.stars);
    for (const auto& [reason, count] : own.refusals) {
        all.refusals[reason] += count;
    }
    all.coloured_edges += own.coloured_edges;
}

void take(Observations& seen, Look look, const Picture& picture, const MeasureInput& input) {
    const bool is_loaded = look.width > 0;
    if (const std::string reason = is_loaded ? unlike_those_before(seen, look) : ""; !reason.empty()) {
        look.own = not_looked_at(picture);
        leave_out(look.own, picture, input, reason);
    } else if (is_loaded) {
        seen.width = look.width;
        seen.height = look.height;
        seen.channels = look.channels;
        seen.grey = seen.grey && look.grey;
        add_observed(seen.sharpness, look.sharpness);
    }
    seen.pictures.push_back(std::move(look.own));
}

// How many pictures of a size are looked at at once: those of a cheap camera on all cores, of a large one fewer.
int at_once(const Observations& seen, int threads) {
    constexpr double kMostPixels = 1e8;  // some 4 GB
    const double pixels = std::max(1.0, static_cast<double>(seen.width) * seen.height);
    const int affordable = static_cast<int>(std::clamp(kMostPixels / pixels, 1.0, 1024.0));
    return threads > 0 ? std::min(threads, affordable)
                       : std::min(affordable, static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

}  // namespace

bool shows_star(const MeasureInput& input) {
    return std::holds_alternative<scene::SiemensStar>(input.chart.pattern);
}

bool has_role(const MeasureInput& input, PictureRole role) {
    return std::ranges::count(input.pictures, role, &Picture::role) > 0;
}

bool looks_for_charts(const Observations& seen) {
    return std::ranges::any_of(seen.pictures, [](const auto& picture) { return picture.view.has_value(); });
}

Observations observe(const MeasureInput& input) {
    Observations seen;
    seen.sharpness.focus_position_mm = input.focus_position_mm;
    std::span<const Picture> rest = input.pictures;
    const auto tell = [&](std::size_t finished) {
        if (input.progress && finished < input.pictures.size()) {
            input.progress(static_cast<double>(finished) / static_cast<double>(input.pictures.size()));
        }
    };
    for (; !rest.empty() && seen.width == 0; rest = rest.subspan(1)) {  // until one says how large they are
        tell(seen.pictures.size());
        take(seen, look_at(rest.front(), input), rest.front(), input);
    }
    std::vector<Look> looks(rest.size());
    parallel_for(
        static_cast<int>(rest.size()), at_once(seen, input.threads),
        [&](int i) {
            const auto at = static_cast<std::size_t>(i);
            looks[at] = look_at(rest[at], input);
        },
        [&](int finished) { tell(seen.pictures.size() + static_cast<std::size_t>(finished)); });
    for (std::size_t i = 0; i < looks.size(); ++i) {
        take(seen, std::move(looks[i]), rest[i], input);
    }
    return seen;
}

InputError none_usable(const MeasureInput& input, const Observations& seen) {
    constexpr std::size_t kMostNamed = 8;
    const std::size_t count = seen.pictures.size();
    const std::string what = has_role(input, PictureRole::directions) ? "too few known directions are seen in any"
                             : looks_for_charts(seen)                 ? "no " + describe(input.chart) + " found in any"
                             : shows_star(input)                      ? "no Siemens star measured in any"
                             : has_role(input, PictureRole::edges)    ? "no edge measured in any"
                             : has_role(input, PictureRole::lines)    ? "no long edge found in any"
                                                                      : "no flat field";
    std::string text =
        input.name + ": " + what + " of " + std::to_string(count) + (count == 1 ? " picture" : " pictures");
    for (std::size_t i = 0; i < std::min(count, kMostNamed); ++i) {
        text += (i == 0 ? ": " : "; ") + seen.pictures[i].account.image + ": " + seen.pictures[i].account.reason;
    }
    return InputError(text + (count > kMostNamed ? "; …" : ""));
}

}  // namespace lensproof::calibration
