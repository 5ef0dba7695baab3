// Between NumPy arrays and matrices.
#pragma once

#include <pybind11/complex.h>
#include <pybind11/numpy.h>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk::python {

/// A complex128 array in C order.  The Python half of the module sees to it that no argument needs
/// a conversion.
using Array = pybind11::array_t<Complex, pybind11::array::c_style>;

/// Returns a new array with the entries of W.
inline Array copy_of(const Matrix& W) {
  Array result({W.rows(), W.cols()});
  Eigen::Map<Matrix>(result.mutable_data(), W.rows(), W.cols()) = W;
  return result;
}

/// Returns the entries of a square array as a matrix.
inline Matrix matrix_of(const Array& W) {
  return Eigen::Map<const Matrix>(W.data(), W.shape(0), W.shape(1));
}

}  // namespace isosyrk::python
