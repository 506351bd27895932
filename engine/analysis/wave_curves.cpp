#include "engine/analysis/wave_curves.h"

#include <algorithm>
#include <cmath>

#include "engine/analysis/field_curves.h"
#include "engine/analysis/mtf.h"
#include "engine/analysis/psf.h"
#include "engine/analysis/wavefront_map.h"
#include "engine/analysis/zernike.h"
#include "engine/base/infinity.h"
#include "engine/base/parallel.h"

namespace lensproof::analysis {

namespace {

constexpr int kMapCells = 64;        // across a wavefront map
constexpr int kLargestPsf = 2048;    // pixels of a PSF's window
constexpr int kMostRefinements = 3;  // of the rays that a geometric MTF sums over
constexpr std::size_t kFrequencies = 51;
constexpr double kHighestFrequency = 100.0;  // cycles/mm, or the cutoff where that is lower
constexpr int kZernikeDegree = 6;
constexpr int kMtfFields = 16;
constexpr double kShownFrequencies[] = {10.0, 20.0, 40.0};  // cycles/mm, over the field

/// Why there is nothing to show.
std::string status_remark(PupilStatus status) {
    switch (status) {
        case PupilStatus::aliased:
            return "aberrations too large for the grid";
        case PupilStatus::folded:
            return "two rays leave in one direction";
        case PupilStatus::ok:
        case PupilStatus::no_light:
            break;
    }
    return "";
}

/// The map over the exit pupil about the chief ray's point in it; `radius`, the axial beam's in direction cosines, is
/// the unit. A ray that comes from above (+y) in the pupil runs downwards, so pupil coordinates are the cosines
/// reversed.
SquareMap over_pupil(const WavefrontMap& map, double radius) {
    const auto shifted = [&](double centre) { return static_cast<int>(std::lround(-centre / map.spacing)); };
    const int shift_x = shifted(map.centre.x);
    const int shift_y = shifted(map.centre.y);
    const int size = map.size + 2 * std::max(std::abs(shift_x), std::abs(shift_y));
    SquareMap shown{.size = static_cast<std::size_t>(size),
                    .half_width = 0.5 * size * map.spacing / radius,
                    .values = std::vector<double>(static_cast<std::size_t>(size) * size, kNaN)};
    const int margin = (size - map.size) / 2;
    for (int row = 0; row < map.size; ++row) {
        for (int column = 0; column < map.size; ++column) {
            if (map.is_inside(row, column)) {
                const int y = margin + map.size - 1 - row + shift_y;
                const int x = margin + map.size - 1 - column + shift_x;
                shown.values[static_cast<std::size_t>(y) * size + x] = map.at(row, column);
            }
        }
    }
    return shown;
}

FieldWavefront field_wavefront(const PolychromaticField& field, const PolychromaticField::Part& part, double field_deg,
                               double radius, int rings) {
    FieldWavefront shown{.field_deg = field_deg, .wavelength_nm = part.wavelength_nm};
    const WavefrontMap map = wavefront_map(field, part, kMapCells);
    if (map.status == PupilStatus::no_light || map.status == PupilStatus::folded) {
        shown.remark = status_remark(map.status);
        return shown;
    }
    shown.opd_waves = over_pupil(map, radius);
    const Wavefront waves = wavefront(part.lens, part.wavelength_nm, field.bundle, field.sphere,
                                      optics::region_quadrature(part.outline, rings));
    const WavefrontErrors errors = wavefront_errors(waves);
    if (waves.rays.size() >= static_cast<std::size_t>(zernike_count(kZernikeDegree))) {
        const double pupil = pupil_radius(part.lens, field.bundle, field.sphere, part.outline);
        shown.zernike_waves = wavefront_zernike(waves, pupil, kZernikeDegree).coefficients;
    }
    shown.rms_waves = errors.rms;
    shown.peak_to_valley_waves = errors.peak_to_valley;
    return shown;
}

MtfCurve ray_mtf(const PolychromaticField& field, std::span<const double> frequencies) {
    GeometricMtfSettings rays;
    MtfCurve curve = geometric_mtf(field, frequencies, rays);
    for (int i = 0; i < kMostRefinements && curve.status == PupilStatus::aliased; ++i) {
        rays = {.azimuths = 2 * rays.azimuths, .rings = 2 * rays.rings};
        curve = geometric_mtf(field, frequencies, rays);
    }
    return curve;
}

FieldMtf field_mtf(const MtfCurve& curve, double field_deg, const std::string& remark = "") {
    FieldMtf mtf{.field_deg = field_deg, .remark = remark};
    if (curve.status != PupilStatus::ok) {
        mtf.remark = status_remark(curve.status);
        return mtf;
    }
    for (std::size_t i = 0; i < curve.frequency.size(); ++i) {
        mtf.tangential.push_back({curve.frequency[i], curve.tangential[i]});
        mtf.sagittal.push_back({curve.frequency[i], curve.sagittal[i]});
    }
    return mtf;
}

}  // namespace

PsfMap psf_map(const PolychromaticField& field, double field_deg) {
    PsfMap map{.field_deg = field_deg};
    Psf psf = fft_psf(field);
    if (psf.status == PupilStatus::aliased && psf.needed_size <= kLargestPsf) {
        psf = fft_psf(field, {.size = psf.needed_size});
    }
    if (psf.status != PupilStatus::ok) {
        map.remark = status_remark(psf.status);
        return map;
    }
    constexpr double kAiryPixels = 2.44;  // of its radius at λ / (2 D) a pixel
    const double wanted = std::max(8.0 * kAiryPixels, 1.2 * psf.largest_aberration_um / psf.pixel_um);
    const int half = std::min(psf.size / 2 - 1, static_cast<int>(std::ceil(wanted)));
    map.intensity = {.size = static_cast<std::size_t>(2 * half + 1), .half_width = (half + 0.5) * psf.pixel_um};
    const int middle = psf.size / 2;
    for (int row = middle - half; row <= middle + half; ++row) {
        for (int column = middle - half; column <= middle + half; ++column) {
            map.intensity.values.push_back(psf.at(row, column) / psf.perfect_peak);
        }
    }
    map.strehl = psf.strehl;
    return map;
}

FieldMtf resolved_mtf(const PolychromaticField& field, std::span<const double> frequencies, double field_deg) {
    const MtfCurve curve = diffraction_mtf(field, frequencies);
    return curve.status == PupilStatus::ok ? field_mtf(curve, field_deg)
                                           : field_mtf(ray_mtf(field, frequencies), field_deg, "by rays");
}

FieldMtf diffraction_limited_mtf(const PolychromaticField& field, std::span<const double> frequencies,
                                 double field_deg) {
    return field_mtf(diffraction_mtf(field, frequencies, MtfKind::diffraction_limited), field_deg);
}

std::vector<double> shown_frequencies(const PolychromaticField& axis) {
    const double highest = std::min(kHighestFrequency, cutoff_frequency(axis));
    std::vector<double> frequencies;
    frequencies.reserve(kFrequencies);
    for (std::size_t i = 0; i < kFrequencies; ++i) {
        frequencies.push_back(highest * static_cast<double>(i) / (kFrequencies - 1));
    }
    return frequencies;
}

namespace {

std::vector<FrequencyMtf> mtf_over_field(const optics::Lens& lens, AnalysisSettings settings, int threads) {
    std::vector<FrequencyMtf> curves;
    curves.reserve(std::size(kShownFrequencies));
    for (const double frequency : kShownFrequencies) {
        curves.push_back({.cycles_per_mm = frequency});
    }
    settings.fields_deg = even_fields(largest_field_deg(settings), kMtfFields);
    const auto fields = polychromatic_fields(lens, settings);
    std::vector<FieldMtf> mtf(fields.size());
    const auto compute = [&](int i) {
        const double field_deg = settings.fields_deg[i];
        mtf[i] = fields[i] ? resolved_mtf(*fields[i], kShownFrequencies, field_deg) : FieldMtf{.field_deg = field_deg};
    };
    parallel_for(static_cast<int>(fields.size()), threads, compute, [](int) {});
    for (const FieldMtf& field : mtf) {
        for (std::size_t k = 0; k < curves.size(); ++k) {
            const bool is_known = !field.tangential.empty();
            curves[k].tangential.push_back({field.field_deg, is_known ? field.tangential[k].y : kNaN});
            curves[k].sagittal.push_back({field.field_deg, is_known ? field.sagittal[k].y : kNaN});
        }
    }
    return curves;
}

}  // namespace

WaveCurves wave_curves(const optics::Lens& lens, const AnalysisSettings& settings, int threads) {
    WaveCurves curves;
    // Frequencies and the pupil's unit are the axis's, or those of the first field with light.
    AnalysisSettings axis_first = settings;
    axis_first.fields_deg.insert(axis_first.fields_deg.begin(), 0.0);
    auto candidates = polychromatic_fields(lens, axis_first);
    const auto lit = std::ranges::find_if(candidates, [](const auto& field) { return field.has_value(); });
    const std::optional<PolychromaticField> axis = lit != candidates.end() ? std::move(*lit) : std::nullopt;
    if (!axis) {
        for (const double field_deg : settings.fields_deg) {
            curves.wavefronts.push_back({.field_deg = field_deg});
            curves.psfs.push_back({.field_deg = field_deg});
            curves.mtf.push_back({.field_deg = field_deg});
            curves.geometric_mtf.push_back({.field_deg = field_deg});
        }
        return curves;
    }
    const std::vector<double> frequencies = shown_frequencies(*axis);
    curves.diffraction_limit = diffraction_limited_mtf(*axis, frequencies, 0.0).tangential;
    const double axial_radius = 0.5 * cosine_box(*axis, axis->parts.front()).width();
    AnalysisSettings at_reference = settings;
    at_reference.wavelengths_nm.assign(1, settings.reference_wavelength_nm);
    const auto reference_fields = polychromatic_fields(lens, at_reference);
    const auto fields = polychromatic_fields(lens, settings);
    curves.wavefronts.resize(fields.size());
    curves.psfs.resize(fields.size());
    curves.mtf.resize(fields.size());
    curves.geometric_mtf.resize(fields.size());
    const auto compute = [&](int i) {
        const double field_deg = settings.fields_deg[i];
        const auto& field = fields[i];
        const auto& reference = reference_fields[i];
        curves.wavefronts[i] =
            reference ? field_wavefront(*reference, reference->parts.front(), field_deg, axial_radius, settings.rings)
                      : FieldWavefront{.field_deg = field_deg};
        curves.psfs[i] = field ? psf_map(*field, field_deg) : PsfMap{.field_deg = field_deg};
        curves.mtf[i] = field ? resolved_mtf(*field, frequencies, field_deg) : FieldMtf{.field_deg = field_deg};
        curves.geometric_mtf[i] = field_mtf(field ? ray_mtf(*field, frequencies) : MtfCurve{}, field_deg);
    };
    parallel_for(static_cast<int>(fields.size()), threads, compute, [](int) {});
    curves.mtf_over_field = mtf_over_field(lens, settings, threads);
    return curves;
}

}  // namespace lensproof::analysis
