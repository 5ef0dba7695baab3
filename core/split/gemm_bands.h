// Index ranges of a product: the terms that can be nonzero within the bands of the factors, and the
// entries of C that are needed.
#pragma once

#include "isosyrk/split/gemm_kernel.h"
#include "isosyrk/split/gemm_vectors.h"

namespace isosyrk {
namespace {

// Indices begin ... end - 1.
struct Range {
  Index begin;
  Index end;
};

// std::min and std::max are functions that the linker could merge.
constexpr Index smaller(Index a, Index b) { return a < b ? a : b; }
constexpr Index greater(Index a, Index b) { return a < b ? b : a; }

// The k within `band` of the indices first ... end - 1.
constexpr Range within_band(Index n, Index first, Index end, Index band) {
  return {greater(0, first - band), smaller(n, end + band)};
}

// The k for which A(i, k) B(k, j) lies within the bands of both factors, for some row i and column
// j of the given block of C.
template <class Real>
inline Range nonzero_terms(const SplitProduct<Real>& product, Index first_row, Index rows,
                           Index first_column, Index columns) {
  const Range of_A = within_band(product.n, first_row, first_row + rows, product.A_band);
  const Range of_B = within_band(product.n, first_column, first_column + columns, product.B_band);
  return {greater(of_A.begin, of_B.begin), smaller(of_A.end, of_B.end)};
}

// True if no entry of the given block of C is needed: all lie beyond C_band or below the upper
// triangle.
template <class Real>
inline bool unneeded(const SplitProduct<Real>& product, Index row, Index rows, Index column,
                     Index columns) {
  return column >= row + rows + product.C_band || column + columns <= row - product.C_band ||
         (product.upper && column + columns <= row);
}

}  // namespace
}  // namespace isosyrk
