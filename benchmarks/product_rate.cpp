#include "benchmarks/product_rate.h"

#include <cblas.h>
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <utility>

#include "benchmarks/median.h"
#include "isosyrk/machine/clocks.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

namespace {

Matrix random_matrix(Index n, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Matrix X(n, n);
  for (Index i = 0; i < n * n; ++i) X.data()[i] = {uniform(generator), uniform(generator)};
  return X;
}

// Calls of `multiply`, one product, in a second.
template <class Multiply>
double rate(Index n, double seconds, Multiply&& multiply) {
  constexpr int blocks = 9;
  multiply();  // touches all memory
  const double least = seconds / blocks;
  std::vector<double> rates;
  for (int block = 0; block < blocks; ++block) {
    // Read the clock once in about 20 microseconds, so that it does not weigh at small n.
    const long batch = std::max(1L, static_cast<long>(1e6 / product_flops(n)));
    const double start = cpu_seconds();
    long products = 0;
    double elapsed = 0.0;
    do {
      for (long k = 0; k < batch; ++k) multiply();
      products += batch;
      elapsed = cpu_seconds() - start;
    } while (elapsed < least);
    rates.push_back(static_cast<double>(products) / elapsed);
  }
  return median(std::move(rates));
}

}  // namespace

double product_rate(ProductBackend backend, Index n, double seconds) {
  std::mt19937_64 generator(1);
  const Matrix A = random_matrix(n, generator);
  const Matrix B = random_matrix(n, generator);
  Matrix C(n, n);
  Products products(backend, n);
  return rate(n, seconds, [&] { products.multiply(A, B, C); });
}

double split_product_rate(Index n, double seconds) {
  std::mt19937_64 generator(1);
  const SplitMatrix A(random_matrix(n, generator));
  const SplitMatrix B(random_matrix(n, generator));
  SplitMatrix C(n);
  SplitProducts products(n);
  return rate(n, seconds, [&] { products.form(into(C, A * B)); });
}

BackendChoice backend_choice_from_name(std::string_view wanted) {
  if (wanted == "fastest") return std::nullopt;
  for (const ProductBackend backend : product_backends()) {
    if (name(backend) == wanted) return backend;
  }
  throw std::invalid_argument(
      fmt::format("products '{}': must be fastest, openblas or eigen", wanted));
}

BackendRates choose_backend(BackendChoice choice, Index n) {
  constexpr Index largest_measured = 257;
  constexpr double seconds = 0.02;
  BackendRates result;
  result.n = std::min(n, largest_measured);
  double best = 0.0;
  for (const ProductBackend backend : product_backends()) {
    const double rate = product_rate(backend, result.n, seconds);
    result.rates.push_back(rate);
    if (rate > best) {
      best = rate;
      result.chosen = backend;
    }
  }
  if (choice) result.chosen = *choice;
  return result;
}

void use_one_blas_thread() { openblas_set_num_threads(1); }

}  // namespace isosyrk
