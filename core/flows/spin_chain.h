// The Heisenberg chain: N classical spins in a ring.
#pragma once

#include "isosyrk/flows/flow.h"

namespace isosyrk {

/// W' = [B(W), W] on su(2)^N, n = 2N.  W is block diagonal; its blocks are the spins
/// W_k = (i/2) Σ_a s_k^a σ_a, k = 0 .. N-1, and
///
///     B_k = W_{k-1} + W_{k+1}  (indices mod N),
///     H(W) = -Σ_k Re tr(W_k† W_{k+1}) = -½ Σ_k s_k · s_{k+1},
///
/// so that s_k' = s_k × (s_{k-1} + s_{k+1}).  The total spin Σ_k W_k is conserved.  In storage the
/// blocks stand on top of one another, 2N x 2.
class SpinChain final : public Flow {
 public:
  /// n is even and at least 6.
  explicit SpinChain(Index n) : Flow(QuadraticAlgebra::skew_hermitian(n, 2), Generator::linear) {}

  void generator(const Matrix& W, Matrix& B) const override;
  double hamiltonian(const Matrix& W) const override;
  /// The coupling of spins k and k + 1 is that of k + 1 and k.
  bool has_self_adjoint_generator() const override { return true; }
};

}  // namespace isosyrk
