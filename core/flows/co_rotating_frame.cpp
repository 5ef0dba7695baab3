#include "isosyrk/flows/co_rotating_frame.h"

#include "isosyrk/flows/invariants.h"
#include "isosyrk/flows/spin.h"
#include "isosyrk/flows/split_laplacian.h"

namespace isosyrk {
namespace {

// V' = [B'(V), V] with B'(V) = B(V - V_1).  B commutes with the projection.
class CoRotatingFlow final : public Flow {
 public:
  explicit CoRotatingFlow(std::shared_ptr<const EulerZeitlin> flow)
      : Flow(flow->algebra(), Generator::linear), flow_(std::move(flow)) {}

  void generator(const Matrix& V, Matrix& B) const override {
    flow_->generator(V, B);
    subtract_rotation(B);
  }

  // R = B(V_1) = -V_1 / (2ħ), where V_1 = i (c · S) with c_a = L_a / tr S_a².
  double rotation_left_out(const Matrix& V) const override {
    const auto [x, y, z] = angular_momentum(V);
    return std::hypot(x, y, z) / std::sqrt(Spin(size()).squared_norm()) /
           (2.0 * hbar(flow_->convention(), size()));
  }

  double hamiltonian(const Matrix& V) const override {
    Matrix B(size(), size());
    generator(V, B);
    return -0.5 * hbar(flow_->convention(), size()) * V.conjugate().cwiseProduct(B).sum().real();
  }

  // So is B' = B (1 - P), since B commutes with the orthogonal projection P onto l = 1.
  bool has_self_adjoint_generator() const override { return true; }
  bool ignores_trace() const override { return true; }

  std::unique_ptr<SplitGenerator> split_generator() const override {
    return std::make_unique<SplitEulerZeitlin>(
        flow_->laplacian(), 1.0 / hbar(flow_->convention(), size()), Rotation::left_out);
  }

 private:
  std::shared_ptr<const EulerZeitlin> flow_;
};

}  // namespace

void subtract_rotation(Matrix& B) {
  const Index n = B.rows();
  const Spin spin(n);
  double of_z = 0.0;
  Complex of_ladder = 0.0;
  for (Index i = 0; i < n; ++i) of_z += spin.magnetic(i) * B(i, i).imag();
  for (Index i = 0; i + 1 < n; ++i) of_ladder += spin.ladder(i) * B(i, i + 1);
  of_z /= spin.squared_norm();
  of_ladder /= 2.0 * spin.squared_norm();
  for (Index i = 0; i < n; ++i) B(i, i) -= Complex(0.0, of_z * spin.magnetic(i));
  for (Index i = 0; i + 1 < n; ++i) {
    B(i, i + 1) -= of_ladder * spin.ladder(i);
    B(i + 1, i) = -std::conj(B(i, i + 1));
  }
}

CoRotatingFrame::CoRotatingFrame(std::shared_ptr<const EulerZeitlin> flow, int threads)
    : hbar_(hbar(flow->convention(), flow->size())),
      flow_(std::make_shared<CoRotatingFlow>(flow)),
      turn_(flow->size(), threads) {}

CoRotatingFrame::Rate CoRotatingFrame::rate(const Matrix& W0) const {
  // W_1 = i (c · S) with c_a = L_a / tr S_a², and Δ⁻¹ W_1 = -W_1 / 2.
  Rate rate = angular_momentum(W0);
  for (double& component : rate) component /= 2.0 * hbar_ * Spin(W0.rows()).squared_norm();
  return rate;
}

SpinRotation CoRotatingFrame::rotation(const Rate& rate_of, double t) {
  const auto [x, y, z] = rate_of;
  const double rate = std::hypot(x, y, z);
  const double half = 0.5 * t * rate;
  const double sine = rate > 0.0 ? std::sin(half) / rate : 0.0;
  return {{std::cos(half), -sine * z}, {-sine * y, -sine * x}};
}

}  // namespace isosyrk
