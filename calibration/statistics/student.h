// calibration/statistics/student.h — intervals for errors that were themselves estimated.
#pragma once
#include "calibration/statistics/curve.h"

namespace lensproof::calibration {

/// Half the width of a 95 % interval in standard errors that rest on `freedom` degrees of freedom: Student's t, by its
/// expansion around the normal distribution (Abramowitz & Stegun 26.7.5), 2e-4 from the tables for 6 and more.
inline double student_95(double freedom) {
    const double z = k95;
    const double z2 = z * z;
    const double g1 = z * (z2 + 1.0) / 4.0;
    const double g2 = z * (3.0 + z2 * (16.0 + z2 * 5.0)) / 96.0;
    const double g3 = z * (-15.0 + z2 * (17.0 + z2 * (19.0 + z2 * 3.0))) / 384.0;
    const double v = 1.0 / freedom;
    return z + v * (g1 + v * (g2 + v * g3));
}

}  // namespace lensproof::calibration
