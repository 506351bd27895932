// experiments/python/bridge.h — what is used of nanobind, or of pybind11 (Debian's) in its place: the two agree on the
// rest, under the name `bridge`.
#pragma once

#ifdef LENSPROOF_PYBIND11
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#define LENSPROOF_MODULE PYBIND11_MODULE

namespace lensproof::python {
namespace bridge = pybind11;
using PythonError = pybind11::error_already_set;
}  // namespace lensproof::python

#else
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#define LENSPROOF_MODULE NB_MODULE

namespace lensproof::python {
namespace bridge = nanobind;
using PythonError = nanobind::python_error;
}  // namespace lensproof::python
#endif
