// The Heisenberg chain: N classical spins in a ring.
#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/flows/normal_numbers.h"
#include "isosyrk/flows/scene.h"

namespace isosyrk {
namespace {

/// W' = [B(W), W] on su(2)^N, n = 2N.  W is block diagonal; its blocks are the spins
/// W_k = (i/2) Σ_a s_k^a σ_a, k = 0 .. N-1, and
///
///     B_k = W_{k-1} + W_{k+1}  (indices mod N),   H(W) = -Σ_k Re tr(W_k† W_{k+1}) = -½ Σ_k s_k ·
///     s_{k+1},
///
/// so that s_k' = s_k × (s_{k-1} + s_{k+1}).  The total spin Σ_k W_k is conserved.  In storage the
/// blocks stand on top of one another, 2N x 2.
class SpinChain final : public Flow {
 public:
  explicit SpinChain(Index n) : Flow(QuadraticAlgebra::skew_hermitian(n, 2), Generator::linear) {}

  void generator(const Matrix& W, Matrix& B) const override {
    const Index n = size();
    B.middleRows(2, n - 4) = W.topRows(n - 4) + W.bottomRows(n - 4);
    B.topRows(2) = W.bottomRows(2) + W.middleRows(2, 2);
    B.bottomRows(2) = W.middleRows(n - 4, 2) + W.topRows(2);
  }
  double hamiltonian(const Matrix& W) const override {
    const Index n = size();
    const auto coupling = [](const auto& a, const auto& b) {
      return a.conjugate().cwiseProduct(b).sum().real();
    };
    return -coupling(W.topRows(n - 2), W.bottomRows(n - 2)) -
           coupling(W.bottomRows(2), W.topRows(2));
  }
  // The coupling of spins k and k + 1 is that of k + 1 and k.
  bool has_self_adjoint_generator() const override { return true; }
};

}  // namespace

namespace scenes {

/// N = n/2 >= 3 spins of length 1 on a smooth curve, with some noise.
Scene spin_chain(const SceneParameters& parameters) {
  const Index n = parameters.n;
  if (n < 6 || n % 2 != 0) {
    throw std::invalid_argument(
        fmt::format("n = {}: spin_chain of N spins has n = 2 N, N >= 3", n));
  }
  NormalNumbers normal;
  Matrix W = Matrix::Zero(n, n);
  for (Index k = 0; k < n; k += 2) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    Eigen::Vector3d s(std::cos(angle), std::sin(angle), 0.5 * std::sin(2.0 * angle));
    for (double& component : s) component += 0.1 * normal.next();
    s.normalize();
    const Complex half_i(0.0, 0.5);
    W(k, k) = half_i * s(2);
    W(k + 1, k + 1) = -half_i * s(2);
    W(k, k + 1) = half_i * Complex(s(0), -s(1));
    W(k + 1, k) = half_i * Complex(s(0), s(1));
  }
  return {"spin_chain", std::make_shared<SpinChain>(n), W, 5.0};
}

}  // namespace scenes
}  // namespace isosyrk
