#include "isosyrk/fast/graded_series.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

// A series ends before a term that adds less than this multiple of the wanted error to its sum.
constexpr double negligible_part = 1.0 / 6.0;

}  // namespace

GradedSeries::GradedSeries(SplitProducts& products, SingleProducts& single_products, Index n,
                           const FastOptions& options)
    : products_(products),
      single_products_(single_products),
      is_graded_(options.graded_series),
      Omega_(n),
      term_(n),
      next_(n),
      product_(n),
      Omega_single_(n),
      term_single_(n),
      next_single_(n),
      product_single_(n),
      squares_of_Omega_(RealVector::Zero(n)) {}

// Returns the factor of T_k in the sum.
double GradedSeries::weight(int k) const {
  return sum_ == Sum::average ? 1.0 / static_cast<double>(k + 1) : 1.0;
}

void GradedSeries::begin(const SplitMatrix& Omega, const SplitMatrix& W, double error, Sum sum) {
  Omega_ = 1.0 * Omega;
  error_ = error;
  sum_ = sum;
  tail_now_ = tail_;
  k_ = 0;
  in_single_ = failed_ = false;
  if (bands_ != nullptr) bands_->measure_symmetric(squares_of_Omega_, Omega);
  term_ = 1.0 * W;
  if (!is_graded_) {
    error = std::min(error, conjugation_error * norm(term_));
    tail_now_ = std::min(tail_now_, error);
  }
  end_ = negligible_part * error;
  size_ = cut(term_);
  growth_.begin(size_);
}

// True if T_k, or what T_{k+1} is expected to be, is negligible.
bool GradedSeries::is_last() const {
  const double next = growth_.next(1.0 / static_cast<double>(k_ + 1));
  return weight(k_) * size_ <= end_ || weight(k_ + 1) * next <= end_;
}

// Cuts Ω to the band beyond which it adds less than the tail to T_k = [Ω, T_{k-1}] / k: the smaller
// T_{k-1}, the narrower.
template <class Real>
void GradedSeries::cut_Omega(SplitMatrixOf<Real>& Omega) {
  if (bands_ == nullptr) return;
  const double tail = tail_now_ / weight(k_) * static_cast<double>(k_) / (2.0 * size_);
  change_band(Omega, std::min(Omega.band(), bands_->band_of(squares_of_Omega_, tail)));
}

// Cuts T_k to its band.  Returns its norm.
template <class Real>
double GradedSeries::cut(SplitMatrixOf<Real>& term) {
  return bands_ != nullptr ? bands_->measure_and_truncate_symmetric(term, tail_now_ / weight(k_))
                           : norm(term);
}

bool GradedSeries::advance() {
  constexpr int most_terms = 200;
  const double roundoff = weight(k_ + 1) * size_ * tuning.single_roundoff;
  if (!in_single_ && roundoff <= error_) {
    in_single_ = true;
    round_to_single(Omega_single_, Omega_);
    round_to_single(term_single_, term_);
  }
  const double factor = 1.0 / static_cast<double>(++k_);
  if (in_single_) {
    cut_Omega(Omega_single_);
    single_products_.form(into(product_single_, Omega_single_ * term_single_));
    skew_part(next_single_, product_single_, factor);
    std::swap(term_single_, next_single_);
    size_ = cut(term_single_);
  } else {
    cut_Omega(Omega_);
    products_.form(into(product_, Omega_ * term_));
    skew_part(next_, product_, factor);
    std::swap(term_, next_);
    size_ = cut(term_);
  }
  failed_ = !std::isfinite(size_) || k_ >= most_terms;
  growth_.record(size_, factor);
  return !failed_ && !is_last();
}

void GradedSeries::add_upper_to(Addition<double> first,
                                std::span<const Addition<float>> others) const {
  if (in_single_) {
    add_upper(first, others, term_single_);
  } else {
    add_upper(first, others, term_);
  }
}

bool GradedSeries::conjugate(SplitMatrix& out, const SplitMatrix& Omega, const SplitMatrix& W,
                             double error) {
  out = 1.0 * W;
  begin(Omega, W, error, Sum::conjugate);
  bool goes_on = true;
  while (goes_on) {
    goes_on = advance();
    if (failed()) return false;
    add_upper_to({&out, 1.0});
  }
  mirror_skew_in_band(out);
  return true;
}

}  // namespace isosyrk
