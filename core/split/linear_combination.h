// Linear combinations of split matrices: every sum over stages, past steps or corrections, in one
// pass over memory.  They read as in the paper, with the output first.  For
// Q₁ = I - h Σ_j b_j QB_j, and for all W̃_i = W₀ + h Σ_j a_ij M_j:
//
//     Q1 = identity - h * sum(b, QB);
//     assign(W, [&](std::size_t i) { return W0 + h * sum(row(i), M); });
//
// The sums cost O(s² n²) operations, products O(s n³).  At moderate n the sums still take a
// noticeable part of a sweep, since they are limited by memory.  All weights are real, so a matrix
// is read as an array of real numbers.  A few numbers of all terms are combined in registers.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <type_traits>

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The term weight X of a linear combination.  Holds a pointer to X.
template <class Real>
struct Multiple {
  double weight;
  const SplitMatrixOf<Real>* X;
};

/// The term factor Σ_j w_j Y_j of a linear combination, with the weights w_j `stride` numbers
/// apart.  Terms of weight 0 are left out.  Holds pointers to the weights and to Y.
template <class Real>
struct StageSum {
  double factor;
  const double* weights;
  Index stride;
  const SplitStagesOf<Real>* Y;
};

/// The sum Σ_t weight_t X_t of 1 to `most` split matrices of one size, made of terms by + and -.
/// Holds pointers: the matrices must outlive the sum.
template <class Real>
class LinearCombination {
 public:
  /// Largest number of terms, enough for any stage equation: X_j and M_jk, j <= k, of 20 stages
  /// (catalogue/fast_forms.cpp asserts it).  Checked in debug builds only.
  static constexpr std::size_t most = 230;

  // Initialises and copies only the terms in use, since the arrays have room for many.
  LinearCombination() {}  // NOLINT(modernize-use-equals-default): `= default` may zero the arrays
  LinearCombination(const LinearCombination& other) : count_(other.count_) {
    std::copy_n(other.weights_.begin(), count_, weights_.begin());
    std::copy_n(other.terms_.begin(), count_, terms_.begin());
  }
  LinearCombination& operator=(const LinearCombination&) = delete;

  /// A sum of one term.
  LinearCombination(const SplitMatrixOf<Real>& X) { add(1.0, X); }
  LinearCombination(const Multiple<Real>& term) { add(1.0, term); }
  LinearCombination(const StageSum<Real>& term) { add(1.0, term); }

  /// Adds `weight` times a term.
  void add(double weight, const SplitMatrixOf<Real>& X) {
    assert(count_ < most);
    weights_[count_] = weight;
    terms_[count_++] = &X;
  }
  void add(double weight, const Multiple<Real>& term) { add(weight * term.weight, *term.X); }
  void add(double weight, const StageSum<Real>& term) {
    const double* w = term.weights;
    for (const SplitMatrixOf<Real>& each : *term.Y) {
      if (*w != 0.0) add(weight * (term.factor * *w), each);
      w += term.stride;
    }
  }
  template <class Term>
  LinearCombination& operator+=(const Term& term) {
    add(1.0, term);
    return *this;
  }

  std::size_t count() const { return count_; }
  Real weight(std::size_t t) const { return static_cast<Real>(weights_[t]); }
  const SplitMatrixOf<Real>& term(std::size_t t) const { return *terms_[t]; }
  /// Returns the widest band of a term.
  Index band() const {
    Index widest = 0;
    for (std::size_t t = 0; t < count_; ++t) {
      if (terms_[t]->band() > widest) widest = terms_[t]->band();
    }
    return widest;
  }

 private:
  std::size_t count_ = 0;
  std::array<double, most> weights_;  // the first `count_`
  std::array<const SplitMatrixOf<Real>*, most> terms_;
};

/// Returns the term weight X.
template <class Real>
Multiple<Real> operator*(double weight, const SplitMatrixOf<Real>& X) {
  return {weight, &X};
}
/// Returns the term Σ_j weights_j Y_j.  The weights are a vector, or a row of a matrix, that
/// outlives the sum.
template <class Weights, class Real>
StageSum<Real> sum(const Weights& weights, const SplitStagesOf<Real>& Y) {
  return {1.0, weights.data(), weights.innerStride(), &Y};
}
template <class Real>
StageSum<Real> operator*(double factor, StageSum<Real> term) {
  term.factor *= factor;
  return term;
}

namespace linear_combination {

// The precision of a term: a matrix, a multiple of one, or a sum over stages.
template <class Term>
struct PrecisionOf;
template <class Real>
struct PrecisionOf<SplitMatrixOf<Real>> {
  using type = Real;
};
template <class Real>
struct PrecisionOf<Multiple<Real>> {
  using type = Real;
};
template <class Real>
struct PrecisionOf<StageSum<Real>> {
  using type = Real;
};
template <class First, class Second>
using SumOfTerms = LinearCombination<std::enable_if_t<
    std::is_same_v<typename PrecisionOf<First>::type, typename PrecisionOf<Second>::type>,
    typename PrecisionOf<First>::type>>;

}  // namespace linear_combination

/// Returns the sum or the difference of two terms, or of a linear combination and a term.
template <class First, class Second>
linear_combination::SumOfTerms<First, Second> operator+(const First& first, const Second& second) {
  linear_combination::SumOfTerms<First, Second> result(first);
  result.add(1.0, second);
  return result;
}
template <class First, class Second>
linear_combination::SumOfTerms<First, Second> operator-(const First& first, const Second& second) {
  linear_combination::SumOfTerms<First, Second> result(first);
  result.add(-1.0, second);
  return result;
}
template <class Real, class Term, class = typename linear_combination::PrecisionOf<Term>::type>
LinearCombination<Real>&& operator+(LinearCombination<Real>&& combination, const Term& term) {
  combination.add(1.0, term);
  return std::move(combination);
}
template <class Real, class Term, class = typename linear_combination::PrecisionOf<Term>::type>
LinearCombination<Real>&& operator-(LinearCombination<Real>&& combination, const Term& term) {
  combination.add(-1.0, term);
  return std::move(combination);
}

namespace linear_combination {

// The operations below this namespace, in some rows of one matrix.  change_rows, residual_rows and
// squares_of_rows return sums of squares: of the change, of R, of X.  `out` may be a term of the
// sum.
template <class Real>
void assign_rows(SplitMatrixOf<Real>& out, const LinearCombination<Real>& combination,
                 parallel::Rows rows);
// The same where all that can change is within a band, in short pieces that follow it.  `out` keeps
// its band.
template <class Real>
void assign_rows_within(SplitMatrixOf<Real>& out, Index band,
                        const LinearCombination<Real>& combination, parallel::Rows rows);
template <class Real>
double change_rows(SplitMatrixOf<Real>& out, const LinearCombination<Real>& combination,
                   parallel::Rows rows);
double residual_rows(SingleMatrix& R, const LinearCombination<double>& combination,
                     const SplitMatrix& X, parallel::Rows rows);
template <class Real>
double squares_of_rows(const SplitMatrixOf<Real>& X, parallel::Rows rows);

// Returns the largest over the items of sqrt(Σ f(item, rows)), summed over blocks in their order.
// NaN if any sum is NaN.
template <class F>
double largest_norm_of(std::size_t items, Index n, F&& f) {
  const Index blocks = parallel::blocks_of(n);
  std::array<double, LinearCombination<double>::most * parallel::most_blocks> squares;
  const auto place = [&](std::size_t item, Index block) {
    return item * static_cast<std::size_t>(blocks) + static_cast<std::size_t>(block);
  };
  parallel::for_each_block(items, n, [&](std::size_t item, parallel::Rows rows, Index block) {
    squares[place(item, block)] = f(item, rows);
  });
  double largest = 0.0;
  for (std::size_t item = 0; item < items; ++item) {
    double sum = 0.0;
    for (Index block = 0; block < blocks; ++block) sum += squares[place(item, block)];
    largest = larger(largest, sum);
  }
  return std::sqrt(largest);
}

}  // namespace linear_combination

/// out_i = combination(i) for all i.  combination(i) is a linear combination or a term of one.
/// out_i may be a term of combination(i), but of no other.
template <class Real, class Combination>
void assign(SplitStagesOf<Real>& out, Combination&& combination) {
  if (out.empty()) return;
  parallel::for_each_block(out.size(), out[0].size(),
                           [&](std::size_t i, parallel::Rows rows, Index) {
                             linear_combination::assign_rows<Real>(out[i], combination(i), rows);
                           });
}

/// out_i = X_i for all i.
template <class Real>
void copy(SplitStagesOf<Real>& out, const SplitStagesOf<Real>& X) {
  assign(out, [&](std::size_t i) { return 1.0 * X[i]; });
}

/// out = combination, in the storage of out.  out may be a term of the combination.
template <class Real>
SplitMatrixOf<Real>& SplitMatrixOf<Real>::operator=(const LinearCombination<Real>& combination) {
  // Beyond the bands of the terms and of the matrix as it was, all is 0 and stays so.
  const Index band = combination.band();
  const Index written = band > band_ ? band : band_;
  parallel::for_each_block(1, size(), [&](std::size_t, parallel::Rows rows, Index) {
    if (written < size() - 1) {
      linear_combination::assign_rows_within(*this, written, combination, rows);
    } else {
      linear_combination::assign_rows(*this, combination, rows);
    }
  });
  set_band(band);
  return *this;
}

/// Sets X_i = combination(i) for all i as assign does, and returns the largest Frobenius norm of a
/// change of X_i.  NaN if any norm is NaN.
template <class Real, class Combination>
double replace(SplitStagesOf<Real>& X, Combination&& combination) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::change_rows<Real>(X[i], combination(i), rows);
      });
}

/// Sets R_i = combination(i) - X_i, formed in double and rounded to single precision.  Returns the
/// largest Frobenius norm of combination(i) - X_i, or NaN if any norm is NaN.
template <class Combination>
double form_residual(SingleStages& R, Combination&& combination, const SplitStages& X) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::residual_rows(R[i], combination(i), X[i], rows);
      });
}

/// Returns the largest Frobenius norm of an X_i, or NaN if any norm is NaN.
template <class Real>
double largest_norm(const SplitStagesOf<Real>& X) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::squares_of_rows(X[i], rows);
      });
}

/// Returns the Frobenius norm of X, NaN if it has a NaN.
template <class Real>
double norm(const SplitMatrixOf<Real>& X) {
  return linear_combination::largest_norm_of(1, X.size(), [&](std::size_t, parallel::Rows rows) {
    return linear_combination::squares_of_rows(X, rows);
  });
}

/// S_i = X_i rounded to single precision, with the band of X_i.
void round_to_single(SingleStages& S, const SplitStages& X);
/// The same for one matrix.
void round_to_single(SingleMatrix& S, const SplitMatrix& X);

/// X = S in double precision, with the band of S.
void widen(SplitMatrix& X, const SingleMatrix& S);

/// X_i += S_i.  The band of X_i becomes the wider of the two.
void add(SplitStages& X, const SingleStages& S);
/// X += weight S, formed in double.  The band of X becomes the wider of the two.
void add(SplitMatrix& X, const SingleMatrix& S, double weight = 1.0);

/// What a term adds to a sum: weight times itself.
template <class Real>
struct Addition {
  SplitMatrixOf<Real>* sum;
  double weight;
};
/// Adds a term to several sums at once, to `first` in double precision, in the upper triangles and
/// unspecified entries below: the term is read once.  The band of each sum becomes the wider of its
/// own and that of the term.  At most three others.
template <class Sum, class Term>
void add_upper(Addition<double> first, std::span<const Addition<Sum>> others,
               const SplitMatrixOf<Term>& term);

/// X_i += scale I.
void add_identity(SingleStages& X, float scale);

}  // namespace isosyrk
