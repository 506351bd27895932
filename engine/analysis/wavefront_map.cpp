#include "engine/analysis/wavefront_map.h"

#include <array>

namespace lensproof::analysis {

WavefrontMap wavefront_map(const PolychromaticField& field, const PolychromaticField::Part& part, int samples) {
    const SampledPupil pupil = sample_pupil(field, part, cosine_box(field, part).width() / samples);
    const Vec3d& chief = field.chief_direction;
    WavefrontMap map{{pupil.size, pupil.spacing, pupil.centre - Vec2d{chief.x, chief.y}},
                     pupil.status,
                     part.wavelength_nm,
                     std::vector<double>(pupil.amplitude.size(), 0.0),
                     std::vector<std::uint8_t>(pupil.amplitude.size(), 0)};
    for (std::size_t i = 0; i < map.opd_waves.size(); ++i) {
        if (pupil.fraction[i] >= 0.5) {
            const std::array<optics::RegionNode, 1> node = {{{pupil.offset[i], 1.0}}};
            const Wavefront one = wavefront(part.lens, part.wavelength_nm, field.bundle, field.sphere, node);
            if (!one.rays.empty()) {
                map.inside[i] = 1;
                map.opd_waves[i] = one.rays.front().opd_mm * 1e6 / part.wavelength_nm;
            }
        }
    }
    return map;
}

}  // namespace lensproof::analysis
