// Linear combinations of split matrices: every sum over stages, past steps or corrections, in one
// pass over memory.
//
// The sums cost O(s² n²) beside the products' O(s n³), and at the sizes of interest they keep a sweep
// from running at the products' speed.  All weights are real, so a matrix is a row of real numbers,
// and everything that is wanted of a few of these is done while they are in registers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Σ_t weight_t X_t of at least one split matrix.  The matrices must outlive it.
template <class Real>
class LinearCombination {
 public:
  /// Room for the terms of any stage equation: all X_j and M_jk, j <= k, of max_stages stages.
  static constexpr std::size_t most = max_stages * (max_stages + 3) / 2;

  // Copies, and leaves alone, all but the terms there are: there is room for many.
  LinearCombination() {}  // NOLINT(modernize-use-equals-default): `= default` would zero the room
  LinearCombination(const LinearCombination& other) : count_(other.count_) {
    std::copy_n(other.weights_.begin(), count_, weights_.begin());
    std::copy_n(other.terms_.begin(), count_, terms_.begin());
  }
  LinearCombination& operator=(const LinearCombination&) = delete;

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
  /// The widest band of a term.
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

/// The sum of one weighted matrix, to be added to.
template <class Real>
LinearCombination<Real> sum_of(double weight, const SplitMatrixOf<Real>& X) {
  return LinearCombination<Real>().add(weight, X);
}
/// Σ_j weights(j) Y_j.
template <class Weights, class Real>
LinearCombination<Real> sum_of(const Weights& weights, const SplitStagesOf<Real>& Y) {
  return LinearCombination<Real>().add(weights, Y);
}

namespace linear_combination {

// Of some rows of one matrix; those that return a number return the sum of squares of what the name
// says.  The out matrix may be a term.
template <class Real>
void assign_rows(const LinearCombination<Real>& sum, parallel::Rows rows, SplitMatrixOf<Real>& out);
template <class Real>
double change_rows(const LinearCombination<Real>& sum, parallel::Rows rows,
                   SplitMatrixOf<Real>& out);
double residual_rows(const LinearCombination<double>& sum, const SplitMatrix& X,
                     parallel::Rows rows, SingleMatrix& R);
template <class Real>
double squares_of_rows(const SplitMatrixOf<Real>& X, parallel::Rows rows);
void round_rows(const SplitMatrix& X, parallel::Rows rows, SingleMatrix& S);
void add_rows(const SingleMatrix& S, parallel::Rows rows, SplitMatrix& X);

// Calls f(item, rows) for the blocks of rows of all items.
template <class F>
void for_each_block_of_rows(std::size_t items, Index n, F&& f) {
  const Index blocks = parallel::sum_blocks(n);
  parallel::for_each_block(
      static_cast<Index>(items), blocks, [&](Index item, Index block) {
        f(static_cast<std::size_t>(item),
          parallel::Rows{n * block / blocks, n * (block + 1) / blocks});
      });
}

// The largest sqrt of Σ f(item, rows) over the blocks of an item, added in the order of blocks; NaN
// if any is.
template <class F>
double largest_norm_of(std::size_t items, Index n, F&& f) {
  const Index blocks = parallel::sum_blocks(n);
  std::array<double, LinearCombination<double>::most * parallel::most_sum_blocks> squares;
  parallel::for_each_block(
      static_cast<Index>(items), blocks, [&](Index item, Index block) {
        squares[static_cast<std::size_t>(item * blocks + block)] =
            f(static_cast<std::size_t>(item),
              parallel::Rows{n * block / blocks, n * (block + 1) / blocks});
      });
  double largest = 0.0;
  for (Index item = 0; item < static_cast<Index>(items); ++item) {
    double sum = 0.0;
    for (Index b = 0; b < blocks; ++b) sum += squares[static_cast<std::size_t>(item * blocks + b)];
    largest = larger(largest, sum);
  }
  return std::sqrt(largest);
}

}  // namespace linear_combination

/// out_i = sum(i), a LinearCombination, for all i.  out_i may be a term of its own sum, not of
/// others.
template <class Real, class Sum>
void assign(SplitStagesOf<Real>& out, Sum&& sum) {
  if (out.empty()) return;
  linear_combination::for_each_block_of_rows(
      out.size(), out[0].size(), [&](std::size_t i, parallel::Rows rows) {
        linear_combination::assign_rows(sum(i), rows, out[i]);
      });
}

/// out = sum, likewise, of one matrix.
template <class Real>
void assign(SplitMatrixOf<Real>& out, const LinearCombination<Real>& sum) {
  linear_combination::for_each_block_of_rows(
      1, out.size(), [&](std::size_t, parallel::Rows rows) {
        linear_combination::assign_rows(sum, rows, out);
      });
}

/// The same of all X_i; returns the largest Frobenius norm of a change of X_i, NaN if any is.
template <class Real, class Sum>
double replace(SplitStagesOf<Real>& X, Sum&& sum) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::change_rows(sum(i), rows, X[i]);
      });
}

/// R_i = sum(i) - X_i, formed in double and rounded to single precision; returns the largest
/// Frobenius norm, NaN if any is.
template <class Sum>
double residual(const SplitStages& X, Sum&& sum, SingleStages& R) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::residual_rows(sum(i), X[i], rows, R[i]);
      });
}

/// The largest Frobenius norm, NaN if any is.
template <class Real>
double largest_norm(const SplitStagesOf<Real>& X) {
  if (X.empty()) return 0.0;
  return linear_combination::largest_norm_of(
      X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows) {
        return linear_combination::squares_of_rows(X[i], rows);
      });
}

/// S_i = X_i rounded to single precision, with its band.
void round_to_single(const SplitStages& X, SingleStages& S);

/// X_i += S_i.
void add(const SingleStages& S, SplitStages& X);

/// X_i += scale I.
void add_identity(float scale, SingleStages& X);

}  // namespace isosyrk
