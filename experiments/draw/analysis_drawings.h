// experiments/draw/analysis_drawings.h — every drawing and picture of an analysis, by the name of its file.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "engine/formats/image/image.h"
#include "engine/optics/prescription.h"
#include "experiments/draw/analysis_plots.h"

namespace lensproof::draw {

/// How wide a pixel of the PSF is.
double pixel_um(const analysis::PsfMap& psf);

/// "psf_12deg.exr": the field to six digits, so that a field whose arithmetic ends in 24.000000000000004 is 24.
std::string psf_file_name(const analysis::PsfMap& psf);

/// The PSF as a picture of one channel "Y", y upwards, in units of the perfect lens's peak; `pixel_um`, `field_deg` and
/// `strehl` are its attributes. Nothing where there is no PSF.
std::optional<formats::Image> psf_image(const analysis::PsfMap& psf);

/// The drawings by file name.
std::map<std::string, std::string> analysis_drawings(const PlotHeading& heading, optics::Projection projection,
                                                     const analysis::RayCurves& curves,
                                                     const analysis::WaveCurves& waves);

}  // namespace lensproof::draw
