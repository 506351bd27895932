// experiments/python/array.h — arrays of Python's, NumPy's say, used where they lie.
#pragma once
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "experiments/python/bridge.h"

namespace lensproof::python {

/// One dimension of numbers of `T`'s size, held for as long as this lives, through the buffer protocol. Throws
/// PythonError for what is no such thing, std::invalid_argument for numbers of another size.
template <class T>
class Array {
  public:
    /// `access`: PyBUF_WRITABLE, or 0 where it is read alone.
    explicit Array(const bridge::handle& object, int access = 0) {
        if (PyObject_GetBuffer(object.ptr(), &view_, PyBUF_STRIDES | access) != 0) {
            throw PythonError();
        }
        if (view_.ndim != 1 || view_.itemsize != static_cast<Py_ssize_t>(sizeof(T))) {
            PyBuffer_Release(&view_);
            throw std::invalid_argument("an array of another shape or type than expected");
        }
    }
    ~Array() { PyBuffer_Release(&view_); }
    Array(const Array&) = delete;
    Array& operator=(const Array&) = delete;

    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(view_.shape[0]); }
    [[nodiscard]] std::ptrdiff_t stride() const { return view_.strides[0]; }
    [[nodiscard]] const char* bytes() const { return static_cast<const char*>(view_.buf); }

    /// For at least `least` numbers in a row, aligned to `alignment` bytes. Throws std::invalid_argument for others.
    [[nodiscard]] T* row(std::size_t least, std::size_t alignment = alignof(T)) const {
        if (size() < least || (size() > 1 && stride() != static_cast<std::ptrdiff_t>(sizeof(T))) ||
            reinterpret_cast<std::uintptr_t>(view_.buf) % alignment != 0) {
            throw std::invalid_argument("an array that is shorter, or lies in memory otherwise, than expected");
        }
        return static_cast<T*>(view_.buf);
    }

  private:
    Py_buffer view_{};
};

}  // namespace lensproof::python
