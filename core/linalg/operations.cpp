#include "isosyrk/linalg/operations.h"

namespace isosyrk {
namespace {

// `Length` consecutive real numbers of a matrix.
template <int Length>
using Piece = Eigen::Array<double, Length, 1>;

template <int Length>
Piece<Length> load(const Matrix& X, Index at) {
  return Eigen::Map<const Piece<Length>>(reals(X).data() + at);
}

template <int Length, class Coefficients>
void update_piece(const Matrix& base, const Coefficients& c, const std::vector<Matrix>& Y,
                  std::vector<Matrix>& X, Index at, Piece<Length>* squares) {
  const Index s = c.rows();
  Piece<Length> y[Coefficients::MaxRowsAtCompileTime];
  for (Index j = 0; j < s; ++j) y[j] = load<Length>(Y[static_cast<std::size_t>(j)], at);
  for (Index i = 0; i < s; ++i) {
    Piece<Length> fresh = load<Length>(base, at);
    for (Index j = 0; j < s; ++j) fresh += c(i, j) * y[j];
    Matrix& X_i = X[static_cast<std::size_t>(i)];
    squares[i] += (fresh - load<Length>(X_i, at)).square();
    Eigen::Map<Piece<Length>>(reals(X_i).data() + at) = fresh;
  }
}

// Implements update_unknowns for s = Size, unrolled by the compiler, or any s (Eigen::Dynamic).
template <int Size>
void update_all(const Matrix& base, double h, const RealMatrix& a, const std::vector<Matrix>& Y,
                std::vector<Matrix>& X, double* squares) {
  constexpr int most = Size == Eigen::Dynamic ? max_stages : Size;
  const Eigen::Matrix<double, Size, Size, Eigen::ColMajor, most, most> c = h * a;
  const Index end = 2 * base.size();
  constexpr int length = 8;
  constexpr int rest = 2;  // 2n² is even
  Piece<length> sums[most];
  Piece<rest> rest_sums[most];
  for (Index i = 0; i < c.rows(); ++i) {
    sums[i].setZero();
    rest_sums[i].setZero();
  }
  Index at = 0;
  for (; at + length <= end; at += length) update_piece<length>(base, c, Y, X, at, sums);
  for (; at < end; at += rest) update_piece<rest>(base, c, Y, X, at, rest_sums);
  for (Index i = 0; i < c.rows(); ++i) squares[i] = sums[i].sum() + rest_sums[i].sum();
}

// Sets X(r, c) = fresh(r, c) for all entries and returns Σ |change of X|².
template <class Fresh>
double replace(Matrix& X, const Fresh& fresh) {
  double change = 0.0;
  for (Index r = 0; r < X.rows(); ++r) {
    double change_of_row = 0.0;
    for (Index c = 0; c < X.cols(); ++c) {
      const Complex value = fresh(r, c);
      change_of_row += std::norm(value - X(r, c));
      X(r, c) = value;
    }
    change += change_of_row;
  }
  return change;
}

}  // namespace

void update_unknowns(const Matrix& base, double h, const RealMatrix& a,
                     const std::vector<Matrix>& Y, std::vector<Matrix>& X, double* squares) {
  switch (Y.size()) {
    case 1:
      return update_all<1>(base, h, a, Y, X, squares);
    case 2:
      return update_all<2>(base, h, a, Y, X, squares);
    case 3:
      return update_all<3>(base, h, a, Y, X, squares);
    default:
      return update_all<Eigen::Dynamic>(base, h, a, Y, X, squares);
  }
}

double update_stage_vorticity(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& S,
                              const Matrix& Y, Matrix& scratch, Matrix& W) {
  if (algebra.is_skew_hermitian()) {
    return replace(W, [&](Index r, Index c) { return W0(r, c) + (S(r, c) - std::conj(Y(c, r))); });
  }
  algebra.involution(Y, scratch);
  return replace(W, [&](Index r, Index c) { return W0(r, c) + (S(r, c) - scratch(r, c)); });
}

double update_midpoint_vorticity(const QuadraticAlgebra& algebra, const Matrix& W0, double a,
                                 const Matrix& M, double b, const Matrix& MB, Matrix& scratch,
                                 Matrix& W) {
  if (algebra.is_skew_hermitian()) {
    return replace(W, [&](Index r, Index c) {
      return W0(r, c) + a * (M(r, c) - std::conj(M(c, r))) + b * MB(r, c);
    });
  }
  algebra.involution(M, scratch);
  return replace(
      W, [&](Index r, Index c) { return W0(r, c) + a * (M(r, c) - scratch(r, c)) + b * MB(r, c); });
}

void commutator_of_product(const QuadraticAlgebra& algebra, const Matrix& C, Matrix& scratch,
                           Matrix& out) {
  if (algebra.is_skew_hermitian()) {
    out = C - C.adjoint();
    return;
  }
  algebra.involution(C, scratch);
  out = C - scratch;
}

void add_commutator(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& C,
                    Matrix& scratch, Matrix& out) {
  commutator_of_product(algebra, C, scratch, out);
  out += W0;
}

}  // namespace isosyrk
