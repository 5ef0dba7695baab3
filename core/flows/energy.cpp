#include "isosyrk/flows/energy.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace isosyrk {

double Energy::value() const {
  if (!is_double()) {
    throw std::range_error(
        fmt::format("energy: is about 1e{:.0f}, which no double holds", log10()));
  }
  return std::ldexp(significand_, exponent_);
}

double Energy::over(const Energy& other) const {
  return std::ldexp(significand_ / other.significand_, exponent_ - other.exponent_);
}

bool Energy::is_double() const {
  if (significand_ == 0.0 || !std::isfinite(significand_)) return true;
  return std::isnormal(std::ldexp(significand_, exponent_));
}

double Energy::log10() const {
  return std::log10(std::abs(significand_)) + exponent_ * std::log10(2.0);
}

}  // namespace isosyrk
