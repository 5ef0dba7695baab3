// Nothing allocates inside a step.
#include <gtest/gtest.h>

#include "benchmarks/allocation_count.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

#ifdef __SANITIZE_ADDRESS__
const std::vector<Index> sizes = {5, 17, 34};  // larger ones take too long
#else
const std::vector<Index> sizes = {5, 17, 66, 129};
#endif

TEST(AllocationCounter, SeesAnAllocation) {
  EXPECT_GE(allocations_during([] {
              Matrix X(40, 40);
              X.setZero();
              EXPECT_EQ(X(3, 3), 0.0);
            }),
            1);
}

TEST(Step, AllocatesNothingForAnyIntegratorBackendAndSize) {
  for (const Index n : sizes) {
    const Scene scene = smooth_scene(n);
    for (const ProductBackend backend : product_backends()) {
      for (const IntegratorEntry& entry : integrators()) {
        const auto integrator = entry.make(*scene.flow, {1e-13, 3}, backend);
        Matrix W = scene.initial;
        integrator->step(W, 1e-4);  // the BLAS sets up its own buffers in its first product
        StepReport report;
        EXPECT_EQ(allocations_during([&] { report = integrator->step(W, 1e-4); }), 0)
            << entry.name << " n = " << n << " " << name(backend);
        EXPECT_GT(report.products, 0);
      }
    }
  }
}

TEST(Step, AllocatesNothingInAFastFormColdOrWarm) {
  for (const Index n : sizes) {
    const Scene scene = smooth_scene(n);
    for (const Formulation formulation : formulations()) {
      for (const int s : {1, 2, 3}) {
        const auto integrator =
            fast_gauss_entry(formulation, s).make(*scene.flow, {}, ProductBackend::openblas);
        Matrix W = scene.initial;
        StepReport report;
        const auto steps = [&] {
          constexpr int until_fitted = 10;
          for (int step = 0; step < until_fitted; ++step) report = integrator->step(W, 1e-3);
          EXPECT_EQ(report.status, Status::converged);
          report = integrator->step(W, 2e-3);
        };
        EXPECT_EQ(allocations_during(steps), 0) << name(formulation) << s << " n = " << n;
        EXPECT_EQ(report.status, Status::converged);
      }
    }
  }
}

TEST(Step, AllocatesNothingWhereJIsNotTheIdentity) {
  const ConjugationFlow flow(QuadraticAlgebra(symplectic_J(3)), 1);
  class Quiet final : public Flow {  // ConjugationFlow's own products allocate
   public:
    explicit Quiet(const QuadraticAlgebra& algebra) : Flow(algebra) {}
    void generator(const Matrix& W, Matrix& B) const override { B = W; }
    double hamiltonian(const Matrix&) const override { return 0.0; }
  };
  const Quiet quiet(flow.algebra());
  for (const Formulation formulation : formulations()) {
    for (const int s : {1, 2, 3}) {
      const auto integrator = gauss(formulation, quiet, s);
      Matrix W = flow.element(2);
      integrator->step(W, 0.1);
      EXPECT_EQ(allocations_during([&] { integrator->step(W, 0.1); }), 0) << name(formulation);
    }
  }
}

}  // namespace
}  // namespace isosyrk::testing
