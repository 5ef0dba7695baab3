#include "isosyrk/solver/neumann_correction.h"

#include <algorithm>
#include <utility>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {

NeumannCorrection::NeumannCorrection(const Unknowns& like)
    : term_(corrections_like(like)), next_(term_) {}

Correction NeumannCorrection::solve(Corrections& delta, Coupling& coupling, const Corrections& R,
                                    const CorrectionRequest& request,
                                    const IterationOptions& options) {
  copy(delta, R);
  copy(term_, R);
  double size = request.size;  // of the last term
  double before = 0.0;         // and of the one before it
  double contraction = tuning.likely_contraction;
  // The terms not yet added sum to about size c / (1 - c).
  const auto rest = [&] { return size * contraction / (1.0 - contraction); };
  for (int k = 0; k < tuning.inner_sweeps && !(rest() < request.forcing_term); ++k) {
    options.swept();
    coupling.couple(next_, term_, tuning.neumann_term * request.forcing_term);
    double now = 0.0;
    for (std::size_t kind = 0; kind < delta.size(); ++kind) {
      SingleStages& sum = delta[kind];
      // One at a time, unlike assign(): only the band of each is passed over.
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = sum[i] + next_[kind][i];
      now = larger(now, largest_norm(next_[kind]));
    }
    // K is not normal: near a steady state terms shrink by 0.03 and grow by 1.4 in turns.
    if (!(now < std::max(size, before))) return {};  // NaN included
    contraction = std::min(std::max(0.5 * contraction, now / size), 0.9);
    before = size;
    size = now;
    std::swap(term_, next_);
  }
  return {.usable = rest() < request.size, .error = rest()};
}

}  // namespace isosyrk
