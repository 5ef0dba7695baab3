// Sums that go from double to single precision and back, one pass over memory each.
//
// Rows of planar matrices are filled up differently in the two, so these run row by row.
#pragma once

#include <algorithm>
#include <vector>

#include "isosyrk/split/split_matrix.h"
#include "isosyrk/split/split_sums.h"

namespace isosyrk {

namespace mixed_sums {

constexpr Index length = 8;
using Doubles = Eigen::Array<double, length, 1>;
using Singles = Eigen::Array<float, length, 1>;

inline auto at(const double* numbers, Index i) { return Eigen::Map<const Doubles>(numbers + i); }
inline auto at(const PlanarMatrix& X, Index i) { return at(X.entries().data(), i); }
inline auto at(PlanarMatrix& X, Index i) { return Eigen::Map<Doubles>(X.entries().data() + i); }
inline auto at(const SingleMatrix& X, Index i) {
  return Eigen::Map<const Singles>(X.entries().data() + i);
}
inline auto at(SingleMatrix& X, Index i) { return Eigen::Map<Singles>(X.entries().data() + i); }

/// Calls body(i, k) for eight numbers after the other, at i in double and k in single precision.
template <class Body>
void for_pieces(Index n, Share share, Body&& body) {
  const Rows rows(n, share);
  const Index row = planar_row<double>(n);
  const Index single_row = planar_row<float>(n);
  const Index columns = std::min(row, single_row);
  for (Index part = 2 * rows.begin; part < 2 * rows.end; ++part) {
    for (Index c = 0; c < columns; c += length) body(part * row + c, part * single_row + c);
  }
}

}  // namespace mixed_sums

/// R_i = base + h Σ_j a_ij Y_j - X_i for i = 1..s, the change that update_unknowns would make, in
/// single precision; squares[i] = Σ |R_i|².
void residuals(const PlanarMatrix& base, double h, const RealMatrix& a,
               const std::vector<PlanarMatrix>& Y, const std::vector<PlanarMatrix>& X,
               std::vector<SingleMatrix>& R, double* squares, Share share);

/// R = fresh - X in single precision, `fresh` as that of planar_sums.h; returns Σ |R|².
template <class Fresh>
double residual(const PlanarMatrix& X, const Fresh& fresh, SingleMatrix& R, Share share) {
  using mixed_sums::at;
  return planar_sums::unrolled(fresh, [&](const auto& sum_at) {
    mixed_sums::Doubles sum = mixed_sums::Doubles::Zero();
    const double* const from = X.entries().data();
    mixed_sums::for_pieces(X.size(), share, [&](Index i, Index k) {
      const auto load = [i](const auto& Y) { return at(Y, i); };
      const mixed_sums::Doubles change = sum_at(load) - at(from, i);
      sum += change.square();
      at(R, k) = change.cast<float>();
    });
    return sum.sum();
  });
}

/// The i-th of the residuals of all stages by itself, the same bit for bit; returns its square.
double residual(const PlanarMatrix& base, double h, const RealMatrix& a, Index i,
                const std::vector<PlanarMatrix>& Y, const PlanarMatrix& X_i, SingleMatrix& R_i,
                Share share);

/// S = X, rounded, with its band.
void narrow(const PlanarMatrix& X, SingleMatrix& S, Share share);

/// X += S.
void add(const SingleMatrix& S, PlanarMatrix& X, Share share);

}  // namespace isosyrk
