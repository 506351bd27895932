#include "calibration/self_test/self_test.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/detection/working_copy.h"
#include "calibration/picture/flat_field_traits.h"
#include "calibration/profile/curve_difference.h"
#include "calibration/self_test/simulated_chart.h"

namespace lensproof::calibration {
namespace {

constexpr double kPixelBox_px2 = 1.0 / 12.0;  // variance of a pixel's own box, which the simulation adds by itself
constexpr double kUsualBlur_px = 0.5;
constexpr std::size_t kFewestSimulatedViews = 3;  // that are simulated, of as many,
constexpr std::size_t kUsualViews = 6;            // if their pixels are no more than these
constexpr double kMostPixels = 36e6;

// The curve between its samples, and straight on beyond them: held at its end it would have a kink that the measured
// lens has not, which smooth fits round off.
std::function<double(double)> function_of(const Profile& profile, const std::string& name, double otherwise) {
    const Curve* found = find_curve(profile, name);
    if (found == nullptr || found->value.size() < 2) {
        return [otherwise](double) { return otherwise; };
    }
    return [curve = *found](double height) {
        const std::vector<double>& at = curve.image_height;
        const double inside = std::clamp(height, at.front(), at.back());
        const std::size_t last = at.size() - 1;
        const double slope =
            height > inside ? (curve.value[last] - curve.value[last - 1]) / (at[last] - at[last - 1]) : 0.0;
        return sample(curve, inside)->value + slope * (height - inside);
    };
}

// That of the picture by this name.
std::optional<int> quality_of(const MeasureInput& input, const std::string& name) {
    const auto picture = std::ranges::find(input.pictures, name, &Picture::name);
    return picture == input.pictures.end() ? std::nullopt : picture->jpeg_quality;
}

// What of a simulated picture its own photo says.
struct PhotoTraits {
    std::optional<int> jpeg_quality;
    bool is_grey = false;
};

SimulatedCamera camera_of(const Profile& profile, const PictureTraits& traits, const PhotoTraits& photo, int threads) {
    SimulatedCamera camera{.model = profile.geometry->model,
                           .width_px = profile.width_px,
                           .height_px = profile.height_px,
                           .channels = {},
                           .white = traits.white,
                           .blur_px = kUsualBlur_px,
                           .read_noise = traits.noise,
                           .shot_noise = 0.0,
                           .is_grey = photo.is_grey,
                           .jpeg_quality = {},
                           .threads = threads,
                           .board = profile.geometry->board,
                           .light_gradient_per_mm = traits.light_gradient_per_mm.value_or(Vec2d{})};
    if (profile.channels.size() == 1 || profile.channels.size() == 3) {  // what a JPEG holds
        camera.jpeg_quality = photo.jpeg_quality;
    }
    for (const std::string& name : profile.channels) {
        camera.channels.push_back({.name = name,
                                   .radial_shift_px = function_of(profile, kQuantities.chromatic_shift.key(name), 0.0),
                                   .vignetting = function_of(profile, kQuantities.vignetting.key(name), 1.0)});
    }
    if (traits.blur_px) {
        camera.blur_px = std::sqrt(std::max(*traits.blur_px * *traits.blur_px - kPixelBox_px2, 0.0));
    }
    return camera;
}

// A flat field has its own exposure and noise, those of its own picture.
SimulatedCamera flat_field_camera(const Profile& profile, const PictureTraits& charts, const Picture& picture,
                                  bool is_grey, int threads) {
    SimulatedCamera camera = camera_of(profile, charts, {picture.jpeg_quality, is_grey}, threads);
    const formats::Image image = picture.load();
    const FlatFieldTraits own = flat_field_traits(image, reference_channel(image));
    if (own.white > 0.0) {
        camera.white = own.white;
        camera.read_noise = own.noise;
    }
    return camera;
}

// The chart as it looks in the picture: white as white, black as dark as it was seen.
scene::Chart chart_of(const scene::Chart& chart, const PictureTraits& traits) {
    scene::Chart own = chart;
    own.white_reflectance = 1.0;
    own.black_reflectance = std::clamp(traits.black / traits.white, 0.0, 1.0);
    return own;
}

bool is_used(const Profile& profile, const Picture& picture) {
    const auto account = std::ranges::find(profile.pictures, picture.name, &PictureAccount::image);
    return account != profile.pictures.end() && account->used;
}

// Of many views every second one, of large ones fewer, evenly: to simulate and measure a picture takes some two to six
// times as long as to measure it.
std::vector<const ProfileView*> sampled_views(const Profile& profile) {
    std::vector<const ProfileView*> all;
    for (const ProfileView& view : profile.views) {
        if (view.found && view.traits && view.pose) {
            all.push_back(&view);
        }
    }
    const auto affordable = static_cast<std::size_t>(kMostPixels / profile.width_px / profile.height_px);
    const std::size_t wanted = std::max(kUsualViews, (all.size() + 1) / 2);
    const std::size_t count = std::min(all.size(), std::max(kFewestSimulatedViews, std::min(wanted, affordable)));
    std::vector<const ProfileView*> sampled;
    for (std::size_t i = 0; i < count; ++i) {
        sampled.push_back(all[i * all.size() / count]);
    }
    return sampled;
}

// Whether the pictures' channels are copies of each other, as in the first that was used.
bool are_grey(const MeasureInput& input, const Profile& profile) {
    const auto used =
        std::ranges::find_if(input.pictures, [&](const Picture& picture) { return is_used(profile, picture); });
    return used != input.pictures.end() && all_channels_alike(used->load());
}

std::vector<Picture> simulated_pictures(const MeasureInput& input, const Profile& profile) {
    std::vector<Picture> pictures;
    const bool is_grey = profile.not_measured.contains(part::kChromaticShift) && are_grey(input, profile);
    std::uint32_t seed = 0;
    PictureTraits last;
    for (const ProfileView* view : sampled_views(profile)) {
        last = *view->traits;
        pictures.push_back(
            {view->image, PictureRole::chart,
             [camera = camera_of(profile, last, {quality_of(input, view->image), is_grey}, input.threads),
              pose = *view->pose, chart = chart_of(input.chart, last),
              seed] { return simulate_chart(camera, pose, chart, seed); }});
        ++seed;
    }
    for (const Picture& picture : input.pictures) {
        if (picture.role == PictureRole::flat_field && !pictures.empty() && is_used(profile, picture)) {
            pictures.push_back({picture.name, PictureRole::flat_field,
                                [camera = flat_field_camera(profile, last, picture, is_grey, input.threads), seed] {
                                    return simulate_flat_field(camera, seed);
                                }});
            ++seed;
        }
    }
    return pictures;
}

void add_points(SelfTest& result, const MeasureInput& input, const Profile& truth, const Profile& again) {
    std::map<std::string, Pose> poses;
    for (const ProfileView& view : truth.views) {
        poses[view.image] = view.pose.value_or(Pose{});
    }
    double squares = 0.0;
    Vec2d sum;
    for (const ProfileView& view : again.views) {
        for (const ProfilePoint& point : view.points) {
            const auto expected = predict(truth.geometry->model, poses.at(view.image), point.chart_mm,
                                          disc_diameter_mm(input.chart), truth.geometry->board);
            if (!expected) {
                continue;
            }
            const Vec2d error{point.image_px.x - expected->x, point.image_px.y - expected->y};
            sum = {sum.x + error.x, sum.y + error.y};
            squares += error.x * error.x + error.y * error.y;
            ++result.points;
        }
    }
    if (result.points > 0) {
        result.point_rms_px = std::sqrt(squares / (2.0 * result.points));
        result.point_bias_px = std::hypot(sum.x, sum.y) / result.points;
    }
}

}  // namespace

SelfTest self_test(const MeasureInput& input, const Profile& profile) {
    MeasureInput simulated = input;
    simulated.model = kind(profile.geometry->model);
    if (const auto& choice = profile.geometry->choice) {
        simulated.geometry.radial_terms = choice->candidates[static_cast<std::size_t>(choice->chosen)].radial_terms;
    }
    simulated.pictures = simulated_pictures(input, profile);
    simulated.parts.sharpness = false;
    const Profile again = measure(simulated);
    SelfTest result;
    result.pictures = static_cast<int>(simulated.pictures.size());
    add_points(result, input, profile, again);
    result.reprojection_rms_px = again.geometry->reprojection_rms_px;
    result.focal_length_px =
        std::abs(focal_length_px(again.geometry->model) - focal_length_px(profile.geometry->model));
    const auto add = [&](const std::string& curve) {
        if (const auto apart = difference(again, profile, curve)) {
            result.curves[curve] = {.rms = apart->rms, .largest = apart->largest, .largest_at = apart->largest_at};
        }
    };
    add(kQuantities.image_position.key());
    for (const auto& [name, curve] : profile.curves) {
        if (const auto known = quantity_of(name); !known || !known->quantity.of_blur) {
            add(name);
        }
    }
    return result;
}

void add_self_test(Profile& profile, const MeasureInput& input) {
    if (!profile.geometry) {
        profile.not_measured[part::kSelfTest] = "without a geometry there is nothing to simulate";
        return;
    }
    if (std::ranges::none_of(profile.views, [](const ProfileView& view) { return view.traits.has_value(); })) {
        profile.not_measured[part::kSelfTest] = "no picture shows a chart that could be simulated";
        return;
    }
    try {
        profile.self_test = self_test(input, profile);
    } catch (const InputError& e) {
        profile.not_measured[part::kSelfTest] = e.what();
    }
}

}  // namespace lensproof::calibration
