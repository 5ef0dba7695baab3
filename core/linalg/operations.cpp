#include "isosyrk/linalg/operations.h"

namespace isosyrk {

template <class Scalar>
void commutator_of_product(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& C,
                           MatrixOf<Scalar>& scratch, MatrixOf<Scalar>& out) {
  if (!algebra.is_skew_hermitian()) {
    algebra.involution(C, scratch);
    out = C - scratch;
  } else if (algebra.is_dense()) {
    out = C - C.adjoint();
  } else {
    const AdjointOf<Scalar> adjoint(C);
    for (Index r = 0; r < C.rows(); ++r) {
      for (Index c = 0; c < C.cols(); ++c) out(r, c) = C(r, c) - adjoint(r, c);
    }
  }
}

template <class Scalar>
void add_commutator(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                    const MatrixOf<Scalar>& C, MatrixOf<Scalar>& scratch, MatrixOf<Scalar>& out) {
  commutator_of_product(algebra, C, scratch, out);
  out += W0;
}

// Makes the operations for real and for complex matrices.
#define ISOSYRK_OPERATIONS(Scalar)                                                      \
  template void commutator_of_product(const QuadraticAlgebra&, const MatrixOf<Scalar>&, \
                                      MatrixOf<Scalar>&, MatrixOf<Scalar>&);            \
  template void add_commutator(const QuadraticAlgebra&, const MatrixOf<Scalar>&,        \
                               const MatrixOf<Scalar>&, MatrixOf<Scalar>&, MatrixOf<Scalar>&);
ISOSYRK_OPERATIONS(double)
ISOSYRK_OPERATIONS(Complex)
#undef ISOSYRK_OPERATIONS

}  // namespace isosyrk
