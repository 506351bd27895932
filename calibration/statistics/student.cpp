#include "calibration/statistics/student.h"

#include <boost/math/distributions/students_t.hpp>

namespace lensproof::calibration {

double student_95(double freedom) {
    return boost::math::quantile(boost::math::students_t(freedom), 0.975);
}

}  // namespace lensproof::calibration
