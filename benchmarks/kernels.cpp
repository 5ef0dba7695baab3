// The parts a sweep is made of: products of each backend, the Poisson solve, and the core's peak.
#include <fmt/format.h>

#include "benchmarks/arguments.h"
#include "benchmarks/benchmark_program.h"
#include "benchmarks/command_line.h"
#include "benchmarks/peak.h"
#include "core/scene.h"

namespace isosyrk {
namespace {

const std::vector<Index> sizes = {17, 33, 65, 129};

std::string product_name(ProductBackend backend, Index n) {
  return fmt::format("kernels/product/{}/n:{}", name(backend), n);
}
std::string poisson_name(Index n) { return fmt::format("kernels/poisson/n:{}", n); }

// ‖C - AB‖_F / (‖A‖_F ‖B‖_F u), the error of a product in units of roundoff.
double product_error(const Matrix& A, const Matrix& B, const Matrix& C) {
  using Extended = Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic>;
  const Extended exact =
      Extended(A.cast<std::complex<long double>>()) * Extended(B.cast<std::complex<long double>>());
  const auto error =
      static_cast<double>((exact - Extended(C.cast<std::complex<long double>>())).norm());
  constexpr double unit_roundoff = 0.5 * std::numeric_limits<double>::epsilon();
  return error / (A.norm() * B.norm() * unit_roundoff);
}

void product(benchmark::State& state, ProductBackend backend, Index n, double peak) {
  const Matrix A = smooth_scene(n).initial;
  Matrix B(n, n);
  smooth_scene(n).flow->generator(A, B);
  Matrix C(n, n);
  Products products(backend, n);
  const double start = cpu_seconds();
  for ([[maybe_unused]] auto _ : state) {
    products.multiply(A, B, C);
    benchmark::DoNotOptimize(C.data());
  }
  const double flops =
      static_cast<double>(products.count()) * product_flops(n) / (cpu_seconds() - start);
  state.counters["gflops"] = 1e-9 * flops;
  state.counters["share_of_peak"] = flops / peak;
  state.counters["error_in_roundoffs"] = product_error(A, B, C);
}

void poisson(benchmark::State& state, Index n) {
  const EulerZeitlin flow(n);
  const Matrix W = smooth_scene(n).initial;
  Matrix P(n, n);
  for ([[maybe_unused]] auto _ : state) {
    flow.laplacian().solve_skew_hermitian(W, 1.0, P);
    benchmark::DoNotOptimize(P.data());
  }
  Matrix back(n, n);
  flow.laplacian().apply(P, back);
  state.counters["residual"] = (back - W).norm() / W.norm();
}

void peak_rate(benchmark::State& state) {
  double flops = 0.0;
  for ([[maybe_unused]] auto _ : state) flops = measured_peak_flops();
  state.counters["gflops"] = 1e-9 * flops;
}

int main_program(int argc, char** argv) {
  CommandLine line{
      "Measures matrix products per backend, the Poisson solve and the core's multiply-add peak at "
      "n = 17, 33, 65, 129.  Takes Google Benchmark's arguments."};
  line.allow_others();
  if (const auto exit_code = line.read(argc, argv)) return *exit_code;
  use_one_blas_thread();
  std::vector<std::string> names = {"kernels/peak"};
  for (const Index n : sizes) {
    for (const ProductBackend backend : product_backends()) {
      names.push_back(product_name(backend, n));
    }
    names.push_back(poisson_name(n));
  }
  const BenchmarkArguments arguments(line.others(), names);

  const double peak = measured_peak_flops();
  std::vector<BackendRates> rates;
  benchmark::RegisterBenchmark("kernels/peak", peak_rate)->Unit(benchmark::kMillisecond);
  for (const Index n : sizes) {
    rates.push_back(choose_backend(std::nullopt, n));
    for (const ProductBackend backend : product_backends()) {
      benchmark::RegisterBenchmark(product_name(backend, n).c_str(), product, backend, n, peak)
          ->Unit(benchmark::kMicrosecond);
    }
    benchmark::RegisterBenchmark(poisson_name(n).c_str(), poisson, n)
        ->Unit(benchmark::kMicrosecond);
  }
  return run_benchmarks(argv[0], arguments, machine_conditions("kernels", std::nullopt, rates));
}

}  // namespace
}  // namespace isosyrk

int main(int argc, char** argv) {
  return isosyrk::guarded("kernels", [&] { return isosyrk::main_program(argc, argv); });
}
