#include "experiments/studies/stray_light/render_variant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>

#include "engine/analysis/ghosts.h"
#include "engine/analysis/veiling_glare.h"
#include "engine/base/angle.h"
#include "engine/formats/image/image_json.h"
#include "engine/formats/image/srgb.h"
#include "engine/render/film/film_image.h"
#include "engine/render/integrators/integrators.h"
#include "engine/render/prepared_scene.h"

namespace lensproof::studies {

static void fields(JsonArchive& json, Estimate& estimate) {
    json.field("value", estimate.value).field("standard_error", estimate.standard_error);
}

static void fields(JsonArchive& json, PassPicture& picture) {
    json.field("pass", picture.pass)
        .field("rgb", picture.rgb)
        .field("light", picture.light)
        .field("error", picture.error);
}

static void fields(JsonArchive& json, GhostEnergy& ghost) {
    json.field("surfaces", ghost.surfaces).field("energy", ghost.energy);
}

namespace {

constexpr double kReferenceWavelength_nm = 550.0;
constexpr std::uint32_t kAuditPaths = 1U << 19U;  // of a half, 0.07 %

Estimate sum(const std::vector<Estimate>& terms) {
    Estimate all;
    for (const Estimate& term : terms) {
        all.value += term.value;
        all.standard_error = std::hypot(all.standard_error, term.standard_error);
    }
    return all;
}

/// Errors of R, G and B are taken to go together.
double error_of(const render::PixelEstimate& pixel) {
    return (std::sqrt(pixel.variance.x) + std::sqrt(pixel.variance.y) + std::sqrt(pixel.variance.z)) / 3.0;
}

/// What a print or a display makes of a light, both from 0 to 1.
double displayed(double light) {
    return formats::linear_to_srgb(static_cast<float>(std::clamp(light, 0.0, 1.0)));
}

/// None of camera paths' light in fewer than two blocks of samples, from whose means its variance is estimated; that of
/// light paths' is from each.
formats::Image errors_of(const render::Film& film, int samples) {
    const bool has_blocks = samples >= 2 * static_cast<int>(render::kSamplesPerBlock);
    formats::Image errors = formats::make_image(film.width(), film.height(), {"Y"});
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            if (!has_blocks && !(film.camera_estimate(x, y).rgb == Vec3d{})) {
                return {};
            }
            errors.at(x, y, 0) = static_cast<float>(error_of(film.estimate(x, y)));
        }
    }
    return errors;
}

/// Errors of pixels do not go together.
Estimate light_of(const render::Film& film) {
    double light = 0.0;
    double variance = 0.0;
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            const render::PixelEstimate pixel = film.estimate(x, y);
            light += (pixel.rgb.x + pixel.rgb.y + pixel.rgb.z) / 3.0;
            const double error = error_of(pixel);
            variance += error * error;
        }
    }
    const double pixels = static_cast<double>(film.width()) * film.height();
    return {light / pixels, std::sqrt(variance) / pixels};
}

/// The steps of one variant. The scene is not prepared before one of them has to be made.
class VariantSteps {
  public:
    VariantSteps(const StrayScene& scene, const StrayVariant& variant, const findings::RunSettings& settings,
                 const findings::RunProgress& progress)
        : scene_(scene),
          variant_(variant),
          settings_(settings),
          progress_(progress),
          files_(files_of(variant)),
          setup_(is_draft() ? render::coarser(variant.setup, findings::kDraftShrinks, findings::kDraftSamplesOver)
                            : variant.setup) {}

    [[nodiscard]] PassPicture pass(std::size_t index) {
        const std::string& name = scene_.passes[index];
        const int samples = samples_of(name);
        return settings_.steps.step(kPass, pass_input(name), [&] {
            const render::Film film =
                render::render_film(renders().at(index), {.first = 0, .end = static_cast<std::uint32_t>(samples)},
                                    settings_.threads, [&](double done) { progress_(name_of(name), done); });
            return PassPicture{.pass = name,
                               .rgb = render::film_rgb(film),
                               .light = light_of(film),
                               .error = errors_of(film, samples)};
        });
    }

    [[nodiscard]] std::vector<GhostEnergy> ghosts(double source_deg) {
        return settings_.steps.step(kGhosts, input({{"source_deg", source_deg}}), [&] {
            progress_(name_of("ghosts one by one"), 0.0);
            return surveyed(source_deg);
        });
    }

    [[nodiscard]] Estimate veiling_glare() {
        return settings_.steps.step(kGlare, input({}), [&] {
            progress_(name_of("veiling glare"), 0.0);
            const analysis::VeilingGlare glare = analysis::veiling_glare(
                lens(), {.wavelength_nm = kReferenceWavelength_nm,
                         .spot_angle = analysis::tenth_of_field(lens(), kReferenceWavelength_nm),
                         .object_distance = setup_.camera.focus_distance_mm,
                         .mirrors = setup_.camera.mirrors,
                         .seed = settings_.seed,
                         .threads = settings_.threads});
            return Estimate{glare.index.fraction, glare.index.standard_error};
        });
    }

    [[nodiscard]] std::vector<std::pair<std::string, Estimate>> fates() {
        const std::vector<Estimate> fractions = settings_.steps.step(kAudit, input({}), [&] {
            progress_(name_of("energy audit"), 0.0);
            std::vector<Estimate> found;
            for (const render::EnergyFraction& fraction : prepared().audit(settings_.seed, kAuditPaths).fractions) {
                found.push_back({fraction.fraction, fraction.standard_error});
            }
            return found;
        });
        std::vector<std::pair<std::string, Estimate>> named;
        std::ranges::transform(
            render::fate_names(), fractions, std::back_inserter(named),
            [](const std::string& name, const Estimate& fraction) { return std::pair(name, fraction); });
        return named;
    }

    [[nodiscard]] std::vector<ChartFeature> features(const std::vector<PassPicture>& passes) {
        return settings_.steps.step(kFeatures, features_input(), [&] {
            progress_(name_of("chart"), 0.0);
            return chart_features(setup_, prepared().camera(), scene_.chart->choice, picture_of(passes),
                                  settings_.threads);
        });
    }

    /// On a frame of a sixteenth of the pixels, which tells as much.
    [[nodiscard]] std::vector<PictureGrowth> growth() {
        return settings_.steps.step(kGrowth, growth_input(), [&] {
            progress_(name_of("loading"), 0.0);
            render::PreparedScene small(render::coarser(setup_, kGrowthShrinks, 1), render::PixelFilter{},
                                        settings_.cache, integrators(), scene_.stray_filter, settings_.device);
            return picture_growth(small.render(scene_.passes, settings_.seed, false, !is_draft()),
                                  scene_.growth_samples, settings_.threads,
                                  [&](double done) { progress_(name_of("growth"), done); });
        });
    }

    [[nodiscard]] std::vector<findings::PlannedStep> planned() const {
        std::vector<findings::PlannedStep> steps;
        const double pixels = static_cast<double>(setup_.camera.sensor.width) * setup_.camera.sensor.height;
        for (std::size_t i = 0; i < scene_.passes.size(); ++i) {
            const std::string& pass = scene_.passes[i];
            constexpr double kSecondsOfSample = 1e-6;  // of the passes' usual scenes
            steps.push_back({kPass, name_of(pass), pass_input(pass), 1.0 + kSecondsOfSample * pixels * samples_of(pass),
                             alone([i](VariantSteps& own) { return own.pass(i); })});
        }
        if (scene_.ghosts_deg) {
            const double source_deg = *scene_.ghosts_deg;
            steps.push_back({kGhosts, name_of("ghosts one by one"), input({{"source_deg", source_deg}}), 5.0,
                             alone([source_deg](VariantSteps& own) { return own.ghosts(source_deg); })});
        }
        if (scene_.has_veiling_glare) {
            steps.push_back({kGlare, name_of("veiling glare"), input({}), 10.0,
                             alone([](VariantSteps& own) { return own.veiling_glare(); })});
        }
        if (scene_.growth_samples > 0) {
            steps.push_back({kGrowth, name_of("growth"), growth_input(), 20.0});
        }
        if (scene_.chart) {
            steps.push_back({kFeatures, name_of("chart"), features_input(), 3.0});
        }
        if (scene_.has_audit) {
            steps.push_back({kAudit, name_of("energy audit"), input({}), 5.0,
                             alone([](VariantSteps& own) { return own.fates(); })});
        }
        return steps;
    }

    [[nodiscard]] const render::Sensor& sensor() const { return setup_.camera.sensor; }

  private:
    static constexpr const char* kPass = "stray-pass";
    static constexpr const char* kGhosts = "stray-ghosts";
    static constexpr const char* kGlare = "stray-glare";
    static constexpr const char* kAudit = "stray-audit";
    static constexpr const char* kFeatures = "stray-chart";
    static constexpr const char* kGrowth = "stray-growth";
    static constexpr int kGrowthShrinks = 4;

    /// A step of this variant by itself.
    template <class Step>
    [[nodiscard]] std::function<void(const findings::RunSettings&, const findings::RunProgress&)> alone(
        const Step& step) const {
        return [&scene = scene_, &variant = variant_, step](const findings::RunSettings& settings,
                                                            const findings::RunProgress& progress) {
            VariantSteps own(scene, variant, settings, progress);
            static_cast<void>(step(own));
        };
    }

    [[nodiscard]] findings::StepInput input(Json what) const {
        what["scene"] = variant_.stated;
        what["seed"] = settings_.seed;
        what["draft"] = is_draft();
        what["stray_filter"] = scene_.stray_filter.name();
        for (const auto& [pass, paths] : scene_.paths) {
            what["paths"][pass] = paths;
        }
        return {.settings = std::move(what), .files = files_};
    }

    [[nodiscard]] findings::StepInput pass_input(const std::string& pass) const {
        return input({{"passes", scene_.passes}, {"pass", pass}, {"samples_per_pixel", samples_of(pass)}});
    }

    [[nodiscard]] int growth_samples() const {
        return is_draft() ? std::max(8, scene_.growth_samples / (findings::kDraftShrinks * findings::kDraftShrinks))
                          : scene_.growth_samples;
    }
    [[nodiscard]] findings::StepInput growth_input() const {
        return input({{"passes", scene_.passes}, {"growth_samples", growth_samples()}});
    }

    /// All that the picture follows from, and what is looked for in it.
    [[nodiscard]] findings::StepInput features_input() const {
        Json samples = Json::list();
        for (const std::string& pass : scene_.passes) {
            samples.push_back(samples_of(pass));
        }
        return input({{"passes", scene_.passes},
                      {"samples", std::move(samples)},
                      {"objects", scene_.chart->choice.objects},
                      {"lamps", scene_.chart->choice.is_lamps}});
    }

    [[nodiscard]] bool is_draft() const { return settings_.quality == findings::Quality::draft; }

    [[nodiscard]] int samples_of(const std::string& pass) const {
        const auto asked = scene_.samples_per_pixel.find(pass);
        if (asked == scene_.samples_per_pixel.end()) {
            return setup_.samples_per_pixel;
        }
        return is_draft() ? std::max(1, asked->second / findings::kDraftSamplesOver) : asked->second;
    }

    [[nodiscard]] std::string name_of(const std::string& what) const {
        return fmt::format("{}, {}: {}", scene_.name, variant_.name, what);
    }

    [[nodiscard]] render::PassIntegrators integrators() const {
        render::PassIntegrators integrators;
        for (const auto& [pass, paths] : scene_.paths) {
            integrators.of_pass[pass] = &render::integrator_named(paths);
        }
        return integrators;
    }

    render::PreparedScene& prepared() {
        if (!prepared_) {
            progress_(name_of("loading"), 0.0);
            prepared_ = std::make_unique<render::PreparedScene>(setup_, render::PixelFilter{}, settings_.cache,
                                                                integrators(), scene_.stray_filter, settings_.device);
        }
        return *prepared_;
    }

    const std::vector<render::Render>& renders() {
        if (renders_.empty()) {
            if (setup_.chart) {
                renders_.push_back(prepared().render(settings_.seed, false));
                return renders_;
            }
            // A draft has too few samples for the search to pay that finds where ghosts come in.
            renders_ = prepared().render(scene_.passes, settings_.seed, false, !is_draft());
        }
        return renders_;
    }

    const optics::Lens& lens() { return prepared().camera().lens().value(); }

    std::vector<GhostEnergy> surveyed(double source_deg) {
        const render::Sensor& sensor = setup_.camera.sensor;
        const analysis::GhostSurvey survey = analysis::survey_ghosts(
            lens(), {.reference_wavelength_nm = kReferenceWavelength_nm,
                     .wavelengths_nm = {},
                     .source_angle = source_deg * kDegree,
                     .chief_angle = source_deg * kDegree,
                     .mirrors = setup_.camera.mirrors,
                     .image_radius = 0.5 * sensor.pixel_pitch_mm * std::hypot(sensor.width, sensor.height),
                     .sampling = {.seed = settings_.seed},
                     .threads = settings_.threads,
                     .device = settings_.device});
        std::vector<GhostEnergy> found;
        for (const analysis::Ghost& ghost : survey.ghosts) {
            GhostEnergy energy{.surfaces = {}, .energy = {ghost.light.energy, ghost.light.standard_error}};
            std::ranges::transform(ghost.path, std::back_inserter(energy.surfaces),
                                   [](int surface) { return surface + 1; });
            found.push_back(std::move(energy));
        }
        return found;
    }

    const StrayScene& scene_;
    const StrayVariant& variant_;
    const findings::RunSettings& settings_;
    const findings::RunProgress& progress_;
    std::vector<std::filesystem::path> files_;
    render::SceneSetup setup_;
    std::unique_ptr<render::PreparedScene> prepared_;
    std::vector<render::Render> renders_;
};

}  // namespace

Estimate ratio(const Estimate& over, const Estimate& under) {
    const double value = over.value / under.value;
    return {value, std::hypot(over.standard_error, value * under.standard_error) / std::abs(under.value)};
}

Estimate VariantFindings::light(const std::string& pass) const {
    std::vector<Estimate> lights;
    for (const PassPicture& picture : passes) {
        if (pass == kPicture || pass == picture.pass) {
            lights.push_back(picture.light);
        }
    }
    return sum(lights);
}

Estimate VariantFindings::ghost_energy(int surface, bool is_involved) const {
    std::vector<Estimate> energies;
    for (const GhostEnergy& ghost : ghosts) {
        if ((std::ranges::count(ghost.surfaces, surface) > 0) == is_involved) {
            energies.push_back(ghost.energy);
        }
    }
    return sum(energies);
}

std::optional<double> VariantFindings::noise() const {
    if (!std::ranges::all_of(passes, [](const PassPicture& pass) { return !pass.error.pixels.empty(); })) {
        return std::nullopt;
    }
    const formats::Image picture = picture_of(passes);
    const std::size_t pixels = passes.front().error.pixels.size();
    double squares = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* rgb = picture.pixels.data() + 3 * i;
        const double light = (rgb[0] + rgb[1] + rgb[2]) / 3.0;
        double variance = 0.0;
        for (const PassPicture& pass : passes) {
            variance += double{pass.error.pixels[i]} * pass.error.pixels[i];
        }
        const double sigma = std::sqrt(variance);
        const double shown = 0.5 * (displayed(light + sigma) - displayed(light - sigma));
        squares += shown * shown;
    }
    return std::sqrt(squares / static_cast<double>(pixels));
}

formats::Image picture_of(const std::vector<PassPicture>& passes) {
    formats::Image all = passes.front().rgb;
    for (std::size_t i = 1; i < passes.size(); ++i) {
        std::ranges::transform(all.pixels, passes[i].rgb.pixels, all.pixels.begin(), std::plus<>());
    }
    return all;
}

std::vector<findings::PlannedStep> steps_of_variant(const StrayScene& scene, const StrayVariant& variant,
                                                    const findings::RunSettings& settings) {
    const findings::RunProgress quiet = [](const std::string&, double) {};
    return VariantSteps(scene, variant, settings, quiet).planned();
}

VariantFindings render_variant(const StrayScene& scene, const StrayVariant& variant,
                               const findings::RunSettings& settings, const findings::RunProgress& progress) {
    VariantSteps steps(scene, variant, settings, progress);
    VariantFindings found;
    for (std::size_t i = 0; i < scene.passes.size(); ++i) {
        found.passes.push_back(steps.pass(i));
    }
    if (scene.ghosts_deg) {
        found.ghosts = steps.ghosts(*scene.ghosts_deg);
    }
    if (scene.has_veiling_glare) {
        found.veiling_glare = steps.veiling_glare();
    }
    if (scene.has_streaks) {
        const auto rgb = [&](const char* pass) -> const formats::Image& {
            return std::ranges::find(found.passes, pass, &PassPicture::pass)->rgb;
        };
        found.streaks = streak_look(rgb("diffracted"), rgb("direct"), steps.sensor(), *variant.setup.camera.blades);
    }
    if (scene.growth_samples > 0) {
        found.growth = steps.growth();
    }
    if (scene.chart) {
        found.features = steps.features(found.passes);
    }
    if (scene.has_audit) {
        found.fates = steps.fates();
    }
    return found;
}

}  // namespace lensproof::studies
