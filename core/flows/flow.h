// Isospectral flows.
#pragma once

#include <memory>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

class SplitGenerator;

/// An isospectral flow  W' = [B(W), W],  B : g -> g, with its algebra g and Hamiltonian.
class Flow {
 public:
  virtual ~Flow() = default;

  const QuadraticAlgebra& algebra() const { return algebra_; }
  Index size() const { return algebra_.size(); }

  /// B = B(W), n x n.  Allocates nothing.  B is not W.  For Euler-Zeitlin this is one Poisson
  /// solve.
  virtual void generator(const Matrix& W, Matrix& B) const = 0;
  /// Returns H(W), which the exact flow conserves.
  virtual double hamiltonian(const Matrix& W) const = 0;
  /// Returns B in split-complex storage for the fast forms, or null if the flow has none.
  virtual std::unique_ptr<SplitGenerator> split_generator() const;

 protected:
  explicit Flow(QuadraticAlgebra algebra) : algebra_(std::move(algebra)) {}

 private:
  QuadraticAlgebra algebra_;
};

}  // namespace isosyrk
