#include "isosyrk/simulation/conservation.h"

#include <stdexcept>

#include "isosyrk/flows/co_rotating_frame.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/linalg/power_of_two.h"

namespace isosyrk {

ConservationWatch::ConservationWatch(const Scene& scene)
    : scene_(scene), initial_energy_(scene.flow->energy(scene.initial)) {}

void ConservationWatch::observe(const Energy& energy) {
  energy_error_ = larger(energy_error_, std::abs(energy.over(initial_energy_) - 1.0));
}

Conservation ConservationWatch::report(const Matrix& W) const {
  const QuadraticAlgebra& algebra = scene_.flow->algebra();
  return {spectrum_error(algebra, W, scene_.initial), algebra.algebra_defect(W), energy_error_};
}

namespace {

// Two matrices in units of a power of two near the norm of the second: ratios of their powers are
// the same, and do not overflow.
struct InUnits {
  InUnits(const Matrix& matrix, const Matrix& initial)
      : unit(exponent_of_largest(initial)),
        W(times_power_of_two(matrix, -unit)),
        W0(times_power_of_two(initial, -unit)) {}
  int unit;
  Matrix W;
  Matrix W0;
};

std::array<double, 4> casimir_errors_in_units(const Matrix& W, const Matrix& W0) {
  const RealVector eigenvalues = spectrum(W0).cwiseAbs();
  std::array<double, 4> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const int k = static_cast<int>(i) + 2;
    const double scale = eigenvalues.array().pow(k).sum();
    errors[i] = std::abs(casimir(W, k) - casimir(W0, k)) / scale;
  }
  return errors;
}

double angular_momentum_error_in_units(const Matrix& W, const Matrix& W0) {
  const std::array<double, 3> momentum = angular_momentum(W);
  const std::array<double, 3> initial = angular_momentum(W0);
  double change = 0.0;
  for (std::size_t a = 0; a < 3; ++a) change = larger(change, std::abs(momentum[a] - initial[a]));
  return change / std::hypot(initial[0], initial[1], initial[2]);
}

}  // namespace

std::array<double, 4> casimir_errors(const Matrix& W, const Matrix& W0) {
  const InUnits in_units(W, W0);
  return casimir_errors_in_units(in_units.W, in_units.W0);
}

double angular_momentum_error(const Matrix& W, const Matrix& W0) {
  const InUnits in_units(W, W0);
  return angular_momentum_error_in_units(in_units.W, in_units.W0);
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
