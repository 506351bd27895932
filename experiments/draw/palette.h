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

/// How the rays of a field are drawn.
struct FieldLine {
    const char* colour;
    const char* dashes;  // as SvgStyle has them; empty: a solid line
};

/// Of the field with that index from 0. Eight colours that trichromats and dichromats of each kind tell apart (in
/// CIELAB 23 at least, simulated after Machado, Oliveira & Fernandes 2009), none of them a finding's. Printed in grey,
/// four of them are told apart by their lightness, and those beyond them by dashes: from the fifth on lines are dashed,
/// from the ninth dotted in the colours of the first.
FieldLine field_line(std::size_t index);

/// Colours of curves that have no natural one, in turn: blue, vermilion, green, purple, ochre, sky blue, brown and
/// grey after Okabe & Ito (Color Universal Design, 2008), darkened to at least 3:1 contrast on white.
std::string series_colour(std::size_t index);

/// "#rrggbb" for a spectral line, as charts of lenses have them: near to what the eye sees at that wavelength, and dark
/// enough for white paper (at least 3.5:1). g is violet, F blue, e green, d dark yellow, C red; infrared lines turn
/// brown and darker with the wavelength, so that they differ from each other. What is no wavelength is grey.
std::string wavelength_colour(double wavelength_nm);

}  // namespace lensproof::draw
