#include "isosyrk/flows/euler_zeitlin.h"

#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/flows/split_laplacian.h"

namespace isosyrk {

std::string_view name(HbarConvention convention) {
  return convention == HbarConvention::paper ? "paper" : "standard";
}

HbarConvention hbar_convention_from_name(std::string_view wanted) {
  for (const auto convention : {HbarConvention::paper, HbarConvention::standard}) {
    if (name(convention) == wanted) return convention;
  }
  throw std::invalid_argument(fmt::format("hbar '{}': must be paper or standard", wanted));
}

double hbar(HbarConvention convention, Index n) {
  const auto size = static_cast<double>(n);
  return convention == HbarConvention::paper ? 2.0 / std::sqrt(size * (size - 1.0))
                                             : 2.0 / std::sqrt(size * size - 1.0);
}

EulerZeitlin::EulerZeitlin(Index n, HbarConvention convention)
    : Flow(QuadraticAlgebra::skew_hermitian(n), Generator::linear),
      laplacian_(n),
      convention_(convention),
      reciprocal_hbar_(1.0 / hbar(convention, n)) {}

void EulerZeitlin::generator(const Matrix& W, Matrix& B) const {
  laplacian_.solve_skew_hermitian(W, reciprocal_hbar_, B);
}

double EulerZeitlin::hamiltonian(const Matrix& W) const {
  Matrix P(size(), size());
  laplacian_.solve_skew_hermitian(W, 1.0, P);
  // <W, P> = Re tr(W† P)
  return -0.5 * W.conjugate().cwiseProduct(P).sum().real();
}

std::unique_ptr<SplitGenerator> EulerZeitlin::split_generator() const {
  return std::make_unique<SplitEulerZeitlin>(laplacian_, reciprocal_hbar_);
}

}  // namespace isosyrk
