#include "isosyrk/integrators/stage_equations.h"

namespace isosyrk {
namespace {

// `Length` consecutive real numbers of a matrix.
template <int Length>
using Piece = Eigen::Array<double, Length, 1>;

template <int Length, class Scalar>
Piece<Length> load(const MatrixOf<Scalar>& X, Index at) {
  return Eigen::Map<const Piece<Length>>(reals(X).data() + at);
}

template <int Length, class Coefficients, class Scalar>
void update_piece(const MatrixOf<Scalar>& base, const Coefficients& c,
                  const std::vector<MatrixOf<Scalar>>& Y, std::vector<MatrixOf<Scalar>>& X,
                  Index at, Piece<Length>* squares) {
  const Index s = c.rows();
  Piece<Length> y[Coefficients::MaxRowsAtCompileTime];
  for (Index j = 0; j < s; ++j) y[j] = load<Length>(Y[static_cast<std::size_t>(j)], at);
  for (Index i = 0; i < s; ++i) {
    Piece<Length> fresh = load<Length>(base, at);
    for (Index j = 0; j < s; ++j) fresh += c(i, j) * y[j];
    MatrixOf<Scalar>& X_i = X[static_cast<std::size_t>(i)];
    squares[i] += (fresh - load<Length>(X_i, at)).square();
    Eigen::Map<Piece<Length>>(reals(X_i).data() + at) = fresh;
  }
}

// Implements update_unknowns for s = Size, unrolled by the compiler, or any s (Eigen::Dynamic).
template <int Size, class Scalar>
void update_all(const MatrixOf<Scalar>& base, double h, const RealMatrix& a,
                const std::vector<MatrixOf<Scalar>>& Y, std::vector<MatrixOf<Scalar>>& X,
                double* squares) {
  constexpr int most = Size == Eigen::Dynamic ? max_stages : Size;
  const Eigen::Matrix<double, Size, Size, Eigen::ColMajor, most, most> c = h * a;
  const Index end = reals(base).size();
  constexpr int length = 8;
  constexpr int rest = std::is_same_v<Scalar, double> ? 1 : 2;
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
template <class Scalar, class Fresh>
double replace(MatrixOf<Scalar>& X, const Fresh& fresh) {
  double change = 0.0;
  for (Index r = 0; r < X.rows(); ++r) {
    double change_of_row = 0.0;
    for (Index c = 0; c < X.cols(); ++c) {
      const Scalar value = fresh(r, c);
      change_of_row += Eigen::numext::abs2(value - X(r, c));
      X(r, c) = value;
    }
    change += change_of_row;
  }
  return change;
}

}  // namespace

template <class Scalar>
void update_unknowns(const MatrixOf<Scalar>& base, double h, const RealMatrix& a,
                     const std::vector<MatrixOf<Scalar>>& Y, std::vector<MatrixOf<Scalar>>& X,
                     double* squares) {
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

template <class Scalar>
double update_stage_vorticity(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                              const MatrixOf<Scalar>& S, const MatrixOf<Scalar>& Y,
                              MatrixOf<Scalar>& scratch, MatrixOf<Scalar>& W) {
  if (algebra.is_skew_hermitian()) {
    const AdjointOf<Scalar> adjoint(Y);
    return replace(W, [&](Index r, Index c) { return W0(r, c) + (S(r, c) - adjoint(r, c)); });
  }
  algebra.involution(Y, scratch);
  return replace(W, [&](Index r, Index c) { return W0(r, c) + (S(r, c) - scratch(r, c)); });
}

template <class Scalar>
double update_midpoint_vorticity(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                                 double a, const MatrixOf<Scalar>& M, double b,
                                 const MatrixOf<Scalar>& MB, MatrixOf<Scalar>& scratch,
                                 MatrixOf<Scalar>& W) {
  if (algebra.is_skew_hermitian()) {
    const AdjointOf<Scalar> adjoint(M);
    return replace(W, [&](Index r, Index c) {
      return W0(r, c) + a * (M(r, c) - adjoint(r, c)) + b * MB(r, c);
    });
  }
  algebra.involution(M, scratch);
  return replace(
      W, [&](Index r, Index c) { return W0(r, c) + a * (M(r, c) - scratch(r, c)) + b * MB(r, c); });
}

using Real = MatrixOf<double>;
template void update_unknowns(const Real&, double, const RealMatrix&, const std::vector<Real>&,
                              std::vector<Real>&, double*);
template void update_unknowns(const Matrix&, double, const RealMatrix&, const std::vector<Matrix>&,
                              std::vector<Matrix>&, double*);
template double update_stage_vorticity(const QuadraticAlgebra&, const Real&, const Real&,
                                       const Real&, Real&, Real&);
template double update_stage_vorticity(const QuadraticAlgebra&, const Matrix&, const Matrix&,
                                       const Matrix&, Matrix&, Matrix&);
template double update_midpoint_vorticity(const QuadraticAlgebra&, const Real&, double, const Real&,
                                          double, const Real&, Real&, Real&);
template double update_midpoint_vorticity(const QuadraticAlgebra&, const Matrix&, double,
                                          const Matrix&, double, const Matrix&, Matrix&, Matrix&);

}  // namespace isosyrk
