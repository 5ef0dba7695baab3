// J-quadratic Lie groups and algebras.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The pair (paper, section 2; J invertible, J^2 = alpha I)
///
///     G = { Q : Q† J Q = J },      g = { W : W† J + J W = 0 }.
///
/// J = I gives u(n), su(n), so(n); J = diag(±1) gives su(p, q); J = [[0, I], [-I, 0]] gives sp(2n).
/// J is kept as the list of its nonzero entries, so that applying it costs O(n) entries times n
/// for each of these; for J = I nothing is kept and nothing is applied.
class QuadraticAlgebra {
 public:
  /// J = I.  Throws std::invalid_argument for n < 1.
  static QuadraticAlgebra skew_hermitian(Index n);
  /// Any J.  Throws std::invalid_argument unless J is square, finite and J^2 = alpha I, alpha != 0,
  /// to 1e-14.
  explicit QuadraticAlgebra(const Matrix& J);

  Index size() const { return n_; }
  bool is_skew_hermitian() const { return entries_.empty(); }

  /// out = J⁻¹ X† J, the anti-automorphism with g = { W : W = -J⁻¹ W† J }.  out is not X.
  void involution(const Matrix& X, Matrix& out) const;
  /// out = J Q J⁻¹.  out is not Q.
  void conjugate_by_J(const Matrix& Q, Matrix& out) const;

  /// Largest entry of |W† J + J W|: zero exactly on g (the skew defect, for J = I).
  double algebra_defect(const Matrix& W) const;
  /// Largest entry of |Q† J Q - J|: zero exactly on G.
  double group_defect(const Matrix& Q) const;

 private:
  struct Entry {
    Index row;
    Index column;
    Complex value;
  };
  explicit QuadraticAlgebra(Index n) : n_(n) {}
  Matrix dense_J() const;

  Index n_;
  Complex alpha_ = 1.0;         // J² = alpha I, so J⁻¹ = J / alpha
  std::vector<Entry> entries_;  // empty for J = I
};

}  // namespace isosyrk
