// The frame that rotates with the angular momentum of an Euler-Zeitlin flow.
//
// The part W_1 of W with l = 1 is conserved, and its generator R = B(W_1) is constant.  W_1 turns
// all of W rigidly.  Since {H_1, H - H_1} = 0, with H_1 the energy of W_1,
//
//     W(t) = e^{tR} V(t) e^{-tR},    V' = [B'(V), V],    B'(V) = B(V - V_1),    V(0) = W(0).
//
// Both are exact.  A method that solves for V is relieved of the rigid rotation, which dominates B.
// If its step is a Poisson map, so is the step for W, because e^{tR} is part of the flow of H_1.
#pragma once

#include <array>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/linalg/products.h"

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

/// The rotation e^{tR} and the flow of V for n x n matrices.
class CoRotatingFrame {
 public:
  /// The three numbers of R = -i (rate · S).
  using Rate = std::array<double, 3>;

  /// Computes the eigenvectors of S_x, which rotations are made of.
  CoRotatingFrame(std::shared_ptr<const EulerZeitlin> flow, ProductBackend backend);

  /// Returns the flow V' = [B'(V), V].
  const SharedFlow& flow() const { return flow_; }

  /// Returns R for the angular momentum of W₀.
  Rate rate(const Matrix& W0) const;
  /// Returns e^{tR}.
  static SpinRotation rotation(const Rate& rate, double t);
  /// W = U V U†, with three products.  Allocates nothing.  W may be V.
  void turn(const SpinRotation& U, const Matrix& V, MatrixView W);
  /// W = e^{tR} V e^{-tR}, as turn().
  void leave(const Rate& rate, double t, const Matrix& V, MatrixView W) {
    turn(rotation(rate, t), V, W);
  }

 private:
  void set_rotation(const SpinRotation& U);

  double hbar_;
  SharedFlow flow_;
  Matrix eigenvectors_;  // of S_x: column k for the eigenvalue k - (n-1)/2
  Matrix rotation_;      // U†
  Matrix scratch_;
  Matrix turned_;
  Products products_;
};

/// Subtracts from a skew-Hermitian B its part with l = 1, which lies on the diagonals 0 and ±1.
void subtract_rotation(Matrix& B);

}  // namespace isosyrk
