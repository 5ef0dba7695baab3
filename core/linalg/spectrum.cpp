#include "isosyrk/linalg/spectrum.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

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
  const lapack_int info =
      LAPACKE_zheevd(LAPACK_COL_MAJOR, 'N', 'L', n, hermitian.data(), n, eigenvalues.data());
  if (info != 0) throw std::runtime_error(fmt::format("spectrum: zheevd failed ({})", info));
  return eigenvalues;
}

double spectrum_error(const Matrix& W, const Matrix& V) {
  return (spectrum(W) - spectrum(V)).cwiseAbs().maxCoeff();
}

namespace {

// The eigenvalues of any square matrix, in no order.
std::vector<Complex> eigenvalues(Matrix W) {
  const auto n = static_cast<lapack_int>(W.rows());
  std::vector<Complex> values(static_cast<std::size_t>(n));
  const lapack_int info = LAPACKE_zgeev(LAPACK_COL_MAJOR, 'N', 'N', n, W.data(), n, values.data(),
                                        nullptr, 1, nullptr, 1);
  if (info != 0) throw std::runtime_error(fmt::format("eigenvalues: zgeev failed ({})", info));
  return values;
}

}  // namespace

double spectrum_error(const QuadraticAlgebra& algebra, const Matrix& W, const Matrix& V) {
  double error = 0.0;
  if (algebra.is_skew_hermitian()) {
    const Index b = algebra.block();
    for (Index at = 0; at < W.rows(); at += b) {
      error = larger(error, spectrum_error(W.block(at, at, b, b), V.block(at, at, b, b)));
    }
    return error;
  }
  if (!W.allFinite() || !V.allFinite()) {
    throw std::invalid_argument("spectrum: W must be square and finite");
  }
  std::vector<Complex> left = eigenvalues(W);
  for (const Complex value : eigenvalues(V)) {
    const auto nearest = std::min_element(left.begin(), left.end(), [&](Complex a, Complex b) {
      return std::abs(a - value) < std::abs(b - value);
    });
    error = larger(error, std::abs(*nearest - value));
    left.erase(nearest);
  }
  return error;
}

double spectral_norm(const Matrix& W) { return spectrum(W).cwiseAbs().maxCoeff(); }

double operator_norm(const Matrix& B) {
  const double scale = B.cwiseAbs().maxCoeff();
  if (scale == 0.0) return 0.0;
  const Matrix unit = B / scale;
  // i B†B is skew-Hermitian.
  return scale * std::sqrt(spectral_norm(Complex(0.0, 1.0) * unit.adjoint().lazyProduct(unit)));
}

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
