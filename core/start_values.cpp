#include "core/start_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace isosyrk {

StartValues::StartValues(int p, const Unknowns& unknowns) : p_(p) {
  constexpr int largest = 12;
  if (p < 0 || p > largest) {
    throw std::invalid_argument(fmt::format("start order {}: must be 0 to {}", p, largest));
  }
  past_.assign(static_cast<std::size_t>(p), unknowns);
}

bool StartValues::predict(double h, Unknowns& unknowns) const {
  if (known_ == 0 || h != h_) return false;
  for (std::size_t kind = 0; kind < unknowns.size(); ++kind) {
    for (std::size_t u = 0; u < unknowns[kind].size(); ++u) {
      const auto past = [&](int k) -> const RealVector& {  // k steps ago, the last is 1
        const std::size_t size = past_.size();
        return past_[(newest_ + size + 1 - static_cast<std::size_t>(k)) % size][kind][u].entries();
      };
      RealVector& x = unknowns[kind][u].entries();
      double weight = known_;  // of k = 1: C(known, 1)
      x = weight * past(1);
      for (int k = 2; k <= known_; ++k) {
        weight *= -static_cast<double>(known_ - k + 1) / static_cast<double>(k);
        x += weight * past(k);
      }
    }
  }
  return true;
}

void StartValues::accept(double h, const Unknowns& unknowns) {
  if (p_ == 0) return;
  if (h != h_) forget();
  h_ = h;
  newest_ = (newest_ + 1) % past_.size();
  for (std::size_t kind = 0; kind < unknowns.size(); ++kind) {
    for (std::size_t u = 0; u < unknowns[kind].size(); ++u) {
      past_[newest_][kind][u].entries() = unknowns[kind][u].entries();
    }
  }
  known_ = std::min(known_ + 1, p_);
}

}  // namespace isosyrk
