#include "benchmarks/peak.h"

#include <algorithm>

#include "benchmarks/product_rate.h"

namespace isosyrk {
namespace {

#if defined(__AVX512F__)
constexpr int width = 8;
constexpr int chains = 16;
#elif defined(__FMA__)
constexpr int width = 4;
constexpr int chains = 12;
#else
constexpr int width = 2;
constexpr int chains = 8;
#endif

using Vector [[gnu::vector_size(width * sizeof(double))]] = double;

Vector splat(double value) {
  Vector v;
  for (int i = 0; i < width; ++i) v[i] = value;
  return v;
}

// `chains` independent dependent chains keep both multiply-add units busy.
double run_chains(long rounds) {
  Vector sum[chains];
  for (Vector& x : sum) x = splat(1.0);
  Vector factor = splat(0.999);
  Vector term = splat(1e-3);
  asm volatile("" : "+m"(factor), "+m"(term));  // unknown to the optimiser
  const Vector f = factor;
  const Vector t = term;
  const double start = cpu_seconds();
  for (long round = 0; round < rounds; ++round) {
    for (Vector& x : sum) {
#if defined(__AVX512F__)
      x = __builtin_ia32_vfmaddpd512_mask(x, f, t, static_cast<unsigned char>(-1), 4);
#elif defined(__FMA__)
      x = __builtin_ia32_vfmaddpd256(x, f, t);
#else
      x = x * f + t;
#endif
    }
  }
  const double elapsed = cpu_seconds() - start;
  for (Vector& x : sum) asm volatile("" : "+m"(x));
  return 2.0 * width * chains * static_cast<double>(rounds) / elapsed;
}

}  // namespace

double measured_peak_flops() {
  double best = 0.0;
  for (int run = 0; run < 20; ++run) best = std::max(best, run_chains(100000));
  return best;
}

double peak_flops_now() { return run_chains(50000); }

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
