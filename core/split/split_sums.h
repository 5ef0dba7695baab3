// Sums of planar matrices, a share of their rows at a time, in one pass over memory: what becomes
// of an unknown, from as many matrices as it takes.
#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

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

namespace planar_sums {

/// Takes `length` neighbouring numbers of any matrix, or of what entries().data() gives of one:
/// views, which an expression may keep.
template <int length, class Real>
struct LoadAt {
  using View = Eigen::Map<const stage_sums::Piece<length, Real>>;

  View operator()(const Real* numbers) const { return View(numbers + at); }
  View operator()(const PlanarMatrixOf<Real>& X) const { return (*this)(X.entries().data()); }

  Index at;
};

/// What `assign` takes at a time: real and imaginary parts of a row together are filled up to that.
template <class Real>
using Assigned = stage_sums::Piece<128 / sizeof(Real), Real>;

/// base + Σ_j c_j Y_j, as the `fresh` of what follows; base is not multiplied by 1, so that the sum
/// rounds as that of update_unknowns does.
template <class Real>
struct Stage {
  template <class Load>
  auto operator()(const Load& load) const {
    auto sum = load(base).eval();
    for (std::size_t j = 0; j < Y.size(); ++j) sum += c[j] * load(Y[j]);
    return sum;
  }

  // Calls use(sum) where sum(load) gives that; of two terms, which threads most often have apart,
  // it is unrolled.
  template <class Use>
  auto unrolled(Use&& use) const {
    if (Y.size() != 2) return use(*this);
    const std::array<Real, 2> c_of{c[0], c[1]};
    const std::array<const Real*, 3> of{base.entries().data(), Y[0].entries().data(),
                                        Y[1].entries().data()};
    return use([&](const auto& load) {
      auto sum = load(of[0]).eval();
      sum += c_of[0] * load(of[1]);
      sum += c_of[1] * load(of[2]);
      return sum;
    });
  }

  const PlanarMatrixOf<Real>& base;
  const std::vector<PlanarMatrixOf<Real>>& Y;
  std::array<Real, max_stages> c;
};

/// base + h Σ_j a_ij Y_j.
template <class Real>
Stage<Real> stage(const PlanarMatrixOf<Real>& base, double h, const RealMatrix& a, Index i,
                  const std::vector<PlanarMatrixOf<Real>>& Y) {
  Stage<Real> sum{base, Y, {}};
  for (std::size_t j = 0; j < Y.size(); ++j) {
    sum.c[j] = static_cast<Real>(h * a(i, static_cast<Index>(j)));
  }
  return sum;
}

/// Calls use(fresh), or what a sum of terms makes of itself.
template <class Fresh, class Use>
auto unrolled(const Fresh& fresh, Use&& use) {
  if constexpr (requires { fresh.unrolled(use); }) {
    return fresh.unrolled(use);
  } else {
    return use(fresh);
  }
}

}  // namespace planar_sums

/// Σ_t weight_t X_t of at least one planar matrix, as the `fresh` of what follows: in one pass.
template <class Real>
class Terms {
 public:
  /// Of all X_j and M_jk, j <= k, there is room for.
  static constexpr std::size_t most = max_stages * (max_stages + 3) / 2;

  void add(double weight, const PlanarMatrixOf<Real>& X) {
    weights_[count_] = static_cast<Real>(weight);
    numbers_[count_++] = X.entries().data();
  }

  // Calls use(sum) where sum(load) gives a piece of it: of up to six terms, as three stages have,
  // unrolled, which is half again as fast.
  template <class Use>
  auto unrolled(Use&& use) const {
    switch (count_) {
      case 1:
        return use(First<1>(*this));
      case 2:
        return use(First<2>(*this));
      case 3:
        return use(First<3>(*this));
      case 4:
        return use(First<4>(*this));
      case 5:
        return use(First<5>(*this));
      case 6:
        return use(First<6>(*this));
      default:
        return use([this](const auto& load) {
          auto sum = (weights_[0] * load(numbers_[0])).eval();
          for (std::size_t t = 1; t < count_; ++t) sum += weights_[t] * load(numbers_[t]);
          return sum;
        });
    }
  }

 private:
  // A copy, which the compiler sees that nothing else changes.
  template <std::size_t count>
  struct First {
    explicit First(const Terms& all) {
      for (std::size_t t = 0; t < count; ++t) {
        weights[t] = all.weights_[t];
        numbers[t] = all.numbers_[t];
      }
    }

    template <class Load>
    auto operator()(const Load& load) const {
      auto sum = (weights[0] * load(numbers[0])).eval();
#pragma GCC unroll 6
      for (std::size_t t = 1; t < count; ++t) sum += weights[t] * load(numbers[t]);
      return sum;
    }

    std::array<Real, count> weights;
    std::array<const Real*, count> numbers;
  };

  std::size_t count_ = 0;
  std::array<Real, most> weights_;  // the first `count_`
  std::array<const Real*, most> numbers_;
};

/// out = fresh, where fresh(load) gives some neighbouring numbers of it from those that load(Y)
/// takes of any matrix, or a sum of terms; each piece is then seen by also(at, value).  Of a share;
/// returns Σ |out - old|² over it.  out may be `old`, or read by fresh.
template <class Real, class Fresh, class Also>
double replace(const PlanarMatrixOf<Real>& old, PlanarMatrixOf<Real>& out, Share share,
               const Fresh& fresh, Also&& also) {
  return planar_sums::unrolled(fresh, [&](const auto& sum_at) {
    const NumbersOfRows numbers(out, share);
    constexpr int length = 64 / sizeof(Real);  // rows are filled up to whole blocks of 64 bytes
    using Numbers = stage_sums::Piece<length, Real>;
    Numbers sum = Numbers::Zero();
    const Real* const was = old.entries().data();
    Real* const to = out.entries().data();
    for (Index at = numbers.begin; at < numbers.end; at += length) {
      const planar_sums::LoadAt<length, Real> load{at};
      const Numbers value = sum_at(load);
      sum += (value - load(was)).square();
      Eigen::Map<Numbers>(to + at) = value;
      also(at, value);
    }
    return static_cast<double>(sum.sum());
  });
}
template <class Real, class Fresh>
double replace(const PlanarMatrixOf<Real>& old, PlanarMatrixOf<Real>& out, Share share,
               const Fresh& fresh) {
  return replace(old, out, share, fresh, [](Index, const auto&) {});
}
/// The same for X that is replaced.
template <class Real, class Fresh, class... Also>
double replace(PlanarMatrixOf<Real>& X, Share share, const Fresh& fresh, Also&&... also) {
  return replace(X, X, share, fresh, also...);
}

/// out = fresh, without a look at what was there.
template <class Real, class Fresh>
void assign(PlanarMatrixOf<Real>& out, Share share, const Fresh& fresh) {
  planar_sums::unrolled(fresh, [&](const auto& sum_at) {
    const NumbersOfRows numbers(out, share);
    using Numbers = planar_sums::Assigned<Real>;
    constexpr int length = Numbers::SizeAtCompileTime;
    Real* const to = out.entries().data();
    for (Index at = numbers.begin; at < numbers.end; at += length) {
      Eigen::Map<Numbers>(to + at) = sum_at(planar_sums::LoadAt<length, Real>{at});
    }
  });
}

/// The i-th of what update_unknowns makes by itself, the same bit for bit, or a share of it;
/// returns its square.
template <class Base, class Real>
double update_unknown(const Base& base, double h, const RealMatrix& a, Index i,
                      const std::vector<PlanarMatrixOf<Real>>& Y, PlanarMatrixOf<Real>& X_i,
                      Share share) {
  return replace(X_i, share, planar_sums::stage(stage_sums::base_of(base, i), h, a, i, Y));
}

// Compiled once, as update_unknowns.
extern template double update_unknown(const PlanarMatrix&, double, const RealMatrix&, Index,
                                      const std::vector<PlanarMatrix>&, PlanarMatrix&, Share);
extern template double update_unknown(const std::vector<SingleMatrix>&, double, const RealMatrix&,
                                      Index, const std::vector<SingleMatrix>&, SingleMatrix&,
                                      Share);

}  // namespace isosyrk
