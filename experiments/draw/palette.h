// experiments/draw/palette.h — the colours that drawings on white share.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace lensproof::draw {

inline constexpr const char* kInk = "#2b2f36";
inline constexpr const char* kQuiet = "#5f6672";
inline constexpr const char* kFaint = "#c3c8d0";
inline constexpr const char* kGridLine = "#e4e7ec";

/// Okabe & Ito's blue, green and purple, the last one darkened: told apart by the colour-blind, and none is a
/// finding's.
inline constexpr std::array kFieldColours = {"#0072b2", "#009e73", "#a3478c"};

/// Colours of curves that have no natural one, in turn: blue, vermilion, green, purple, ochre, sky blue, brown and
/// grey after Okabe & Ito (Color Universal Design, 2008), darkened to at least 3:1 contrast on white.
std::string series_colour(std::size_t index);

/// "#rrggbb" for a spectral line, as charts of lenses have them: near to what the eye sees at that wavelength, and dark
/// enough for white paper (at least 3.5:1). g is violet, F blue, e green, d dark yellow, C red; infrared lines turn
/// brown and darker with the wavelength, so that they differ from each other. What is no wavelength is grey.
std::string wavelength_colour(double wavelength_nm);

}  // namespace lensproof::draw
