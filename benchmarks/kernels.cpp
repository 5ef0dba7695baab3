// The parts a sweep is made of: products of each backend and of split matrices, the Poisson solve,
// and the core's peak.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "benchmarks/arguments.h"
#include "benchmarks/benchmark_program.h"
#include "benchmarks/command_line.h"
#include "benchmarks/median.h"
#include "benchmarks/peak.h"
#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/machine/clocks.h"
#include "isosyrk/scenes/euler_zeitlin_scenes.h"
#include "isosyrk/split/skew.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk::kernels {
namespace {

const std::vector<Index> sizes = {17, 33, 65, 129};

// ‖C - AB‖_F / (‖A‖_F ‖B‖_F u), the error of a product in units of Real's roundoff.
template <class Real = double>
double product_error(const Matrix& A, const Matrix& B, const Matrix& C) {
  using Extended = std::complex<long double>;
  const auto exact = A.cast<Extended>().lazyProduct(B.cast<Extended>());
  const auto error = static_cast<double>((exact - C.cast<Extended>()).norm());
  constexpr double unit_roundoff = 0.5 * std::numeric_limits<Real>::epsilon();
  return error / (A.norm() * B.norm() * unit_roundoff);
}

// Two factors as they meet in a sweep: W and B(W).
struct Factors {
  explicit Factors(Index n) : W(smooth_scene(n).initial), B(n, n) {
    smooth_scene(n).flow->generator(W, B);
  }
  Matrix W, B;
};

// Share of the core's peak that `multiply` reaches, one product of so many flops: the median of
// many short runs, each over the peak just before and just after it, since on a shared machine a
// core's speed changes by a third from one millisecond to another.
template <class Multiply>
double median_share_of_peak(double flops, double peaks, Multiply&& multiply) {
  constexpr int turns = 21;
  constexpr double seconds = 3e-4;  // of a turn, at least
  std::vector<double> shares;
  double before = peak_flops_now();
  for (int turn = 0; turn < turns; ++turn) {
    const long products = std::lround(std::max(1.0, seconds * peaks * before / flops));
    const double start = cpu_seconds();
    for (long k = 0; k < products; ++k) multiply();
    const double rate = static_cast<double>(products) * flops / (cpu_seconds() - start);
    const double after = peak_flops_now();
    shares.push_back(rate / (peaks * 0.5 * (before + after)));
    before = after;
  }
  return median(std::move(shares));
}

// Times `multiply`, one product; a triangle counts as one.  In single precision a vector holds
// twice as many numbers, and the peak is twice as high.
template <class Real = double, class Multiply>
void time_products(benchmark::State& state, Index n, Multiply&& multiply) {
  long products = 0;
  const double start = cpu_seconds();
  for ([[maybe_unused]] auto _ : state) {
    multiply();
    ++products;
  }
  const double flops = static_cast<double>(products) * product_flops(n) / (cpu_seconds() - start);
  state.counters["gflops"] = 1e-9 * flops;
  constexpr double peaks = sizeof(double) / sizeof(Real);
  state.counters["share_of_peak"] = median_share_of_peak(product_flops(n), peaks, multiply);
}

void product(benchmark::State& state, ProductBackend backend, Index n) {
  const Factors given(n);
  Matrix C(n, n);
  Products products(backend, n);
  time_products(state, n, [&] {
    products.multiply(given.W, given.B, C);
    benchmark::DoNotOptimize(C.data());
  });
  state.counters["error_in_roundoffs"] = product_error(given.W, given.B, C);
}

// A B or A† B, in double or in single precision.
template <class Real, bool of_adjoint = false>
void split_product(benchmark::State& state, const GemmKernel& kernel, Index n) {
  const Factors given(n);
  const SplitMatrixOf<Real> W(given.W), B(given.B);
  SplitMatrixOf<Real> C(n);
  SplitProductsOf<Real> products(n, kernel);
  time_products<Real>(state, n, [&] {
    products.form(into(C, of_adjoint ? adjoint(W) * B : W * B));
    benchmark::DoNotOptimize(C.re());
  });
  const Matrix left = W.interleaved();
  state.counters["error_in_roundoffs"] =
      product_error<Real>(of_adjoint ? left.adjoint() : left, B.interleaved(), C.interleaved());
}

// B (W B), which is skew-Hermitian: its upper triangle and the mirror of that.
void split_triangle(benchmark::State& state, const GemmKernel& kernel, Index n) {
  const Factors given(n);
  const SplitMatrix W(given.W), B(given.B);
  SplitMatrix WB(n), C(n);
  SplitProducts products(n, kernel);
  products.form(into(WB, W * B));
  time_products(state, n, [&] {
    products.form(into(C, B * WB).upper_triangle());
    mirror_skew(C);
    benchmark::DoNotOptimize(C.re());
  });
  state.counters["error_in_roundoffs"] = product_error(given.B, WB.interleaved(), C.interleaved());
}

void split_poisson(benchmark::State& state, Index n) {
  const Laplacian laplacian(n);
  const SplitLaplacianOf<double> split(laplacian);
  const Matrix given = smooth_scene(n).initial;
  const SplitStages W = {SplitMatrix(given)};
  SplitStages P = {SplitMatrix(n)};
  for ([[maybe_unused]] auto _ : state) {
    split.solve_upper(W, 1.0, n - 1, P);
    mirror_skew(P);
    benchmark::DoNotOptimize(P[0].re());
  }
  Matrix back(n, n);
  laplacian.apply(P[0].interleaved(), back);
  state.counters["residual"] = (back - given).norm() / given.norm();
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

struct Row {
  std::string name;
  std::function<void(benchmark::State&)> time;
};

std::vector<Row> all_rows() {
  using State = benchmark::State;
  const std::vector<std::pair<std::string_view, void (*)(State&, const GemmKernel&, Index)>>
      split_parts = {{"product", split_product<double>},
                     {"adjoint", split_product<double, true>},
                     {"single", split_product<float>},
                     {"triangle", split_triangle}};
  std::vector<Row> rows = {{"kernels/peak", peak_rate}};
  for (const Index n : sizes) {
    for (const ProductBackend backend : product_backends()) {
      rows.push_back({fmt::format("kernels/product/{}/n:{}", name(backend), n),
                      [=](State& state) { product(state, backend, n); }});
    }
    for (const GemmKernel& kernel : gemm_kernels()) {
      for (const auto& [part, time] : split_parts) {
        rows.push_back({fmt::format("kernels/{}/split_{}/n:{}", part, kernel.name, n),
                        [=, run = time](State& state) { run(state, kernel, n); }});
      }
    }
    rows.push_back(
        {fmt::format("kernels/poisson/n:{}", n), [=](State& state) { poisson(state, n); }});
    rows.push_back({fmt::format("kernels/poisson/split/n:{}", n),
                    [=](State& state) { split_poisson(state, n); }});
  }
  return rows;
}

}  // namespace

int main_program(int argc, char** argv) {
  CommandLine line{
      "Measures matrix products per backend, the Poisson solve and the core's multiply-add peak at "
      "n = 17, 33, 65, 129.  Takes Google Benchmark's arguments."};
  line.allow_extras();
  if (const auto exit_code = line.parse(argc, argv)) return *exit_code;
  use_one_blas_thread();
  const std::vector<Row> rows = all_rows();
  std::vector<std::string> names;
  for (const Row& row : rows) names.push_back(row.name);
  const BenchmarkArguments arguments = read_benchmark_arguments(line.remaining(), names);
  for (const Row& row : rows) {
    benchmark::RegisterBenchmark(row.name.c_str(), row.time)->Unit(benchmark::kMicrosecond);
  }
  std::vector<BackendRates> rates;
  for (const Index n : sizes) rates.push_back(choose_backend(std::nullopt, n));
  return run_benchmarks(argv[0], arguments, machine_conditions("kernels", std::nullopt, rates));
}

}  // namespace isosyrk::kernels
