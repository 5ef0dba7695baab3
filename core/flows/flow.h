// Isospectral flows.
#pragma once

#include <memory>

#include "isosyrk/flows/energy.h"
#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

class SplitGenerator;

/// What may be assumed of B.
enum class Generator {
  /// B takes matrices of g.  A stage W̃ is in g only once its equations are solved: integrators
  /// project it onto g before they call B.
  of_algebra,
  /// B takes every matrix in storage, and is linear in it.
  linear,
};

/// An isospectral flow  W' = [B(W), W],  B : g -> g, with its algebra g and Hamiltonian.
class Flow {
 public:
  virtual ~Flow() = default;

  const QuadraticAlgebra& algebra() const { return algebra_; }
  Index size() const { return algebra_.size(); }

  /// B = B(W), both in the storage of the algebra: n x n if dense, otherwise diagonal blocks on top
  /// of one another.  W is in g to rounding unless kind() is `linear`; the caller sees to that by
  /// argument().  Allocates nothing, unless the flow is a RealFlow, of which integrators call
  /// real_generator().  B is not W.  For Euler-Zeitlin this is one Poisson solve.
  virtual void generator(const Matrix& W, Matrix& B) const = 0;
  /// Returns H(W), which the exact flow conserves, for W in storage.  Squares may overflow:
  /// energy() and stored_energy() are for W of any norm.
  virtual double hamiltonian(const Matrix& W) const = 0;
  /// Returns whether B is linear on g and self-adjoint in the pairing <A, B> = -tr(AB).  B is then
  /// the gradient of the quadratic Hamiltonian ½ <W, B(W)>, of which hamiltonian() may be a
  /// multiple.  Methods that differentiate B need this.  False unless the flow says so.
  virtual bool has_self_adjoint_generator() const { return false; }
  /// Returns whether B(W + icI) = B(W) for every real c, where J = I.  W + icI then moves as W
  /// does, and integrators set the trace of W aside.  False unless the flow says so.
  virtual bool ignores_trace() const { return false; }
  /// Returns whether H(cW) = c² H(W).  The energy is then computed from W / 2^e of norm about 1.
  virtual bool has_quadratic_hamiltonian() const { return has_self_adjoint_generator(); }
  /// Returns ‖R‖_F of a rotation R that B(W) is computed with and left without, 0 unless the flow
  /// says so: B(W) errs by the rounding of R.  W is n x n, in storage.
  virtual double rotation_left_out(const Matrix&) const { return 0.0; }
  /// Returns B in split-complex storage for the fast forms, or null if the flow has none.
  virtual std::unique_ptr<SplitGenerator> split_generator() const;

  Generator kind() const { return kind_; }
  /// Returns the matrix that generator() takes for a W in storage: W itself if B is linear,
  /// otherwise its projection onto g, in `projected`.
  template <class Scalar>
  const MatrixOf<Scalar>& argument(const MatrixOf<Scalar>& W, MatrixOf<Scalar>& projected) const {
    if (kind_ == Generator::linear) return W;
    algebra_.project(W, projected);
    return projected;
  }

  /// Returns B(W), n x n, for an n x n matrix W.  Throws as QuadraticAlgebra::pack.
  Matrix dense_generator(const Matrix& W) const;
  /// Returns H(W) for an n x n matrix W of any norm, if H is quadratic.  Throws as
  /// QuadraticAlgebra::pack.
  Energy energy(const Matrix& W) const;
  /// Returns H(2^exponent V) for V in storage.
  Energy stored_energy(const Matrix& V, int exponent = 0) const;

 protected:
  explicit Flow(QuadraticAlgebra algebra, Generator kind = Generator::of_algebra)
      : algebra_(std::move(algebra)), kind_(kind) {}

 private:
  QuadraticAlgebra algebra_;
  Generator kind_;
};

/// A flow that is shared: an integrator keeps its flow alive.
using SharedFlow = std::shared_ptr<const Flow>;

/// A flow of real matrices, which integrators keep real.
class RealFlow : public Flow {
 public:
  /// B = B(W) and H(W), as above, for real matrices.
  virtual void real_generator(const MatrixOf<double>& W, MatrixOf<double>& B) const = 0;
  virtual double real_hamiltonian(const MatrixOf<double>& W) const = 0;

  using Flow::stored_energy;
  /// Returns H(2^exponent V) for a real V in storage.
  Energy stored_energy(const MatrixOf<double>& V, int exponent) const;

  /// The same for complex matrices whose imaginary parts are 0.  Both allocate.
  void generator(const Matrix& W, Matrix& B) const final;
  double hamiltonian(const Matrix& W) const final;

 protected:
  /// Throws std::invalid_argument unless J is real.
  explicit RealFlow(QuadraticAlgebra algebra, Generator kind = Generator::of_algebra);
};

}  // namespace isosyrk
