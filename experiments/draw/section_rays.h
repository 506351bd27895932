// experiments/draw/section_rays.h — the rays of a lens section: meridional bundles at three fields; in mm.
#pragma once
#include <string>
#include <vector>

#include "experiments/draw/section_geometry.h"

namespace lensproof::draw {

struct SectionRay {
    SectionLine points;  // at least one, from in front of the lens to the sensor, or to where it is blocked
    bool passes = true;
    bool is_chief = false;
};

struct SectionBundle {
    double field_angle = 0.0;  // of the chief ray, radians
    std::vector<SectionRay> rays;
};

struct SectionRays {
    std::vector<SectionBundle> bundles;
    std::string remark;  // what a reader should know of them; may be empty
};

/// Bundles at 0, 0.7 and 1 of the stated half field (else of the field that fills the stated image circle), or of the
/// largest field whose chief ray passes, where that is less. Each bundle holds `count` ≥ 3 rays that pass, from rim to
/// rim and with the chief ray among them. Where not even the ray along the axis passes, it is drawn up to its block.
/// Rays begin on a wavefront `lead` mm in front of the first surface (measured along the chief ray).
SectionRays section_rays(const optics::Prescription& prescription, const optics::Lens& lens, double lead, int count,
                         const std::vector<double>& fields_deg = {});

/// The wavelength that a drawing is made at, nm: the prescription's first, else the d line, or the middle of the
/// glasses' common range where they do not cover it.
double drawing_wavelength(const optics::Prescription& prescription, const optics::Lens& lens);

}  // namespace lensproof::draw
