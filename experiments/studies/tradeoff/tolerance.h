// experiments/studies/tradeoff/tolerance.h — how far a picture is off, and how far it may be.
#pragma once
#include <limits>
#include <string>

#include "experiments/studies/tradeoff/measured.h"

namespace lensproof::studies {

/// How far a picture is off, as a tolerance has it: px of the scene's own frame and EV, rms over it; mean CIEDE2000.
struct Contribution {
    Measured px;
    Measured ev;
    Measured ciede2000;
};

/// What may be wrong in a picture: where light is, rms over the frame; how bright, rms; in which colours, mean
/// CIEDE2000. Infinite where nothing is asked.
struct Tolerance {
    double px = std::numeric_limits<double>::infinity();
    double ev = std::numeric_limits<double>::infinity();
    double ciede2000 = std::numeric_limits<double>::infinity();
};

/// "0.5px,0.02ev,1de", each at most once and in any order, or "visible": a pixel, 0.03 EV (a contrast of 2 %, Weber's
/// fraction in daylight), one CIEDE2000. Throws InputError naming what is wrong.
Tolerance parse_tolerance(const std::string& text);

/// What a found contribution surely is, less two standard errors; and whether a contribution is within a tolerance,
/// with two standard errors of it.
Contribution surely(const Contribution& found);
bool keeps(const Contribution& found, const Tolerance& tolerance);

/// Its parts with two standard errors: "0.1 px, 0.02 EV", or "nothing".
std::string words_of(const Contribution& found);
/// Of these parts the ones that exceed a tolerance: "0.8 px where 0.5 may be"; empty where none does.
std::string excess(const Contribution& found, const Tolerance& tolerance);
/// The part that comes nearest to what may be, or exceeds it most, over that.
double over_tolerance(const Contribution& found, const Tolerance& tolerance);

/// Contributions that are left out together, with two standard errors each: places and colours add up as independent
/// errors do, exposures as they are.
class LeftOut {
  public:
    void add(const Contribution& more);
    [[nodiscard]] bool keeps(const Tolerance& tolerance) const;

  private:
    double px_ = 0.0;
    double ev_ = 0.0;
    double ciede2000_ = 0.0;
};

}  // namespace lensproof::studies
