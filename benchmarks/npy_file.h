// Matrices as NumPy writes and reads them.  Source: numpy.lib.format.
#pragma once

#include <string>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// W in NumPy's .npy format 1.0: complex128, C order, n x n.
std::string npy(const Matrix& W);

/// Reads an n x n matrix from a .npy file of format 1.0 or 2.0: complex128, in C or Fortran order.
/// Throws std::invalid_argument, which says what was found but not in which file, for anything
/// else.
Matrix read_npy(const std::string& path, Index n);

}  // namespace isosyrk
