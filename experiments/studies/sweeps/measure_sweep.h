// experiments/studies/sweeps/measure_sweep.h — the quantities that a sweep can measure, and one value of it measured.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/optics/lens.h"
#include "experiments/findings/axis.h"

namespace lensproof::studies {

/// A quantity, as `lensproof analyze` computes it (engine/analysis).
struct SweepQuantity {
    const char* key;     // "spot_rms_um"
    const char* family;  // quantities of one family share a chart: "MTF"
    const char* label;   // "tangential"
    const char* unit;
    bool is_mtf = false;
};

/// mtf_tangential, mtf_sagittal, spot_rms_um, distortion_percent, relative_illumination, vignetting,
/// transmittance, lateral_colour_um, tangential_focus_mm, sagittal_focus_mm, astigmatism_mm (tangential less sagittal),
/// wavefront_rms_waves, chief_ray_height_mm, efl_mm, bfl_mm, f_number_paraxial, entrance_pupil_diameter_mm.
const std::vector<SweepQuantity>& sweep_quantities();
std::vector<std::string> sweep_quantity_keys();
const SweepQuantity& sweep_quantity(const std::string& key);

/// "diffraction" (of what the MTF is by default), "diffraction-limited", "geometric".
const std::vector<std::string>& mtf_models();

/// Where a sweep looks; what is not said is as `analyze` has it.
struct SweepSetting {
    std::string lens;
    std::string zoom;
    std::optional<double> f_number;
    std::optional<double> focus_distance_mm;  // the lens is focused there; none: as its table says
    std::optional<double> image_shift_mm;     // of the image plane from there, away from the lens
    std::string model;                        // of the MTF
    std::optional<double> frequency_per_mm;
    double field_deg = 0.0;
    /// None: the d line, for MTF d, F and C together, and for lateral colour F less C.
    std::optional<double> wavelength_nm;
};

SweepSetting sweep_setting(const std::vector<findings::Axis>& axes, std::size_t i);

/// What was found there. What does not exist, such as a spot beyond the field, is nothing.
struct SweepValue {
    std::map<std::string, std::optional<double>> quantities;
    std::string refused{};  // why the lens cannot be set so: it does not open so far
};

void fields(JsonArchive& json, SweepValue& value);

/// A lens as a sweep sets it, made once for all values that follow each other and differ in what they look at alone.
class SweptLens {
  public:
    /// Throws InputError for what cannot be read; a lens that cannot be set so is refused.
    SweepValue measure(const SweepSetting& setting, const std::vector<std::string>& quantities);

  private:
    void set(const SweepSetting& setting);

    std::optional<SweepSetting> setting_;
    std::optional<optics::Lens> lens_;
    double object_distance_mm_ = 0.0;
    std::string refused_;
};

}  // namespace lensproof::studies
