// The energy of a state of any norm.
#pragma once

namespace isosyrk {

/// An energy H(W) = significand · 2^exponent.  Steps are right at any norm of W, while squares of
/// its entries overflow from 1e154 on and underflow below 1e-154: therefore two parts.
class Energy {
 public:
  explicit Energy(double significand = 0.0, int exponent = 0)
      : significand_(significand), exponent_(exponent) {}

  /// Returns the energy.  A significand that is not finite is returned as it is.  Throws
  /// std::range_error, naming the order of magnitude, where the energy is no normal double.
  double value() const;
  operator double() const { return value(); }

  /// Returns this energy over another one, neither of which need be a double.
  double over(const Energy& other) const;

  /// Returns whether the energy is a normal double, 0 or not finite.
  bool is_double() const;
  /// Returns log10 |H|, -inf for 0.
  double log10() const;

 private:
  double significand_;
  int exponent_;
};

}  // namespace isosyrk
