#include "calibration/measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/chromatic/measure_bands.h"
#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "calibration/detection/working_copy.h"
#include "calibration/geometry/geometry_curves.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/light/light_gradient.h"
#include "calibration/light/light_samples.h"
#include "calibration/light/vignetting.h"
#include "calibration/photos/picture_quality.h"
#include "calibration/self_test/self_test.h"
#include "calibration/sharpness/measure_sharpness.h"
#include "engine/io/hash.h"
#include "engine/io/input_error.h"

namespace lensproof {
namespace {

constexpr double kLeastFoundShare = 0.6;  // of the points detected; with fewer the detection itself is doubtful

// What is kept of the pictures once they are gone.
struct Observations {
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;
    bool grey = true;  // every picture has one channel, or all channels alike
    std::vector<PictureAccount> pictures;
    std::map<std::string, std::string> names_by_pixels;  // the pictures in use, by their pixels' hash
    std::vector<ProfileView> views;
    std::vector<ChartView> chart_views;                                  // of the views found
    std::map<std::string, std::vector<ChromaticPair>> chromatic_pairs;   // by channel
    std::map<std::string, std::vector<LightGroup>> flat_fields, whites;  // by channel
    /// By view: the channel that geometry is measured in, and where among its `whites` the view's stands.
    std::map<std::size_t, std::pair<std::string, std::size_t>> reference_whites;
    SharpnessObservations sharpness;
};

std::string describe(const Chart& chart) {
    const GridSize grid = feature_grid(chart);
    return std::to_string(grid.columns) + " × " + std::to_string(grid.rows) + " " + kind_name(chart);
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : ", ") + word;
    }
    return text;
}

void check_alike(const Observations& seen, const Image& image, const std::string& name) {
    const auto size = [](int width, int height) { return std::to_string(width) + " × " + std::to_string(height); };
    if (image.width < 1 || image.height < 1 || image.channels.empty() ||
        image.pixels.size() != static_cast<std::size_t>(image.width) * image.height * image.channels.size()) {
        throw InputError(name + ": the picture is " + size(image.width, image.height) + " with " +
                         std::to_string(image.channels.size()) + " channels: expected pixels");
    }
    if (seen.width != 0 && (image.width != seen.width || image.height != seen.height)) {
        throw InputError(name + ": the picture is " + size(image.width, image.height) + " pixels: expected " +
                         size(seen.width, seen.height) + " like the pictures before it");
    }
    if (!seen.channels.empty() && image.channels != seen.channels) {
        throw InputError(name + ": the picture has the channels " + joined(image.channels) + ": expected " +
                         joined(seen.channels) + " like the pictures before it");
    }
}

bool all_channels_alike(const Image& image) {
    const auto count = static_cast<std::size_t>(image.channel_count());
    for (std::size_t i = 0; i < image.pixels.size(); i += count) {
        for (std::size_t c = 1; c < count; ++c) {
            if (image.pixels[i + c] != image.pixels[i]) {
                return false;
            }
        }
    }
    return true;
}

// Why what was refined does not do; empty where it does.
std::string too_few(const ChartPoints& refined, const ChartPoints& detected) {
    const int count = count_found(refined);
    const int seen = count_found(detected);
    return count >= kLeastFoundShare * seen
               ? ""
               : "only " + std::to_string(count) + " of " + std::to_string(seen) +
                     " points seen could be measured: too little contrast, clipped, or not this chart";
}

// What the profile keeps of a picture in which a chart was looked for; adds to `account`.
void observe_chart(Observations& seen, const Image& image, const Picture& picture, const Chart& chart,
                   PictureAccount& account) {
    const std::string& name = picture.name;
    ProfileView view{.image = name, .found = false, .reason = {}, .traits = {}, .pose = {}, .points = {}};
    const std::vector<Vec2d> features = feature_points(chart);
    const Detection detection = detect(image, chart);
    const int reference = reference_channel(image);
    const ChartPoints points = detection.found() ? refine(image, reference, detection.points, chart) : ChartPoints{};
    view.reason = detection.found() ? too_few(points, detection.points) : detection.reason;
    if (!detection.found()) {
        const std::string fault = visible_fault(image, reference);
        view.reason += (fault.empty() ? "" : "; ") + fault;
    }
    const ChartQuality quality = view.reason.empty() ? chart_quality(image, reference, points, chart) : ChartQuality{};
    if (view.reason.empty()) {
        view.reason = too_blurred(quality);
    }
    view.found = view.reason.empty();
    account.used = view.found;
    account.reason = view.found ? picture.remark : view.reason;
    if (view.found && quality.clipped_white_share > 0.5) {
        account.reason += std::string(account.reason.empty() ? "" : "; ") +
                          "over-exposed: the chart's white is clipped, so it says nothing of vignetting";
    }
    if (view.found) {
        view.traits = picture_traits(image, reference, points);
        ChartView own{.name = name, .chart_mm = {}, .image_px = {}};
        for (std::size_t i = 0; i < features.size(); ++i) {
            if (points.found[i]) {
                own.chart_mm.push_back(features[i]);
                own.image_px.push_back(points.image_px[i]);
            }
        }
        seen.chart_views.push_back(std::move(own));
        const bool grey = all_channels_alike(image);
        for (int channel = 0; channel < image.channel_count(); ++channel) {
            const std::string& channel_name = image.channels[channel];
            if (picture.use_light) {
                if (channel == reference) {
                    seen.reference_whites[seen.views.size()] = {channel_name, seen.whites[channel_name].size()};
                }
                seen.whites[channel_name].push_back(chart_white_samples(image, channel, points, chart));
            }
            if (channel == reference || !grey) {
                observe_chart_edges(seen.sharpness, image, channel, picture.name, points, chart);
            }
            if (channel == reference || grey) {
                continue;
            }
            const ChartPoints other = refine(image, channel, points, chart);
            for (std::size_t i = 0; i < features.size(); ++i) {
                if (points.found[i] && other.found[i]) {
                    seen.chromatic_pairs[channel_name].push_back({points.image_px[i], other.image_px[i]});
                }
            }
        }
    }
    seen.views.push_back(std::move(view));
}

// The picture, checked against those before it. Throws InputError for one that is not to be used.
Image load(const Observations& seen, const Picture& picture) {
    if (!picture.left_out.empty()) {
        throw InputError(picture.left_out);
    }
    if (!picture.load) {
        throw InputError("the picture cannot be loaded");
    }
    Image image = picture.load();
    check_alike(seen, image, picture.name);
    return image;
}

std::string hash_of_pixels(const Image& image) {
    return hash_text({reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size() * sizeof(float)});
}

std::string role_name(PictureRole role) {
    return role == PictureRole::chart ? "chart" : role == PictureRole::edges ? "edges" : "flat field";
}

// A message without the picture's name, which stands beside it.
std::string without_name(const std::string& message, const std::string& name) {
    return message.rfind(name + ": ", 0) == 0 ? message.substr(name.size() + 2) : message;
}

void observe_picture(Observations& seen, const Picture& picture, const MeasureInput& input, PictureAccount& account) {
    const Image image = load(seen, picture);
    const auto [same, is_new] = seen.names_by_pixels.emplace(hash_of_pixels(image), picture.name);
    if (!is_new) {
        throw InputError("the same picture as " + same->second);
    }
    seen.width = image.width;
    seen.height = image.height;
    seen.channels = image.channels;
    seen.grey = seen.grey && all_channels_alike(image);
    if (const auto* star = std::get_if<SiemensStar>(&input.chart.pattern);
        star != nullptr && picture.role == PictureRole::chart) {
        const bool grey = all_channels_alike(image);
        for (int channel = 0; channel < image.channel_count(); ++channel) {
            if (!grey || channel == reference_channel(image)) {
                observe_stars(seen.sharpness, image, channel, picture.name, *star);
            }
        }
        account.used = true;
        account.reason = picture.remark;
        return;
    }
    if (picture.role == PictureRole::chart) {
        observe_chart(seen, image, picture, input.chart, account);
        return;
    }
    if (picture.role == PictureRole::edges) {
        const bool grey = all_channels_alike(image);
        for (int channel = 0; channel < image.channel_count(); ++channel) {
            if (!grey || channel == reference_channel(image)) {
                observe_edges(seen.sharpness, image, channel, picture.name, input.edges);
            }
        }
        account.used = true;
        return;
    }
    for (int channel = 0; channel < image.channel_count() && picture.use_light; ++channel) {
        seen.flat_fields[image.channels[channel]].push_back(flat_field_samples(image, channel));
    }
    account.used = picture.use_light;
    account.reason = picture.remark;
}

bool shows_star(const MeasureInput& input) {
    return std::holds_alternative<SiemensStar>(input.chart.pattern);
}

Observations observe(const MeasureInput& input) {
    Observations seen;
    seen.sharpness.focus_position_mm = input.focus_position_mm;
    for (const Picture& picture : input.pictures) {
        const bool is_chart = picture.role == PictureRole::chart && !shows_star(input);
        PictureAccount account{.image = picture.name,
                               .role = role_name(picture.role),
                               .used = false,
                               .reason = {},
                               .orientation = picture.orientation};
        try {
            observe_picture(seen, picture, input, account);
        } catch (const InputError& e) {
            account.reason = without_name(e.what(), picture.name);
            if (is_chart) {
                seen.views.push_back({.image = picture.name,
                                      .found = false,
                                      .reason = account.reason,
                                      .traits = {},
                                      .pose = {},
                                      .points = {}});
            }
        }
        seen.pictures.push_back(std::move(account));
    }
    return seen;
}

// That no picture does, and why each does not.
InputError none_usable(const MeasureInput& input, const Observations& seen) {
    constexpr std::size_t kMostNamed = 8;
    const std::size_t count = seen.pictures.size();
    const std::string what = !seen.views.empty()   ? "no " + describe(input.chart) + " found in any"
                             : shows_star(input)   ? "no Siemens star measured in any"
                             : input.edges.empty() ? "no flat field"
                                                   : "no edge";
    std::string text =
        input.name + ": " + what + " of " + std::to_string(count) + (count == 1 ? " picture" : " pictures");
    for (std::size_t i = 0; i < std::min(count, kMostNamed); ++i) {
        text += (i == 0 ? ": " : "; ") + seen.pictures[i].image + ": " + seen.pictures[i].reason;
    }
    return InputError(text + (count > kMostNamed ? "; …" : ""));
}

struct Geometry {
    GeometryFit fit;
    std::optional<ModelChoice> choice;
};

Geometry fit(const MeasureInput& input, const Observations& seen) {
    GeometryOptions options = input.geometry;
    options.disc_diameter_mm = disc_diameter_mm(input.chart);
    if (input.model) {
        options.model = *input.model;
        return {fit_geometry(seen.chart_views, seen.width, seen.height, options), std::nullopt};
    }
    ChosenGeometry chosen = choose_model(seen.chart_views, seen.width, seen.height, options);
    return {std::move(chosen.fit), std::move(chosen.choice)};
}

void add_geometry(Profile& profile, const Observations& seen, const GeometryFit& geometry) {
    const double half_diagonal = half_diagonal_px(profile);
    profile.geometry =
        ProfileGeometry{.model = geometry.model,
                        .covariance = geometry.covariance,
                        .view_standard_error = geometry.view_standard_error,
                        .reprojection_rms_px = geometry.rms_px,
                        .views_used = static_cast<int>(geometry.views.size()),
                        .points_used = geometry.points_used,
                        .covered_image_height = geometry.covered_radius_px / half_diagonal,
                        .board = geometry.board,
                        .uncertainty = uncertainty_map(geometry, seen.chart_views, seen.width, seen.height),
                        .choice = std::nullopt};
    std::size_t next = 0;
    for (ProfileView& view : profile.views) {
        if (!view.found) {
            continue;
        }
        const ChartView& measured = seen.chart_views[next];
        const FittedView& fitted = geometry.views[next];
        ++next;
        view.pose = fitted.pose;
        for (const PointResidual& r : fitted.residuals) {
            const auto i = static_cast<std::size_t>(r.index);
            view.points.push_back({measured.chart_mm[i], measured.image_px[i], r.measured_minus_model_px, r.used});
        }
    }
    profile.curves["field_angle_deg"] = field_angle_curve(geometry, half_diagonal);
    profile.curves["distortion_percent"] = rectilinear_distortion_curve(geometry, half_diagonal);
    profile.curves["distortion_equidistant_percent"] = equidistant_distortion_curve(geometry, half_diagonal);
}

void add_vignetting(Profile& profile, const Observations& seen, const Vec2d& centre) {
    const auto& groups = seen.flat_fields.empty() ? seen.whites : seen.flat_fields;
    for (const auto& [channel, samples] : groups) {
        try {
            Vignetting vignetting = fit_vignetting(samples, centre, half_diagonal_px(profile));
            profile.vignetting_models[channel] = fit_vignetting_models(vignetting);
            profile.shading[channel] = shading_grid(vignetting, seen.width, seen.height);
            FittedTerms& terms = profile.terms["vignetting_" + channel];
            for (std::size_t i = 0; i < vignetting.coefficients.size(); ++i) {
                terms.names.push_back("spline_" + std::to_string(i));
            }
            terms.values = std::move(vignetting.coefficients);
            terms.covariance = std::move(vignetting.covariance);
            profile.curves["vignetting_" + channel] = std::move(vignetting.ratio);
            profile.curves["vignetting_" + channel + "_ev"] = std::move(vignetting.ev);
        } catch (const InputError& e) {
            profile.not_measured["vignetting"] = e.what();
        }
    }
}

// What the charts' white shows of the lamps, now that the vignetting is known.
void add_light_gradients(Profile& profile, const Observations& seen, const Vec2d& centre) {
    for (std::size_t v = 0; v < profile.views.size(); ++v) {
        const auto white = seen.reference_whites.find(v);
        if (white == seen.reference_whites.end()) {
            continue;
        }
        const auto curve = profile.curves.find("vignetting_" + white->second.first);
        if (curve != profile.curves.end()) {
            const auto& [channel, index] = white->second;
            profile.views[v].traits->light_gradient_per_mm =
                light_gradient_per_mm(seen.whites.at(channel)[index], curve->second, centre, half_diagonal_px(profile));
        }
    }
}

void add_chromatic_shifts(Profile& profile, const Observations& seen, const Vec2d& centre) {
    if (seen.grey) {
        profile.not_measured["chromatic_shift"] = "the pictures are grey";
        return;
    }
    if (seen.chromatic_pairs.empty()) {
        profile.not_measured["chromatic_shift"] = "no chart was found in a picture in colour";
        return;
    }
    for (const auto& [channel, pairs] : seen.chromatic_pairs) {
        try {
            add_chromatic_shift(profile, channel_label(channel), pairs, centre);
        } catch (const InputError& e) {
            profile.not_measured["chromatic_shift"] = e.what();
        }
    }
}

void add_self_test(Profile& profile, const MeasureInput& input) {
    if (!profile.geometry) {
        profile.not_measured["self_test"] = "without a geometry there is nothing to simulate";
        return;
    }
    try {
        profile.self_test = self_test(input, profile);
    } catch (const InputError& e) {
        profile.not_measured["self_test"] = e.what();
    }
}

}  // namespace

Profile measure(const MeasureInput& input) {
    if (input.pictures.empty()) {
        throw InputError("measuring " + input.name + ": no pictures given: expected at least one");
    }
    const Observations seen = observe(input);
    const bool has_light_or_edges =
        !seen.flat_fields.empty() || !seen.sharpness.edges.empty() || !seen.sharpness.stars.empty();
    if (seen.chart_views.empty() && (!seen.views.empty() || !has_light_or_edges)) {
        throw none_usable(input, seen);
    }
    Profile profile;
    profile.name = input.name;
    profile.source = input.source;
    profile.source.images.clear();
    for (const Picture& picture : input.pictures) {
        profile.source.images.push_back(picture.name);
    }
    profile.width_px = seen.width;
    profile.height_px = seen.height;
    profile.channels = seen.channels;
    profile.pixel_pitch_um = input.pixel_pitch_um;
    profile.views = seen.views;
    profile.pictures = seen.pictures;

    Vec2d centre{(seen.width - 1) / 2.0, (seen.height - 1) / 2.0};
    if (seen.chart_views.empty()) {
        profile.not_measured["geometry"] = shows_star(input)     ? "a Siemens star has but one point"
                                           : input.edges.empty() ? "there are flat fields only"
                                                                 : "there is no chart";
    } else {
        Geometry geometry = fit(input, seen);
        centre = centre_px(geometry.fit.model);
        add_geometry(profile, seen, geometry.fit);
        profile.geometry->choice = std::move(geometry.choice);
    }
    add_sharpness(profile, seen.sharpness, centre);
    add_vignetting(profile, seen, centre);
    add_light_gradients(profile, seen, centre);
    add_chromatic_shifts(profile, seen, centre);
    if (input.self_test) {
        add_self_test(profile, input);
    }
    return profile;
}

}  // namespace lensproof
