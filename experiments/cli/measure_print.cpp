// experiments/cli/measure_print.cpp — a profile as text.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>

#include "calibration/detection/numbering.h"
#include "experiments/cli/measure_parts.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

using calibration::kQuantities;

void print_curve(const calibration::Profile& profile, const calibration::Quantity& quantity,
                 std::string_view channel = "") {
    const calibration::Curve* found = find_curve(profile, quantity.key(channel));
    if (found == nullptr) {
        return;
    }
    const calibration::Curve& curve = *found;
    const double height =  // some curves are extrapolated beyond what was covered, some end before it
        curve.image_height.empty() ? 0.0 : std::min(curve.covered_image_height, curve.image_height.back());
    if (const std::optional<calibration::Banded> end = calibration::sample(curve, height)) {
        print("{:22} {:9.4f} ± {:.4f} {} at image height {:.2f}\n", quantity.title(channel), end->value,
              (end->upper_95 - end->lower_95) / (2.0 * calibration::k95), quantity.unit.symbol, height);
    }
}

void print_edge(const std::string& channel, const calibration::ProfileEdge& listed) {
    const calibration::EdgeMtf& edge = listed.edge;
    if (edge.mtf50) {
        print("{:22} {:9.4f} ± {:.4f} cycles/px at ({:.1f}, {:.1f}) px, edge normal {:.1f}°\n",
              fmt::format("MTF50 {}", channel), edge.mtf50->cycles_per_px, edge.mtf50->standard_error, edge.centre_px.x,
              edge.centre_px.y, edge.normal_deg);
    }
}

void print_star(const std::string& channel, const calibration::ProfileStar& listed) {
    const calibration::StarMtf& star = listed.star;
    print("{:22} at ({:.1f}, {:.1f}), {:.0f} x {:.0f} px\n", "star " + channel, star.centre_px.x, star.centre_px.y,
          2.0 * star.outline.long_half_axis_px, 2.0 * star.outline.short_half_axis_px);
    for (const calibration::StarSegment& segment : star.segments) {
        const std::string label = fmt::format("  along {:.0f}° (at {:.0f}°)", segment.frequency_deg, segment.side_deg);
        if (segment.mtf50) {
            print("{:22} MTF50 {:.4f} ± {:.4f} cycles/px\n", label, segment.mtf50->cycles_per_px,
                  segment.mtf50->standard_error);
        } else {
            print("{:22} no MTF50 among the star's frequencies, {:.3f} to {:.3f} cycles/px\n", label,
                  segment.cycles_per_px.front(), segment.cycles_per_px.back());
        }
    }
}

void print_sharpness(const calibration::Profile& profile) {
    for (const auto& [channel, stars] : profile.siemens_stars) {
        for (const calibration::ProfileStar& star : stars) {
            print_star(channel, star);
        }
    }
    constexpr std::size_t few = 6;  // edges that are listed one by one; more make a curve
    for (const auto& [channel, edges] : profile.sharpness) {
        for (std::size_t i = 0; i < edges.size() && edges.size() < few; ++i) {
            print_edge(channel, edges[i]);
        }
        print_curve(profile, kQuantities.tangential_mtf50, channel);
        print_curve(profile, kQuantities.tangential_focus, channel);
        print_curve(profile, kQuantities.sagittal_mtf50, channel);
        print_curve(profile, kQuantities.sagittal_focus, channel);
    }
}

/// What the pictures leave open of which point is which, and how many leave it open: where several do, it is said once
/// for all of them.
std::map<std::string, std::ptrdiff_t> shared_remarks(const calibration::Profile& profile) {
    using enum calibration::Numbering;
    std::map<std::string, std::ptrdiff_t> shared;
    for (const calibration::Numbering numbering : {half_turn, quarter_turn, whole_pitches}) {
        const std::string words = numbering_in_words(numbering);
        const auto count = std::ranges::count_if(
            profile.pictures, [&](const calibration::PictureAccount& p) { return p.reason.ends_with(words); });
        if (count > 1) {
            shared[words] = count;
        }
    }
    return shared;
}

/// A picture's reason without what is said of several at once.
std::string own_reason(std::string reason, const std::map<std::string, std::ptrdiff_t>& shared) {
    for (const auto& [words, count] : shared) {
        if (reason.ends_with(words)) {
            reason.resize(reason.size() - words.size());
            reason.resize(reason.ends_with("; ") ? reason.size() - 2 : reason.size());
        }
    }
    return reason;
}

/// A line for each picture: used or left out, and why.
void print_account(const calibration::Profile& profile) {
    const auto used =
        std::ranges::count_if(profile.pictures, [](const calibration::PictureAccount& p) { return p.used; });
    print("{} of {} pictures used\n", used, profile.pictures.size());
    std::size_t widest = 0;
    for (const calibration::PictureAccount& picture : profile.pictures) {
        widest = std::max(widest, picture.image.size());
    }
    const std::map<std::string, std::ptrdiff_t> shared = shared_remarks(profile);
    for (const calibration::PictureAccount& picture : profile.pictures) {
        const std::string reason = own_reason(picture.reason, shared);
        const std::string held = picture.orientation == 1
                                     ? ""
                                     : fmt::format("EXIF orientation {} not applied: the sensor's rows count{}",
                                                   picture.orientation, reason.empty() ? "" : "; ");
        const std::string line =
            fmt::format("  {:8}  {:{}}  {}{}", picture.used ? "used" : "left out", picture.image, widest, held, reason);
        print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
    }
    for (const auto& [words, count] : shared) {
        print("in {} pictures {}\n", count, words);
    }
    for (const std::string& suspicion : profile.source.suspicions) {
        print("correction suspected: {}\n", suspicion);
    }
}

}  // namespace

void print_profile(const calibration::Profile& profile) {
    for (const std::string& warning : profile.warnings) {
        print("warning: {}\n", warning);
    }
    const bool lacks_camera = !profile.geometry && !profile.views.empty();
    if (lacks_camera) {
        print("no camera: {}; what needs none is measured about the picture's middle\n",
              why_not_measured(profile, calibration::part::kGeometry, "it was not measured"));
    }
    print_account(profile);
    if (profile.geometry) {
        const calibration::ProfileGeometry& geometry = *profile.geometry;
        const std::vector<std::string> names = calibration::parameter_names(geometry.model);
        const std::vector<double> values = calibration::parameters(geometry.model);
        print("{}: {} points in {} views, rms {:.4f} px\n", calibration::kind_name(geometry.model),
              geometry.points_used, geometry.views_used, geometry.reprojection_rms_px);
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (names[i] == calibration::kStretchY && values[i] == 0.0) {
                continue;  // square pixels
            }
            if (geometry.standard_error(i) == 0.0) {
                print("{:22} {:.6g} (held)\n", names[i], values[i]);
                continue;
            }
            print("{:22} {:.6g} ± {:.2g}", names[i], values[i], geometry.standard_error(i));
            print("{}\n", geometry.view_standard_error.empty()
                              ? ""
                              : fmt::format(" (from view to view ± {:.2g})", geometry.view_standard_error[i]));
        }
    }
    if (profile.geometry && profile.geometry->board) {
        for (std::size_t i = 0; i < calibration::kBoardTerms; ++i) {
            print("{:22} {:.4f} ± {:.2g}\n", calibration::kBoardTermNames[i], profile.geometry->board->height_mm[i],
                  calibration::standard_error_mm(*profile.geometry->board, i));
        }
    }
    if (profile.geometry && profile.geometry->choice) {
        print("chosen because: {}\n", profile.geometry->choice->why);
    }
    print_lines(profile);
    print_curve(profile, kQuantities.distortion);
    if (!profile.scene_lines.empty()) {
        print_curve(profile, kQuantities.equidistant_distortion);
    }
    for (const char channel : kQuantities.vignetting_ev.channels) {
        print_curve(profile, kQuantities.vignetting_ev, {&channel, 1});
    }
    for (const auto& [channel, models] : profile.vignetting_models) {
        if (!models.empty()) {
            print("{:22} {}: {}\n", "vignetting " + channel, models.front().name, models.front().verdict);
        }
    }
    for (const auto& [name, terms] : profile.terms) {
        const auto channel = calibration::kMeanShiftTerms.channel_in(name);
        for (std::size_t i = 0; channel && i < terms.names.size(); ++i) {
            print("{:22} {:9.4f} ± {:.4f} px, {} of all points\n", "shift " + *channel, terms.values[i],
                  std::sqrt(terms.covariance[i * (terms.names.size() + 1)]), terms.names[i]);
        }
    }
    for (const auto& [name, curve] : profile.curves) {
        if (kQuantities.chromatic_shift.key.channel_in(name)) {  // along the radius, and across
            const auto shift = calibration::quantity_of(name);
            print_curve(profile, shift->quantity, shift->channel);
        }
    }
    if (profile.self_test) {
        print("{:22} {}\n", "floor of the method", calibration::describe_floor(*profile.self_test));
    }
    print_sharpness(profile);
    for (const auto& [what, why] : profile.not_measured) {
        if (!lacks_camera || what != calibration::part::kGeometry) {  // which stands first
            print("{} not measured: {}\n", what, why);
        }
    }
}

}  // namespace lensproof::cli
