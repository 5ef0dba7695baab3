// J-quadratic Lie groups and algebras.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The group and the algebra of a matrix J with J² = alpha I, alpha != 0 (the paper, section 2):
///
///     G = { Q : Q† J Q = J },      g = { W : W† J + J W = 0 }.
///
/// J = I gives u(n), su(n), so(n); J = diag(±1) gives su(p, q); J = [[0, I], [-I, 0]] gives sp(2n).
/// J is stored as the list of its k nonzero entries.  Applying J from both sides costs O(n² + k²).
/// For J = I the list is empty and nothing is applied.
class QuadraticAlgebra {
 public:
  /// Returns the algebra of J = I.  Throws std::invalid_argument for n < 1.
  static QuadraticAlgebra skew_hermitian(Index n);
  /// The algebra of any J.  Throws std::invalid_argument unless J is square and finite with
  /// J² = alpha I, alpha != 0, to 1e-14 relative to |alpha|.
  explicit QuadraticAlgebra(const Matrix& J);

  Index size() const { return n_; }
  bool is_skew_hermitian() const { return entries_.empty(); }

  /// out = J⁻¹ X† J, the anti-automorphism with g = { W : W = -J⁻¹ W† J }.  out is not X.
  void involution(const Matrix& X, Matrix& out) const;
  /// out = J Q J⁻¹.  out is not Q.
  void conjugate_by_J(const Matrix& Q, Matrix& out) const;

  /// Returns the largest entry of |W† J + J W|, which is 0 exactly on g.  For J = I this is
  /// skew_defect(W).
  double algebra_defect(const Matrix& W) const;
  /// Returns the largest entry of |Q† J Q - J|, which is 0 exactly on G.
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
