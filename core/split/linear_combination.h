// Linear combinations of split matrices: every sum over stages, past steps or corrections, in one
// pass over memory.
//
// The sums cost O(s² n²) operations, products O(s n³).  At moderate n the sums still take a
// noticeable part of a sweep, since they are limited by memory.  All weights are real, so a matrix
// is read as an array of real numbers.  A few numbers of all terms are combined in registers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The sum Σ_t weight_t X_t of 1 to `most` split matrices of one size.  Holds pointers: the
/// matrices must outlive the sum.
template <class Real>
class LinearCombination {
 public:
  /// Largest number of terms, enough for any stage equation: X_j and M_jk, j <= k, of 20 stages
  /// (catalogue/fast_forms.cpp asserts it).  Not checked.
  static constexpr std::size_t most = 230;

  // Initialises and copies only the terms in use, since the arrays have room for many.
  LinearCombination() {}  // NOLINT(modernize-use-equals-default): `= default` may zero the arrays
  LinearCombination(const LinearCombination& other) : count_(other.count_) {
    std::copy_n(other.weights_.begin(), count_, weights_.begin());
    std::copy_n(other.terms_.begin(), count_, terms_.begin());
  }
  LinearCombination& operator=(const LinearCombination&) = delete;

  /// Adds weight X.
  LinearCombination& add(double weight, const SplitMatrixOf<Real>& X) {
    weights_[count_] = static_cast<Real>(weight);
    terms_[count_++] = &X;
    return *this;
  }
  /// Adds Σ_j weights(j) Y_j.
  template <class Weights>
  LinearCombination& add(const Weights& weights, const SplitStagesOf<Real>& Y) {
    for (std::size_t j = 0; j < Y.size(); ++j) add(weights(static_cast<Index>(j)), Y[j]);
    return *this;
  }

  std::size_t count() const { return count_; }
  Real weight(std::size_t t) const { return weights_[t]; }
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
  std::array<Real, most> weights_;  // the first `count_`
  std::array<const SplitMatrixOf<Real>*, most> terms_;
};

/// Returns weight X.
template <class Real>
LinearCombination<Real> sum_of(double weight, const SplitMatrixOf<Real>& X) {
  return LinearCombination<Real>().add(weight, X);
}
/// Returns Σ_j weights(j) Y_j.
template <class Weights, class Real>
LinearCombination<Real> sum_of(const Weights& weights, const SplitStagesOf<Real>& Y) {
  return LinearCombination<Real>().add(weights, Y);
}

namespace linear_combination {

// The operations below this namespace, in some rows of one matrix.  change_rows, residual_rows and
// squares_of_rows return sums of squares: of the change, of R, of X.  `out` may be a term of the
// sum.
template <class Real>
void assign_rows(const LinearCombination<Real>& sum, parallel::Rows rows, SplitMatrixOf<Real>& out);
template <class Real>
double change_rows(const LinearCombination<Real>& sum, parallel::Rows rows,
                   SplitMatrixOf<Real>& out);
double residual_rows(const LinearCombination<double>& sum, const SplitMatrix& X,
                     parallel::Rows rows, SingleMatrix& R);
template <class Real>
double squares_of_rows(const SplitMatrixOf<Real>& X, parallel::Rows rows);

// Returns the largest over the items of sqrt(Σ f(item, rows)), summed over blocks in their order.
// NaN if any sum is NaN.
template <class F>
double largest_norm_of(std::size_t items, Index n, F&& f) {
  const Index blocks = parallel::sum_blocks(n);
  std::array<double, LinearCombination<double>::most * parallel::most_sum_blocks> squares;
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

/// out_i = sum(i) for all i.  sum(i) is a LinearCombination.  out_i may be a term of sum(i), but of
/// no other sum.
template <class Real, class Sum>
void assign(SplitStagesOf<Real>& out, Sum&& sum) {
  if (out.empty()) return;
  parallel::for_each_block(out.size(), out[0].size(),
                           [&](std::size_t i, parallel::Rows rows, Index) {
                             linear_combination::assign_rows(sum(i), rows, out[i]);
                           });
}

/// out = sum.  out may be a term of the sum.
template <class Real>
void assign(SplitMatrixOf<Real>& out, const LinearCombination<Real>& sum) {
  parallel::for_each_block(1, out.size(), [&](std::size_t, parallel::Rows rows, Index) {
    linear_combination::assign_rows(sum, rows, out);
  });
}

/// Sets X_i = sum(i) for all i as assign does, and returns the largest Frobenius norm of a change
/// of X_i.  NaN if any norm is NaN.
template <class Real, class Sum>
double replace(SplitStagesOf<Real>& X, Sum&& sum) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::change_rows(sum(i), rows, X[i]);
      });
}

/// Sets R_i = sum(i) - X_i, formed in double and rounded to single precision.  Returns the largest
/// Frobenius norm of sum(i) - X_i, or NaN if any norm is NaN.
template <class Sum>
double residual(const SplitStages& X, Sum&& sum, SingleStages& R) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::residual_rows(sum(i), X[i], rows, R[i]);
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

/// S_i = X_i rounded to single precision, with the band of X_i.
void round_to_single(const SplitStages& X, SingleStages& S);

/// X_i += S_i.  The band of X_i becomes the wider of the two.
void add(const SingleStages& S, SplitStages& X);

/// X_i += scale I.
void add_identity(float scale, SingleStages& X);

}  // namespace isosyrk
