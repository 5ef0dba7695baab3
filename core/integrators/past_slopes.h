// What a multistep method keeps of its past steps.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// The slopes at the starts of this step and of those before it, the newest first: of steps of one
/// size.
template <class Stored>
class PastSlopes {
 public:
  /// Takes room for as many slopes as the method needs, that of its own step included.
  explicit PastSlopes(std::vector<Stored> room) : slopes_(std::move(room)) {}

  /// Begins a step of size h, and returns the place of the slope at its start, to be filled in.
  Stored& join(double h) {
    if (h != h_) forget();
    h_ = h;
    count_ = std::min(count_ + 1, slopes_.size());
    std::rotate(slopes_.begin(), slopes_.end() - 1, slopes_.end());
    return slopes_[0];
  }
  /// True if there are slopes of as many steps as the method needs.
  bool is_complete() const { return count_ == slopes_.size(); }
  const std::vector<Stored>& slopes() const { return slopes_; }
  void forget() { count_ = 0; }
  void archive(StateArchive& state) {
    state.pass(count_, h_);
    if (count_ > slopes_.size()) throw std::invalid_argument("state: is of another method");
    for (std::size_t k = 0; k < count_; ++k) state.pass(slopes_[k]);
  }

 private:
  std::vector<Stored> slopes_;
  std::size_t count_ = 0;
  double h_ = 0.0;
};

}  // namespace isosyrk
