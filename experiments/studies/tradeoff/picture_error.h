// experiments/studies/tradeoff/picture_error.h — how far a model's pictures are from the lens's, apart from noise.
#pragma once
#include <vector>

#include "engine/formats/image/image.h"
#include "experiments/studies/tradeoff/measured.h"

namespace lensproof::studies {

/// The mean over a picture of a difference that one sees, in two parts.
struct SeenDifference {
    Measured bias;       // what is left however many samples are taken
    double noise = 0.0;  // what the samples' noise alone makes of it
};
void fields(JsonArchive& json, SeenDifference& difference);

struct PictureErrors {
    SeenDifference ciede2000;
    SeenDifference flip;
    Measured exposure_ev;  // of the whole picture's luminance, over the reference's
};
void fields(JsonArchive& json, PictureErrors& errors);

/// Pictures of the model and of the reference, linear RGB alike, each of a seed of its own, at least two of both and as
/// many of the one as of the other.
///
/// Let d1 and d2 be the mean differences model − reference of the even and of the odd seeds, and b the mean of all
/// pictures. The pair b ± (d1 + d2)/4 are the means of model and reference: a metric q of it sees bias and noise. The
/// pair b ± (d1 − d2)/4 has the same noise, in each picture and in their difference, and no bias. Where q² is quadratic
/// in small differences, q² of the one less q² of the other has the bias's own for its expectation. Of the maps S and N
/// of q for the two pairs, `noise` is the mean of N, and `bias` the mean of S times √(1 − ⟨N²⟩/⟨S²⟩), 0 where that is
/// no number. (FLIP is no such metric where it saturates; there noise is small beside the bias.) Standard errors are
/// those of the jackknife over the picture's blocks.
PictureErrors picture_errors(const std::vector<formats::Image>& model, const std::vector<formats::Image>& reference,
                             int threads);

/// A picture's noise as its seeds show it: root mean square over pixels of the standard error of the luminance over its
/// mean, where a pixel darker than a hundredth of the picture's mean counts as that bright (as render::RenderGoal has
/// it).
double relative_noise(const std::vector<formats::Image>& pictures);

}  // namespace lensproof::studies
