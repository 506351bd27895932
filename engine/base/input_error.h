// engine/base/input_error.h — what is said when an input cannot be used.
#pragma once
#include <stdexcept>
#include <string>

namespace lensproof {

/// A command line or a file that cannot be used: the program says `what()` and ends with exit status 2.
///
/// Thrown while inputs are read and checked, never while rays are traced. The message names the file, the line or key,
/// what was found and what is expected: "lenses/my.toml:12: surfaces[3].semi_diameter_mm is -15: expected a positive
/// length".
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace lensproof
