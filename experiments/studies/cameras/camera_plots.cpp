#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "experiments/studies/cameras/measured_camera.h"

namespace lensproof::studies {

namespace {

using calibration::kQuantities;

/// What is added belongs to the plot begun last.
class CameraPlots {
  public:
    CameraPlots(const MeasuredCamera& camera, const ClosedLoopLimits& limits) : camera_(camera), limits_(limits) {}

    std::vector<findings::Plot> all() {
        const bool is_fisheye =
            camera_.profile.geometry && !calibration::is_perspective(camera_.profile.geometry->model);
        begin({"distortion", "Distortion", "against f·tan θ, f being the slope on the axis", "distortion", "%"});
        if (!is_fisheye) {
            add_measured(kQuantities.distortion.key());
        }
        begin({"distortion-fisheye", "Distortion of fisheyes", "against f·θ, f being the slope on the axis",
               "distortion", "%"});
        if (is_fisheye) {
            add_measured(kQuantities.equidistant_distortion.key());
        }
        begin({"distortion-difference", "Image position: measured minus traced",
               "radial distance of the image of one direction", "difference", "px", limits_.distortion_largest_px});
        add_difference(kQuantities.image_position.key());

        begin({"vignetting", "Vignetting", "light relative to the axis, green (grey photos: their one channel)",
               "relative illumination", "EV"});
        const auto& curves = camera_.profile.curves;
        const std::string green = kQuantities.vignetting_ev.key("G");
        const std::string grey = kQuantities.vignetting_ev.key("Y");
        add_measured(curves.contains(grey) && !curves.contains(green) ? grey : green);
        begin({"vignetting-difference", "Vignetting: measured minus traced",
               "relative illumination, as a share of the axis", "difference", "%", limits_.vignetting_percent});
        add_difference(kQuantities.vignetting.key("G"), 100.0);

        for (const auto& [channel, colour] : {std::pair{"R", "red"}, std::pair{"B", "blue"}}) {
            const std::string curve = kQuantities.chromatic_shift.key(channel);
            begin({fmt::format("chromatic-{}", colour), fmt::format("Chromatic shift of {}", colour),
                   fmt::format("radial position of {} minus green", colour), "shift", "px"});
            add_measured(curve);
            begin({fmt::format("chromatic-{}-difference", colour),
                   fmt::format("Chromatic shift of {}: measured minus traced", colour), "", "difference", "px",
                   limits_.chromatic_shift_px});
            add_difference(curve);
        }

        begin({"chromatic-wavelengths", "Lateral colour by wavelength",
               "radial position of single wavelengths minus the green channel's", "shift", "px"});
        for (const std::string& channel : shown_wavelengths()) {
            const std::string nm = channel.substr(0, channel.size() - 2);
            add_measured(kQuantities.chromatic_shift.key(channel), fmt::format(", {} nm", nm));
        }

        begin({"sharpness", "Sharpness", "MTF50 along the radius (tangential) and across (sagittal), green", "MTF50",
               "cycles/px"});
        add_both_directions(kQuantities.tangential_mtf50, kQuantities.sagittal_mtf50);
        begin({"field-curvature", "Field curvature", "where the focus has to stand for the sharpest picture, green",
               "focus", "mm"});
        add_both_directions(kQuantities.tangential_focus, kQuantities.sagittal_focus);
        return std::move(plots_);
    }

  private:
    void begin(findings::Plot plot) { plots_.push_back(std::move(plot)); }

    void add(const std::string& label, const char* style, const calibration::Curve& curve,
             std::optional<double> floor) {
        plots_.back().series.push_back(
            {.label = label, .subject = camera_.subject.id, .style = style, .curve = curve, .floor = floor});
    }

    /// And what is traced of it, and what others say.
    void add_measured(const std::string& curve, const std::string& suffix = "") {
        const std::string label = camera_.subject.id + suffix;
        if (const calibration::Curve* found = find_curve(camera_.profile, curve)) {
            add(label, "measured", *found, rms_floor(camera_.profile, curve));
        }
        if (const calibration::Curve* found = camera_.traced ? find_curve(*camera_.traced, curve) : nullptr) {
            add(label + ", traced", "reference", *found, std::nullopt);
        }
        for (const calibration::Profile& reference : camera_.references) {
            if (const calibration::Curve* found = find_curve(reference, curve)) {
                add(label + ", " + reference.name, "reference", *found, std::nullopt);
            }
        }
    }

    /// Measured minus traced, times `scale`.
    void add_difference(const std::string& curve, double scale = 1.0) {
        auto difference =
            camera_.traced ? calibration::difference(camera_.profile, *camera_.traced, curve) : std::nullopt;
        if (!difference) {
            return;
        }
        calibration::Curve& scaled = difference->curve;
        for (std::vector<double>* values : {&scaled.value, &scaled.lower_95, &scaled.upper_95}) {
            std::ranges::transform(*values, values->begin(), [&](double value) { return scale * value; });
        }
        std::optional<double> floor = rms_floor(camera_.profile, curve);
        if (floor) {
            *floor *= scale;
        }
        add(camera_.subject.id, "difference", scaled, floor);
    }

    /// Those that any of the curves' sources has by itself.
    [[nodiscard]] std::set<std::string> shown_wavelengths() const {
        std::vector<const calibration::Profile*> sources = {&camera_.profile};
        if (camera_.traced) {
            sources.push_back(&*camera_.traced);
        }
        for (const calibration::Profile& reference : camera_.references) {
            sources.push_back(&reference);
        }
        std::set<std::string> channels;
        for (const calibration::Profile* source : sources) {
            for (const auto& [key, curve] : source->curves) {
                const auto known = calibration::quantity_of(key);
                if (known && known->quantity.key(known->channel) == kQuantities.chromatic_shift.key(known->channel) &&
                    known->channel.ends_with("nm")) {
                    channels.insert(known->channel);
                }
            }
        }
        return channels;
    }

    /// In green (grey photos: their one channel).
    void add_both_directions(const calibration::Quantity& tangential, const calibration::Quantity& sagittal) {
        for (const char* channel : {"G", "Y"}) {
            add_measured(tangential.key(channel), ", tangential");
        }
        for (const char* channel : {"G", "Y"}) {
            add_measured(sagittal.key(channel), ", sagittal");
        }
    }

    const MeasuredCamera& camera_;
    const ClosedLoopLimits& limits_;
    std::vector<findings::Plot> plots_;
};

}  // namespace

std::vector<findings::Plot> camera_plots(const MeasuredCamera& camera, const ClosedLoopLimits& limits) {
    return CameraPlots(camera, limits).all();
}

}  // namespace lensproof::studies
