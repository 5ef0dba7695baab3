// How the terms of a series of nested commutators go on.
#pragma once

#include <limits>

namespace isosyrk {

/// The sizes of the terms c_k = f_k [Ω, c_{k-1}] of a series, from which the next is foretold.
///
/// With x_k = ‖[Ω, c_{k-1}]‖ / ‖c_{k-1}‖, a normal ad_Ω has x_k <= x_{k+1}, and x_k was seen to
/// rise ever more slowly: x_{k+1} is taken as x_k² / x_{k-1}.
class TermGrowth {
 public:
  /// Begins with ‖c₀‖.
  void begin(double size) {
    size_ = size;
    growth_ = growth_before_ = 0.0;
  }
  /// Records ‖c_k‖ and f_k of the next k.
  void record(double size, double factor) {
    growth_before_ = growth_;
    growth_ = size / (factor * size_);
    size_ = size;
  }
  /// Returns the expected ‖c_{k+1}‖ for this f_{k+1}: infinite before two terms were seen.
  double next(double factor) const {
    if (!(growth_before_ > 0.0)) return std::numeric_limits<double>::infinity();
    return factor * growth_ * (growth_ / growth_before_) * size_;
  }

 private:
  double size_ = 0.0;
  double growth_ = 0.0;
  double growth_before_ = 0.0;
};

}  // namespace isosyrk
