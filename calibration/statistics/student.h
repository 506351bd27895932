// calibration/statistics/student.h — intervals for errors that were themselves estimated.
#pragma once

namespace lensproof::calibration {

/// Half the width of a 95 % interval in standard errors that rest on `freedom` > 0 degrees of freedom: Student's t.
double student_95(double freedom);

}  // namespace lensproof::calibration
