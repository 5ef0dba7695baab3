// The Euler-Zeitlin equations: a finite model of the incompressible Euler equations on the sphere.
#pragma once

#include <string_view>

#include "isosyrk/flows/flow.h"
#include "isosyrk/flows/laplacian.h"

namespace isosyrk {

/// Convention for the ħ that scales the bracket.
enum class HbarConvention {
  paper,     ///< ħ = 2 / sqrt(n (n-1)), as printed in the paper
  standard,  ///< ħ = 2 / sqrt(n² - 1), as in the convention that the paper cites, and in quflow
};

/// Returns "paper" or "standard".
std::string_view name(HbarConvention convention);
/// Returns the convention with this name.  Throws std::invalid_argument, naming both names, for
/// another one.
HbarConvention hbar_convention_from_name(std::string_view name);

/// Returns ħ for n x n matrices, n >= 2.
double hbar(HbarConvention convention, Index n);

/// The flow W' = (1/ħ) [Δ⁻¹W, W] on su(n), with B(W) = Δ⁻¹W / ħ.  H(W) = -½ <W, Δ⁻¹W> is the
/// kinetic energy.  B reads the upper triangle of W and the imaginary part of its diagonal.
class EulerZeitlin final : public Flow {
 public:
  /// Throws std::invalid_argument for n < 2.
  explicit EulerZeitlin(Index n, HbarConvention convention = HbarConvention::paper);

  void generator(const Matrix& W, Matrix& B) const override;
  double hamiltonian(const Matrix& W) const override;
  /// Δ⁻¹ is a symmetric matrix on each diagonal of W.
  bool has_self_adjoint_generator() const override { return true; }
  /// The multiple of I in W is not in the range of Δ.
  bool ignores_trace() const override { return true; }
  std::unique_ptr<SplitGenerator> split_generator() const override;

  HbarConvention convention() const { return convention_; }
  const Laplacian& laplacian() const { return laplacian_; }

 private:
  Laplacian laplacian_;
  HbarConvention convention_;
  double reciprocal_hbar_;
};

}  // namespace isosyrk
