// Linear combinations of stage matrices, block by block, and the change of an unknown.
//
// The sums over stages cost O(s^2 n^2) and would, done matrix by matrix, be passes over memory.
// Done in blocks, a block of every stage is in the first-level cache when it is combined, stored
// and compared with its old value.  All coefficients are real, so that a matrix is seen as 2n²
// real numbers and a block is a range of them.
#pragma once

#include <vector>

#include "core/matrix.h"

namespace isosyrk {

/// Real numbers begin .. begin + length - 1 of the 2n² of a matrix.
struct Block {
  Index begin;
  Index length;
};

/// Real numbers in a block: the dozen or so blocks combined together fit the first-level cache.
inline constexpr Index block_length = 128;

/// Calls body(Block) for the blocks of an n x n matrix in turn.
template <class Body>
void for_each_block(Index n, Body&& body) {
  const Index end = 2 * n * n;
  for (Index begin = 0; begin < end; begin += block_length) {
    body(Block{begin, std::min(block_length, end - begin)});
  }
}

using Entries = Eigen::Map<Eigen::ArrayXd>;
using ConstEntries = Eigen::Map<const Eigen::ArrayXd>;

/// The block's part of X.
inline Entries entries(Matrix& X, Block block) {
  return {reinterpret_cast<double*>(X.data()) + block.begin, block.length};
}
inline ConstEntries entries(const Matrix& X, Block block) {
  return {reinterpret_cast<const double*>(X.data()) + block.begin, block.length};
}

/// Room for the entries of one block.
class BlockWorkspace {
 public:
  Entries entries(Block block) { return {values_, block.length}; }

 private:
  alignas(64) double values_[block_length] = {};
};

/// Adds the identity's part to a block of an n x n matrix.
inline void add_identity(Entries values, Index n, Block block) {
  const Index period = 2 * (n + 1);  // from one diagonal entry to the next
  for (Index at = (block.begin + period - 1) / period * period; at < block.begin + block.length;
       at += period) {
    values(at - block.begin) += 1.0;
  }
}

/// sum = coefficient(0) X_0 + ... + coefficient(s-1) X_{s-1} on one block, s >= 1.
/// `coefficients` is any s-vector expression of doubles.
template <class Coefficients>
void combine(const Coefficients& coefficients, const Matrix* X, Block block, Entries sum) {
  const Index s = coefficients.size();
  // Up to three terms in one pass over the block; the rest is added three at a time.
  switch (s) {
    case 1:
      sum = coefficients(0) * entries(X[0], block);
      return;
    case 2:
      sum = coefficients(0) * entries(X[0], block) + coefficients(1) * entries(X[1], block);
      return;
    default:
      sum = coefficients(0) * entries(X[0], block) + coefficients(1) * entries(X[1], block) +
            coefficients(2) * entries(X[2], block);
      break;
  }
  for (Index j = 3; j < s; ++j) sum += coefficients(j) * entries(X[j], block);
}

/// Σ |fresh - old|² over one block.
template <class Fresh, class Old>
double squared_change(const Fresh& fresh, const Old& old) {
  return (fresh - old).square().sum();
}

/// Σ |fresh - old|² over two matrices.
inline double squared_change(const Matrix& fresh, const Matrix& old) {
  const Block all{0, 2 * fresh.size()};
  return squared_change(entries(fresh, all), entries(old, all));
}

/// The largest change of several unknowns from their squares; NaN if any is.
inline double largest_change(const RealVector& squares) {
  double largest = 0.0;
  for (const double square : squares) largest = larger(largest, square);
  return std::sqrt(largest);
}

/// s matrices of size n x n, zero.
inline std::vector<Matrix> stage_matrices(Index s, Index n) {
  return std::vector<Matrix>(static_cast<std::size_t>(s), Matrix::Zero(n, n));
}

}  // namespace isosyrk
