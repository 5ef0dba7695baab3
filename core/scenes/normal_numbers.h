// Random numbers for initial data.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

namespace isosyrk {

/// Standard normal numbers by the method of Box and Muller.  They are the same with every standard
/// library, while the algorithm of std::normal_distribution is unspecified.
class NormalNumbers {
 public:
  explicit NormalNumbers(std::uint64_t seed = 20260101) : bits_(seed) {}

  double next() {
    if (spare_) return *std::exchange(spare_, std::nullopt);
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    return radius * std::cos(angle);
  }

 private:
  double uniform() { return static_cast<double>(bits_() >> 11U) * 0x1p-53; }

  std::mt19937_64 bits_;
  std::optional<double> spare_;
};

}  // namespace isosyrk
