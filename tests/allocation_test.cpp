// Nothing allocates inside a step.  This program replaces malloc to count; where AddressSanitizer
// has replaced it already, its hooks count instead.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "tests/support.h"

namespace {

std::atomic<long> allocations{0};

}  // namespace

#if defined(__SANITIZE_ADDRESS__)

extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             size_t),
                                                         void (*free_hook)(const volatile void*));
namespace {
const int hooks_installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, size_t) { ++allocations; }, [](const volatile void*) {});
}  // namespace

#else

// glibc lets a program put its own allocator in front; these count and pass on.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, size_t size) {
  ++allocations;
  return __libc_realloc(old, size);
}
void* memalign(size_t alignment, size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, size_t alignment, size_t size) {
  ++allocations;
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? 12 : 0;
}
}

#endif

namespace isosyrk::testing {
namespace {

long allocations_during(const std::function<void()>& action) {
  const long before = allocations;
  action();
  return allocations - before;
}

TEST(AllocationCounter, SeesAnAllocation) {
  EXPECT_GE(allocations_during([] {
              Matrix X(40, 40);
              X.setZero();
              EXPECT_EQ(X(3, 3), 0.0);
            }),
            1);
}

TEST(Step, AllocatesNothingForAnyIntegratorBackendAndSize) {
  for (const Index n : {5, 17, 66, 129}) {
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
