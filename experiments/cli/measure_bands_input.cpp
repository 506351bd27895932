// experiments/cli/measure_bands_input.cpp — `measure --bands`: pictures of one scene, each in its own narrow band.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "calibration/chromatic/mosaic.h"
#include "calibration/measure/measure_bands.h"
#include "engine/base/input_error.h"
#include "engine/formats/image/photo.h"
#include "experiments/cli/measure_parts.h"

namespace lensproof::cli {

namespace {

double parse_wavelength(const std::string& text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value > 0.0) || !std::isfinite(value)) {
        throw InputError(fmt::format("--bands: found \"{}\", expected a wavelength in nm", text));
    }
    return value;
}

// A raw mosaic holds the sensor's own, linear values, unless it is said otherwise.
calibration::BandPlanes read_mosaic(const std::string& file, calibration::MosaicPattern pattern,
                                    const std::optional<formats::TransferCurve>& curve) {
    const formats::Image image =
        formats::read_photo(file, curve.value_or(formats::TransferCurve{.kind = formats::TransferKind::linear}));
    try {
        return {calibration::mosaic_plane(image, pattern), calibration::mosaic_colours(image, pattern)};
    } catch (const InputError& e) {
        throw InputError(fmt::format("{}: {}", file, e.what()));
    }
}

}  // namespace

calibration::Profile run_bands(const MeasureOptions& options, const calibration::ProfileSource& source) {
    calibration::BandInput input{.name = "bands",
                                 .bands = {},
                                 .reference_wavelength_nm = options.reference_band_nm,
                                 .chart = {},
                                 .centre_px = {},
                                 .source = source,
                                 .pixel_pitch_um = {}};
    const std::optional<formats::TransferCurve> curve = formats::parse_transfer_curve(options.transfer);
    for (const std::string& band : options.bands) {
        const std::size_t sign = band.find('=');
        if (sign == std::string::npos || sign + 1 == band.size()) {
            throw InputError(fmt::format("--bands: found \"{}\", expected NM=FILE", band));
        }
        const std::string file = band.substr(sign + 1);
        const auto pattern = calibration::mosaic_pattern(options.mosaic);
        input.bands.push_back({.wavelength_nm = parse_wavelength(band.substr(0, sign)), .name = file, .load = [=] {
                                   return pattern ? read_mosaic(file, *pattern, curve)
                                                  : calibration::BandPlanes{formats::read_photo(file, curve)};
                               }});
    }
    if (!options.chart.empty()) {
        input.chart = chart_to_find(options.chart);
    }
    if (!options.image_centre_px.empty()) {
        input.centre_px = Vec2d{options.image_centre_px[0], options.image_centre_px[1]};
    }
    if (options.pixel_pitch_um > 0.0) {
        input.pixel_pitch_um = options.pixel_pitch_um;
    }
    return calibration::measure_bands(input);
}

}  // namespace lensproof::cli
