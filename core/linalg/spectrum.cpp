#include "isosyrk/linalg/spectrum.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <stdexcept>

#include "isosyrk/linalg/products.h"

namespace isosyrk {

RealVector spectrum(const Matrix& W) {
  if (W.rows() != W.cols() || !W.allFinite()) {
    throw std::invalid_argument(
        fmt::format("spectrum: W is {} x {}; must be square and finite", W.rows(), W.cols()));
  }
  const Complex minus_half_i(0.0, -0.5);
  Matrix hermitian = minus_half_i * (W - W.adjoint());
  const auto n = static_cast<lapack_int>(W.rows());
  RealVector eigenvalues(W.rows());
  // Read by columns, the array is the transpose, which has the same eigenvalues.  The lower
  // triangle is used because of a bug in OpenBLAS 0.3.21: with the upper one, its zgemv kernel for
  // AVX2, called by zhetrd, reads past the end of the array.
  const lapack_int info = LAPACKE_zheevd(LAPACK_COL_MAJOR, 'N', 'L', n,
                                         hermitian.data(), n, eigenvalues.data());
  if (info != 0) throw std::runtime_error(fmt::format("spectrum: zheevd failed ({})", info));
  return eigenvalues;
}

double spectrum_error(const Matrix& W, const Matrix& V) {
  return (spectrum(W) - spectrum(V)).cwiseAbs().maxCoeff();
}

double spectral_norm(const Matrix& W) { return spectrum(W).cwiseAbs().maxCoeff(); }

Complex casimir(const Matrix& W, int k) {
  if (k < 1) throw std::invalid_argument(fmt::format("casimir: k = {}, must be at least 1", k));
  Products products(ProductBackend::eigen, W.rows());
  Matrix power = W;
  Matrix next(W.rows(), W.cols());
  for (int i = 1; i < k; ++i) {
    products.multiply(power, W, next);
    power.swap(next);
  }
  return power.trace();
}

double skew_defect(const Matrix& W) { return (W + W.adjoint()).cwiseAbs().maxCoeff(); }

}  // namespace isosyrk
