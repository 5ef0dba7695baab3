// Linear combinations of stage matrices, and the change of an unknown, in one pass over memory.
//
// The sums over stages cost O(s² n²) beside the products' O(s n³), and at the sizes of interest
// they are what keeps a sweep from running at the products' speed.  So each matrix is read once:
// all coefficients are real, a matrix is seen as its 2n² real numbers, and everything that is
// wanted of a few of these is done while they are in registers.  `AnyMatrix` is Matrix or
// PlanarMatrix, whose real numbers include what fills up its rows, 0 throughout.
#pragma once

#include <type_traits>
#include <vector>

#include "core/matrix.h"
#include "core/planar_matrix.h"
#include "core/tableau.h"

namespace isosyrk {

using Reals = Eigen::Map<Eigen::ArrayXd>;
using ConstReals = Eigen::Map<const Eigen::ArrayXd>;

/// The 2n² real numbers of X, in storage order.
inline Reals reals(Matrix& X) { return {reinterpret_cast<double*>(X.data()), 2 * X.size()}; }
inline ConstReals reals(const Matrix& X) {
  return {reinterpret_cast<const double*>(X.data()), 2 * X.size()};
}

template <class Real>
Eigen::Map<Eigen::Array<Real, Eigen::Dynamic, 1>> reals(PlanarMatrixOf<Real>& X) {
  return {X.entries().data(), X.entries().size()};
}
template <class Real>
Eigen::Map<const Eigen::Array<Real, Eigen::Dynamic, 1>> reals(const PlanarMatrixOf<Real>& X) {
  return {X.entries().data(), X.entries().size()};
}

/// Those of them that a share is of.
template <class Real>
Eigen::Map<Eigen::Array<Real, Eigen::Dynamic, 1>> reals(PlanarMatrixOf<Real>& X, Share share) {
  const NumbersOfRows numbers(X, share);
  return {X.entries().data() + numbers.begin, numbers.end - numbers.begin};
}
template <class Real>
Eigen::Map<const Eigen::Array<Real, Eigen::Dynamic, 1>> reals(const PlanarMatrixOf<Real>& X,
                                                              Share share) {
  const NumbersOfRows numbers(X, share);
  return {X.entries().data() + numbers.begin, numbers.end - numbers.begin};
}

/// s matrices of size n x n, zero.
inline std::vector<Matrix> stage_matrices(Index s, Index n) {
  return std::vector<Matrix>(static_cast<std::size_t>(s), Matrix::Zero(n, n));
}

namespace stage_sums {

/// Calls set(sum) with the sum of the first terms weights(j) Y_j, up to three, as an expression to
/// be evaluated in one pass; the rest is added to out one term at a time.  Of all real numbers, or
/// those of a share.
template <class Weights, class AnyMatrix, class Set, class... OfShare>
void combine(const Weights& weights, const std::vector<AnyMatrix>& Y, AnyMatrix& out, Set&& set,
             OfShare... share) {
  const auto term = [&](std::size_t j) {
    return weights(static_cast<Index>(j)) * reals(Y[j], share...);
  };
  switch (Y.size()) {
    case 1:
      set(term(0));
      return;
    case 2:
      set(term(0) + term(1));
      return;
    default:
      set(term(0) + term(1) + term(2));
      break;
  }
  for (std::size_t j = 3; j < Y.size(); ++j) reals(out, share...) += term(j);
}

}  // namespace stage_sums

/// out = Σ_j weights(j) Y_j, at least one term.  `weights` is any vector expression of doubles; out
/// is none of the Y_j.
template <class Weights, class AnyMatrix>
void combine(const Weights& weights, const std::vector<AnyMatrix>& Y, AnyMatrix& out) {
  stage_sums::combine(weights, Y, out, [&](const auto& sum) { reals(out) = sum; });
}
/// A share of that.
template <class Weights, class Real>
void combine(const Weights& weights, const std::vector<PlanarMatrixOf<Real>>& Y,
             PlanarMatrixOf<Real>& out, Share share) {
  const auto set = [&](const auto& sum) { reals(out, share) = sum; };
  stage_sums::combine(weights, Y, out, set, share);
}

/// out = base + Σ_j weights(j) Y_j, likewise; out is not base either.
template <class Weights, class AnyMatrix>
void combine(const AnyMatrix& base, const Weights& weights, const std::vector<AnyMatrix>& Y,
             AnyMatrix& out) {
  stage_sums::combine(weights, Y, out, [&](const auto& sum) { reals(out) = reals(base) + sum; });
}
/// A share of that.
template <class Weights, class Real>
void combine(const PlanarMatrixOf<Real>& base, const Weights& weights,
             const std::vector<PlanarMatrixOf<Real>>& Y, PlanarMatrixOf<Real>& out, Share share) {
  const auto set = [&](const auto& sum) { reals(out, share) = reals(base, share) + sum; };
  stage_sums::combine(weights, Y, out, set, share);
}

/// Σ |fresh - old|² over two matrices, or a share of them.
template <class AnyMatrix, class... OfShare>
double squared_change(const AnyMatrix& fresh, const AnyMatrix& old, OfShare... share) {
  return (reals(fresh, share...) - reals(old, share...)).square().sum();
}

/// The largest change of several unknowns from their squares; NaN if any is.
inline double largest_change(const RealVector& squares) {
  double largest = 0.0;
  for (const double square : squares) largest = larger(largest, square);
  return std::sqrt(largest);
}

namespace stage_sums {

/// double, or float for what is in single precision.
template <class AnyMatrix>
using RealOf = typename std::remove_cvref_t<decltype(reals(std::declval<AnyMatrix&>()))>::Scalar;

/// `Length` neighbouring real numbers of a matrix.
template <int Length, class Real = double>
using Piece = Eigen::Array<Real, Length, 1>;

template <int Length, class AnyMatrix>
Piece<Length, RealOf<AnyMatrix>> load(const AnyMatrix& X, Index at) {
  return Eigen::Map<const Piece<Length, RealOf<AnyMatrix>>>(reals(X).data() + at);
}

template <int Length, class AnyMatrix>
void store(const Piece<Length, RealOf<AnyMatrix>>& values, AnyMatrix& X, Index at) {
  Eigen::Map<Piece<Length, RealOf<AnyMatrix>>>(reals(X).data() + at) = values;
}

// The base of X_i: the same for all, or one for each.
template <class AnyMatrix>
const AnyMatrix& base_of(const AnyMatrix& base, Index) {
  return base;
}
template <class AnyMatrix>
const AnyMatrix& base_of(const std::vector<AnyMatrix>& bases, Index i) {
  return bases[static_cast<std::size_t>(i)];
}

/// update_unknowns on the real numbers from `at` on.
template <int Length, class Base, class Coefficients, class AnyMatrix>
void update_piece(const Base& base, const Coefficients& c, const std::vector<AnyMatrix>& Y,
                  std::vector<AnyMatrix>& X, Index at, Piece<Length, RealOf<AnyMatrix>>* squares) {
  using Numbers = Piece<Length, RealOf<AnyMatrix>>;
  const Index s = c.rows();
  Numbers y[Coefficients::MaxRowsAtCompileTime];
  for (Index j = 0; j < s; ++j) y[j] = load<Length>(Y[static_cast<std::size_t>(j)], at);
  for (Index i = 0; i < s; ++i) {
    Numbers fresh = load<Length>(base_of(base, i), at);
    for (Index j = 0; j < s; ++j) fresh += c(i, j) * y[j];
    AnyMatrix& X_i = X[static_cast<std::size_t>(i)];
    squares[i] += (fresh - load<Length>(X_i, at)).square();
    store<Length>(fresh, X_i, at);
  }
}

/// update_unknowns for s = Size, which the compiler unrolls, or for any s (Eigen::Dynamic).
template <int Size, class Base, class AnyMatrix>
void update_all(const Base& base, double h, const RealMatrix& a, const std::vector<AnyMatrix>& Y,
                std::vector<AnyMatrix>& X, double* squares, Index begin, Index end) {
  constexpr int most = Size == Eigen::Dynamic ? max_stages : Size;
  using Real = RealOf<AnyMatrix>;
  const Eigen::Matrix<Real, Size, Size, Eigen::ColMajor, most, most> c = (h * a).cast<Real>();
  constexpr int length = 64 / sizeof(Real);
  Piece<length, Real> sums[most];
  for (Index i = 0; i < c.rows(); ++i) sums[i].setZero();
  Index at = begin;
  for (; at + length <= end; at += length) update_piece<length>(base, c, Y, X, at, sums);

  constexpr int rest = 2;  // 2n² is even
  Piece<rest, Real> rest_sums[most];
  for (Index i = 0; i < c.rows(); ++i) rest_sums[i].setZero();
  for (; at < end; at += rest) update_piece<rest>(base, c, Y, X, at, rest_sums);
  for (Index i = 0; i < c.rows(); ++i)
    squares[i] = static_cast<double>(sums[i].sum() + rest_sums[i].sum());
}

}  // namespace stage_sums

/// X_i = base + h Σ_j a_ij Y_j for i = 1..s, each Y_j read once; squares[i] = Σ |change of X_i|².
/// a is s x s, s = Y.size() = X.size() <= max_stages.  Of the real numbers of each matrix those
/// from `begin` up to `end`, multiples of 8, in single precision of 16.  Base is one matrix, or a
/// vector of one for each.
template <class Base, class AnyMatrix>
void update_unknowns(const Base& base, double h, const RealMatrix& a,
                     const std::vector<AnyMatrix>& Y, std::vector<AnyMatrix>& X, double* squares,
                     Index begin, Index end) {
  switch (Y.size()) {
    case 1:
      return stage_sums::update_all<1>(base, h, a, Y, X, squares, begin, end);
    case 2:
      return stage_sums::update_all<2>(base, h, a, Y, X, squares, begin, end);
    case 3:
      return stage_sums::update_all<3>(base, h, a, Y, X, squares, begin, end);
    default:
      return stage_sums::update_all<Eigen::Dynamic>(base, h, a, Y, X, squares, begin, end);
  }
}

/// The same, of whole matrices.
template <class AnyMatrix>
void update_unknowns(const std::type_identity_t<AnyMatrix>& base, double h, const RealMatrix& a,
                     const std::vector<AnyMatrix>& Y, std::vector<AnyMatrix>& X, double* squares) {
  update_unknowns(base, h, a, Y, X, squares, 0, reals(base).size());
}

// Of planar matrices it is compiled once, in stage_sums.cpp, as what has to give the same bit for
// bit is: compiled with other options, as tests are, it would round otherwise.
extern template void update_unknowns(const PlanarMatrix&, double, const RealMatrix&,
                                     const std::vector<PlanarMatrix>&, std::vector<PlanarMatrix>&,
                                     double*, Index, Index);
extern template void update_unknowns(const std::vector<SingleMatrix>&, double, const RealMatrix&,
                                     const std::vector<SingleMatrix>&, std::vector<SingleMatrix>&,
                                     double*, Index, Index);

}  // namespace isosyrk
