// Nothing allocates inside a step, and what an integrator holds is known before it is made.
#include "benchmarks/allocation_count.h"
#include "benchmarks/product_rate.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/machine/memory.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

#ifdef __SANITIZE_ADDRESS__
const std::vector<Index> sizes = {5, 17, 34};  // larger ones take too long
#else
const std::vector<Index> sizes = {5, 17, 66, 129};
#endif

// More threads of OpenBLAS allocate in each product.
const bool has_one_blas_thread = [] {
  use_one_blas_thread();
  return true;
}();

TEST(AllocationCounter, SeesAnAllocationAndItsEnd) {
  const long before = bytes_in_use();
  EXPECT_GE(allocations_during([&] {
              const Matrix X = Matrix::Zero(40, 40);
              EXPECT_EQ(X(3, 3), 0.0);
              EXPECT_GE(bytes_in_use() - before, 40 * 40 * 16);
            }),
            1);
  EXPECT_EQ(bytes_in_use(), before);
}

class EachIntegrator : public ::testing::TestWithParam<IntegratorEntry> {};

TEST_P(EachIntegrator, AllocatesNothingInAStepForAnyBackendAndSize) {
  for (const Index n : sizes) {
    const Scene scene = smooth_scene(n);
    for (const ProductBackend backend : product_backends()) {
      const auto integrator = GetParam().make(scene.flow, {1e-13, 3}, backend);
      Matrix W = scene.initial;
      integrator->step(W, 1e-4);  // the BLAS sets up its own buffers in its first product
      StepReport report;
      EXPECT_EQ(allocations_during([&] { report = integrator->step(W, 1e-4); }), 0)
          << "n = " << n << " " << name(backend);
      EXPECT_GT(report.work.products, 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(List, EachIntegrator, ::testing::ValuesIn(integrators()),
                         ::testing::PrintToStringParamName());

// Threads are made in the first step, and kept.
TEST(Step, AllocatesNothingInAFastFormColdOrWarm) {
  for (const Index n : sizes) {
    const Scene scene = smooth_scene(n);
    for (const IntegratorEntry& entry : fast_integrators()) {
      for (const int threads : {1, 3}) {
        const auto integrator =
            made(fast_entry(entry, {.iteration = {}, .threads = threads}), *scene.flow);
        Matrix W = scene.initial;
        StepReport report;
        const auto steps = [&] {
          constexpr int until_fitted = 10;
          for (int step = 0; step < until_fitted; ++step) report = continued(*integrator, W, 1e-3);
          EXPECT_EQ(report.status, Status::converged);
          report = integrator->step(W, 2e-3);
        };
        if (threads > 1) integrator->step(W, 2e-3);
        EXPECT_EQ(allocations_during(steps), 0) << entry.name << " n = " << n;
        EXPECT_EQ(report.status, Status::converged);
      }
    }
  }
}

// What a run calls beside its steps, with a trace and without.
TEST(Run, AllocatesNothingWhereItsStateIsSetAmendedOrAskedFor) {
  const Scene scene = smooth_scene(33);
  for (const IntegratorEntry& listed : integrators()) {
    for (const IntegratorEntry& entry : forms_of(listed)) {
      const auto integrator = made(entry, *scene.flow);
      Matrix W = scene.initial, alone = scene.initial;
      integrator->step(alone, 1e-3);
      for (const double c : {0.0, 3.0}) {
        W.diagonal().array() += Complex(0.0, c);
        alone = W;
        const auto calls = [&] {
          integrator->set_state(W);
          integrator->step(1e-3);
          integrator->state(W);
          integrator->set_state(W);
          integrator->step(alone, 1e-3);
          W *= 0.9;
          integrator->amend_state(W);
          integrator->step(1e-3);
          integrator->state(W);
        };
        EXPECT_EQ(allocations_during(calls), 0) << entry.name << " c = " << c;
      }
    }
  }
}

TEST(Step, AllocatesNothingWhereJIsNotTheIdentity) {
  const ConjugationFlow flow(QuadraticAlgebra(symplectic_J(3)), 1);
  // ConjugationFlow's own products allocate.
  const FlowOf quiet(flow.algebra(), [](const Matrix& W, Matrix& B) { B = W; });
  for (const auto& [formulation, s] : methods(3)) {
    const auto integrator = gauss(formulation, quiet, s);
    Matrix W = flow.element(2);
    integrator->step(W, 0.1);
    EXPECT_EQ(allocations_during([&] { integrator->step(W, 0.1); }), 0) << name(formulation);
  }
}

// A sanitizer's malloc tells glibc's statistics nothing, so that nothing could be asked for.
#ifndef __SANITIZE_ADDRESS__
// What is asked for before an integrator is made is between these multiples of what it takes, with
// OpenBLAS's products: Eigen's have blocks of their own.
void expect_bytes(const IntegratorEntry& entry, Index n, double least, double most) {
  const Scene scene = smooth_scene(n);
  const long before = bytes_in_use();
  const auto integrator = entry.make(scene.flow, {}, ProductBackend::openblas);
  const auto bytes = static_cast<double>(bytes_in_use() - before);
  const double asked = integrator_bytes(entry, n);
  EXPECT_GE(asked, least * bytes) << entry.name << " n = " << n;
  EXPECT_LE(asked, most * bytes) << entry.name << " n = " << n;
}

TEST(Memory, OfAPublishedFormIsWhatIsAskedFor) {
  for (const Index n : {33, 193}) {
    for (const IntegratorEntry& entry : integrators()) expect_bytes(entry, n, 0.9, 1.1);
    expect_bytes(gauss_entry(Formulation::algebra, 6), n, 0.9, 1.1);
  }
}

TEST(Memory, OfAFastFormIsWhatIsAskedFor) {
  for (const Index n : {33, 65, 129, 193}) {
    const FastOptions options = with_defaults({}, n);
    for (const IntegratorEntry& entry : fast_integrators()) {
      expect_bytes(fast_entry(entry, options), n, 0.9, 1.1);
    }
    for (const Formulation formulation : formulations()) {
      expect_bytes(fast_gauss_entry(formulation, 6, options), n, 0.9, 1.1);
    }
  }
}
#endif

}  // namespace
}  // namespace isosyrk::testing
