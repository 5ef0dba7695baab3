// Linear combinations of stage matrices, and the change of an unknown, in one pass over memory.
//
// The sums over stages cost O(s² n²) beside the products' O(s n³), and at the sizes of interest
// they are what keeps a sweep from running at the products' speed.  So each matrix is read once:
// all coefficients are real, a matrix is seen as its 2n² real numbers, and everything that is
// wanted of a few of these is done while they are in registers.  `AnyMatrix` is Matrix or
// PlanarMatrix, whose real numbers include what fills up its rows, 0 throughout.
#pragma once

#include <array>
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

/// Calls use(fresh) where fresh(load) gives a piece of base + h Σ_j a_ij Y_j, from what load(X) takes
/// of any matrix; returns what that does.
template <class Real, class Use>
auto with_stage(const PlanarMatrixOf<Real>& base, double h, const RealMatrix& a, Index i,
                const std::vector<PlanarMatrixOf<Real>>& Y, Use&& use) {
  std::array<Real, max_stages> c{};
  for (std::size_t j = 0; j < Y.size(); ++j) {
    c[j] = static_cast<Real>(h * a(i, static_cast<Index>(j)));
  }
  if (Y.size() == 2) {  // which the compiler unrolls
    return use([&](const auto& load) {
      auto fresh = load(base).eval();
      fresh += c[0] * load(Y[0]);
      fresh += c[1] * load(Y[1]);
      return fresh;
    });
  }
  return use([&](const auto& load) {
    auto fresh = load(base).eval();
    for (std::size_t j = 0; j < Y.size(); ++j) fresh += c[j] * load(Y[j]);
    return fresh;
  });
}

}  // namespace stage_sums

/// out = fresh, where fresh(load) gives 64 neighbouring bytes of it from those that load(Y) takes of
/// any matrix, each piece then seen by also(at, value); returns Σ |out - old|².  Of all, or a share
/// of it.  out may be `old`, or read by fresh.
template <class Real, class Fresh, class Also>
double replace(const PlanarMatrixOf<Real>& old, PlanarMatrixOf<Real>& out, Share share,
               Fresh&& fresh, Also&& also) {
  const NumbersOfRows numbers(out, share);
  constexpr int length = 64 / sizeof(Real);  // rows are filled up to whole blocks of 64 bytes
  using Numbers = stage_sums::Piece<length, Real>;
  Numbers sum = Numbers::Zero();
  for (Index at = numbers.begin; at < numbers.end; at += length) {
    // A view, which an expression may keep; a copy would be gone before it is evaluated.
    const auto load = [at](const PlanarMatrixOf<Real>& Y) {
      return Eigen::Map<const Numbers>(reals(Y).data() + at);
    };
    const Numbers value = fresh(load);
    sum += (value - load(old)).square();
    stage_sums::store<length>(value, out, at);
    also(at, value);
  }
  return static_cast<double>(sum.sum());
}
template <class Real, class Fresh>
double replace(const PlanarMatrixOf<Real>& old, PlanarMatrixOf<Real>& out, Share share,
               Fresh&& fresh) {
  return replace(old, out, share, fresh, [](Index, const auto&) {});
}
/// The same for X that is replaced.
template <class Real, class Fresh, class... Also>
double replace(PlanarMatrixOf<Real>& X, Share share, Fresh&& fresh, Also&&... also) {
  return replace(X, X, share, fresh, also...);
}

/// out = fresh, without a look at what was there.
template <class Real, class Fresh>
void assign(PlanarMatrixOf<Real>& out, Share share, Fresh&& fresh) {
  const NumbersOfRows numbers(out, share);
  constexpr int length = 64 / sizeof(Real);
  using Numbers = stage_sums::Piece<length, Real>;
  for (Index at = numbers.begin; at < numbers.end; at += length) {
    const auto load = [at](const PlanarMatrixOf<Real>& Y) {
      return Eigen::Map<const Numbers>(reals(Y).data() + at);
    };
    stage_sums::store<length>(Numbers(fresh(load)), out, at);
  }
}

/// Σ_t weight_t X_t, as the `fresh` of these: one pass for all terms.
template <class Real>
class Terms {
 public:
  /// Of all X_j and M_jk, j <= k, there is room for.
  static constexpr std::size_t most = max_stages * (max_stages + 3) / 2;

  void add(double weight, const PlanarMatrixOf<Real>& X) {
    weights_[count_] = static_cast<Real>(weight);
    matrices_[count_++] = &X;
  }

  template <class Load>
  auto operator()(const Load& load) const {
    auto sum = (weights_[0] * load(*matrices_[0])).eval();
    for (std::size_t t = 1; t < count_; ++t) sum += weights_[t] * load(*matrices_[t]);
    return sum;
  }

 private:
  std::size_t count_ = 0;
  std::array<Real, most> weights_;  // the first `count_`
  std::array<const PlanarMatrixOf<Real>*, most> matrices_;
};

/// X_i = base + h Σ_j a_ij Y_j for i = 1..s, each Y_j read once; squares[i] = Σ |change of X_i|².
/// a is s x s, s = Y.size() = X.size() <= max_stages.  Of the real numbers of each matrix those
/// from `begin` up to `end`, a multiple of 8 each.  Base is one matrix, or a vector of one for
/// each; so is `end` of numbers in single precision of 16.
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

/// The i-th of these by itself, the same bit for bit, or a share of it; returns its square.
template <class Base, class Real>
double update_unknown(const Base& base, double h, const RealMatrix& a, Index i,
                      const std::vector<PlanarMatrixOf<Real>>& Y, PlanarMatrixOf<Real>& X_i,
                      Share share) {
  return stage_sums::with_stage(stage_sums::base_of(base, i), h, a, i, Y,
                                [&](const auto& fresh) { return replace(X_i, share, fresh); });
}

/// The same as update_unknowns above, of whole matrices.
template <class AnyMatrix>
void update_unknowns(const std::type_identity_t<AnyMatrix>& base, double h, const RealMatrix& a,
                     const std::vector<AnyMatrix>& Y, std::vector<AnyMatrix>& X, double* squares) {
  update_unknowns(base, h, a, Y, X, squares, 0, reals(base).size());
}

// Of planar matrices both are compiled once, in stage_sums.cpp: compiled with other options, as tests
// are, the one that the linker takes would round otherwise than the other.
extern template void update_unknowns(const PlanarMatrix&, double, const RealMatrix&,
                                     const std::vector<PlanarMatrix>&, std::vector<PlanarMatrix>&,
                                     double*, Index, Index);
extern template void update_unknowns(const std::vector<SingleMatrix>&, double, const RealMatrix&,
                                     const std::vector<SingleMatrix>&, std::vector<SingleMatrix>&,
                                     double*, Index, Index);
extern template double update_unknown(const PlanarMatrix&, double, const RealMatrix&, Index,
                                      const std::vector<PlanarMatrix>&, PlanarMatrix&, Share);
extern template double update_unknown(const std::vector<SingleMatrix>&, double, const RealMatrix&,
                                      Index, const std::vector<SingleMatrix>&, SingleMatrix&,
                                      Share);

}  // namespace isosyrk
