// The matrix type of the whole project, and the few scalars taken from one.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace isosyrk {

using Complex = std::complex<double>;
using Index = Eigen::Index;

/// Complex matrix, stored by rows: row i, columns i..n-1, then holds entry i of every diagonal
/// (i, i+m), m >= 0, next to one another, which is what the Poisson solve runs over.
using Matrix = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// A view of complex numbers that belong to the caller, stored by rows: of a Matrix, of a block of
/// one, or of a Map of any memory.  A matrix stored by columns does not convert to it.
using MatrixView = Eigen::Ref<Matrix>;
using RealMatrix = Eigen::MatrixXd;
using RealVector = Eigen::VectorXd;

/// The most stages a tableau may have; Gauss tableaux are computed to the last digit up to here.
inline constexpr int max_stages = 20;

/// The larger of two numbers, and NaN if either is: std::max would drop a NaN in its second
/// argument, and with it the only sign of a diverged iteration.
inline double larger(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::quiet_NaN();
  return std::max(a, b);
}

}  // namespace isosyrk
