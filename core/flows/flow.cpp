#include "isosyrk/flows/flow.h"

#include <stdexcept>

#include "isosyrk/flows/split_generator.h"
#include "isosyrk/linalg/power_of_two.h"

namespace isosyrk {
namespace {

// Returns H(2^exponent V) for a function H of V.
template <class Scalar, class Hamiltonian>
Energy energy_of(const MatrixOf<Scalar>& V, int exponent, bool is_quadratic,
                 const Hamiltonian& hamiltonian) {
  if (!is_quadratic) return Energy(hamiltonian(times_power_of_two(V, exponent)));
  const int unit = exponent_of_largest(V);
  return Energy(hamiltonian(times_power_of_two(V, -unit)), 2 * (exponent + unit));
}

}  // namespace

std::unique_ptr<SplitGenerator> Flow::split_generator() const { return nullptr; }

Matrix Flow::dense_generator(const Matrix& W) const {
  Matrix stored = algebra_.zero<Complex>();
  Matrix B = stored;
  algebra_.pack(W, stored);
  Matrix projected = B;
  generator(argument(stored, projected), B);
  Matrix dense(size(), size());
  algebra_.unpack(B, dense);
  return dense;
}

Energy Flow::energy(const Matrix& W) const {
  if (algebra_.is_dense()) return stored_energy(W);
  Matrix stored = algebra_.zero<Complex>();
  algebra_.pack(W, stored);
  return stored_energy(stored);
}

Energy Flow::stored_energy(const Matrix& V, int exponent) const {
  return energy_of(V, exponent, has_quadratic_hamiltonian(),
                   [this](const Matrix& W) { return hamiltonian(W); });
}

RealFlow::RealFlow(QuadraticAlgebra algebra, Generator kind) : Flow(std::move(algebra), kind) {
  if (!this->algebra().has_real_J()) {
    throw std::invalid_argument("flow of real matrices: J must be real");
  }
}

void RealFlow::generator(const Matrix& W, Matrix& B) const {
  MatrixOf<double> real_B = algebra().zero<double>();
  real_generator(W.real(), real_B);
  B = real_B.cast<Complex>();
}

Energy RealFlow::stored_energy(const MatrixOf<double>& V, int exponent) const {
  return energy_of(V, exponent, has_quadratic_hamiltonian(),
                   [this](const MatrixOf<double>& W) { return real_hamiltonian(W); });
}

double RealFlow::hamiltonian(const Matrix& W) const { return real_hamiltonian(W.real()); }

}  // namespace isosyrk
