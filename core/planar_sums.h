// Sums of planar matrices, a share of their rows at a time, in one pass over memory: what becomes
// of an unknown, from as many matrices as it takes.
#pragma once

#include <array>
#include <vector>

#include "core/planar_matrix.h"
#include "core/stage_sums.h"
#include "core/tableau.h"

namespace isosyrk {

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
