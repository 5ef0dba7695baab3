#include "isosyrk/fast/graded_series.h"

#include <cmath>
#include <utility>

#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

GradedSeries::GradedSeries(SplitProducts& products, SingleProducts& single_products, Index n)
    : products_(products),
      single_products_(single_products),
      term_(split_stages(1, n)),
      next_(n),
      product_(n),
      Omega_single_(n),
      term_single_(n),
      next_single_(n),
      product_single_(n),
      rounded_(n) {}

void GradedSeries::begin(const SplitMatrix& Omega, const SplitMatrix& W, double error) {
  Omega_ = &Omega;
  error_ = error;
  k_ = 0;
  in_single_ = failed_ = false;
  term_[0] = 1.0 * W;
  size_ = norm(term_[0]);
}

bool GradedSeries::advance() {
  constexpr int most_terms = 200;
  const double factor = 1.0 / static_cast<double>(++k_);
  if (!in_single_ && size_ * tuning.single_roundoff <= error_) {
    in_single_ = true;
    round_to_single(Omega_single_, *Omega_);
    round_to_single(term_single_, term_[0]);
  }
  if (in_single_) {
    if (bands_ != nullptr) bands_->truncate(term_single_, tail_);
    single_products_.form(into(product_single_, Omega_single_ * term_single_));
    skew_part(next_single_, product_single_, factor);
    std::swap(term_single_, next_single_);
    size_ = norm(term_single_);
  } else {
    if (bands_ != nullptr) bands_->truncate(term_, tail_);
    products_.form(into(product_, *Omega_ * term_[0]));
    skew_part(next_, product_, factor);
    std::swap(term_[0], next_);
    size_ = norm(term_[0]);
  }
  failed_ = !std::isfinite(size_) || k_ >= most_terms;
  return !failed_ && size_ > tuning.series_end * error_;
}

void GradedSeries::add_to(SplitMatrix& sum, double weight) const {
  if (in_single_) {
    add(sum, term_single_, weight);
  } else {
    sum = sum + weight * term_[0];
  }
}

void GradedSeries::add_to(SingleMatrix& sum, double weight) {
  if (!in_single_) round_to_single(rounded_, term_[0]);
  sum = sum + weight * (in_single_ ? term_single_ : rounded_);
}

bool GradedSeries::conjugate(SplitMatrix& out, const SplitMatrix& Omega, const SplitMatrix& W,
                             double error) {
  out = 1.0 * W;
  begin(Omega, W, error);
  bool goes_on = true;
  while (goes_on) {
    goes_on = advance();
    if (failed()) return false;
    add_to(out, 1.0);
  }
  return true;
}

}  // namespace isosyrk
