#include "isosyrk/flows/flow.h"

#include <stdexcept>

#include "isosyrk/flows/split_generator.h"

namespace isosyrk {

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

double Flow::energy(const Matrix& W) const {
  if (algebra_.is_dense()) return hamiltonian(W);
  Matrix stored = algebra_.zero<Complex>();
  algebra_.pack(W, stored);
  return hamiltonian(stored);
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

double RealFlow::hamiltonian(const Matrix& W) const { return real_hamiltonian(W.real()); }

}  // namespace isosyrk
