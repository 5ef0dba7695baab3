// Flows of one's own, whose B is right on the algebra only, through every published integrator.
#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/linalg/spectrum.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

struct OwnFlow {
  std::string name;
  QuadraticAlgebra algebra;
  FlowOf::Generator B;
  Matrix initial;  // n x n
  bool self_adjoint = false;
};

// A rigid body on u(n) by Manakov's inertia.
OwnFlow rigid_body() {
  const Index n = 8;
  return {"rigid_body", QuadraticAlgebra::skew_hermitian(n),
          [](const Matrix& W, Matrix& B) {
            for (Index r = 0; r < W.rows(); ++r) {
              for (Index c = 0; c < W.cols(); ++c) B(r, c) = W(r, c) / (1.0 + 0.2 * double(r + c));
            }
          },
          random_skew_hermitian(n, 1), true};
}

// The Toda lattice L' = [B, L], L symmetric and tridiagonal, B = L_+ - L_-, with W = iL.
OwnFlow toda() {
  const Index n = 6;
  Matrix W0 = Matrix::Zero(n, n);
  for (Index k = 0; k < n; ++k) W0(k, k) = Complex(0.0, 0.2 * double(k * k % 5) - 0.3);
  for (Index k = 0; k + 1 < n; ++k)
    W0(k, k + 1) = W0(k + 1, k) = Complex(0.0, 0.3 + 0.05 * double(k));
  return {"toda", QuadraticAlgebra::skew_hermitian(n),
          [](const Matrix& W, Matrix& B) {
            const Complex minus_i(0.0, -1.0);
            B.setZero();
            B.triangularView<Eigen::StrictlyUpper>() = minus_i * W;
            B.triangularView<Eigen::StrictlyLower>() = -minus_i * W;
          },
          W0};
}

// Point vortices x_k on the sphere, W_k = (i/2) x_k · σ:  B_k = Σ_j Γ_j W_j / (1.1 - x_j · x_k), in
// blocks on top of one another.  Not linear.
OwnFlow vortices() {
  const Index count = 4;
  Matrix W0 = Matrix::Zero(2 * count, 2 * count);
  for (Index k = 0; k < count; ++k) {
    const Matrix block = random_skew_hermitian(2, 10 + static_cast<unsigned>(k));
    Matrix spin = block - 0.5 * block.trace() * Matrix::Identity(2, 2);
    W0.block(2 * k, 2 * k, 2, 2) = 0.5 * spin / spectral_norm(spin);
  }
  return {"vortices", QuadraticAlgebra::skew_hermitian(2 * count, 2),
          [](const Matrix& W, Matrix& B) {
            B.setZero();
            for (Index k = 0; k < W.rows(); k += 2) {
              for (Index j = 0; j < W.rows(); j += 2) {
                if (j == k) continue;
                const Matrix product = W.middleRows(j, 2).lazyProduct(W.middleRows(k, 2));
                const Complex dot = -2.0 * product.trace();
                const double strength = 0.3 + 0.1 * static_cast<double>(j);
                B.middleRows(k, 2) += strength * W.middleRows(j, 2) / (1.1 - dot);
              }
            }
          },
          W0};
}

std::vector<OwnFlow> own_flows() { return {rigid_body(), toda(), vortices()}; }

// The end of so many steps of the classical Runge-Kutta method for W' = [B(W), W], written out.
Matrix reference(const Flow& flow, Matrix W, double time, int steps) {
  const double h = time / steps;
  const auto slope = [&](const Matrix& at) { return commutator(flow.dense_generator(at), at); };
  for (int k = 0; k < steps; ++k) {
    const Matrix k1 = slope(W), k2 = slope(W + 0.5 * h * k1), k3 = slope(W + 0.5 * h * k2),
                 k4 = slope(W + h * k3);
    W += (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return W;
}

// The largest |W + W†| that B is called with, over the largest entry of W, and whether B(W) is in
// the algebra there to 1e-10, as the module asks of a function in Python.
struct Seen {
  double defect = 0.0;
  double defect_of_B = 0.0;
};

FlowOf watched(const OwnFlow& own, Seen& seen, Generator kind = Generator::of_algebra) {
  const auto defect = [algebra = own.algebra](const Matrix& stored) {
    Matrix adjoint = stored;
    algebra.involution(stored, adjoint);
    return (stored + adjoint).cwiseAbs().maxCoeff() / stored.cwiseAbs().maxCoeff();
  };
  return FlowOf(
      own.algebra,
      [B_of = own.B, &seen, defect](const Matrix& W, Matrix& B) {
        B_of(W, B);
        seen.defect = larger(seen.defect, defect(W));
        seen.defect_of_B = larger(seen.defect_of_B, defect(B));
      },
      kind, own.self_adjoint);
}

class EachPublishedIntegrator : public ::testing::TestWithParam<IntegratorEntry> {};

TEST_P(EachPublishedIntegrator, IntegratesFlowsOfOnesOwn) {
  const IntegratorEntry& entry = GetParam();
  for (const OwnFlow& own : own_flows()) {
    SCOPED_TRACE(own.name);
    Seen seen;
    const FlowOf flow = watched(own, seen);
    if (!takes(entry, flow)) {
      expect_refused([&] { made(entry, flow); }, entry.name + ": ");
      continue;
    }
    constexpr double time = 1.0;
    // Of order 4 at h = 1/1000: 1e-12 or less.
    const Matrix exact = reference(flow, own.initial, time, 1000);
    ASSERT_GE(largest_difference(exact, own.initial), 1e-2);
    const auto end = [&](long steps) {
      return integrated(*made(entry, flow), own.initial, time / static_cast<double>(steps), steps);
    };
    const Matrix coarse = end(20), fine = end(40);
    const double error = (fine - exact).norm();
    // The error falls by 2^order, within a factor of 2, or is as small as the reference's.
    EXPECT_LE(error, 2.0 * std::ldexp((coarse - exact).norm(), -entry.order) + 1e-11);
    EXPECT_LE(error, 1e-2);
    EXPECT_LE(flow.algebra().algebra_defect(fine), 1e-11);
    if (entry.keeps.isospectral) {
      EXPECT_LE(spectrum_error(flow.algebra(), fine, own.initial), 1e-11);
    }
    EXPECT_EQ(seen.defect, 0.0);
    EXPECT_LE(seen.defect_of_B, 1e-14);
  }
}

std::vector<IntegratorEntry> for_any_flow() {
  std::vector<IntegratorEntry> found;
  for (const IntegratorEntry& entry : integrators()) {
    if (!entry.co_rotating) found.push_back(entry);
  }
  for (const char* name : {"algebra2_two_products", "yoshida4_group", "yoshida4_cotangent"}) {
    found.push_back(integrator_entry(name));
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(List, EachPublishedIntegrator, ::testing::ValuesIn(for_any_flow()),
                         [](const auto& tested) { return tested.param.name; });

// Without the projection B is called with stages that are not solved yet, and is itself off g.
TEST(OwnFlow, WithoutProjectionStagesAreOffTheAlgebra) {
  for (const char* name : {"algebra2", "algebra3"}) {
    Seen seen;
    const OwnFlow own = rigid_body();
    const FlowOf flow = watched(own, seen, Generator::linear);
    integrated(*made(integrator_entry(name), flow), own.initial, 0.01, 1);
    EXPECT_GE(seen.defect, 1e-10) << name;
    EXPECT_GE(seen.defect_of_B, 1e-10) << name;
  }
}

TEST(Projection, IsOntoTheAlgebraAndLeavesItsElements) {
  for (const QuadraticAlgebra& algebra :
       {QuadraticAlgebra::skew_hermitian(6), QuadraticAlgebra::skew_hermitian(6, 2),
        QuadraticAlgebra(symplectic_J(3)), QuadraticAlgebra(indefinite_J(4, 2))}) {
    const Matrix X = random_matrix(6, 1).leftCols(algebra.block());
    Matrix projected = X, again = X, dense(6, 6);
    algebra.project(X, projected);
    algebra.unpack(projected, dense);
    EXPECT_LE(algebra.algebra_defect(dense), algebra.is_skew_hermitian() ? 0.0 : 1e-15);
    algebra.project(projected, again);
    EXPECT_LE(largest_difference(again, projected), algebra.is_skew_hermitian() ? 0.0 : 1e-15);
    EXPECT_GE(largest_difference(X, projected), 0.1);
  }
  const QuadraticAlgebra real = QuadraticAlgebra::skew_hermitian(4);
  MatrixOf<double> X = random_matrix(4, 2).real(), projected = X;
  real.project(X, projected);
  EXPECT_EQ(projected, MatrixOf<double>(-projected.transpose()));
}

}  // namespace
}  // namespace isosyrk::testing
