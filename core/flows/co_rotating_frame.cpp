#include "isosyrk/flows/co_rotating_frame.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <numbers>
#include <stdexcept>

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

// Column k is the eigenvector of S_x for the eigenvalue k - (n-1)/2.
Matrix eigenvectors_of_S_x(Index n) {
  const Spin spin(n);
  RealVector d = RealVector::Zero(n);
  RealVector e(n);
  for (Index i = 0; i + 1 < n; ++i) e(i) = 0.5 * spin.ladder(i);
  RealMatrix vectors(n, n);
  const auto size = static_cast<lapack_int>(n);
  const lapack_int info =
      LAPACKE_dstevd(LAPACK_COL_MAJOR, 'V', size, d.data(), e.data(), vectors.data(), size);
  if (info != 0) throw std::runtime_error(fmt::format("eigenvectors of S_x: failed ({})", info));
  return vectors.cast<Complex>();
}

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

CoRotatingFrame::CoRotatingFrame(std::shared_ptr<const EulerZeitlin> flow, ProductBackend backend)
    : hbar_(hbar(flow->convention(), flow->size())),
      flow_(std::make_shared<CoRotatingFlow>(flow)),
      eigenvectors_(eigenvectors_of_S_x(flow->size())),
      rotation_(flow->size(), flow->size()),
      scratch_(flow->size(), flow->size()),
      turned_(flow->size(), flow->size()),
      products_(backend, flow->size()) {}

CoRotatingFrame::Rate CoRotatingFrame::rate(const Matrix& W0) const {
  // W_1 = i (c · S) with c_a = L_a / tr S_a², and Δ⁻¹ W_1 = -W_1 / 2.
  Rate rate = angular_momentum(W0);
  for (double& component : rate) component /= 2.0 * hbar_ * Spin(W0.rows()).squared_norm();
  return rate;
}

SpinRotation SpinRotation::after(const SpinRotation& first) const {
  return {a * first.a - b * std::conj(first.b), a * first.b + b * std::conj(first.a)};
}

SpinRotation SpinRotation::normalized() const {
  const double norm = std::hypot(std::abs(a), std::abs(b));
  return {a / norm, b / norm};
}

SpinRotation CoRotatingFrame::rotation(const Rate& rate_of, double t) {
  const auto [x, y, z] = rate_of;
  const double rate = std::hypot(x, y, z);
  const double half = 0.5 * t * rate;
  const double sine = rate > 0.0 ? std::sin(half) / rate : 0.0;
  return {{std::cos(half), -sine * z}, {-sine * y, -sine * x}};
}

// U = e^{-iαS_z} e^{-iβS_y} e^{-iγS_z}, with the angles of the same rotation of spin 1/2, and
// e^{-iβS_y} = e^{-i(π/2)S_z} e^{-iβS_x} e^{i(π/2)S_z}.
void CoRotatingFrame::set_rotation(const SpinRotation& U) {
  const Index n = rotation_.rows();
  const Spin spin(n);
  const double beta = 2.0 * std::atan2(std::abs(U.b), std::abs(U.a));
  const double sum = -std::arg(U.a);
  const double difference = -std::arg(-U.b);

  // b = 0 leaves the difference of the angles free.
  constexpr double quarter = 0.5 * std::numbers::pi;
  const double alpha = sum + difference + quarter;
  const double gamma = sum - difference - quarter;
  const auto phase = [](double angle) { return std::polar(1.0, -angle); };
  for (Index k = 0; k < n; ++k) {
    scratch_.col(k) = phase(beta * (static_cast<double>(k) - spin.j)) * eigenvectors_.col(k);
  }
  products_.multiply_adjoint_right(scratch_, eigenvectors_, rotation_);
  for (Index i = 0; i < n; ++i) {
    rotation_.row(i) *= phase(alpha * spin.magnetic(i));
    rotation_.col(i) *= phase(gamma * spin.magnetic(i));
  }
}

void CoRotatingFrame::turn(const SpinRotation& U, const Matrix& V, MatrixView W) {
  if (U.a == 1.0 && U.b == 0.0) {
    W = V;
    return;
  }
  set_rotation(U.inverse());
  products_.congruence(rotation_, V, rotation_, scratch_, turned_);
  W = 0.5 * (turned_ - turned_.adjoint());  // skew-Hermitian exactly, as V is
}

}  // namespace isosyrk
