#include "core/start_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/stage_sums.h"

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

// Each entry from all its past ones at once.
void StartValues::predict(std::size_t kind, std::size_t unknown, PlanarMatrix& X,
                          Share share) const {
  std::array<const double*, largest> past{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(known_); ++k) {
    const std::size_t step = (newest_ + past_.size() - k) % past_.size();
    past[k] = past_[step][kind][unknown].entries().data();
  }
  constexpr Index length = 8;  // rows are filled up to whole blocks of 8
  const NumbersOfRows numbers(X, share);
  for (Index i = numbers.begin; i < numbers.end; i += length) {
    using Piece = Eigen::Array<double, length, 1>;
    Piece sum = weights_[0] * Eigen::Map<const Piece>(past[0] + i);
    for (std::size_t k = 1; k < static_cast<std::size_t>(known_); ++k) {
      sum += weights_[k] * Eigen::Map<const Piece>(past[k] + i);
    }
    Eigen::Map<Piece>(X.entries().data() + i) = sum;
  }
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
