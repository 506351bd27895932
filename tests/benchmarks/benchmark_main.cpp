// lensproof_benchmark: times the hot paths, then prints their ratios, which say more than times on a shared machine.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <map>

#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

struct Ratio {
    const char* what;
    const char* of;
    const char* to;
};

constexpr Ratio kRatios[] = {
    {"float / double, clip", "trace/tessar/reverse/clip/float", "trace/tessar/reverse/clip/double"},
    {"follow / clip, every ray passes", "trace/tessar/reverse/follow/double", "trace/tessar/reverse/clip/double"},
    {"forward / reverse", "trace/tessar/forward/clip/double", "trace/tessar/reverse/clip/double"},
    {"plain loop: Fresnel on / off", "batch/tessar/plain_fresnel", "batch/tessar/plain"},
    {"plain loop with Fresnel / trace", "batch/tessar/plain_fresnel", "trace/tessar/reverse/clip/double"},
    {"checkerboard / flat field, Tessar", "render/tessar/checkerboard", "render/tessar/flat-field"},
    {"disc grid / flat field, Tessar", "render/tessar/disc-grid", "render/tessar/flat-field"},
    {"fisheye / Tessar, flat field", "render/muller-fisheye/flat-field", "render/tessar/flat-field"},
    {"scene: exact lens / pinhole", "scene/exact", "scene/pinhole"},
    {"wall and sphere: noise / even sky", "scene/sky/noise", "scene/sky/even"},
    {"wall and sphere: panorama / even sky", "scene/sky/panorama", "scene/sky/even"},
    {"wall and sphere: small noise / even sky", "scene/sky/small_noise", "scene/sky/even"},
    {"still life: noise / even sky", "scene/still_life/noise", "scene/still_life/even"},
    {"still life: panorama / even sky", "scene/still_life/panorama", "scene/still_life/even"},
    {"still life: small noise / even sky", "scene/still_life/small_noise", "scene/still_life/even"},
    {"analysis: curves / table", "analyze/westrogon-24/curves", "analyze/westrogon-24/table"},
    {"analysis: fisheye / Tessar, table", "analyze/muller-fisheye/table", "analyze/tessar/table"},
    {"rough metal / diffuse, sample", "bsdf/metal/sample", "bsdf/diffuse/sample"},
    {"frosted glass / diffuse, sample", "bsdf/frosted-glass/sample", "bsdf/diffuse/sample"},
    {"rough plastic / diffuse, sample", "bsdf/rough-plastic/sample", "bsdf/diffuse/sample"},
    {"rough metal / diffuse, evaluate", "bsdf/metal/evaluate", "bsdf/diffuse/evaluate"},
    {"dispersive / plain frosted glass", "bsdf/frosted-prism/evaluate", "bsdf/frosted-glass/evaluate"},
    {"lossless / brushed metal, evaluate", "bsdf/lossless-metal/evaluate", "bsdf/brushed-metal/evaluate"},
    {"texture: picture / constant", "texture/picture", "texture/constant"},
    {"a ghost's four rays: alone / in lanes", "ghosts/ray/alone", "ghosts/ray/lanes"},
    {"discs / corners, refinement", "refine/disc-grid", "refine/checkerboard"},
};

/// The usual console output, and every benchmark's CPU time in seconds: the median where it was repeated.
class RatioReporter : public benchmark::ConsoleReporter {
  public:
    void ReportRuns(const std::vector<Run>& runs) override {
        benchmark::ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            const bool is_median = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
            if (!run.error_occurred && (is_median || run.run_type == Run::RT_Iteration)) {
                seconds_[run.run_name.str()] =
                    run.GetAdjustedCPUTime() / benchmark::GetTimeUnitMultiplier(run.time_unit);
            }
            failed_ = failed_ || run.error_occurred;
        }
    }

    void Finalize() override {
        fmt::print("\nRatios of CPU time\n");
        for (const Ratio& ratio : kRatios) {
            const auto of = seconds_.find(ratio.of);
            const auto to = seconds_.find(ratio.to);
            if (of != seconds_.end() && to != seconds_.end()) {
                fmt::print("  {:<36} {:6.2f}\n", ratio.what, of->second / to->second);
            }
        }
        print_speed_ups();
        print_buffered_speed_ups();
    }

    [[nodiscard]] bool failed() const { return failed_; }

  private:
    /// Of every camera_paths/LENS/buffers/WHAT over paths one by one with the same consumer.
    void print_buffered_speed_ups() const {
        fmt::print("\nCamera paths: times as fast as one by one\n");
        for (const auto& [name, seconds] : seconds_) {
            const std::size_t at = name.find("/buffers/");
            if (!name.starts_with("camera_paths/") || at == std::string::npos) {
                continue;
            }
            const auto alone =
                seconds_.find(name.substr(0, at) + "/one_by_one" + (name.ends_with("/chart") ? "/chart" : ""));
            if (alone != seconds_.end()) {
                fmt::print("  {:<60} {:6.2f}\n", name.substr(name.find('/') + 1), alone->second / seconds);
            }
        }
    }

    /// Of every batch/LENS/TYPE/LEVEL/WHAT over the plain loop of the same physics, batch/LENS/plain….
    void print_speed_ups() const {
        fmt::print("\nTimes as fast as the plain scalar loop in double\n");
        for (const auto& [name, seconds] : seconds_) {
            const std::size_t lens_end = name.find('/', name.find('/') + 1);
            if (!name.starts_with("batch/") || name.find('/', lens_end + 1) == std::string::npos) {
                continue;
            }
            const bool with_fresnel = name.find("/fresnel") != std::string::npos;
            const auto plain = seconds_.find(name.substr(0, lens_end) + (with_fresnel ? "/plain_fresnel" : "/plain"));
            if (plain != seconds_.end()) {
                fmt::print("  {:<60} {:6.2f}\n", name.substr(name.find('/') + 1), plain->second / seconds);
            }
        }
    }

    std::map<std::string, double> seconds_;
    bool failed_ = false;
};

}  // namespace

}  // namespace lensproof

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
        return 2;
    }
    lensproof::register_trace_benchmarks();
    lensproof::register_render_benchmarks();
    lensproof::register_scene_benchmarks();
    lensproof::register_camera_path_benchmarks();
    lensproof::register_polynomial_benchmarks();
    lensproof::register_bsdf_benchmarks();
    lensproof::register_measure_benchmarks();
    lensproof::register_analysis_benchmarks();
    lensproof::register_ghost_benchmarks();
    lensproof::register_device_benchmarks();
    lensproof::RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    benchmark::Shutdown();
    return reporter.failed() ? 1 : 0;
}
