#include "experiments/studies/pupil_passage/passage_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "experiments/draw/section_drawing.h"

namespace lensproof::studies {

namespace {
constexpr double kDrawingWidth = 900.0;
constexpr double kMargin = 24.0;
constexpr double kTitle = 26.0;

std::string id_of(const PassageSetting& setting) {
    return fmt::format("{}-f{}", setting.lens, setting.f_number);
}

std::string label_of(const Passage& passage) {
    return fmt::format("{} at f/{}", passage.lens.name, passage.setting.f_number);
}

findings::Check lost_at_most(const Passage& passage, const std::string& what, const std::string& label, double lost,
                             double sigma, double limit, const std::string& explanation) {
    return {.id = id_of(passage.setting) + "-" + what,
            .group = label_of(passage),
            .subject = id_of(passage.setting),
            .label = label,
            .value = 100.0 * lost,
            .sigma = 100.0 * sigma,
            .unit = "%",
            .limit = limit,
            .expectation = findings::Expectation::at_most,
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
    view.scale = std::min((kDrawingWidth - 2.0 * kMargin) / view.box.width(), 300.0 / view.box.height());
    return view;
}

/// Two sections, one above the other.
findings::Picture section_drawing(const Passage& passage) {
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
    const double height = kMargin + 2.0 * panel;
    return {.name = id_of(passage.setting) + ".svg",
            .caption =
                "Paths from four heights on the sensor (right) through the section; those that a rim stops "
                "end there",
            .width = kDrawingWidth,
            .height = height,
            .bytes = svg.document(kDrawingWidth, height)};
}

Json percentages(const std::array<double, kPassageRings>& fractions) {
    Json list = Json::list();
    std::ranges::transform(fractions, std::back_inserter(list), [](double fraction) { return 100.0 * fraction; });
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

findings::Subject passage_subject(const Passage& passage) {
    const auto percent = [](double fraction) { return fmt::format("{:.1f} %", 100.0 * fraction); };
    findings::Subject subject{
        .id = id_of(passage.setting),
        .kind = "lens",
        .label = label_of(passage),
        .facts = {{"paths that leave the front, whole rear element", percent(passage.whole_element.mean)},
                  {"with pupil sampling", percent(passage.pupil.mean)},
                  {"in the worst of eight rings", percent(std::ranges::min(passage.pupil.rings))},
                  {"image circle", fmt::format("{:.1f} mm", 2.0 * passage.circle_mm)}},
        .pictures = {section_drawing(passage)}};
    if (const auto& published = passage.setting.published) {
        subject.facts.push_back(
            {"published (Steinert et al. 2011)",
             fmt::format("{:g} % and {:g} %", published->whole_element_percent, published->pupil_percent)});
    }
    return subject;
}

constexpr const char* kPassageStep = "passage";

findings::StepInput input_of(const PassageSetting& setting, const findings::RunSettings& settings) {
    return {.settings = {{"lens", setting.lens}, {"f_number", setting.f_number}, {"seed", settings.seed}},
            .files = formats::files_of_lens(setting.lens)};
}

}  // namespace

PassageSetting read_passage_setting(TomlTable& table) {
    constexpr Bounds kPercent{.min = 0.0, .max = 100.0};
    PassageSetting setting{.lens = formats::read_lens_name(table),
                           .f_number = table.number("f_number", {.min = 0.1, .max = 1000.0}),
                           .published = {}};
    if (auto published = table.optional_table("published_percent")) {
        setting.published =
            PassageSetting::Published{.whole_element_percent = published->number("whole_element", kPercent),
                                      .pupil_percent = published->number("pupil", kPercent)};
        published->finish();
    }
    table.finish();
    return setting;
}

std::vector<findings::Check> passage_checks(const std::vector<Passage>& passages) {
    std::vector<findings::Check> checks;
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

findings::Findings passage_findings(const std::vector<Passage>& passages) {
    findings::Findings found{.checks = passage_checks(passages), .subjects_title = "Lenses"};
    std::ranges::transform(passages, std::back_inserter(found.subjects), passage_subject);
    Json table;
    std::ranges::transform(passages, std::back_inserter(table), passage_json);
    found.tables = {{"passages", std::move(table)}};
    return found;
}

std::vector<findings::Study> read_pupil_passage(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("pupil_passage")) {
        const PassageSetting setting = read_passage_setting(table);
        file.add_subject(table, "lens", id_of(setting));
        const auto counted = [setting](const findings::RunSettings& settings, const findings::RunProgress& progress) {
            progress(id_of(setting), 0.0);
            return settings.steps.step(kPassageStep, input_of(setting, settings),
                                       [&] { return count_passage(passage_lens(setting), settings.seed); });
        };
        const auto carry_out = [setting, counted](const findings::RunSettings& settings,
                                                  const findings::RunProgress& progress, const findings::Findings&) {
            return passage_findings({{counted(settings, progress), setting, passage_lens(setting)}});
        };
        studies.push_back({id_of(setting), carry_out, [setting, counted](const findings::RunSettings& settings) {
                               return std::vector<findings::PlannedStep>{{kPassageStep, "paths that leave the front",
                                                                          input_of(setting, settings), 2.0, counted}};
                           }});
    }
    return studies;
}

}  // namespace lensproof::studies
