#include "isosyrk/solver/linear_prediction.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <stdexcept>

namespace isosyrk {
namespace {

// Of the diagonal of the normal equations, relative to its mean.  The rounding of a Cholesky
// factorisation with q terms is at most about q² roundoffs: 6e-14.
constexpr double smallest_raise = 1e-15;
constexpr double largest_raise = 64e-15;

}  // namespace

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
  if (q == 0) return Weights(0);
  // Keeps a singular A from becoming indefinite by rounding.  How large that is depends on the
  // order in which a processor adds, so a raise that is too small is followed by a larger one.
  const double mean = A.trace() / static_cast<double>(q);
  for (double raise = smallest_raise; raise <= largest_raise; raise *= 4.0) {
    Normal raised = A;
    raised.diagonal().array() += raise * mean;
    const Eigen::LLT<Eigen::Ref<Normal>> factors(raised);
    if (factors.info() != Eigen::Success) continue;
    factors.solveInPlace(c);
    return c.allFinite() ? c : Weights(0);
  }
  return Weights(0);
}

}  // namespace isosyrk
