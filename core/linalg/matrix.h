// The matrix type of the project, and scalar types that go with it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace isosyrk {

using Complex = std::complex<double>;
using Index = Eigen::Index;

/// Matrix of real or complex numbers, stored by rows.  Columns i..n-1 of row i are then entry i of
/// every diagonal (i, i+m), m >= 0, contiguous in memory.  The Poisson solve runs over these.
template <class Scalar>
using MatrixOf = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Matrix = MatrixOf<Complex>;
/// View of the caller's complex numbers, stored by rows: a Matrix, a block of a Matrix, or a Map of
/// any memory.  A matrix stored by columns does not convert to a MatrixView.
using MatrixView = Eigen::Ref<Matrix>;
/// The same to read from.  Other matrices of complex numbers are copied to one.
using ConstMatrixView = Eigen::Ref<const Matrix>;
using RealMatrix = Eigen::MatrixXd;
using RealVector = Eigen::VectorXd;

/// Returns the larger of two numbers, or NaN if either is NaN.  std::max drops a NaN in its second
/// argument, and a NaN is the only sign of a diverged iteration.
inline double larger(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::quiet_NaN();
  return std::max(a, b);
}

}  // namespace isosyrk
