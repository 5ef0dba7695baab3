#include "core/commutator_update.h"

namespace isosyrk {

void add_commutator(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& C,
                    Matrix& scratch, Matrix& out) {
  if (algebra.is_skew_hermitian()) {
    out = W0 + (C - C.adjoint());
    return;
  }
  algebra.involution(C, scratch);
  out = W0 + C - scratch;
}

}  // namespace isosyrk
