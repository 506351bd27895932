#include "calibration/export/lensfun.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calibration/export/covered_frame.h"
#include "calibration/light/vignetting.h"
#include "calibration/statistics/linear_fit.h"
#include "engine/base/bisect.h"
#include "engine/base/input_error.h"
#include "engine/base/markup.h"

namespace lensproof::calibration {
namespace {

constexpr int kRadii = 200;
constexpr int kFrameColumns = 49;
constexpr double kLinearEnough_px = 0.01;
constexpr double kFisheyeFrom_rad = 0.9;  // 52°: no rectilinear lens that is sold reaches much farther

/// r = Σ coefficient[i] t^power[i], t = r/f of the ideal projection.
struct SparsePolynomial {
    std::vector<int> powers;
    std::vector<double> coefficients;

    [[nodiscard]] double operator()(double t) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < powers.size(); ++i) {
            sum += coefficients[i] * std::pow(t, powers[i]);
        }
        return sum;
    }
    [[nodiscard]] double coefficient(int power) const {
        const auto found = std::ranges::find(powers, power);
        return found == powers.end() ? 0.0 : coefficients[static_cast<std::size_t>(found - powers.begin())];
    }
};

struct Sample {
    double t = 0.0;
    double value = 0.0;
    double sigma = 1.0;
};

std::optional<SparsePolynomial> fit_powers(const std::vector<Sample>& samples, std::vector<int> powers) {
    const auto rows = static_cast<Eigen::Index>(samples.size());
    LinearProblem problem{.a = Eigen::MatrixXd(rows, static_cast<Eigen::Index>(powers.size())),
                          .y = Eigen::VectorXd(rows),
                          .row_sigma = Eigen::VectorXd(rows),
                          .group = {}};
    for (Eigen::Index i = 0; i < rows; ++i) {
        const Sample& sample = samples[static_cast<std::size_t>(i)];
        for (std::size_t p = 0; p < powers.size(); ++p) {
            problem.a(i, static_cast<Eigen::Index>(p)) = std::pow(sample.t, powers[p]);
        }
        problem.y(i) = sample.value;
        problem.row_sigma(i) = sample.sigma;
    }
    const auto fit = fit_linear(problem, 0.0);
    if (!fit) {
        return std::nullopt;
    }
    return SparsePolynomial{std::move(powers),
                            {fit->parameters.data(), fit->parameters.data() + fit->parameters.size()}};
}

/// The smallest t with P(t) = radius; none where P turns back before.
std::optional<double> solve(const SparsePolynomial& polynomial, double radius, double step) {
    double low = 0.0;
    double previous = 0.0;
    for (int i = 0; i < 10 * kRadii; ++i) {
        const double value = polynomial(low + step);
        if (!(value > previous)) {
            return std::nullopt;
        }
        if (value >= radius) {
            const auto [inside, outside] =
                bisected({low, low + step}, 60, [&](double t) { return polynomial(t) < radius; });
            return 0.5 * (inside + outside);
        }
        low += step;
        previous = value;
    }
    return std::nullopt;
}

/// lensfun's terms, in its units.
struct Distortion {
    std::string model;
    double focal_px = 0.0;
    std::vector<std::pair<std::string, double>> terms;
    SparsePolynomial polynomial;
    double largest_difference_px = 0.0;
};

/// From r = Σ A_n t^n to lensfun's r_d/s = Σ a_n (r_u/s)^n with r_u = f t, so a_n = A_n s^(n−1) / f^n. poly5 has
/// a_1 = 1, hence f = A_1; poly3 and ptlens keep the radius s where it is (Σ a_n = 1), hence f = s / t_s, P(t_s) = s.
std::optional<Distortion> lensfun_terms(const std::string& model, SparsePolynomial polynomial, double unit_px,
                                        double step) {
    Distortion result{.model = model, .focal_px = polynomial.coefficient(1), .terms = {}, .polynomial = {}};
    if (model != "poly5") {
        const auto fixed = solve(polynomial, unit_px, step);
        if (!fixed) {
            return std::nullopt;
        }
        result.focal_px = unit_px / *fixed;
    }
    const auto term = [&](int power) {
        return polynomial.coefficient(power) * std::pow(unit_px, power - 1) / std::pow(result.focal_px, power);
    };
    if (model == "ptlens") {
        result.terms = {{"a", term(4)}, {"b", term(3)}, {"c", term(2)}};
    } else if (model == "poly3") {
        result.terms = {{"k1", term(3)}};
    } else {
        result.terms = {{"k1", term(3)}, {"k2", term(5)}};
    }
    result.polynomial = std::move(polynomial);
    return result;
}

/// Where lensfun's correction says that a direction is imaged.
std::optional<Vec2d> image_of(const Distortion& distortion, optics::Projection type, const Vec2d& centre,
                              const Vec3d& direction) {
    const double lateral = std::hypot(direction.x, direction.y);
    const auto t = ideal_radius(type, std::atan2(lateral, direction.z));
    if (!t) {
        return std::nullopt;
    }
    const double scale = lateral > 0.0 ? distortion.polynomial(*t) / lateral : 0.0;
    return Vec2d{centre.x + scale * direction.x, centre.y + scale * direction.y};
}

std::optional<Distortion> fit_distortion(const Profile& profile, optics::Projection type, double unit_px) {
    std::vector<Sample> samples;
    for (const RadialPoint& point : radial_points(profile, kRadii)) {
        const auto t = ideal_radius(type, point.angle_rad);
        if (t) {
            samples.push_back({*t, point.radius_px, point.covered ? 1.0 : kUncoveredSigma});
        } else if (point.covered) {
            return std::nullopt;
        }
    }
    const std::vector<FramePoint> frame = frame_points(profile, kFrameColumns);
    const Vec2d centre = centre_px(exported_geometry(profile).model);
    std::optional<Distortion> best;
    const std::array<std::pair<const char*, std::vector<int>>, 3> models = {
        {{"poly3", {1, 3}}, {"poly5", {1, 3, 5}}, {"ptlens", {1, 2, 3, 4}}}};
    for (const auto& [model, powers] : models) {
        auto polynomial = fit_powers(samples, powers);
        auto candidate = polynomial && !samples.empty()
                             ? lensfun_terms(model, *std::move(polynomial), unit_px, samples.back().t / kRadii)
                             : std::nullopt;
        if (!candidate || !(candidate->focal_px > 0.0)) {
            continue;
        }
        const auto difference = largest_difference_px(
            frame, [&](const Vec3d& direction) { return image_of(*candidate, type, centre, direction); });
        if (difference && (!best || *difference < best->largest_difference_px)) {
            candidate->largest_difference_px = *difference;
            best = std::move(candidate);
        }
    }
    return best;
}

/// Rectilinear for a lens that does not reach far, however barrel-shaped its distortion: its corrected pictures are to
/// keep lines straight. Else the type whose ideal projection, of the lens's own focal length, departs least from r(θ).
optics::Projection nearest_type(const Profile& profile) {
    const double focal = focal_length_px(exported_geometry(profile).model);
    const std::vector<RadialPoint> radii = radial_points(profile, kRadii);
    if (std::ranges::none_of(radii, [](const RadialPoint& p) { return p.covered && p.angle_rad > kFisheyeFrom_rad; })) {
        return optics::Projection::rectilinear;
    }
    double least = INFINITY;
    optics::Projection nearest = optics::Projection::equidistant;
    for (const optics::Projection type : optics::kProjections) {
        double largest = 0.0;
        for (const RadialPoint& point : radii) {
            const auto ideal = ideal_radius(type, point.angle_rad);
            if (point.covered) {
                largest = std::max(largest, ideal ? std::abs(focal * *ideal - point.radius_px) : INFINITY);
            }
        }
        if (largest < least) {
            least = largest;
            nearest = type;
        }
    }
    return nearest;
}

/// A comment in XML must not hold two hyphens in a row.
std::string comment(std::string text) {
    std::ranges::replace(text, '-', '_');
    std::ranges::replace_if(
        text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    return fmt::format("<!-- {} -->", text);
}

/// One channel's TCA: r_channel / r_green = v + c ρ + b ρ², ρ = r_green / unit.
struct ChannelShift {
    double v = 1.0;
    double c = 0.0;
    double b = 0.0;
    double largest_difference_px = 0.0;
};

std::optional<ChannelShift> fit_shift(const Profile& profile, const std::string& channel, bool linear, double unit_px) {
    const Curve* found = find_curve(profile, kQuantities.chromatic_shift.key(channel));
    if (found == nullptr) {
        return std::nullopt;
    }
    std::vector<Sample> samples;
    for (std::size_t i = 0; i < found->image_height.size(); ++i) {
        const double height = found->image_height[i];
        if (height > 0.0 && height <= found->covered_image_height) {
            samples.push_back({height * half_diagonal_px(profile) / unit_px, found->value[i], 1.0});
        }
    }
    const auto polynomial = fit_powers(samples, linear ? std::vector{1} : std::vector{1, 2, 3});
    if (!polynomial) {
        return std::nullopt;
    }
    ChannelShift shift{.v = 1.0 + polynomial->coefficient(1) / unit_px,
                       .c = polynomial->coefficient(2) / unit_px,
                       .b = polynomial->coefficient(3) / unit_px};
    for (const Sample& sample : samples) {
        shift.largest_difference_px =
            std::max(shift.largest_difference_px, std::abs((*polynomial)(sample.t) - sample.value));
    }
    return shift;
}

std::string tca_element(const Profile& profile, const LensfunOptions& options, double unit_px,
                        std::vector<std::string>& notes) {
    const auto fit = [&](bool linear) {
        return std::pair(fit_shift(profile, "R", linear, unit_px), fit_shift(profile, "B", linear, unit_px));
    };
    const auto [red_line, blue_line] = fit(true);
    if (!red_line || !blue_line) {
        notes.push_back("no chromatic shift: " +
                        why_not_measured(profile, part::kChromaticShift, "the profile has none of red and blue"));
        return "";
    }
    const double linear_error = std::max(red_line->largest_difference_px, blue_line->largest_difference_px);
    const auto [red, blue] = fit(false);
    if (linear_error < kLinearEnough_px || !red || !blue) {
        notes.push_back(
            fmt::format("chromatic shift: linear, differs from the profile's by at most {:.3g} px", linear_error));
        return fmt::format("            <tca model=\"linear\" focal=\"{:.9g}\" kr=\"{:.9g}\" kb=\"{:.9g}\"/>\n",
                           options.focal_length_mm, red_line->v, blue_line->v);
    }
    notes.push_back(fmt::format("chromatic shift: poly3, differs from the profile's by at most {:.3g} px",
                                std::max(red->largest_difference_px, blue->largest_difference_px)));
    return fmt::format(
        "            <tca model=\"poly3\" focal=\"{:.9g}\" vr=\"{:.9g}\" cr=\"{:.9g}\" br=\"{:.9g}\" vb=\"{:.9g}\" "
        "cb=\"{:.9g}\" bb=\"{:.9g}\"/>\n",
        options.focal_length_mm, red->v, red->c, red->b, blue->v, blue->c, blue->b);
}

std::string vignetting_element(const Profile& profile, const LensfunOptions& options, double unit_px,
                               std::vector<std::string>& notes) {
    const Curve* curve = nullptr;
    for (const char* channel : {"G", "Y", "R", "B"}) {
        curve = curve ? curve : find_curve(profile, kQuantities.vignetting.key(channel));
    }
    if (!curve) {
        notes.push_back("no vignetting: " + why_not_measured(profile, part::kVignetting, "the profile has none"));
        return "";
    }
    if (!options.f_number) {
        notes.emplace_back("no vignetting: lensfun keeps it by f-number, which the profile does not say");
        return "";
    }
    PolynomialVignetting fit;
    try {
        fit = polynomial_vignetting(*curve);
    } catch (const InputError& e) {
        notes.push_back(std::string("no vignetting: ") + e.what());
        return "";
    }
    notes.push_back(fmt::format("vignetting: pa, differs from the profile's by at most {:.3g} % of the axis's light",
                                100.0 * fit.largest_error));
    const double scale2 = std::pow(unit_px / half_diagonal_px(profile), 2);
    return fmt::format(
        "            <vignetting model=\"pa\" focal=\"{:.9g}\" aperture=\"{:.9g}\" distance=\"{:.9g}\" k1=\"{:.9g}\" "
        "k2=\"{:.9g}\" k3=\"{:.9g}\"/>\n",
        options.focal_length_mm, *options.f_number, options.focus_distance_m, fit.a[0] * scale2,
        fit.a[1] * scale2 * scale2, fit.a[2] * scale2 * scale2 * scale2);
}

}  // namespace

LensfunExport lensfun_export(const Profile& profile, const LensfunOptions& options) {
    const ProfileGeometry& geometry = exported_geometry(profile);
    const double width = profile.width_px - 1.0;
    const double height = profile.height_px - 1.0;
    const int shorter = std::min(profile.width_px, profile.height_px);
    const int longer = std::max(profile.width_px, profile.height_px);
    const int common = std::gcd(shorter, longer);
    const double half_diagonal = std::hypot(width, height) / 2.0;
    const double unit_px = half_diagonal * shorter / std::hypot(shorter, longer);
    const double centre_unit_px = std::min(width, height) / 2.0;
    LensfunExport result;
    result.type = options.type ? *options.type : nearest_type(profile);
    const auto distortion = fit_distortion(profile, result.type, unit_px);
    if (!distortion) {
        throw InputError("none of lensfun's distortion models follows the profile's " + kind_name(geometry.model) +
                         " from the type " + name_of(result.type) +
                         ": expected a narrower field, or another --lens-type");
    }
    result.distortion_model = distortion->model;
    result.corrected_focal_length_px = distortion->focal_px;
    result.largest_difference_px = distortion->largest_difference_px;
    result.notes.push_back(fmt::format(
        "distortion: {} on {}, differs from the profile's {} by at most {:.3g} px within the covered {:.0f} % of the "
        "half diagonal",
        distortion->model, name_of(result.type), kind_name(geometry.model), result.largest_difference_px,
        100.0 * geometry.covered_image_height));

    if (stretch_y(geometry.model) != 0.0) {
        result.notes.push_back(
            fmt::format("lensfun knows square pixels only: a stretch of heights by {:.3g} % is left out",
                        100.0 * stretch_y(geometry.model)));
    }
    std::string calibration = fmt::format("            <distortion model=\"{}\" focal=\"{:.9g}\"", distortion->model,
                                          options.focal_length_mm);
    for (const auto& [name, value] : distortion->terms) {
        calibration += fmt::format(" {}=\"{:.9g}\"", name, value);
    }
    calibration += "/>\n" + tca_element(profile, options, unit_px, result.notes) +
                   vignetting_element(profile, options, half_diagonal, result.notes);

    const Vec2d centre = centre_px(geometry.model);
    std::string notes = "    " + comment("lensproof export of the profile " + profile.name) + "\n";
    notes += "    " +
             comment(fmt::format("measured at {} x {} px; a corrected picture has the focal length {:.9g} px",
                                 profile.width_px, profile.height_px, result.corrected_focal_length_px)) +
             "\n";
    for (const std::string& note : result.notes) {
        notes += "    " + comment(note) + "\n";
    }
    result.xml = fmt::format(
        "<!DOCTYPE lensdatabase SYSTEM \"lensfun-database.dtd\">\n<lensdatabase version=\"1\">\n{}    <lens>\n"
        "        <maker>{}</maker>\n        <model>{}</model>\n        <mount>{}</mount>\n        <type>{}</type>\n"
        "        <cropfactor>{:.9g}</cropfactor>\n        <aspect-ratio>{}:{}</aspect-ratio>\n"
        "        <center x=\"{:.9g}\" y=\"{:.9g}\"/>\n        <calibration>\n{}        </calibration>\n"
        "    </lens>\n</lensdatabase>\n",
        notes, escape_markup(options.maker), escape_markup(options.model), escape_markup(options.mount),
        name_of(result.type), options.crop_factor, longer / common, shorter / common,
        (centre.x - width / 2.0) / centre_unit_px, (centre.y - height / 2.0) / centre_unit_px, calibration);
    return result;
}

}  // namespace lensproof::calibration
