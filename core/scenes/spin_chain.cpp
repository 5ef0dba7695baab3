#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "isosyrk/flows/spin_chain.h"
#include "isosyrk/scenes/normal_numbers.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk::scenes {

/// The Heisenberg chain of N = n/2 >= 3 spins of length 1 on a smooth curve, with some noise.
Scene spin_chain(const SceneParameters& parameters) {
  const Index n = parameters.n;
  if (n < 6 || n % 2 != 0) {
    throw std::invalid_argument(
        fmt::format("n = {}: spin_chain of N spins has n = 2 N, N >= 3", n));
  }
  NormalNumbers normal;
  Matrix W = Matrix::Zero(n, n);
  for (Index k = 0; k < n; k += 2) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    Eigen::Vector3d s(std::cos(angle), std::sin(angle), 0.5 * std::sin(2.0 * angle));
    for (double& component : s) component += 0.1 * normal.next();
    s.normalize();
    const Complex half_i(0.0, 0.5);
    W(k, k) = half_i * s(2);
    W(k + 1, k + 1) = -half_i * s(2);
    W(k, k + 1) = half_i * Complex(s(0), -s(1));
    W(k + 1, k) = half_i * Complex(s(0), s(1));
  }
  return {"spin_chain", std::make_shared<SpinChain>(n), W, 5.0};
}

}  // namespace isosyrk::scenes
