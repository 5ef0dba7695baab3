// J-quadratic Lie groups and algebras, and the storage of their matrices.
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
///
/// Storage: integrators and flows hold an n x n matrix as its diagonal blocks of size b, one on top
/// of the other, n x b.  A dense matrix is one block, b = n.  Sums and norms need not know of b;
/// products and adjoints work on each block.
class QuadraticAlgebra {
 public:
  /// Returns the algebra of J = I, of dense matrices.  Throws std::invalid_argument for n < 1.
  static QuadraticAlgebra skew_hermitian(Index n) { return skew_hermitian(n, n); }
  /// Returns the algebra of J = I, of matrices with diagonal blocks of size b: u(b)^(n/b).  Throws
  /// std::invalid_argument unless b divides n >= 1.
  static QuadraticAlgebra skew_hermitian(Index n, Index b);
  /// The algebra of any J, of dense matrices.  Throws std::invalid_argument unless J is square and
  /// finite with J² = alpha I, alpha != 0, to 1e-14 relative to |alpha|.
  explicit QuadraticAlgebra(const Matrix& J);

  Index size() const { return n_; }
  /// Returns b, the size of the diagonal blocks; n if matrices are dense.
  Index block() const { return block_; }
  bool is_dense() const { return block_ == n_; }
  bool is_skew_hermitian() const { return entries_.empty(); }
  /// True if J is real up to a factor, which g and G do not depend on.
  bool has_real_J() const { return real_; }

  // Each for Scalar = double, if J is real, and Complex.
  /// Returns the zero matrix in storage.
  template <class Scalar>
  MatrixOf<Scalar> zero() const {
    return MatrixOf<Scalar>::Zero(n_, block_);
  }
  /// Returns the identity in storage.
  template <class Scalar>
  MatrixOf<Scalar> identity() const {
    return MatrixOf<Scalar>::Identity(block_, block_).replicate(n_ / block_, 1);
  }
  /// Copies an n x n matrix to storage.  Throws std::invalid_argument for one that storage cannot
  /// hold: with an imaginary part if Scalar is double, or an entry outside the blocks.
  template <class Scalar>
  void pack(const Eigen::Ref<const Matrix>& W, MatrixOf<Scalar>& stored) const;
  /// Copies a matrix in storage to an n x n matrix.
  template <class Scalar>
  void unpack(const MatrixOf<Scalar>& stored, MatrixView W) const;

  /// out = J⁻¹ X† J, the anti-automorphism with g = { W : W = -J⁻¹ W† J }.  out is not X.
  template <class Scalar>
  void involution(const MatrixOf<Scalar>& X, MatrixOf<Scalar>& out) const;
  /// out = X projected onto g: X itself for X in g, otherwise ½ (X - J⁻¹ X† J).  For J = I it is
  /// made of the upper triangle of X and the imaginary part of its diagonal, and in g exactly.  out
  /// is not X.
  template <class Scalar>
  void project(const MatrixOf<Scalar>& X, MatrixOf<Scalar>& out) const;
  /// out = J Q J⁻¹.  out is not Q.
  template <class Scalar>
  void conjugate_by_J(const MatrixOf<Scalar>& Q, MatrixOf<Scalar>& out) const;

  /// Returns the largest entry of |W† J + J W| for an n x n matrix, which is 0 exactly on g.  For
  /// J = I this is skew_defect(W).
  double algebra_defect(const Matrix& W) const;
  /// Returns the largest entry of |Q† J Q - J|, which is 0 exactly on G.
  double group_defect(const Matrix& Q) const;

 private:
  struct Entry {
    Index row;
    Index column;
    Complex value;
  };
  QuadraticAlgebra(Index n, Index b);
  // out = J Y J⁻¹ for a matrix or an expression Y.
  template <class Expression, class Scalar>
  void conjugate(const Expression& Y, MatrixOf<Scalar>& out) const;
  // The same as a sum over pairs of entries of J, with factors double or Complex.
  template <class Factor, class Expression, class Scalar>
  void sum_over_entries(const Expression& Y, MatrixOf<Scalar>& out) const;
  Matrix dense_J() const;

  Index n_;
  Index block_;
  bool real_ = true;
  Complex alpha_ = 1.0;         // J² = alpha I, so J⁻¹ = J / alpha
  std::vector<Entry> entries_;  // empty for J = I
};

}  // namespace isosyrk
