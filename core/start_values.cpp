#include "core/start_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/planar_sums.h"

namespace isosyrk {

StartValues::StartValues(int p, const Unknowns& unknowns) : p_(p) {
  if (p < 0 || p > largest) {
    throw std::invalid_argument(fmt::format("start order {}: must be 0 to {}", p, int{largest}));
  }
  past_.assign(static_cast<std::size_t>(p), unknowns);
}

bool StartValues::begin(double h) {
  if (known_ == 0 || h != h_) return false;
  weights_[0] = known_;  // of the last step: C(known, 1)
  for (int k = 1; k < known_; ++k) {
    weights_[static_cast<std::size_t>(k)] = -weights_[static_cast<std::size_t>(k - 1)] *
                                            static_cast<double>(known_ - k) /
                                            static_cast<double>(k + 1);
  }
  return true;
}

void StartValues::predict(std::size_t kind, std::size_t unknown, PlanarMatrix& X,
                          Share share) const {
  Terms<double> terms;
  for (std::size_t k = 0; k < static_cast<std::size_t>(known_); ++k) {
    const std::size_t step = (newest_ + past_.size() - k) % past_.size();
    terms.add(weights_[k], past_[step][kind][unknown]);
  }
  assign(X, share, terms);
}

void StartValues::accept(double h) {
  if (p_ == 0) return;
  if (h != h_) forget();
  h_ = h;
  newest_ = (newest_ + 1) % past_.size();
  known_ = std::min(known_ + 1, p_);
}

void StartValues::keep(std::size_t kind, std::size_t unknown, const PlanarMatrix& X, Share share) {
  if (p_ > 0) reals(past_[newest_][kind][unknown], share) = reals(X, share);
}

}  // namespace isosyrk
