// engine/base/bisect.h — where something ends, by halving.
#pragma once

namespace lensproof {

/// Two numbers, the larger of which may be either: something holds at `inside` and does not at `outside`.
struct Bracket {
    double inside = 0.0;
    double outside = 0.0;
};

/// The bracket after so many halvings by what holds(number) says; its ends themselves are not asked about.
template <class Holds>
Bracket bisected(Bracket bracket, int halvings, const Holds& holds) {
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (bracket.inside + bracket.outside);
        (holds(middle) ? bracket.inside : bracket.outside) = middle;
    }
    return bracket;
}

}  // namespace lensproof
