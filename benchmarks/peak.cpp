#include "benchmarks/peak.h"

#include <algorithm>

#include "isosyrk/machine/clocks.h"

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
void run_chains(long rounds) {
  Vector sum[chains];
  for (Vector& x : sum) x = splat(1.0);
  Vector factor = splat(0.999);
  Vector term = splat(1e-3);
  asm volatile("" : "+m"(factor), "+m"(term));  // unknown to the optimiser
  const Vector f = factor;
  const Vector t = term;
  for (long round = 0; round < rounds; ++round) {
    for (Vector& x : sum) x = x * f + t;  // one instruction where the processor has it
  }
  for (Vector& x : sum) asm volatile("" : "+m"(x));
}

double flops_per_second(long rounds) {
  const double start = cpu_seconds();
  run_chains(rounds);
  return 2.0 * width * chains * static_cast<double>(rounds) / (cpu_seconds() - start);
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
