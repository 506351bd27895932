#include "calibration/comparison/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibration/comparison/colour_planes.h"
#include "calibration/comparison/stripes.h"
#include "engine/base/order_statistics.h"
#include "engine/spectral/colour_matching.h"

namespace lensproof::calibration {

namespace {

// 2020, sections 4.1 to 4.3.
constexpr double kColourExponent = 0.7;                    // q_c
constexpr double kKnee = 0.4;                              // p_c, of the largest colour difference
constexpr double kAtKnee = 0.95;                           // p_t
constexpr double kFeatureExponent = 0.5;                   // q_f
constexpr double kEdgeWidth_deg = 0.082;                   // w, from peak to trough of an edge detector
constexpr std::array<double, 2> kBlackWhite{1.0, 0.0047};  // a and b of the contrast sensitivities
constexpr std::array<double, 2> kRedGreen{1.0, 0.0053};    //
constexpr std::array<double, 4> kBlueYellow{34.1, 0.04, 13.5, 0.025};
constexpr double kWidestB = 0.04;
// 2021: Narkowicz's curve, its input scaled by 0.6.
constexpr std::array<double, 6> kAces{0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};
constexpr double kAlmostWhite = 0.85;

using Planes = std::array<cv::Mat, 3>;  // of floats

cv::Mat gaussian(int radius, double exponent_per_square) {
    cv::Mat kernel(2 * radius + 1, 1, CV_64F);
    for (int i = -radius; i <= radius; ++i) {
        kernel.at<double>(i + radius) = std::exp(-exponent_per_square * i * i);
    }
    return kernel / cv::sum(kernel)[0];
}

/// Of positive weights the sum becomes 1, of negative ones -1.
cv::Mat balanced(cv::Mat kernel) {
    double positive = 0.0;
    double negative = 0.0;
    for (int i = 0; i < kernel.rows; ++i) {
        const double weight = kernel.at<double>(i);
        (weight > 0.0 ? positive : negative) += std::abs(weight);
    }
    for (int i = 0; i < kernel.rows; ++i) {
        double& weight = kernel.at<double>(i);
        weight /= weight > 0.0 ? positive : std::max(negative, 1e-300);
    }
    return kernel;
}

/// Everything that follows from how far away the display is.
struct Viewing {
    cv::Mat black_white;
    cv::Mat red_green;
    std::array<cv::Mat, 2> blue_yellow;
    std::array<double, 2> blue_yellow_weight{};
    cv::Mat smooth;  // of the detectors of edges and points, across them
    cv::Mat edge;
    cv::Mat point;
    int reach_px = 0;
};

Viewing viewing(double pixels_per_degree) {
    constexpr double pi = std::numbers::pi;
    const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(kWidestB / (2.0 * pi * pi)) * pixels_per_degree));
    // Eq. 4: exp(-π² x² / b), x in degrees.
    const auto sensitivity = [&](double b) {
        return gaussian(radius, pi * pi / (b * pixels_per_degree * pixels_per_degree));
    };
    Viewing result{.black_white = sensitivity(kBlackWhite[1]), .red_green = sensitivity(kRedGreen[1])};
    for (std::size_t i = 0; i < 2; ++i) {
        const double a = kBlueYellow[2 * i];
        const double b = kBlueYellow[2 * i + 1];
        result.blue_yellow[i] = sensitivity(b);
        // The unnormalised Gaussian's sum over the plane is one over the normalised one's middle, squared.
        const double middle = result.blue_yellow[i].at<double>(radius);
        result.blue_yellow_weight[i] = a * std::sqrt(pi / b) / (middle * middle);
    }
    const double whole = result.blue_yellow_weight[0] + result.blue_yellow_weight[1];
    result.blue_yellow_weight[0] /= whole;
    result.blue_yellow_weight[1] /= whole;

    const double sigma = 0.5 * kEdgeWidth_deg * pixels_per_degree;
    const int feature_radius = static_cast<int>(std::ceil(3.0 * sigma));
    result.smooth = gaussian(feature_radius, 0.5 / (sigma * sigma));
    result.edge = result.smooth.clone();
    result.point = result.smooth.clone();
    for (int i = -feature_radius; i <= feature_radius; ++i) {
        result.edge.at<double>(i + feature_radius) *= -i;
        result.point.at<double>(i + feature_radius) *= i * i / (sigma * sigma) - 1.0;
    }
    result.edge = balanced(result.edge);
    result.point = balanced(result.point);
    result.reach_px = std::max(radius, feature_radius);
    return result;
}

cv::Mat filtered(const cv::Mat& plane, const cv::Mat& along_x, const cv::Mat& along_y) {
    cv::Mat result;
    cv::sepFilter2D(plane, result, CV_32F, along_x, along_y, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
    return result;
}

/// L*a*b*'s axes without its cube root (Flynn et al. 2008), in which light adds up.
Vec3d opponent(const Vec3d& linear_rgb) {
    const Vec3d xyz = xyz_of(linear_rgb);
    const double x = xyz.x / kWhite.x;
    const double z = xyz.z / kWhite.z;
    return {116.0 * xyz.y - 16.0, 500.0 * (x - xyz.y), 200.0 * (xyz.y - z)};
}

Vec3d rgb_of_opponent(const Vec3d& colour) {
    const double y = (colour.x + 16.0) / 116.0;
    return rgb_of({kWhite.x * (y + colour.y / 500.0), y, kWhite.z * (y - colour.z / 200.0)});
}

Vec3d clipped(const Vec3d& rgb) {
    return {std::clamp(rgb.x, 0.0, 1.0), std::clamp(rgb.y, 0.0, 1.0), std::clamp(rgb.z, 0.0, 1.0)};
}

/// CIELAB with chroma that fades with lightness (Hunt 1952; eq. 6).
Vec3d hunt_lab(const Vec3d& linear_rgb) {
    const Vec3d lab = spectral::cielab(xyz_of(linear_rgb), kWhite);
    return {lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z};
}

/// Abasi, Amani Tehran and Fairchild 2019.
double hyab(const Vec3d& a, const Vec3d& b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// Eq. 7 to 9: a colour difference as 0 to 1.
double redistributed(double difference) {
    static const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kColourExponent);
    const double raised = std::pow(difference, kColourExponent);
    const double knee = kKnee * largest;
    return raised < knee ? kAtKnee / knee * raised : kAtKnee + (raised - knee) / (largest - knee) * (1.0 - kAtKnee);
}

Planes make_planes(int rows, int columns) {
    return {cv::Mat(rows, columns, CV_32F), cv::Mat(rows, columns, CV_32F), cv::Mat(rows, columns, CV_32F)};
}

void set(Planes& planes, int y, int x, const Vec3d& value) {
    planes[0].at<float>(y, x) = static_cast<float>(value.x);
    planes[1].at<float>(y, x) = static_cast<float>(value.y);
    planes[2].at<float>(y, x) = static_cast<float>(value.z);
}

Vec3d get(const Planes& planes, int y, int x) {
    return {static_cast<double>(planes[0].at<float>(y, x)), static_cast<double>(planes[1].at<float>(y, x)),
            static_cast<double>(planes[2].at<float>(y, x))};
}

/// What an eye gets of a picture's rows: colours as it resolves them, and the strengths of edges and points.
struct Seen {
    Planes colour;
    cv::Mat edges;
    cv::Mat points;
};

cv::Mat strength_of(const cv::Mat& luminance, const cv::Mat& detector, const cv::Mat& across) {
    cv::Mat result;
    cv::magnitude(filtered(luminance, detector, across), filtered(luminance, across, detector), result);
    return result;
}

/// `tone`: what a display shows of the picture's light, 0 to 1.
template <class Tone>
Seen seen(const formats::Image& image, const Stripe& stripe, const Viewing& view, const Tone& tone) {
    Planes planes = make_planes(stripe.padded_last - stripe.padded_first, image.width);
    for (int y = 0; y < planes[0].rows; ++y) {
        const std::size_t row =
            static_cast<std::size_t>(y + stripe.padded_first) * static_cast<std::size_t>(image.width);
        for (int x = 0; x < image.width; ++x) {
            set(planes, y, x, opponent(tone(rgb_at(image, row + static_cast<std::size_t>(x)))));
        }
    }
    const cv::Mat relative = (planes[0] + 16.0) / 116.0;
    Seen result{.edges = strength_of(relative, view.edge, view.smooth),
                .points = strength_of(relative, view.point, view.smooth)};
    result.colour[0] = filtered(planes[0], view.black_white, view.black_white);
    result.colour[1] = filtered(planes[1], view.red_green, view.red_green);
    result.colour[2] = view.blue_yellow_weight[0] * filtered(planes[2], view.blue_yellow[0], view.blue_yellow[0]) +
                       view.blue_yellow_weight[1] * filtered(planes[2], view.blue_yellow[1], view.blue_yellow[1]);
    return result;
}

/// Raises the map's values to those of this pair of pictures' rows.
template <class Tone>
void raise_to_flip(const formats::Image& a, const formats::Image& b, const Stripe& stripe, const Viewing& view,
                   const Tone& tone, formats::Image& map) {
    const Seen one = seen(a, stripe, view, tone);
    const Seen other = seen(b, stripe, view, tone);
    for (int y = stripe.first; y < stripe.last; ++y) {
        const int row = y - stripe.padded_first;
        for (int x = 0; x < a.width; ++x) {
            const double colour = redistributed(hyab(hunt_lab(clipped(rgb_of_opponent(get(one.colour, row, x)))),
                                                     hunt_lab(clipped(rgb_of_opponent(get(other.colour, row, x))))));
            const float features = std::max(std::abs(one.edges.at<float>(row, x) - other.edges.at<float>(row, x)),
                                            std::abs(one.points.at<float>(row, x) - other.points.at<float>(row, x)));
            const double feature = std::pow(static_cast<double>(features) / std::numbers::sqrt2, kFeatureExponent);
            float& value = map.at(x, y, 0);
            value = std::max(value, static_cast<float>(std::pow(colour, 1.0 - feature)));
        }
    }
}

/// The light that the tone curve makes `shown` of.
double light_shown_as(double shown) {
    const double a = kAces[0] - shown * kAces[3];
    const double b = kAces[1] - shown * kAces[4];
    const double c = kAces[2] - shown * kAces[5];
    return (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

double aces(double light) {
    return ((kAces[0] * light + kAces[1]) * light + kAces[2]) / ((kAces[3] * light + kAces[4]) * light + kAces[5]);
}

}  // namespace

formats::Image flip_low_range(const formats::Image& a, const formats::Image& b, double pixels_per_degree, int threads) {
    const Viewing view = viewing(pixels_per_degree);
    formats::Image map = formats::make_image(a.width, a.height, {"flip"});
    for_stripes(a.height, view.reach_px, threads,
                [&](const Stripe& stripe) { raise_to_flip(a, b, stripe, view, clipped, map); });
    return map;
}

FlipExposures flip_exposures(const formats::Image& reference) {
    std::vector<float> luminances = luminance_of(reference).pixels;
    const auto brightest = static_cast<double>(*std::ranges::max_element(luminances));
    const auto middle = static_cast<double>(median(luminances));
    const double light = light_shown_as(kAlmostWhite);
    const auto brought = [&](double luminance) { return std::log2(light / std::max(luminance, 1e-6)); };
    FlipExposures result{.first_ev = brought(brightest), .last_ev = brought(middle)};
    result.count = std::max(2, static_cast<int>(std::ceil(result.last_ev - result.first_ev)));
    return result;
}

formats::Image flip_high_range(const formats::Image& a, const formats::Image& b, double pixels_per_degree,
                               const FlipExposures& exposures, int threads) {
    const Viewing view = viewing(pixels_per_degree);
    formats::Image map = formats::make_image(a.width, a.height, {"flip"});
    const double step_ev = (exposures.last_ev - exposures.first_ev) / (exposures.count - 1);
    for_stripes(a.height, view.reach_px, threads, [&](const Stripe& stripe) {
        for (int i = 0; i < exposures.count; ++i) {
            const double gain = std::exp2(exposures.first_ev + i * step_ev);
            const auto tone = [gain](const Vec3d& rgb) {
                const auto shown = [gain](double light) { return aces(gain * std::max(light, 0.0)); };
                return clipped({shown(rgb.x), shown(rgb.y), shown(rgb.z)});
            };
            raise_to_flip(a, b, stripe, view, tone, map);
        }
    });
    return map;
}

}  // namespace lensproof::calibration
