#include "isosyrk/integrators/isospectral_midpoint.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/linalg/commutator.h"

namespace isosyrk {

IsospectralMidpoint::IsospectralMidpoint(const Flow& flow, const SolverOptions& options,
                                         ProductBackend backend)
    : Integrator(flow, backend), options_(options) {
  W_stage_ = B_ = M_ = MB_ = Matrix::Zero(flow.size(), flow.size());
  if (!flow.algebra().is_skew_hermitian()) adjoint_ = M_;
}

double IsospectralMidpoint::sweep(const Matrix& W0, double h) {
  generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_);
  products_.multiply(M_, B_, MB_);
  const double linear = 0.5 * h;
  const double quadratic = 0.25 * h * h;
  double change = 0.0;
  if (flow_.algebra().is_skew_hermitian()) {
    change = replace(W_stage_, [&](Index r, Index c) {
      return W0(r, c) + linear * (M_(r, c) - std::conj(M_(c, r))) + quadratic * MB_(r, c);
    });
  } else {
    flow_.algebra().involution(M_, adjoint_);
    change = replace(W_stage_, [&](Index r, Index c) {
      return W0(r, c) + linear * (M_(r, c) - adjoint_(r, c)) + quadratic * MB_(r, c);
    });
  }
  return std::sqrt(change);
}

SolveReport IsospectralMidpoint::advance(const Matrix& W0, double h, Matrix& W1) {
  W_stage_ = W0;
  const SolveReport report = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (report.status != Status::converged) return report;

  generator(W_stage_, B_);
  products_.multiply(B_, W_stage_, M_, h);
  add_commutator(flow_.algebra(), W0, M_, adjoint_, W1);
  return report;
}

}  // namespace isosyrk
