#include "experiments/studies/pupil_passage/passage_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "engine/base/json.h"
#include "engine/formats/prescription/prescription_file.h"
#include "experiments/draw/section_drawing.h"
#include "experiments/runner/provenance.h"
#include "experiments/runner/report_content.h"

namespace lensproof::studies {

namespace {
constexpr double kWidth = 900.0;
constexpr double kMargin = 24.0;
constexpr double kTitle = 26.0;

std::string id_of(const Passage& passage) {
    return fmt::format("{}-f{}", passage.setting.lens, passage.setting.f_number);
}

std::string label_of(const Passage& passage) {
    return fmt::format("{} at f/{}", passage.lens.name, passage.setting.f_number);
}

runner::Check lost_at_most(const Passage& passage, const std::string& what, const std::string& label, double lost,
                           double sigma, double limit, const std::string& explanation) {
    return {.id = id_of(passage) + "-" + what,
            .group = label_of(passage),
            .subject = id_of(passage),
            .label = label,
            .value = 100.0 * lost,
            .sigma = 100.0 * sigma,
            .unit = "%",
            .limit = limit,
            .expectation = runner::Expectation::at_most,
            .explanation = explanation};
}

draw::SectionRays section_rays_of(const std::vector<DrawnPath>& paths) {
    draw::SectionBundle bundle;
    for (const DrawnPath& path : paths) {
        draw::SectionRay ray{.points = {}, .passes = path.passes};
        std::ranges::transform(path.points, std::back_inserter(ray.points),
                               [](Vec2d point) { return draw::SectionPoint{.z = point.x, .y = point.y}; });
        bundle.rays.push_back(std::move(ray));
    }
    return {.bundles = {std::move(bundle)}, .remark = {}};
}

/// The part of lens space that both panels show: the glass, the sensor, and a little of what leaves the front.
draw::SectionView view_of(const draw::SectionGeometry& geometry, const Passage& passage) {
    draw::SectionView view;
    view.box = draw::glass_box(geometry);
    const double size = std::max(view.box.width(), view.box.height());
    for (const DrawnPath& path : passage.pupil.drawn) {
        for (const Vec2d& point : path.points) {
            view.box.hold(draw::SectionPoint{.z = std::max(point.x, view.box.z_min), .y = point.y});
        }
    }
    view.box.hold({view.box.z_min - 0.15 * size, 0.0});
    view.sensor_half_height = passage.circle_mm;
    view.box.hold({geometry.image_z, passage.circle_mm});
    view.box.hold({geometry.image_z, -passage.circle_mm});
    view.scale = std::min((kWidth - 2.0 * kMargin) / view.box.width(), 300.0 / view.box.height());
    return view;
}

/// Two sections, one above the other.
std::string section_drawing(const Passage& passage) {
    const draw::SectionGeometry geometry = draw::section_geometry(
        formats::read_prescription(formats::find_lens_file(passage.setting.lens)), &passage.lens);
    draw::SectionView view = view_of(geometry, passage);
    draw::Svg svg(label_of(passage));
    const double panel = kTitle + view.scale * view.box.height() + kMargin;
    const auto draw = [&](int row, const std::string& words, const PassageOf& of) {
        view.corner = {kMargin, kMargin + row * panel + kTitle};
        svg.text({kMargin, view.corner.y - 10.0},
                 fmt::format("{}: {:.1f} % of the paths leave the front", words, 100.0 * of.mean),
                 {.size = 15.0, .bold = true});
        draw::draw_section(svg, view, geometry, section_rays_of(of.drawn), {});
    };
    draw(0, "Points of the whole rear element", passage.whole_element);
    draw(1, "Points of the pupil of each pixel", passage.pupil);
    return svg.document(kWidth, kMargin + 2.0 * panel);
}

double section_height(const Passage& passage) {
    const draw::SectionGeometry geometry = draw::section_geometry(
        formats::read_prescription(formats::find_lens_file(passage.setting.lens)), &passage.lens);
    const draw::SectionView view = view_of(geometry, passage);
    return kMargin + 2.0 * (kTitle + view.scale * view.box.height() + kMargin);
}

Json percentages(const std::array<double, kPassageRings>& shares) {
    Json list = Json::list();
    std::ranges::transform(shares, std::back_inserter(list), [](double share) { return 100.0 * share; });
    return list;
}

Json passage_json(const Passage& passage) {
    const auto& published = passage.setting.published;
    return {{"lens", passage.setting.lens},
            {"f_number", passage.setting.f_number},
            {"image_circle_mm", 2.0 * passage.circle_mm},
            {"whole_element_percent", 100.0 * passage.whole_element.mean},
            {"pupil_percent", 100.0 * passage.pupil.mean},
            {"pupil_error_percent", 100.0 * passage.pupil.error},
            {"whole_element_rings_percent", percentages(passage.whole_element.rings)},
            {"pupil_rings_percent", percentages(passage.pupil.rings)},
            {"published_percent",
             published ? Json{{"whole_element", published->whole_element_percent}, {"pupil", published->pupil_percent}}
                       : Json(nullptr)}};
}

Json subject_json(const Passage& passage) {
    const auto& published = passage.setting.published;
    const auto percent = [](double share) { return fmt::format("{:.1f} %", 100.0 * share); };
    Json facts = {
        {{"label", "paths that leave the front, whole rear element"}, {"value", percent(passage.whole_element.mean)}},
        {{"label", "with pupil sampling"}, {"value", percent(passage.pupil.mean)}},
        {{"label", "in the worst of eight rings"}, {"value", percent(std::ranges::min(passage.pupil.rings))}},
        {{"label", "image circle"}, {"value", fmt::format("{:.1f} mm", 2.0 * passage.circle_mm)}}};
    if (published) {
        facts.push_back(
            {{"label", "published (Steinert et al. 2011)"},
             {"value", fmt::format("{:g} % and {:g} %", published->whole_element_percent, published->pupil_percent)}});
    }
    return {{"id", id_of(passage)},
            {"kind", "lens"},
            {"label", label_of(passage)},
            {"facts", facts},
            {"pictures",
             {{{"name", id_of(passage) + ".svg"},
               {"caption",
                "Paths from four heights on the sensor (right) through the section; those that a rim stops "
                "end there"},
               {"width", kWidth},
               {"height", section_height(passage)}}}}};
}

}  // namespace

std::vector<Passage> run_pupil_passage(const runner::Experiment& experiment, const runner::RunSettings& settings,
                                       const runner::RunProgress& progress) {
    std::vector<Passage> passages;
    const std::vector<runner::PassageSetting>& wanted = experiment.pupil_passage;
    for (const runner::PassageSetting& setting : wanted) {
        passages.push_back(measure_passage(setting, settings.seed));
        progress("passage", static_cast<double>(passages.size()) / static_cast<double>(wanted.size()));
    }
    return passages;
}

std::vector<runner::Check> passage_checks(const std::vector<Passage>& passages) {
    std::vector<runner::Check> checks;
    for (const Passage& passage : passages) {
        const double lost = 1.0 - passage.pupil.mean;
        checks.push_back(lost_at_most(passage, "lost", "paths that do not leave the front", lost, passage.pupil.error,
                                      3.0, "The mean over the image circle's area and the band from 400 to 700 nm."));
        checks.push_back(lost_at_most(passage, "worst-ring", "in the worst of eight rings",
                                      1.0 - std::ranges::min(passage.pupil.rings), 0.0, 10.0,
                                      "Rings of the image circle, of equal width."));
        if (const auto& published = passage.setting.published) {
            checks.push_back(lost_at_most(
                passage, "published", "against what is published", lost, passage.pupil.error,
                100.0 - published->pupil_percent,
                fmt::format(
                    "Published: {:g} % pass of the whole element's paths, {:g} % with pupil sampling. Here {:.1f} % "
                    "of the whole element's pass: its points are drawn from a disc, not from a box around it, and "
                    "over the image circle.",
                    published->whole_element_percent, published->pupil_percent, 100.0 * passage.whole_element.mean)));
        }
    }
    return checks;
}

std::map<std::string, std::string> passage_drawings(const std::vector<Passage>& passages) {
    std::map<std::string, std::string> drawings;
    for (const Passage& passage : passages) {
        drawings[id_of(passage) + ".svg"] = section_drawing(passage);
    }
    return drawings;
}

Json passage_report_json(const runner::Experiment& experiment, const std::vector<Passage>& passages,
                         const runner::RunSettings& settings) {
    const std::vector<runner::Check> checks = passage_checks(passages);
    Json report{{"schema", "lensproof-report/1"}, {"title", experiment.title},
                {"summary", experiment.summary},  {"verdict", runner::verdict_name(runner::overall(checks))},
                {"subjects_title", "Lenses"},     {"checks", Json::list()},
                {"subjects", Json::list()}};
    std::ranges::transform(checks, std::back_inserter(report["checks"]), runner::check_json);
    std::ranges::transform(passages, std::back_inserter(report["subjects"]), subject_json);
    std::ranges::transform(passages, std::back_inserter(report["passages"]), passage_json);
    report["provenance"] = runner::provenance_json({experiment.file}, settings);
    report["reproduce"] =
        fmt::format("./lensproof run {} --seed {}", runner::portable_path(experiment.file), settings.seed);
    return report;
}

}  // namespace lensproof::studies
