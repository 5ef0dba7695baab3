#include "isosyrk/simulation/conservation.h"

#include <stdexcept>

#include "isosyrk/flows/co_rotating_frame.h"
#include "isosyrk/flows/invariants.h"

namespace isosyrk {

ConservationWatch::ConservationWatch(const Scene& scene)
    : scene_(scene), initial_energy_(scene.flow->energy(scene.initial)) {}

void ConservationWatch::observe(double energy) {
  energy_error_ = larger(energy_error_, std::abs(energy / initial_energy_ - 1.0));
}

Conservation ConservationWatch::report(const Matrix& W) const {
  const QuadraticAlgebra& algebra = scene_.flow->algebra();
  return {spectrum_error(algebra, W, scene_.initial), algebra.algebra_defect(W), energy_error_};
}

std::array<double, 4> casimir_errors(const Matrix& W, const Matrix& W0) {
  const RealVector eigenvalues = spectrum(W0).cwiseAbs();
  std::array<double, 4> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const int k = static_cast<int>(i) + 2;
    const double scale = eigenvalues.array().pow(k).sum();
    errors[i] = std::abs(casimir(W, k) - casimir(W0, k)) / scale;
  }
  return errors;
}

double angular_momentum_error(const Matrix& W, const Matrix& W0) {
  const std::array<double, 3> momentum = angular_momentum(W);
  const std::array<double, 3> initial = angular_momentum(W0);
  double change = 0.0;
  for (std::size_t a = 0; a < 3; ++a) change = larger(change, std::abs(momentum[a] - initial[a]));
  return change / std::hypot(initial[0], initial[1], initial[2]);
}

RealVector generator_frequencies(const Scene& scene, bool co_rotating) {
  if (!scene.flow->algebra().is_skew_hermitian()) {
    throw std::invalid_argument("frequencies of B: for J = I only");
  }
  Matrix B = scene.flow->dense_generator(scene.initial);
  if (co_rotating) subtract_rotation(B);
  return spectrum(B);
}

double generator_norm(const Scene& scene) {
  if (scene.flow->algebra().is_skew_hermitian()) return generator_norms(scene).B;
  return operator_norm(scene.flow->dense_generator(scene.initial));
}

GeneratorNorms generator_norms(const Scene& scene) {
  return generator_norms(generator_frequencies(scene));
}

GeneratorNorms generator_norms(const RealVector& frequencies) {
  return {frequencies.cwiseAbs().maxCoeff(), frequencies.maxCoeff() - frequencies.minCoeff()};
}

}  // namespace isosyrk
