#include "isosyrk/integrators/isospectral_midpoint.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/linalg/operations.h"

namespace isosyrk {

IsospectralMidpoint::IsospectralMidpoint(const Flow& flow, const SolverOptions& options,
                                         ProductBackend backend)
    : Integrator(flow), flow_(flow), products_(backend, flow.size()), options_(options) {
  W_stage_ = B_ = M_ = MB_ = Matrix::Zero(flow.size(), flow.size());
  if (!flow.algebra().is_skew_hermitian()) adjoint_ = M_;
}

double IsospectralMidpoint::sweep(const Matrix& W0, double h) {
  flow_.generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_);
  products_.multiply(M_, B_, MB_);
  return std::sqrt(update_midpoint_vorticity(flow_.algebra(), W0, 0.5 * h, M_, 0.25 * h * h, MB_,
                                             adjoint_, W_stage_));
}

StepReport IsospectralMidpoint::advance(const Matrix& W0, double h, Matrix& W1) {
  const StepCount count(flow_, products_);
  W_stage_ = W0;
  const SolveReport solve = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (solve.status != Status::converged) return count.report(solve);

  flow_.generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_, h);
  add_commutator(flow_.algebra(), W0, M_, adjoint_, W1);
  return count.report(solve);
}

}  // namespace isosyrk
