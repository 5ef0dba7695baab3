#include "isosyrk/integrators/isospectral_midpoint.h"

namespace isosyrk {

IsospectralMidpoint::IsospectralMidpoint(const Flow& flow, const SolverOptions& options,
                                         ProductBackend backend)
    : ImplicitForm(flow, options, backend) {
  W_stage_ = B_ = M_ = MB_ = Matrix::Zero(flow.size(), flow.size());
  if (!flow.algebra().is_skew_hermitian()) adjoint_ = M_;
}

double IsospectralMidpoint::sweep(const Matrix& W0, double h) {
  generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_);
  products_.multiply(M_, B_, MB_);
  return std::sqrt(update_midpoint_vorticity(flow().algebra(), W0, 0.5 * h, M_, 0.25 * h * h, MB_,
                                             adjoint_, W_stage_));
}

void IsospectralMidpoint::start(const Matrix& W0) { W_stage_ = W0; }

void IsospectralMidpoint::update(const Matrix& W0, double h, Matrix& W1) {
  generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_, h);
  add_commutator(flow().algebra(), W0, M_, adjoint_, W1);
}

}  // namespace isosyrk
