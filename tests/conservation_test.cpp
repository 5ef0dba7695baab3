// What the flow conserves, the formulations conserve: Lie-Poisson structure, momentum, energy.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "isosyrk/flows/invariants.h"
#include "isosyrk/simulation/run.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(Formulations, NearlyConserveEnergy) {
  const Scene scene = smooth_scene(17);
  const double initial = scene.flow->hamiltonian(scene.initial);
  for (const Formulation formulation : formulations()) {
    double worst = 0.0;
    Matrix W = scene.initial;
    const auto integrator = gauss(formulation, *scene.flow, 2);
    run(*integrator, W, 0.1, 300, [&](long, const Matrix& V, const StepReport&) {
      worst = larger(worst, std::abs(scene.flow->hamiltonian(V) / initial - 1.0));
    });
    EXPECT_LE(worst, 1e-5);
    EXPECT_GE(worst, 1e-12);  // nearly: it is not the exact flow
  }
}

// The step as a map on the skew-Hermitian matrices, differentiated by central differences, against
// the Poisson tensor Π(W)(α, β) = <W, [α, β]>.
double poisson_map_defect(Integrator& integrator, const Matrix& W0, double h) {
  const Index n = W0.rows();
  std::vector<Matrix> basis;  // orthonormal
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      Matrix E = Matrix::Zero(n, n);
      E(i, j) = i < j ? Complex(1.0) : Complex(0.0, 1.0);
      E -= E.adjoint().eval();
      basis.push_back(E / E.norm());
    }
  }
  const auto inner = [](const Matrix& A, const Matrix& B) {
    return A.conjugate().cwiseProduct(B).sum().real();
  };
  const auto size = static_cast<Index>(basis.size());
  const auto tensor = [&](const Matrix& W) {
    return RealMatrix(RealMatrix::NullaryExpr(size, size, [&](Index a, Index b) {
      return inner(
          W, commutator(basis[static_cast<std::size_t>(a)], basis[static_cast<std::size_t>(b)]));
    }));
  };
  const double delta = 1e-4;
  RealMatrix derivative(size, size);
  for (Index b = 0; b < size; ++b) {
    const Matrix& direction = basis[static_cast<std::size_t>(b)];
    const auto shifted = [&](double amount) {
      return integrated(integrator, W0 + amount * direction, h, 1);
    };
    // Fourth-order differences: error delta^4, rounding 1e-13 / delta.
    const Matrix slope = (8.0 * (shifted(delta) - shifted(-delta)) -
                          (shifted(2.0 * delta) - shifted(-2.0 * delta))) /
                         (12.0 * delta);
    for (Index a = 0; a < size; ++a) {
      derivative(a, b) = inner(basis[static_cast<std::size_t>(a)], slope);
    }
  }
  const RealMatrix before = tensor(W0);
  const RealMatrix after = tensor(integrated(integrator, W0, h, 1));
  return (derivative.lazyProduct(before).eval().lazyProduct(derivative.transpose()) - after)
             .norm() /
         after.norm();
}

TEST(EachListedIntegrator, IsAPoissonMapIfAndOnlyIfItSaysSo) {
  // h is large enough for the controls to show; the generator takes the trace out before the solve
  // and gives none back, so it is a gradient on u(n), as the test needs.
  const Scene scene = smooth_scene(
      4, HbarConvention::paper,
      {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}, {2, 1, {1.0, 0.3}}, {3, 2, {-0.6, 0.9}}, {3, 0, 0.7}});
  for (const IntegratorEntry& entry : integrators()) {
    const auto integrator = entry.make(*scene.flow, {1e-15, 1000}, ProductBackend::openblas);
    const double defect = poisson_map_defect(*integrator, scene.initial, 2.0);
    if (entry.keeps.lie_poisson) {
      EXPECT_LE(defect, 1e-10) << entry.name;
    } else {
      EXPECT_GE(defect, 1e-6) << entry.name;
    }
  }
}

}  // namespace
}  // namespace isosyrk::testing
