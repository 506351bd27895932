// engine/optics/multiprecision.h — the number type that judges the others.
#pragma once
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace lensproof::optics {

/// A hundred decimal digits, in software (Boost.Multiprecision). Without expression templates, so that the tracer's
/// `auto` and `select` see numbers. About a thousand times slower than double.
using Multiprecision =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

}  // namespace lensproof::optics
