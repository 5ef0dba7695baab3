#include "isosyrk/linalg/spectral_projection.h"

#include <lapacke.h>

#include <cmath>
#include <limits>

namespace isosyrk {

// Lengths of the workspace as LAPACK documents them, with blocks of 64 columns for zhetrd.
SpectralProjection::SpectralProjection(const QuadraticAlgebra& algebra, ProductBackend backend)
    : block_(algebra.block()), products_(backend, algebra.block()) {
  hermitian_ = rows_ = scratch_ = product_ = Matrix::Zero(block_, block_);
  values_.resize(block_);
  const auto b = static_cast<std::size_t>(block_);
  work_.resize(66 * b);
  real_work_.resize(24 * b);
  integer_work_.resize(10 * b);
  support_.resize(2 * b);
}

// Finds Λ of the block that begins in row `at`, and R.
bool SpectralProjection::decompose(const Matrix& W, Index at, bool vectors) {
  const auto block = W.block(at, at, block_, block_);
  if (!block.allFinite()) return false;
  // In units of a power of two, so that the digits do not depend on the scale of W.
  const double largest =
      std::max(block.real().cwiseAbs().maxCoeff(), block.imag().cwiseAbs().maxCoeff());
  int exponent = 0;
  std::frexp(largest, &exponent);
  const Complex minus_half_i(0.0, -0.5);
  hermitian_ = minus_half_i * std::ldexp(1.0, -exponent) * (block - block.adjoint());
  // Read by columns, the array is conj(-iW) = V Λ V†.  Read by rows, the V that LAPACK leaves is
  // R = Vᵀ.  The lower triangle, as in spectrum().
  const auto b = static_cast<lapack_int>(block_);
  const auto length = [](const auto& workspace) {
    return static_cast<lapack_int>(workspace.size());
  };
  lapack_int found = 0;
  const lapack_int info = LAPACKE_zheevr_work(
      LAPACK_COL_MAJOR, vectors ? 'V' : 'N', 'A', 'L', b, hermitian_.data(), b, 0.0, 0.0, 0, 0, 0.0,
      &found, values_.data(), rows_.data(), b, support_.data(), work_.data(), length(work_),
      real_work_.data(), length(real_work_), integer_work_.data(), length(integer_work_));
  values_ *= std::ldexp(1.0, exponent);
  return info == 0 && found == b;
}

// R ← ½ (3 I - R R†) R, a Newton step to the nearest unitary matrix: zheevr leaves R R† - I of some
// n times rounding.
void SpectralProjection::make_unitary() {
  products_.multiply_adjoint_right(rows_, rows_, product_);
  product_ *= -0.5;
  product_.diagonal().array() += 1.5;
  products_.multiply(product_, rows_, scratch_);
  rows_.swap(scratch_);
}

bool SpectralProjection::find_spectrum(const Matrix& W, RealVector& eigenvalues) {
  for (Index at = 0; at < W.rows(); at += block_) {
    if (!decompose(W, at, false)) {
      eigenvalues.setConstant(std::numeric_limits<double>::quiet_NaN());
      return false;
    }
    eigenvalues.segment(at, block_) = values_;
  }
  return true;
}

bool SpectralProjection::project(const RealVector& eigenvalues, Matrix& W) {
  if (!eigenvalues.allFinite() || !W.allFinite()) return false;
  const Complex half_i(0.0, 0.5);
  double distance = 0.0;
  for (Index at = 0; at < W.rows(); at += block_) {
    if (!decompose(W, at, true)) return false;
    // Of matrices of any norm, whose squares may overflow.
    const double of_block = (values_ - eigenvalues.segment(at, block_)).stableNorm();
    distance = std::hypot(distance, of_block);
    make_unitary();
    scratch_ = eigenvalues.segment(at, block_).asDiagonal() * rows_;
    products_.multiply_adjoint_left(rows_, scratch_, product_);
    W.block(at, at, block_, block_) = half_i * (product_ + product_.adjoint());
  }
  distance_ = distance;
  return true;
}

}  // namespace isosyrk
