#include "isosyrk/integrators/state_scale.h"

#include <cmath>
#include <random>

namespace isosyrk {
namespace {

// Returns an e with 2^e at most twice the largest entry of W and at least half of it; 0 if W is 0
// or not finite.  Squares of entries over 2^e neither overflow nor underflow where they count.
int exponent_of(const ConstMatrixView& W) {
  const double sum = W.real().cwiseAbs().maxCoeff() + W.imag().cwiseAbs().maxCoeff();
  int exponent = 0;
  if (sum > 0.0 && std::isfinite(sum)) std::frexp(sum, &exponent);
  return exponent;
}

double frobenius_norm(const ConstMatrixView& W, int exponent) {
  return std::ldexp((std::ldexp(1.0, -exponent) * W).norm(), exponent);
}

}  // namespace

double frobenius_norm(const ConstMatrixView& W) { return frobenius_norm(W, exponent_of(W)); }

ScaleFinder::ScaleFinder(Index n) : start_(n), x_(n), y_(n) {
  std::minstd_rand numbers;  // the same everywhere
  const auto next = [&] {
    return static_cast<double>(numbers()) / static_cast<double>(std::minstd_rand::max()) - 0.5;
  };
  for (Complex& entry : start_) {
    const double re = next();
    entry = {re, next()};
  }
  start_.normalize();
}

// After k products with W or W† the estimate is at least |c|^(1/k) ‖W‖₂, with c the part of the
// start along the first singular vector, about n^(-1/2).
StateScale ScaleFinder::find(const ConstMatrixView& W) {
  constexpr int pairs_of_products = 6;
  StateScale scale;
  const int exponent = exponent_of(W);
  scale.frobenius_norm = frobenius_norm(W, exponent);
  if (!(scale.frobenius_norm > 0.0) || !std::isfinite(scale.frobenius_norm)) return scale;
  const double unit = std::ldexp(1.0, -exponent);
  double ratio = 0.0;
  x_ = start_;
  for (int k = 0; k < pairs_of_products; ++k) {
    y_.noalias() = W * x_;
    y_ *= unit;
    x_.noalias() = W.adjoint() * y_;
    x_ *= unit;
    const double norm_of_y = y_.norm();
    const double norm_of_x = x_.norm();
    if (!(norm_of_x > 0.0) || !std::isfinite(norm_of_x)) return scale;
    ratio = norm_of_x / norm_of_y;
    x_ /= norm_of_x;
  }
  scale.value = std::exp2(std::round(std::log2(ratio) + exponent));
  return scale;
}

bool ScaleFinder::changed_twofold(const StateScale& scale, const ConstMatrixView& W) {
  const double norm = frobenius_norm(W);
  return !(norm <= 2.0 * scale.frobenius_norm && norm >= 0.5 * scale.frobenius_norm);
}

}  // namespace isosyrk
