// The Euler-Zeitlin equations: a finite model of the incompressible Euler equations on the sphere.
#pragma once

#include <string_view>

#include "isosyrk/flows/flow.h"
#include "isosyrk/flows/laplacian.h"

namespace isosyrk {

/// Which ħ scales the bracket.
enum class HbarConvention {
  paper,     ///< ħ = 2 / sqrt(n (n-1)), as the paper prints it
  standard,  ///< ħ = 2 / sqrt(n² - 1), as in the convention it cites (and in quflow)
};

std::string_view name(HbarConvention convention);

/// ħ for size n >= 2.
double hbar(HbarConvention convention, Index n);

/// W' = (1/ħ) [Δ⁻¹W, W] on su(n):  B(W) = Δ⁻¹W / ħ,  H(W) = -½ <W, Δ⁻¹W>  (kinetic energy).
class EulerZeitlin final : public Flow {
 public:
  /// Throws std::invalid_argument for n < 2.
  explicit EulerZeitlin(Index n, HbarConvention convention = HbarConvention::paper);

  void generator(const Matrix& W, Matrix& B) const override;
  double hamiltonian(const Matrix& W) const override;
  std::unique_ptr<SplitGenerator> split_generator() const override;

  HbarConvention convention() const { return convention_; }
  const Laplacian& laplacian() const { return laplacian_; }

 private:
  Laplacian laplacian_;
  HbarConvention convention_;
  double reciprocal_hbar_;
};

}  // namespace isosyrk
