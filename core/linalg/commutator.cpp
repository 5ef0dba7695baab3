#include "isosyrk/linalg/commutator.h"

namespace isosyrk {

void commutator_of_product(const QuadraticAlgebra& algebra, const Matrix& C, Matrix& scratch,
                           Matrix& out) {
  if (algebra.is_skew_hermitian()) {
    out = C - C.adjoint();
    return;
  }
  algebra.involution(C, scratch);
  out = C - scratch;
}

void add_commutator(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& C,
                    Matrix& scratch, Matrix& out) {
  commutator_of_product(algebra, C, scratch, out);
  out += W0;
}

}  // namespace isosyrk
