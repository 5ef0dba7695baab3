#include "isosyrk/integrators/isospectral_midpoint.h"

namespace isosyrk {

template <class Scalar>
IsospectralMidpoint<Scalar>::IsospectralMidpoint(SharedFlowIn<Scalar> flow,
                                                 const IterationOptions& options,
                                                 ProductBackend backend)
    : Form(std::move(flow), options, backend) {
  W_stage_ = B_ = M_ = MB_ = zero();
  adjoint_ = scratch_of_J();
}

template <class Scalar>
double IsospectralMidpoint<Scalar>::sweep(const Stored& W0, double h) {
  generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_);
  products_.multiply(M_, B_, MB_);
  return std::sqrt(
      update_midpoint_vorticity(algebra(), W0, 0.5 * h, M_, 0.25 * h * h, MB_, adjoint_, W_stage_));
}

template <class Scalar>
void IsospectralMidpoint<Scalar>::start(const Stored& W0) {
  W_stage_ = W0;
}

template <class Scalar>
void IsospectralMidpoint<Scalar>::update(const Stored& W0, double h, Stored& W1) {
  generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_, h);
  add_commutator(algebra(), W0, M_, adjoint_, W1);
}

template class IsospectralMidpoint<double>;
template class IsospectralMidpoint<Complex>;

}  // namespace isosyrk
