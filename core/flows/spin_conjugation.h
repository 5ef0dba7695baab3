// Rotations of the sphere, as they turn matrices of the spin-j representation.
#pragma once

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// A rotation as it turns spin 1/2: the unitary matrix with the rows (a, b) and (-b̄, ā), |a|² +
/// |b|² = 1.  The sign is left open, since ±U turn every W alike.
struct SpinRotation {
  Complex a = 1.0;
  Complex b = 0.0;

  SpinRotation inverse() const { return {std::conj(a), -b}; }
  /// Returns the rotation by `first`, then by this one.
  SpinRotation after(const SpinRotation& first) const;
  /// Returns this rotation with |a|² + |b|² = 1 to rounding, which many in a row lose.
  SpinRotation normalized() const;
};

/// W = U V U† for skew-Hermitian n x n matrices V and rotations U of spin j = (n-1)/2:
///
///     U = e^{-iαS_z} e^{-iβS_y} e^{-iγS_z},   e^{-iβS_y} = e^{-i(π/2)S_z} e^{-iβS_x} e^{i(π/2)S_z}
///
/// Around S_z the entries are only multiplied by phases.  S_x commutes with the reversal i ↦ n-1-i
/// of rows and columns.  So e^{-iβS_x} does not mix the even and the odd combinations of the two,
/// (x_i ± x_{n-1-i}) / √2, and is made of two matrices of half the size, E e^{-iβk} Eᵀ with the
/// real eigenvectors E of S_x among the even, and among the odd combinations.
///
/// Products of the size (n+1)/2: 4, 2 triangles, and 2 for the rotation, together 7/8 of a full
/// product of size n.
class SpinConjugation {
 public:
  /// On `threads` threads.  Throws std::invalid_argument as checked_threads, and std::runtime_error
  /// if LAPACK finds no eigenvectors.
  SpinConjugation(Index n, int threads);

  /// W = U V U†, exactly skew-Hermitian.  W may be V.  Allocates nothing.
  void conjugate(const SpinRotation& U, const Matrix& V, MatrixView W);

 private:
  // The even or the odd combinations.
  struct Parity {
    RealMatrix eigenvectors;  // of S_x, a column each; zero beyond their number
    RealVector eigenvalues;   // half-integers in ascending order
    SplitMatrix rotation;     // E e^{iβk} Eᵀ
    SplitMatrix block;        // of V, and of W
  };

  static Parity parity(Index n, bool even);
  void set_rotation(Parity& parity, double beta);
  void set_phases(double angle);
  void combine(const Matrix& V);
  void separate(MatrixView W) const;

  Index n_;
  Index half_;  // (n+1)/2 rounded down, the number of even combinations
  int threads_;
  SplitProducts products_;
  Parity even_, odd_;
  SplitMatrix mixed_;  // the block of even rows and odd columns
  SplitMatrix product_, factor_;
  double unit_ = 1.0;        // a power of two, about the largest entry of V
  Eigen::VectorXcd phases_;  // of a rotation around S_z
};

}  // namespace isosyrk
