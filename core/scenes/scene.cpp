#include "isosyrk/scenes/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace isosyrk {

namespace {

void require_in(const QuadraticAlgebra& algebra, const Matrix& W0, std::string_view what) {
  constexpr double largest_defect = 1e-10;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{}: {}", what, why));
  };
  const Index n = algebra.size();
  if (W0.rows() != n || W0.cols() != n) {
    refuse(fmt::format("{} x {}; must be {} x {}", W0.rows(), W0.cols(), n, n));
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const Complex entry = W0(i, j);
      if (std::isfinite(entry.real()) && std::isfinite(entry.imag())) continue;
      refuse(fmt::format("entry ({}, {}) is {}{:+}i; must be finite", i, j, entry.real(),
                         entry.imag()));
    }
  }
  const double largest = W0.cwiseAbs().maxCoeff();
  if (largest == 0.0) refuse("all entries are 0; some must be nonzero");
  const double defect = algebra.algebra_defect(W0) / largest;
  if (!(defect <= largest_defect)) {
    refuse(
        fmt::format("the largest entry of |{}| is {:.3g} of the largest of |W|; must be at most "
                    "{:.0e} ({})",
                    algebra.is_skew_hermitian() ? "W + W†" : "W†J + JW", defect, largest_defect,
                    algebra.is_skew_hermitian() ? "skew-Hermitian" : "in the algebra of J"));
  }
}

}  // namespace

void require_initial_data(const Matrix& W0, Index n) {
  require_in(QuadraticAlgebra::skew_hermitian(n), W0, "initial data");
}

void require_initial_data(const Flow& flow, const Matrix& W0, std::string_view what) {
  const QuadraticAlgebra& algebra = flow.algebra();
  require_in(algebra, W0, what);
  try {
    if (dynamic_cast<const RealFlow*>(&flow) != nullptr) {
      MatrixOf<double> stored = algebra.zero<double>();
      algebra.pack(W0, stored);
    } else {
      Matrix stored = algebra.zero<Complex>();
      algebra.pack(W0, stored);
    }
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", what, error.what()));
  }
}

}  // namespace isosyrk
