#include "isosyrk/solver/linear_prediction.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <stdexcept>

namespace isosyrk {

LinearPrediction::LinearPrediction(Index numbers, int q) {
  if (q < 0 || q > most) {
    throw std::invalid_argument(
        fmt::format("linear prediction by {} terms: must be 0 to {}", q, int{most}));
  }
  vectors_ = RealMatrix::Zero(numbers, q + 1);
  dots_ = RealMatrix::Zero(q + 1, q + 1);
}

void LinearPrediction::add() {
  newest_ = after_newest();
  known_ = std::min<int>(known_ + 1, static_cast<int>(vectors_.cols()));
  const auto y = vectors_.col(newest_);
  for (Index j = 0; j < vectors_.cols(); ++j) {
    dots_(newest_, j) = dots_(j, newest_) = vectors_.col(j).dot(y);
  }
}

LinearPrediction::Weights LinearPrediction::weights() const {
  using Normal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
  const Index q = terms();
  const auto place = [&](Index j) { return (newest_ + vectors_.cols() - j) % vectors_.cols(); };
  Normal A(q, q);
  Weights c(q);
  for (Index j = 0; j < q; ++j) {
    c(j) = dots_(place(j + 1), place(0));
    for (Index i = j; i < q; ++i) A(i, j) = dots_(place(i + 1), place(j + 1));
  }
  // Keeps a singular A from becoming indefinite by rounding.
  constexpr double rounding = 1e-15;
  if (q > 0) A.diagonal().array() += rounding * A.trace() / static_cast<double>(q);
  const Eigen::LLT<Eigen::Ref<Normal>> factors(A);
  if (q == 0 || factors.info() != Eigen::Success) return Weights(0);
  factors.solveInPlace(c);
  return c.allFinite() ? c : Weights(0);
}

}  // namespace isosyrk
