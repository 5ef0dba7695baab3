#include "benchmarks/peak.h"

#include <algorithm>

#include "isosyrk/machine/clocks.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace isosyrk {
namespace {

// A loop of fused multiply-adds, x = x f + t, in as many independent chains as keep the units busy,
// and the operations of a round.
struct Chains {
  void (*run)(long rounds);
  double flops_of_a_round;
};

// Of the vectors that this file is compiled for.
namespace baseline {
constexpr int width = 2;
constexpr int chains = 8;
using Vector [[gnu::vector_size(width * sizeof(double))]] = double;

void run(long rounds) {
  Vector sum[chains];
  for (Vector& x : sum) x = Vector{1.0, 1.0};
  Vector f{0.999, 0.999};
  Vector t{1e-3, 1e-3};
  asm volatile("" : "+m"(f), "+m"(t));  // unknown to the optimiser
  const Vector factor = f;
  const Vector term = t;
  for (long round = 0; round < rounds; ++round) {
    for (Vector& x : sum) x = x * factor + term;
  }
  for (Vector& x : sum) asm volatile("" : "+m"(x));
}
}  // namespace baseline

#if defined(__x86_64__)
constexpr int chains_avx2 = 12;
constexpr int chains_avx512 = 16;

[[gnu::target("avx2,fma")]] void run_avx2(long rounds) {
  __m256d sum[chains_avx2];
  for (__m256d& x : sum) x = _mm256_set1_pd(1.0);
  __m256d f = _mm256_set1_pd(0.999);
  __m256d t = _mm256_set1_pd(1e-3);
  asm volatile("" : "+m"(f), "+m"(t));
  const __m256d factor = f;
  const __m256d term = t;
  for (long round = 0; round < rounds; ++round) {
    for (__m256d& x : sum) x = _mm256_fmadd_pd(x, factor, term);
  }
  for (__m256d& x : sum) asm volatile("" : "+m"(x));
}

[[gnu::target("avx512f")]] void run_avx512(long rounds) {
  __m512d sum[chains_avx512];
  for (__m512d& x : sum) x = _mm512_set1_pd(1.0);
  __m512d f = _mm512_set1_pd(0.999);
  __m512d t = _mm512_set1_pd(1e-3);
  asm volatile("" : "+m"(f), "+m"(t));
  const __m512d factor = f;
  const __m512d term = t;
  for (long round = 0; round < rounds; ++round) {
    for (__m512d& x : sum) x = _mm512_fmadd_pd(x, factor, term);
  }
  for (__m512d& x : sum) asm volatile("" : "+m"(x));
}
#endif

// The widest that the processor has: libraries choose their kernels so too, whatever this program
// is compiled for.
Chains widest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return {run_avx512, 2.0 * 8 * chains_avx512};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return {run_avx2, 2.0 * 4 * chains_avx2};
  }
#endif
  return {baseline::run, 2.0 * baseline::width * baseline::chains};
}

double flops_per_second(long rounds) {
  static const Chains chains = widest();
  const double start = cpu_seconds();
  chains.run(rounds);
  return chains.flops_of_a_round * static_cast<double>(rounds) / (cpu_seconds() - start);
}

}  // namespace

double measured_peak_flops() {
  double best = 0.0;
  for (int run = 0; run < 20; ++run) best = std::max(best, flops_per_second(100000));
  return best;
}

double peak_flops_now() { return flops_per_second(50000); }

const char* compiled_vector_units() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__FMA__)
  return "AVX2 with FMA";
#else
  return "baseline";
#endif
}

}  // namespace isosyrk
