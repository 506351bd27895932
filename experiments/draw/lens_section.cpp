#include "experiments/draw/lens_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/optics/paraxial.h"
#include "experiments/draw/label_row.h"
#include "experiments/draw/section_drawing.h"

namespace lensproof::draw {

namespace {

constexpr double kMargin = 40.0;  // px
constexpr double kSectionTextSize = 12.0;
constexpr double kLeader = 14.0;  // height of a leader's slanted piece

/// What is known of the whole lens: computed, with the claim in brackets where there is one.
std::string summary(const optics::Prescription& prescription, const optics::Lens* lens) {
    const optics::StatedData& stated = prescription.stated;
    optics::ParaxialData data{.efl = NAN, .f_number = NAN};
    double wavelength_nm = NAN;
    if (lens != nullptr) {
        try {
            wavelength_nm = drawing_wavelength(prescription, *lens);
            data = optics::paraxial_data(optics::at_wavelength<double>(*lens, wavelength_nm));
        } catch (const InputError&) {
            wavelength_nm = NAN;  // the rays' remark says what is wrong
        }
    }
    std::string text;
    const auto add = [&](const char* prefix, double computed, const std::optional<double>& claim, const char* suffix) {
        if (!std::isfinite(computed) && !claim) {
            return;
        }
        text += text.empty() ? "" : "   ·   ";
        text += std::isfinite(computed) ? fmt::format("{}{:.4g}{}", prefix, computed, suffix) : "";
        if (claim) {
            text += std::isfinite(computed) ? fmt::format(" ({:.4g} stated)", *claim)
                                            : fmt::format("{}{:.4g}{} stated", prefix, *claim, suffix);
        }
    };
    add("f = ", data.efl, stated.efl_mm, " mm");
    add("f/", std::round(100.0 * data.f_number) / 100.0, stated.f_number, "");
    add("half field ", NAN, stated.half_field_deg, "°");
    add("image circle ", NAN, stated.image_circle_mm, " mm");
    add("", wavelength_nm, std::nullopt, " nm");
    return text;
}

/// Writes the name and what is known of the lens; returns where the page is free below.
double draw_title(Svg& svg, const optics::Prescription& prescription, const optics::Lens* lens, double width) {
    constexpr double kSectionTitleSize = 17.0;
    const auto most = static_cast<std::size_t>((width - 2.0 * kMargin) / (0.58 * kSectionTitleSize));
    svg.text({kMargin, 34.0}, shortened(prescription.name, most),
             {.size = kSectionTitleSize, .fill = kInk, .bold = true, .class_name = "title"});
    svg.text({kMargin, 54.0}, summary(prescription, lens), {.size = 12.5, .fill = kQuiet, .class_name = "summary"});
    if (lens != nullptr) {
        return 66.0;
    }
    svg.text({kMargin, 73.0}, "This table cannot be traced as it stands: it is drawn as far as it goes, without rays.",
             {.size = 12.5, .fill = severity_colour(optics::Severity::error), .class_name = "untraced"});
    return 85.0;
}

/// How far in front of the first vertex its rays begin, mm: a seventh of the whole before the lens, in front of a
/// secondary mirror too, and not before a near object.
double lead_in(const SectionGeometry& geometry, const SectionBox& glass, double object_distance_mm) {
    const double length = std::max(glass.z_max, geometry.image_z) - glass.z_min;
    const bool has_mirrors = std::ranges::any_of(geometry.surfaces, &SectionSurface::is_mirror);
    const double lead = std::max(std::min(length / 7.0, 1.2 * glass.height()), 0.2 * glass.height()) +
                        (has_mirrors ? -std::min(glass.z_min, geometry.image_z) : 0.0);
    return object_distance_mm > 0.0 ? std::min(lead, object_distance_mm) : lead;
}

/// What is shown: the glass, where the rays begin, and the sensor, unless it stands so far off that the lens would
/// shrink to a dot.
SectionView view_of(const SectionGeometry& geometry, const SectionRays& rays, const optics::StatedData& stated,
                    const LensSectionOptions& options) {
    constexpr double kFarthestSensor = 30.0;  // in sizes of the glass
    constexpr double kLargestImage = 12.0;
    constexpr double kFarthestRay = 3.0;
    SectionView view;
    const SectionBox glass = glass_box(geometry);
    view.box = glass;
    const double size = std::max({glass.width(), glass.height(), 1e-6});
    const bool shows_sensor = std::abs(geometry.image_z - glass.z_max) <= kFarthestSensor * size;
    double height = stated.image_circle_mm && *stated.image_circle_mm > 0.0 ? 0.5 * *stated.image_circle_mm : 0.0;
    for (const SectionBundle& bundle : rays.bundles) {
        for (const SectionRay& ray : bundle.rays) {
            for (const SectionPoint end : {ray.points.front(), ray.points.back()}) {
                if (std::max(std::abs(end.z), std::abs(end.y)) <= kFarthestRay * size) {
                    view.box.hold(end);
                }
            }
            if (ray.passes && !stated.image_circle_mm && ray.is_chief) {
                height = std::max(height, 1.08 * std::abs(ray.points.back().y));
            }
        }
    }
    if (shows_sensor) {
        view.sensor_half_height = std::min(height > 0.0 ? height : 0.4 * glass.height(), kLargestImage * size);
        view.box.hold({geometry.image_z, view.sensor_half_height});
        view.box.hold({geometry.image_z, -view.sensor_half_height});
    }
    const double width_px = options.width_px - 2.0 * kMargin;
    const double box_width = std::max(view.box.width(), 1e-6);
    const double box_height = std::max(view.box.height(), 1e-6);
    view.scale = std::min(width_px / box_width, options.largest_height_px / box_height);
    view.corner.x = 0.5 * (options.width_px - view.scale * box_width);
    return view;
}

/// A line from a label down (or up) to what it names.
void draw_leader(Svg& svg, SvgPoint label, SvgPoint target, const char* colour, double width = 0.7) {
    const double bend = label.y + (target.y > label.y ? kLeader : -kLeader);
    svg.path({label, {target.x, bend}, target}, {.stroke = colour, .width = width, .class_name = "leader"});
}

/// The surfaces' worst findings, as many labels of codes as there is room for in two rows; returns the free y below.
class SurfaceLabels {
  public:
    SurfaceLabels(const SectionGeometry& geometry, const SectionView& view,
                  const std::vector<optics::Finding>& findings, double page_width)
        : geometry_(geometry), view_(view), left_(0.4 * kMargin), right_(page_width - 0.4 * kMargin) {
        const int count = static_cast<int>(geometry.surfaces.size());
        for (const optics::Finding& finding : findings) {  // the worst come first
            if (finding.surface >= 1 && finding.surface <= count && finding.severity != optics::Severity::info) {
                codes_[finding.surface].push_back(&finding);
                marks_.emplace(finding.surface, finding.severity);
            }
        }
        // A number takes 17 px; where there are too many, every second, third … is written, and the marked ones.
        constexpr double kNumberWidth = 17.0;
        const int stride = 1 + static_cast<int>(count * kNumberWidth / (right_ - left_));
        std::vector<PlacedLabel> labels;
        for (const SectionSurface& surface : geometry.surfaces) {
            if ((surface.number - 1) % stride == 0 || marks_.contains(surface.number)) {
                numbers_.push_back(surface.number);
                labels.push_back({view.to_page(surface.curve.back()).x, kNumberWidth});
            }
        }
        x_ = spread_labels(labels, left_, right_);
    }

    [[nodiscard]] const SurfaceMarks& marks() const { return marks_; }

    /// Height of the rows of codes and numbers above the section.
    [[nodiscard]] double height() const { return rows() * kCodeRow + kNumberRow + kLeader + 8.0; }

    void draw(Svg& svg, double top) const {
        const double number_y = top + rows() * kCodeRow + 0.5 * kNumberRow;
        svg.open_group("surface-numbers");
        for (std::size_t i = 0; i < numbers_.size(); ++i) {
            const SectionSurface& surface = geometry_.surfaces[numbers_[i] - 1];
            const auto mark = marks_.find(surface.number);
            const bool is_marked = mark != marks_.end();
            SvgPoint target = view_.to_page(surface.curve.back());
            target.y -= surface.is_stop ? 24.0 : 1.5;
            const SvgPoint at{x_[i], number_y};
            const char* colour = is_marked ? severity_colour(mark->second) : kFaint;
            draw_leader(svg, {at.x, at.y + 0.5 * kNumberRow}, target, colour, is_marked ? 1.0 : 0.6);
            if (is_marked) {
                svg.circle(at, 8.5, {.fill = colour, .class_name = "marker"});
            }
            svg.text({at.x, at.y + 3.8}, std::to_string(surface.number),
                     {.size = 10.5,
                      .fill = is_marked ? "#fff" : kQuiet,
                      .anchor = SvgAnchor::middle,
                      .bold = is_marked || surface.is_stop});
        }
        svg.close_group();
        draw_codes(svg, top, number_y);
    }

  private:
    static constexpr double kCodeRow = 17.0;
    static constexpr double kNumberRow = 18.0;
    static constexpr std::size_t kMostCodes = 12;

    [[nodiscard]] int rows() const { return static_cast<int>(std::min<std::size_t>((codes_.size() + 3) / 4, 3)); }

    void draw_codes(Svg& svg, double top, double number_y) const {
        std::vector<std::string> words;
        std::vector<std::size_t> at;  // among the numbers
        for (std::size_t i = 0; i < numbers_.size() && words.size() < kMostCodes; ++i) {
            if (const auto found = codes_.find(numbers_[i]); found != codes_.end()) {
                const std::size_t more = found->second.size() - 1;
                words.push_back(shortened(found->second.front()->code, 28) +
                                (more > 0 ? fmt::format(" +{}", more) : std::string()));
                at.push_back(i);
            }
        }
        svg.open_group("codes");
        for (int row = 0; row < rows(); ++row) {
            std::vector<PlacedLabel> labels;
            std::vector<std::size_t> here;
            for (std::size_t k = row; k < words.size(); k += rows()) {
                labels.push_back({x_[at[k]], 1.08 * svg_text_width(words[k], 11.0) + 12.0});
                here.push_back(k);
            }
            const std::vector<double> x = spread_labels(labels, left_, right_);
            const double y = top + (row + 0.5) * kCodeRow;
            for (std::size_t k = 0; k < here.size(); ++k) {
                const char* colour = severity_colour(marks_.at(numbers_[at[here[k]]]));
                svg.line({x[k], y + 6.0}, {x_[at[here[k]]], number_y - 8.5}, {.stroke = colour, .width = 0.8});
                svg.rectangle({x[k] - 0.5 * labels[k].width + 3.0, y - 7.0}, labels[k].width - 6.0, 13.0,
                              {.fill = "#fff"});
                svg.text(
                    {x[k], y + 3.5}, words[here[k]],
                    {.size = 11.0, .fill = colour, .anchor = SvgAnchor::middle, .bold = true, .class_name = "code"});
            }
        }
        svg.close_group();
    }

    const SectionGeometry& geometry_;
    const SectionView& view_;
    double left_;
    double right_;
    SurfaceMarks marks_;
    std::map<int, std::vector<const optics::Finding*>> codes_;
    std::vector<int> numbers_;
    std::vector<double> x_;  // of the numbers' middles
};

/// Writes the glasses' names under the section, upright where they would fan out too far; returns the free y below.
double draw_glass_names(Svg& svg, const SectionView& view, const SectionGeometry& geometry, double top,
                        double page_width) {
    constexpr double kSize = 11.0;
    constexpr double kGap = 10.0;
    constexpr std::size_t kLongest = 22;
    std::vector<std::string> names;
    std::vector<PlacedLabel> across;
    std::vector<PlacedLabel> upright;
    std::vector<SvgPoint> targets;
    double total = 0.0;
    double longest = 0.0;
    for (const SectionElement& element : geometry.elements) {
        const std::string name = shortened(element.name, kLongest);
        const SectionPoint front = geometry.surfaces[element.front - 1].curve.front();
        const SectionPoint back = geometry.surfaces[element.front].curve.front();
        const SectionPoint foot{0.5 * (front.z + back.z), std::ranges::min(element.outline, {}, &SectionPoint::y).y};
        const SvgPoint target = view.to_page(foot);
        const double width = svg_text_width(name, kSize);
        names.push_back(name);
        targets.push_back({target.x, target.y + 2.0});
        across.push_back({target.x, width + kGap});
        upright.push_back({target.x, kSize + 3.0});
        total += width + kGap;
        longest = std::max(longest, width);
    }
    if (names.empty()) {
        return top;
    }
    const auto [first, last] = std::ranges::minmax(targets, {}, &SvgPoint::x);
    const bool is_upright = total > 1.15 * (last.x - first.x) + 120.0 || total > page_width - kMargin;
    const std::vector<double> x =
        spread_labels(is_upright ? upright : across, 0.4 * kMargin, page_width - 0.4 * kMargin);
    svg.open_group("glass-names");
    const double label_y = top + kLeader + 6.0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        draw_leader(svg, {x[i], label_y}, targets[i], kFaint, 0.6);
        if (is_upright) {
            svg.text({x[i] + 3.8, label_y + 4.0}, names[i],
                     {.size = kSize, .fill = kInk, .anchor = SvgAnchor::end, .rotation_deg = -90.0});
        } else {
            svg.text({x[i], label_y + 12.0}, names[i], {.size = kSize, .fill = kInk, .anchor = SvgAnchor::middle});
        }
    }
    svg.close_group();
    return label_y + (is_upright ? longest + 8.0 : 18.0);
}

/// The lowest y under the glass: its own, or that of the steep rays that begin there.
double lowest_under_glass(const SectionBox& glass, const SectionRays& rays) {
    double lowest = glass.y_min;
    for (const SectionBundle& bundle : rays.bundles) {
        for (const SectionRay& ray : bundle.rays) {
            if (ray.points.front().z > glass.z_min) {
                lowest = std::min(lowest, ray.points.front().y);
            }
        }
    }
    return lowest;
}

/// The largest of 1, 2, 5 × 10^k that is at most `most`.
double round_length(double most) {
    const double decade = std::pow(10.0, std::floor(std::log10(most)));
    return most >= 5.0 * decade ? 5.0 * decade : (most >= 2.0 * decade ? 2.0 * decade : decade);
}

/// Scale, tints, fields and what is to be said of the rays, in as many rows as it takes; returns the free y below.
double draw_legend(Svg& svg, const SectionView& view, const SectionGeometry& geometry, const SectionRays& rays,
                   double top, double page_width) {
    constexpr double kLongestBar = 160.0;
    constexpr double kRow = 18.0;
    constexpr double kFieldSample = 32.0;  // of a field's line: long enough for its dashes
    double y = top + kRow;
    double x = kMargin;
    const auto make_room = [&](double width) {
        if (x > kMargin && x + width > page_width - kMargin) {
            x = kMargin;
            y += kRow;
        }
    };
    const auto words = [&](const std::string& text, const char* colour = kQuiet) {
        make_room(svg_text_width(text, kSectionTextSize));
        svg.text({x, y + 4.0}, text, {.size = kSectionTextSize, .fill = colour});
        x += svg_text_width(text, kSectionTextSize) + 14.0;
    };
    svg.open_group("legend");
    const double length_mm = round_length(kLongestBar / view.scale);
    const double length = length_mm * view.scale;
    svg.path({{x, y - 4.0}, {x, y + 4.0}, {x, y}, {x + length, y}, {x + length, y - 4.0}, {x + length, y + 4.0}},
             {.stroke = kInk, .width = 1.2, .class_name = "scale"});
    x += length + 8.0;
    words(fmt::format("{:.6g} mm", length_mm), kInk);
    x += 12.0;
    for (const auto& [kind, name] : {std::pair{GlassKind::crown, "crown"}, {GlassKind::flint, "flint"}}) {
        if (std::ranges::count(geometry.elements, kind, glass_kind) > 0) {
            svg.rectangle({x, y - 6.0}, 18.0, 12.0, {.fill = glass_colour(kind), .stroke = kInk, .width = 0.8});
            x += 24.0;
            words(name);
        }
    }
    x += 12.0;
    for (std::size_t i = 0; i < rays.bundles.size(); ++i) {
        const std::string angle =
            fmt::format("{:.4g}°", std::round(100.0 * rays.bundles[i].field_angle / kDegree) / 100.0 + 0.0);
        make_room(kFieldSample + 6.0 + svg_text_width(angle, kSectionTextSize));
        const FieldLine line = field_line(i);
        svg.line({x, y}, {x + kFieldSample, y},
                 {.stroke = line.colour, .width = 2.0, .dashes = line.dashes, .class_name = "field"});
        x += kFieldSample + 6.0;
        words(angle);
    }
    if (!(view.sensor_half_height > 0.0)) {
        words(fmt::format("sensor at z = {:.6g} mm, off the page", geometry.image_z));
    }
    if (!rays.remark.empty()) {
        words(shortened(rays.remark, 90), severity_colour(optics::Severity::warning));
    }
    svg.close_group();
    return y + 14.0;
}

/// The first findings, written out; returns the free y below.
double draw_findings(Svg& svg, const std::vector<optics::Finding>& findings, const LensSectionOptions& options,
                     double top) {
    constexpr double kFindingLine = 16.0;
    if (findings.empty()) {
        return top;
    }
    const double indent = kMargin + 16.0;
    const auto most =
        static_cast<std::size_t>(std::max(20.0, (options.width_px - indent - kMargin) / (0.52 * kSectionTextSize)));
    double y = top + 20.0;
    svg.open_group("findings");
    for (std::size_t i = 0; i < std::min(findings.size(), options.most_findings); ++i) {
        const optics::Finding& finding = findings[i];
        svg.rectangle({kMargin, y - 9.0}, 9.0, 9.0, {.fill = severity_colour(finding.severity)});
        const std::string text = (finding.surface > 0 ? fmt::format("surface {} · ", finding.surface) : std::string()) +
                                 finding.code + ": " + finding.message;
        for (const std::string& line : wrapped(text, most, 2)) {
            svg.text({indent, y}, line, {.size = kSectionTextSize, .fill = kInk, .class_name = "finding"});
            y += kFindingLine;
        }
        y += 3.0;
    }
    if (findings.size() > options.most_findings) {
        svg.text({indent, y}, fmt::format("and {} more", findings.size() - options.most_findings),
                 {.size = kSectionTextSize, .fill = kQuiet});
        y += kFindingLine;
    }
    svg.close_group();
    return y;
}

}  // namespace

std::string lens_section_svg(const optics::Prescription& prescription, const optics::Lens* lens,
                             const std::vector<optics::Finding>& findings, const LensSectionOptions& options) {
    std::vector<optics::Finding> sorted = findings;
    std::ranges::stable_sort(sorted, std::ranges::greater(), &optics::Finding::severity);

    const SectionGeometry geometry = section_geometry(prescription, lens);
    const SectionBox glass = glass_box(geometry);
    SectionRays rays;
    if (lens != nullptr) {
        rays = section_rays(prescription, *lens, lead_in(geometry, glass, prescription.object_distance_mm),
                            std::max(options.rays, 3), options.fields_deg);
    }
    SectionView view = view_of(geometry, rays, prescription.stated, options);
    const SurfaceLabels labels(geometry, view, sorted, options.width_px);

    Svg svg(prescription.name);
    // The rows of labels stand next to the glass; the sensor and the rays may reach beyond them.
    const double title_end = draw_title(svg, prescription, lens, options.width_px);
    const double above_glass = view.scale * (view.box.y_max - glass.y_max);
    view.corner.y = title_end + std::max(6.0, labels.height() - above_glass);
    labels.draw(svg, view.corner.y + above_glass - labels.height());
    draw_section(svg, view, geometry, rays, labels.marks());
    const double names_top = view.corner.y + view.scale * (view.box.y_max - lowest_under_glass(glass, rays));
    const double names_end = draw_glass_names(svg, view, geometry, names_top, options.width_px);
    double y = std::max(names_end, view.corner.y + view.scale * view.box.height());
    y = draw_legend(svg, view, geometry, rays, y + 4.0, options.width_px);
    y = draw_findings(svg, sorted, options, y);
    return svg.document(options.width_px, y + 0.5 * kMargin);
}

}  // namespace lensproof::draw
