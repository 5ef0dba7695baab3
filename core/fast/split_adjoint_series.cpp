#include "isosyrk/fast/split_adjoint_series.h"

#include <cmath>
#include <utility>

#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

SplitAdjointSeries::SplitAdjointSeries(Index n)
    : term_(split_stages(1, n)),
      next_(term_),
      product_(term_),
      Omega_single_(split_stages<float>(1, n)),
      term_single_(Omega_single_),
      next_single_(Omega_single_),
      product_single_(Omega_single_) {}

bool SplitAdjointSeries::conjugate(SplitStages& out, const SplitStages& Omega, const SplitStages& W,
                                   SplitProducts& products, SingleProducts& single_products,
                                   BandTruncation& bands, double tail) {
  constexpr int most_terms = 200;
  constexpr double rounding = 1e-17;  // relative to W, in the Frobenius norm
  const double size_of_W = largest_norm(W);
  copy(out, W);
  copy(term_, W);
  bool in_single = false;
  for (int k = 1; k <= most_terms; ++k) {
    const double factor = 1.0 / static_cast<double>(k);
    double size = 0.0;  // of T_k
    if (in_single) {
      single_products.form(into(product_single_[0], Omega_single_[0] * term_single_[0]));
      skew_part(next_single_, product_single_, factor);
      add(out, next_single_);
      std::swap(term_single_, next_single_);
      size = largest_norm(term_single_);
    } else {
      bands.truncate(term_, tail);
      products.form(into(product_[0], Omega[0] * term_[0]));
      skew_part(next_, product_, factor);
      out[0] = out[0] + next_[0];
      std::swap(term_, next_);
      size = largest_norm(term_);
    }
    if (!std::isfinite(size)) return false;
    if (size <= rounding * size_of_W) return true;
    if (!in_single && size <= tuning.single_term * size_of_W) {
      in_single = true;
      round_to_single(Omega_single_, Omega);
      round_to_single(term_single_, term_);
    }
  }
  return false;
}

}  // namespace isosyrk
