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
#include "isosyrk/flows/spin_conjugation.h"

namespace isosyrk {

/// The rotation e^{tR} and the flow of V for n x n matrices.
class CoRotatingFrame {
 public:
  /// The three numbers of R = -i (rate · S).
  using Rate = std::array<double, 3>;

  /// Turns on so many threads.  Throws as SpinConjugation.
  explicit CoRotatingFrame(std::shared_ptr<const EulerZeitlin> flow, int threads = 1);

  /// Returns the flow V' = [B'(V), V].
  const SharedFlow& flow() const { return flow_; }

  /// Returns R for the angular momentum of W₀.
  Rate rate(const Matrix& W0) const;
  /// Returns e^{tR}.
  static SpinRotation rotation(const Rate& rate, double t);
  /// W = U V U†.  W may be V.
  void turn(const SpinRotation& U, const Matrix& V, MatrixView W) { turn_.conjugate(U, V, W); }
  /// W = e^{tR} V e^{-tR}.  W may be V.
  void leave(const Rate& rate, double t, const Matrix& V, MatrixView W) {
    turn(rotation(rate, t), V, W);
  }

 private:
  double hbar_;
  SharedFlow flow_;
  SpinConjugation turn_;
};

/// Subtracts from a skew-Hermitian B its part with l = 1, which lies on the diagonals 0 and ±1.
void subtract_rotation(Matrix& B);

}  // namespace isosyrk
