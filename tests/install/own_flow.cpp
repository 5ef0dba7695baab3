// A flow of the user's: the free rigid body in n dimensions, W' = [B(W), W] on so(n) with
// B(W)_jk = W_jk / (d_j + d_k).
#include <isosyrk/catalogue/make_integrator.h>
#include <isosyrk/linalg/spectrum.h>
#include <isosyrk/simulation/run.h>

#include <cmath>
#include <cstdio>

using isosyrk::Index;
using isosyrk::Matrix;

namespace {

class RigidBody final : public isosyrk::Flow {
 public:
  explicit RigidBody(Index n) : Flow(isosyrk::QuadraticAlgebra::skew_hermitian(n)) {}

  void generator(const Matrix& W, Matrix& B) const override {
    for (Index j = 0; j < size(); ++j) {
      for (Index k = 0; k < size(); ++k) B(j, k) = W(j, k) / static_cast<double>(j + k + 2);
    }
  }
  double hamiltonian(const Matrix& W) const override {
    Matrix B(size(), size());
    generator(W, B);
    return 0.5 * (W.conjugate().array() * B.array()).sum().real();
  }
};

}  // namespace

int main() {
  const auto body = std::make_shared<const RigidBody>(4);
  Matrix W = Matrix::Zero(4, 4);
  for (Index j = 0; j < 4; ++j) {
    for (Index k = 0; k < j; ++k) {
      W(j, k) = 0.1 * static_cast<double>(j + 2 * k + 1);
      W(k, j) = -W(j, k);
    }
  }
  const Matrix initial = W;
  const auto integrator = isosyrk::make_integrator(body, "algebra2");
  if (!isosyrk::run(*integrator, W, 0.1, 100).converged()) return 1;
  // 100 steps of tolerance 1e-13 each, and a margin of 10.
  const bool kept = isosyrk::spectrum_error(W, initial) < 1e-10;
  const bool moved = (W - initial).norm() > 1e-3;
  // Order 4 with h = 0.1: the energy oscillates by far less.
  const double drift = std::abs(body->hamiltonian(W) - body->hamiltonian(initial));
  std::printf("%s\n", kept && moved && drift < 1e-5 ? "kept" : "lost");
  return kept && moved && drift < 1e-5 ? 0 : 1;
}
